/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/directory/directory.h"

#include "core/attributes.h"
#include "core/name.h"
#include "core/text.h"
#include "muster/memory.h"

#include <string.h>

void services_init(struct services *s)
{
    *s = (struct services){.soonest_ns = UINT64_MAX};
    mu_pairs_init(&s->pairs, MU_SERVICES_MAX);
    mu_pairs_init(&s->by_agent, MU_SERVICES_MAX);
    s->lines = mu_startup_array(MU_SERVICES_MAX, sizeof *s->lines);
    s->line_of = mu_startup_array(MU_SERVICES_MAX, sizeof *s->line_of);
    changelog_init(&s->changes, MU_SERVICES_MAX);
}

/* --- room ------------------------------------------------------------------------------------- */

static void line_forget(struct services *s, uint32_t line)
{
    if (s->told_to) {
        subscriptions_forget(s->told_to, line);
    }
    const char *service = mu_pairs_first(&s->pairs, line);
    const char *agent = mu_pairs_second(&s->pairs, line);
    mu_pairs_remove(&s->by_agent, mu_pairs_find(&s->by_agent, agent, service));
    changelog_remove(&s->changes, line);
    mu_pairs_remove(&s->pairs, line);
}

/* @return the oldest line that is withdrawn, and is none of these; MU_NONE: there is none */
static uint32_t spare_find(const struct services *s, const uint64_t kept[SUBSCRIPTIONS_WORDS])
{
    uint32_t line = s->changes.first;
    while (line != MU_NONE &&
           (s->lines[line].offered || changelog_version(&s->changes, line) > s->told ||
            (kept[line / 64] >> (line % 64) & 1) != 0)) {
        line = changelog_next(&s->changes, line);
    }
    return line;
}

/* First of all a line goes that no subscriber who is away is still to hear of.
 * @return whether a line that is withdrawn has made room */
static bool line_spare(struct services *s)
{
    static const uint64_t none[SUBSCRIPTIONS_WORDS];
    uint64_t rest[SUBSCRIPTIONS_WORDS] = {0};
    if (s->told_to) {
        subscriptions_rest(s->told_to, rest);
    }
    uint32_t line = spare_find(s, rest);
    line = line != MU_NONE ? line : spare_find(s, none);
    if (line != MU_NONE) {
        line_forget(s, line);
    }
    return line != MU_NONE;
}

bool services_full(const struct services *s)
{
    return s->pairs.count == MU_SERVICES_MAX;
}

/* @return the line, made if it is not there; MU_NONE: full */
static uint32_t line_get(struct services *s, const char *service, const char *agent)
{
    uint32_t line = mu_pairs_find(&s->pairs, service, agent);
    if (line != MU_NONE || (services_full(s) && !line_spare(s))) {
        return line;
    }
    line = mu_pairs_add(&s->pairs, service, agent);
    uint32_t turned = mu_pairs_add(&s->by_agent, agent, service);
    MU_ASSERT(line != MU_NONE && turned != MU_NONE);
    s->line_of[turned] = line;
    s->lines[line] = (struct service_line){.until_ns = UINT64_MAX};
    return line;
}

/* --- changes ---------------------------------------------------------------------------------- */

static void line_say(struct services *s, uint32_t line, bool offered, const struct said *said)
{
    struct service_line *l = &s->lines[line];
    s->offers_now += (uint32_t)offered - (uint32_t)l->offered;
    l->offered = offered;
    l->stamp_ns = said->stamp_ns > l->stamp_ns ? said->stamp_ns : l->stamp_ns + 1;
    mu_text_copy(l->origin, sizeof l->origin, said->origin);
    changelog_touch(&s->changes, line);
}

/* left_ns: of the lease */
static void lease_begin(struct services *s, uint32_t line, uint64_t left_ns, uint64_t mail_ns)
{
    struct service_line *l = &s->lines[line];
    bool ends = l->lease_ns > 0 && mail_ns <= UINT64_MAX - left_ns;
    l->until_ns = ends ? mail_ns + left_ns : UINT64_MAX;
    s->soonest_ns = l->until_ns < s->soonest_ns ? l->until_ns : s->soonest_ns;
}

