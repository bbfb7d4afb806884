/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/directory/directory.h"

#include "core/name.h"
#include "core/text.h"
#include "muster/memory.h"

#include <string.h>

void lines_init(struct lines *l, enum lines_kind kind)
{
    uint32_t capacity = kind == LINES_GROUPS ? MU_MEMBERSHIPS_MAX : MU_SERVICES_MAX;
    *l = (struct lines){.soonest_ns = UINT64_MAX, .keys_max = MU_GROUPS_MAX};
    mu_pairs_init(&l->pairs, capacity);
    l->at = mu_startup_array(capacity, sizeof *l->at);
    changelog_init(&l->changes, capacity);
    if (kind == LINES_SERVICES) {
        l->keys_max = capacity + 1;
        l->offers = mu_startup_array(capacity, sizeof *l->offers);
        mu_pairs_init(&l->by_agent, capacity);
        l->line_of = mu_startup_array(capacity, sizeof *l->line_of);
    }
}

/* --- room ------------------------------------------------------------------------------------- */

static bool key_has_lines(const struct lines *l, const char *key)
{
    return mu_pairs_of(&l->pairs, mu_pairs_start(&l->pairs, key), key) != MU_NONE;
}

static void line_forget(struct lines *l, uint32_t line)
{
    char key[MU_NAME_MAX + 1];
    mu_text_copy(key, sizeof key, mu_pairs_first(&l->pairs, line));
    if (l->told_to) {
        subscriptions_forget(l->told_to, line);
    }
    if (l->offers) {
        const char *agent = mu_pairs_second(&l->pairs, line);
        mu_pairs_remove(&l->by_agent, mu_pairs_find(&l->by_agent, agent, key));
    }
    changelog_remove(&l->changes, line);
    mu_pairs_remove(&l->pairs, line);
    l->keys -= !key_has_lines(l, key);
}

/* A line that says nothing any more, and that all have been told of. */
static bool line_is_spare(const struct lines *l, uint32_t line)
{
    const struct line *at = &l->at[line];
    return !at->holds && !at->holds_inside && changelog_version(&l->changes, line) <= l->told;
}

/* @return the oldest spare line that is none of these; MU_NONE: there is none */
static uint32_t spare_find(const struct lines *l, const uint64_t kept[SUBSCRIPTIONS_WORDS])
{
    uint32_t line = mu_list_first(&l->changes.list);
    while (line != MU_NONE &&
           (!line_is_spare(l, line) || (kept && (kept[line / 64] >> (line % 64) & 1) != 0))) {
        line = changelog_next(&l->changes, line);
    }
    return line;
}

/* A line that an absent subscriber is still to hear of goes last.
 * @return whether a spare line has made room */
static bool line_spare(struct lines *l)
{
    uint64_t rest[SUBSCRIPTIONS_WORDS];
    uint32_t line = MU_NONE;
    if (l->told_to) {
        subscriptions_rest(l->told_to, rest);
        line = spare_find(l, rest);
    }
    line = line != MU_NONE ? line : spare_find(l, NULL);
    if (line != MU_NONE) {
        line_forget(l, line);
    }
    return line != MU_NONE;
}

static bool key_is_spare(const struct lines *l, const char *key)
{
    uint32_t place = mu_pairs_start(&l->pairs, key), line;
    while ((line = mu_pairs_of(&l->pairs, place, key)) != MU_NONE && line_is_spare(l, line)) {
        place++;
    }
    return line == MU_NONE;
}

/* @return whether a key whose lines are all spare has made room, the oldest first */
static bool key_spare(struct lines *l)
{
    char key[MU_NAME_MAX + 1];
    uint32_t line = mu_list_first(&l->changes.list);
    while (line != MU_NONE && !key_is_spare(l, mu_pairs_first(&l->pairs, line))) {
        line = changelog_next(&l->changes, line);
    }
    if (line == MU_NONE) {
        return false;
    }
    mu_text_copy(key, sizeof key, mu_pairs_first(&l->pairs, line));
    uint32_t place = mu_pairs_start(&l->pairs, key);
    while ((line = mu_pairs_of(&l->pairs, place, key)) != MU_NONE) {
        line_forget(l, line);
    }
    return true;
}

bool lines_full(const struct lines *l)
{
    /* A change takes two lines at most: the group's own and a member's. */
    return l->pairs.count + 2 > l->pairs.capacity || l->keys == l->keys_max;
}

