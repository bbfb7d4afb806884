/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/directory/directory.h"

#include "core/name.h"
#include "core/text.h"
#include "muster/memory.h"

#include <string.h>

void groups_init(struct groups *g)
{
    *g = (struct groups){0};
    mu_pairs_init(&g->pairs, MU_MEMBERSHIPS_MAX);
    g->lines = mu_startup_array(MU_MEMBERSHIPS_MAX, sizeof *g->lines);
    changelog_init(&g->changes, MU_MEMBERSHIPS_MAX);
}

static bool line_holds(const struct group_line *line, bool inside)
{
    return inside ? line->joined_inside : line->joined;
}

/* --- room ------------------------------------------------------------------------------------- */

/* @return whether any line of the group is there */
static bool group_has_lines(const struct groups *g, const char *group)
{
    return mu_pairs_of(&g->pairs, mu_pairs_start(&g->pairs, group), group) != MU_NONE;
}

static void line_forget(struct groups *g, uint32_t line)
{
    char group[MU_NAME_MAX + 1];
    mu_text_copy(group, sizeof group, mu_pairs_first(&g->pairs, line));
    changelog_remove(&g->changes, line);
    mu_pairs_remove(&g->pairs, line);
    g->count -= !group_has_lines(g, group);
}

/* A line that says nothing any more, and that everybody has been told of. */
static bool line_is_spare(const struct groups *g, uint32_t line)
{
    const struct group_line *l = &g->lines[line];
    return !l->joined && !l->joined_inside && changelog_version(&g->changes, line) <= g->told;
}

/* @return whether a line has made room, the oldest first */
static bool line_spare(struct groups *g)
{
    for (uint32_t line = g->changes.first; line != MU_NONE;
         line = changelog_next(&g->changes, line)) {
        if (line_is_spare(g, line)) {
            line_forget(g, line);
            return true;
        }
    }
    return false;
}

static bool group_is_spare(const struct groups *g, const char *group)
{
    uint32_t place = mu_pairs_start(&g->pairs, group), line;
    while ((line = mu_pairs_of(&g->pairs, place, group)) != MU_NONE && line_is_spare(g, line)) {
        place++;
    }
    return line == MU_NONE;
}

/* @return whether a group that is no more has made room, the oldest first */
static bool group_spare(struct groups *g)
{
    char group[MU_NAME_MAX + 1];
    uint32_t line = g->changes.first;
    while (line != MU_NONE && !group_is_spare(g, mu_pairs_first(&g->pairs, line))) {
        line = changelog_next(&g->changes, line);
    }
    if (line == MU_NONE) {
        return false;
    }
    mu_text_copy(group, sizeof group, mu_pairs_first(&g->pairs, line));
    uint32_t place = mu_pairs_start(&g->pairs, group);
    while ((line = mu_pairs_of(&g->pairs, place, group)) != MU_NONE) {
        line_forget(g, line);
    }
    return true;
}

bool groups_full(const struct groups *g)
{
    /* A change takes two lines at most: the group's own and a member's. */
    return g->pairs.count + 2 > MU_MEMBERSHIPS_MAX || g->count == MU_GROUPS_MAX;
}

/* @return the line, made if it is not there; MU_NONE: full */
static uint32_t line_get(struct groups *g, const char *group, const char *agent)
{
    uint32_t line = mu_pairs_find(&g->pairs, group, agent);
    if (line != MU_NONE) {
        return line;
    }
    if ((!group_has_lines(g, group) && g->count == MU_GROUPS_MAX && !group_spare(g)) ||
        (g->pairs.count == MU_MEMBERSHIPS_MAX && !line_spare(g))) {
        return MU_NONE;
    }
    g->count += !group_has_lines(g, group);
    line = mu_pairs_add(&g->pairs, group, agent);
    MU_ASSERT(line != MU_NONE);
    g->lines[line] = (struct group_line){0};
    return line;
}

/* --- changes ---------------------------------------------------------------------------------- */

/* What is said here is younger than all that was known here, whatever another clock showed. */
static void line_say(struct groups *g, uint32_t line, bool joined, const struct said *said)
{
    struct group_line *l = &g->lines[line];
    bool is_group = mu_pairs_second(&g->pairs, line)[0] == '\0';
    *(is_group ? &g->groups_now : &g->members_now) += (uint32_t)joined - (uint32_t)l->joined;
    l->joined = joined;
    l->joined_inside = said->inside ? joined : l->joined_inside;
    l->stamp_ns = said->stamp_ns > l->stamp_ns ? said->stamp_ns : l->stamp_ns + 1;
    mu_text_copy(l->origin, sizeof l->origin, said->origin);
    changelog_touch(&g->changes, line);
}

const char *groups_create(struct groups *g, const char *group, const struct said *said)
{
    if (!mu_name_of_group(group)) {
        return "not-a-name";
    }
    if (groups_exists(g, group, said->inside)) {
        return "group-exists";
    }
    uint32_t line = line_get(g, group, "");
    if (line == MU_NONE) {
        return "full";
    }
    line_say(g, line, true, said);
    return NULL;
}

