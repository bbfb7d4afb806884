/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/directory/directory.h"

#include "core/name.h"

#include <string.h>

static bool line_holds(const struct line *line, bool inside)
{
    return inside ? line->holds_inside : line->holds;
}

/* --- changes ---------------------------------------------------------------------------------- */

const char *groups_create(struct lines *g, const char *group, const struct said *said)
{
    if (!mu_name_of_group(group)) {
        return "not-a-name";
    }
    if (groups_exists(g, group, said->inside)) {
        return "group-exists";
    }
    uint32_t line = lines_get(g, group, "");
    if (line == MU_NONE) {
        return "full";
    }
    lines_say(g, line, true, said);
    return NULL;
}

const char *groups_join(struct lines *g, const char *group, const char *agent,
                        const struct said *said)
{
    if (!mu_name_of_group(group) || !mu_name_valid(agent)) {
        return "not-a-name";
    }
    uint32_t own = lines_get(g, group, "");
    if (own == MU_NONE) {
        return "full";
    }
    bool is_new = !line_holds(&g->at[own], said->inside);
    if (is_new) { /* before its member, whose line must not take its place */
        lines_say(g, own, true, said);
    }
    uint32_t line = lines_get(g, group, agent);
    if (line == MU_NONE) {
        if (is_new) {
            lines_say(g, own, false, said);
        }
        return "full";
    }
    if (!line_holds(&g->at[line], said->inside)) {
        lines_say(g, line, true, said);
    }
    return NULL;
}

static bool group_has_members(const struct lines *g, const char *group, bool inside)
{
    uint32_t place = 0;
    return groups_member(g, group, inside, &place) != NULL;
}

const char *groups_leave(struct lines *g, const char *group, const char *agent,
                         const struct said *said)
{
    if (!mu_name_valid(group) || !mu_name_valid(agent)) {
        return "not-a-name";
    }
    uint32_t line = mu_pairs_find(&g->pairs, group, agent);
    if (line == MU_NONE || !line_holds(&g->at[line], said->inside)) {
        return groups_exists(g, group, said->inside) ? "not-a-member" : "unknown-group";
    }
    lines_say(g, line, false, said);
    uint32_t own = mu_pairs_find(&g->pairs, group, "");
    if (own == MU_NONE) {
        return NULL;
    }
    struct line *l = &g->at[own];
    if (said->inside && !group_has_members(g, group, true) && l->holds_inside) {
        l->holds_inside = false;
        changelog_touch(&g->changes, own);
    }
    if (!group_has_members(g, group, false) && l->holds) {
        struct said outside = *said;
        outside.inside = false;
        lines_say(g, own, false, &outside);
    }
    return NULL;
}

/* --- a run by steps --------------------------------------------------------------------------- */

void groups_freeze(struct lines *g)
{
    for (uint32_t i = 0; i < g->pairs.count; i++) {
        struct line *l = &g->at[g->pairs.order[i]];
        l->holds_inside = l->holds;
    }
}

void groups_enter(struct lines *g, const char *agent)
{
    for (uint32_t i = 0; i < g->pairs.count; i++) {
        uint32_t line = g->pairs.order[i];
        if (strcmp(mu_pairs_second(&g->pairs, line), agent) == 0) {
            g->at[line].holds_inside = g->at[line].holds;
            changelog_touch(&g->changes, line);
        }
    }
}

/* --- questions -------------------------------------------------------------------------------- */

bool groups_exists(const struct lines *g, const char *group, bool inside)
{
    uint32_t own = mu_pairs_find(&g->pairs, group, "");
    return (own != MU_NONE && line_holds(&g->at[own], inside)) ||
           group_has_members(g, group, inside);
}

bool groups_has(const struct lines *g, const char *group, const char *agent, bool inside)
{
    uint32_t line = mu_pairs_find(&g->pairs, group, agent);
    return line != MU_NONE && line_holds(&g->at[line], inside);
}

const char *groups_member(const struct lines *g, const char *group, bool inside, uint32_t *place)
{
    uint32_t line;
    *place = *place ? *place : mu_pairs_start(&g->pairs, group);
    while ((line = mu_pairs_of(&g->pairs, *place, group)) != MU_NONE) {
        (*place)++;
        const char *agent = mu_pairs_second(&g->pairs, line);
        if (agent[0] != '\0' && line_holds(&g->at[line], inside)) {
            return agent;
        }
    }
    return NULL;
}

const char *groups_name(const struct lines *g, bool inside, uint32_t *place)
{
    while (*place < g->pairs.count) {
        const char *group = mu_pairs_first(&g->pairs, g->pairs.order[*place]);
        bool holds = false;
        for (uint32_t line; (line = mu_pairs_of(&g->pairs, *place, group)) != MU_NONE; (*place)++) {
            holds = holds || line_holds(&g->at[line], inside);
        }
        if (holds) {
            return group;
        }
    }
    return NULL;
}