uint32_t lines_get(struct lines *l, const char *key, const char *agent)
{
    uint32_t line = mu_pairs_find(&l->pairs, key, agent);
    if (line != MU_NONE) {
        return line;
    }
    if ((!key_has_lines(l, key) && l->keys == l->keys_max && !key_spare(l)) ||
        (l->pairs.count == l->pairs.capacity && !line_spare(l))) {
        return MU_NONE;
    }
    l->keys += !key_has_lines(l, key);
    line = mu_pairs_add(&l->pairs, key, agent);
    MU_ASSERT(line != MU_NONE);
    l->at[line] = (struct line){0};
    if (l->offers) {
        l->offers[line] = (struct line_offer){.until_ns = UINT64_MAX};
        l->line_of[mu_pairs_add(&l->by_agent, agent, key)] = line;
    }
    return line;
}

/* --- changes ---------------------------------------------------------------------------------- */

/* What is said here is younger than all that was known here, whatever another clock showed. */
void lines_say(struct lines *l, uint32_t line, bool holds, const struct said *said)
{
    struct line *at = &l->at[line];
    bool is_key = mu_pairs_second(&l->pairs, line)[0] == '\0';
    *(is_key ? &l->keys_now : &l->now) += (uint32_t)holds - (uint32_t)at->holds;
    at->holds = holds;
    at->holds_inside = said->inside || l->offers ? holds : at->holds_inside;
    at->stamp_ns = said->stamp_ns > at->stamp_ns ? said->stamp_ns : at->stamp_ns + 1;
    mu_text_copy(at->origin, sizeof at->origin, said->origin);
    changelog_touch(&l->changes, line);
}

void lines_offer(struct lines *l, uint32_t line, const struct line_word *w, uint64_t left_ns,
                 const struct said *now)
{
    struct line_offer *o = &l->offers[line];
    bool ends = w->lease_ns > 0 && now->mail_ns <= UINT64_MAX - left_ns;
    mu_text_copy(o->attributes, sizeof o->attributes, w->attributes);
    o->lease_ns = w->lease_ns;
    o->until_ns = ends ? now->mail_ns + left_ns : UINT64_MAX;
    l->soonest_ns = o->until_ns < l->soonest_ns ? o->until_ns : l->soonest_ns;
}

static bool word_is_whole(const struct lines *l, const struct line_word *w)
{
    bool of_agent = l->offers || w->agent[0] != '\0';
    return mu_name_valid(w->key) && (!of_agent || mu_name_valid(w->agent)) &&
           strnlen(w->origin, MU_NAME_MAX + 1) <= MU_NAME_MAX &&
           (!l->offers || mu_attributes_valid(w->attributes));
}

mu_result lines_merge(struct lines *l, const struct line_word *w, const struct said *now)
{
    if (!word_is_whole(l, w)) {
        return MU_MALFORMED;
    }
    uint32_t line = lines_get(l, w->key, w->agent);
    if (line == MU_NONE) {
        return MU_FULL;
    }
    struct line *at = &l->at[line];
    if (changelog_version(&l->changes, line) > 0 &&
        (w->stamp_ns < at->stamp_ns ||
         (w->stamp_ns == at->stamp_ns && strcmp(w->origin, at->origin) <= 0))) {
        return MU_EXISTS;
    }
    if (l->offers) {
        uint64_t age_ns = now->stamp_ns > w->stamp_ns ? now->stamp_ns - w->stamp_ns : 0;
        uint64_t left_ns = w->lease_ns > age_ns ? w->lease_ns - age_ns : 0;
        lines_offer(l, line, w, left_ns, now);
    }
    lines_say(l, line, w->present, now);
    at->stamp_ns = w->stamp_ns;
    mu_text_copy(at->origin, sizeof at->origin, w->origin);
    return MU_OK;
}

struct line_word lines_word(const struct lines *l, uint32_t line, bool inside)
{
    const struct line *at = &l->at[line];
    return (struct line_word){.key = mu_pairs_first(&l->pairs, line),
                              .agent = mu_pairs_second(&l->pairs, line),
                              .present = inside ? at->holds_inside : at->holds,
                              .attributes = l->offers ? l->offers[line].attributes : "",
                              .origin = at->origin,
                              .lease_ns = l->offers ? l->offers[line].lease_ns : 0,
                              .stamp_ns = at->stamp_ns};
}
