/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/directory/directory.h"

#include "core/name.h"

const char *services_advertise(struct lines *s, const struct line_word *word,
                               const struct said *said)
{
    if (!mu_name_valid(word->key) || !mu_name_valid(word->agent)) {
        return "not-a-name";
    }
    if (!mu_attributes_valid(word->attributes)) {
        return "not-attributes";
    }
    uint32_t line = lines_get(s, word->key, word->agent);
    if (line == MU_NONE) {
        return "full";
    }
    lines_offer(s, line, word, word->lease_ns, said);
    lines_say(s, line, true, said);
    return NULL;
}

const char *services_withdraw(struct lines *s, const char *service, const char *agent,
                              const struct said *said)
{
    if (!mu_name_valid(service) || !mu_name_valid(agent)) {
        return "not-a-name";
    }
    uint32_t line = mu_pairs_find(&s->pairs, service, agent);
    if (line == MU_NONE || !s->at[line].holds) {
        return "not-offered";
    }
    lines_say(s, line, false, said);
    return NULL;
}

void services_expire(struct lines *s, uint64_t mail_ns)
{
    if (mail_ns < s->soonest_ns) {
        return;
    }
    s->soonest_ns = UINT64_MAX;
    for (uint32_t i = 0; i < s->pairs.count; i++) { /* by name: the same every time */
        uint32_t line = s->pairs.order[i];
        uint64_t until_ns = s->offers[line].until_ns;
        if (!s->at[line].holds) {
            continue;
        }
        if (until_ns <= mail_ns) {
            s->now--; /* its stamp stays: every broker ends it by itself */
            s->at[line].holds = s->at[line].holds_inside = false;
            changelog_touch(&s->changes, line);
        } else if (until_ns < s->soonest_ns) {
            s->soonest_ns = until_ns;
        }
    }
}

void services_touch(struct lines *s, const char *agent)
{
    uint32_t place = mu_pairs_start(&s->by_agent, agent), turned;
    while ((turned = mu_pairs_of(&s->by_agent, place++, agent)) != MU_NONE) {
        if (s->at[s->line_of[turned]].holds) {
            changelog_touch(&s->changes, s->line_of[turned]);
        }
    }
}