const char *groups_join(struct groups *g, const char *group, const char *agent,
                        const struct said *said)
{
    if (!mu_name_of_group(group) || !mu_name_valid(agent)) {
        return "not-a-name";
    }
    uint32_t own = line_get(g, group, "");
    if (own == MU_NONE) {
        return "full";
    }
    bool is_new = !line_holds(&g->lines[own], said->inside);
    if (is_new) { /* before its member, whose line must not take its place */
        line_say(g, own, true, said);
    }
    uint32_t line = line_get(g, group, agent);
    if (line == MU_NONE) {
        if (is_new) {
            line_say(g, own, false, said);
        }
        return "full";
    }
    if (!line_holds(&g->lines[line], said->inside)) {
        line_say(g, line, true, said);
    }
    return NULL;
}

static bool group_has_members(const struct groups *g, const char *group, bool inside)
{
    uint32_t place = 0;
    return groups_member(g, group, inside, &place) != NULL;
}

const char *groups_leave(struct groups *g, const char *group, const char *agent,
                         const struct said *said)
{
    if (!mu_name_valid(group) || !mu_name_valid(agent)) {
        return "not-a-name";
    }
    uint32_t line = mu_pairs_find(&g->pairs, group, agent);
    if (line == MU_NONE || !line_holds(&g->lines[line], said->inside)) {
        return groups_exists(g, group, said->inside) ? "not-a-member" : "unknown-group";
    }
    line_say(g, line, false, said);
    uint32_t own = mu_pairs_find(&g->pairs, group, "");
    if (own == MU_NONE) {
        return NULL;
    }
    struct group_line *l = &g->lines[own];
    if (said->inside && !group_has_members(g, group, true) && l->joined_inside) {
        l->joined_inside = false;
        changelog_touch(&g->changes, own);
    }
    if (!group_has_members(g, group, false) && l->joined) {
        line_say(g, own, false, &(struct said){said->stamp_ns, said->origin, false});
    }
    return NULL;
}

mu_result groups_merge(struct groups *g, const muster_Membership *m, bool inside)
{
    if (!mu_name_valid(m->group) || (m->agent[0] != '\0' && !mu_name_valid(m->agent)) ||
        strnlen(m->origin, MU_NAME_MAX + 1) > MU_NAME_MAX) {
        return MU_MALFORMED;
    }
    uint32_t line = mu_pairs_find(&g->pairs, m->group, m->agent);
    if (line != MU_NONE) {
        const struct group_line *l = &g->lines[line];
        bool older = m->stamp_ns < l->stamp_ns ||
                     (m->stamp_ns == l->stamp_ns && strcmp(m->origin, l->origin) <= 0);
        if (older) {
            return MU_EXISTS;
        }
    } else if ((line = line_get(g, m->group, m->agent)) == MU_NONE) {
        return MU_FULL;
    }
    struct group_line *l = &g->lines[line];
    l->stamp_ns = 0; /* its own stamp is the younger one */
    line_say(g, line, m->joined, &(struct said){m->stamp_ns, m->origin, inside});
    l->stamp_ns = m->stamp_ns;
    return MU_OK;
}

/* --- the lock step ---------------------------------------------------------------------------- */

void groups_freeze(struct groups *g)
{
    for (uint32_t i = 0; i < g->pairs.count; i++) {
        struct group_line *l = &g->lines[g->pairs.order[i]];
        l->joined_inside = l->joined;
    }
}

void groups_enter(struct groups *g, const char *agent)
{
    for (uint32_t i = 0; i < g->pairs.count; i++) {
        uint32_t line = g->pairs.order[i];
        if (strcmp(mu_pairs_second(&g->pairs, line), agent) == 0) {
            g->lines[line].joined_inside = g->lines[line].joined;
            changelog_touch(&g->changes, line);
        }
    }
}

/* --- questions -------------------------------------------------------------------------------- */

bool groups_exists(const struct groups *g, const char *group, bool inside)
{
    uint32_t own = mu_pairs_find(&g->pairs, group, "");
    return (own != MU_NONE && line_holds(&g->lines[own], inside)) ||
           group_has_members(g, group, inside);
}

bool groups_has(const struct groups *g, const char *group, const char *agent, bool inside)
{
    uint32_t line = mu_pairs_find(&g->pairs, group, agent);
    return line != MU_NONE && line_holds(&g->lines[line], inside);
}

const char *groups_member(const struct groups *g, const char *group, bool inside, uint32_t *place)
{
    uint32_t line;
    *place = *place ? *place : mu_pairs_start(&g->pairs, group);
    while ((line = mu_pairs_of(&g->pairs, *place, group)) != MU_NONE) {
        (*place)++;
        const char *agent = mu_pairs_second(&g->pairs, line);
        if (agent[0] != '\0' && line_holds(&g->lines[line], inside)) {
            return agent;
        }
    }
    return NULL;
}

const char *groups_name(const struct groups *g, bool inside, uint32_t *place)
{
    while (*place < g->pairs.count) {
        const char *group = mu_pairs_first(&g->pairs, g->pairs.order[*place]);
        bool holds = false;
        for (uint32_t line; (line = mu_pairs_of(&g->pairs, *place, group)) != MU_NONE; (*place)++) {
            holds = holds || line_holds(&g->lines[line], inside);
        }
        if (holds) {
            return group;
        }
    }
    return NULL;
}

void groups_line(const struct groups *g, uint32_t line, bool inside, muster_Membership *out)
{
    const struct group_line *l = &g->lines[line];
    *out = (muster_Membership){.joined = line_holds(l, inside), .stamp_ns = l->stamp_ns};
    out->group = sample_text(mu_pairs_first(&g->pairs, line));
    out->agent = sample_text(mu_pairs_second(&g->pairs, line));
    out->origin = sample_text(l->origin);
}