const char *services_advertise(struct services *s, const char *service, const char *agent,
                               const struct offer *offer, const struct said *said)
{
    if (!mu_name_valid(service) || !mu_name_valid(agent)) {
        return "not-a-name";
    }
    if (!mu_attributes_valid(offer->attributes)) {
        return "not-attributes";
    }
    uint32_t line = line_get(s, service, agent);
    if (line == MU_NONE) {
        return "full";
    }
    mu_text_copy(s->lines[line].attributes, sizeof s->lines[line].attributes, offer->attributes);
    s->lines[line].lease_ns = offer->lease_ns;
    lease_begin(s, line, offer->lease_ns, offer->mail_ns);
    line_say(s, line, true, said);
    return NULL;
}

const char *services_withdraw(struct services *s, const char *service, const char *agent,
                              const struct said *said)
{
    if (!mu_name_valid(service) || !mu_name_valid(agent)) {
        return "not-a-name";
    }
    uint32_t line = mu_pairs_find(&s->pairs, service, agent);
    if (line == MU_NONE || !s->lines[line].offered) {
        return "not-offered";
    }
    line_say(s, line, false, said);
    return NULL;
}

static bool offer_is_whole(const muster_Offer *o)
{
    return mu_name_valid(o->service) && mu_name_valid(o->agent) &&
           strnlen(o->origin, MU_NAME_MAX + 1) <= MU_NAME_MAX && mu_attributes_valid(o->attributes);
}

mu_result services_merge(struct services *s, const muster_Offer *o, const struct said *said,
                         uint64_t mail_ns)
{
    if (!offer_is_whole(o)) {
        return MU_MALFORMED;
    }
    uint32_t line = mu_pairs_find(&s->pairs, o->service, o->agent);
    if (line != MU_NONE) {
        const struct service_line *l = &s->lines[line];
        bool older = o->stamp_ns < l->stamp_ns ||
                     (o->stamp_ns == l->stamp_ns && strcmp(o->origin, l->origin) <= 0);
        if (older) {
            return MU_EXISTS;
        }
    } else if ((line = line_get(s, o->service, o->agent)) == MU_NONE) {
        return MU_FULL;
    }
    struct service_line *l = &s->lines[line];
    mu_text_copy(l->attributes, sizeof l->attributes, o->attributes);
    l->lease_ns = o->lease_ns;
    uint64_t age_ns = said->stamp_ns > o->stamp_ns ? said->stamp_ns - o->stamp_ns : 0;
    lease_begin(s, line, o->lease_ns > age_ns ? o->lease_ns - age_ns : 0, mail_ns);
    line_say(s, line, o->offered, said);
    l->stamp_ns = o->stamp_ns;
    mu_text_copy(l->origin, sizeof l->origin, o->origin);
    return MU_OK;
}

void services_expire(struct services *s, uint64_t mail_ns)
{
    if (mail_ns < s->soonest_ns) {
        return;
    }
    s->soonest_ns = UINT64_MAX;
    for (uint32_t i = 0; i < s->pairs.count;
         i++) { /* in order of name, to be the same every time */
        uint32_t line = s->pairs.order[i];
        struct service_line *l = &s->lines[line];
        if (!l->offered) {
            continue;
        }
        if (l->until_ns <= mail_ns) {
            s->offers_now--;
            l->offered = false; /* its stamp stays: every broker ends it by itself */
            changelog_touch(&s->changes, line);
        } else if (l->until_ns < s->soonest_ns) {
            s->soonest_ns = l->until_ns;
        }
    }
}

void services_touch(struct services *s, const char *agent)
{
    uint32_t place = mu_pairs_start(&s->by_agent, agent), turned;
    while ((turned = mu_pairs_of(&s->by_agent, place++, agent)) != MU_NONE) {
        if (s->lines[s->line_of[turned]].offered) {
            changelog_touch(&s->changes, s->line_of[turned]);
        }
    }
}

void services_line(const struct services *s, uint32_t line, bool shown, muster_Offer *out)
{
    const struct service_line *l = &s->lines[line];
    *out = (muster_Offer){
        .offered = l->offered && shown, .lease_ns = l->lease_ns, .stamp_ns = l->stamp_ns};
    out->service = sample_text(mu_pairs_first(&s->pairs, line));
    out->agent = sample_text(mu_pairs_second(&s->pairs, line));
    out->attributes = sample_text(l->attributes);
    out->origin = sample_text(l->origin);
}
