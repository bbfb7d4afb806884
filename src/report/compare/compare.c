/* SPDX-License-Identifier: Apache-2.0 */
/* Which statistics, which groups, and what the runs of each amount to. */
#include "report/compare/compare.h"

#include "core/text.h"
#include "muster/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const compare_usual[] = {
    "robots.distance_m", "robots.mean_speed_m_s", "robots.stalls",
    "robots.stalled_s",  "explored_fraction",     "mail.sent",
    "mail.delivered",    "robots.rule_firings",   "real_time_factor",
    "wall_time_s",       "expectations.met",
};

static mu_result statistic_add(struct compare *c, const char *name)
{
    if (c->statistics_count == COMPARE_STATISTICS_MAX) {
        fprintf(stderr, "expected at most %d statistics\n", COMPARE_STATISTICS_MAX);
        return MU_FAULT_USAGE;
    }
    if (!mu_text_copy(c->statistics[c->statistics_count], COMPARE_NAME_MAX, name) || !name[0]) {
        char shown[MU_TEXT_SHOWN];
        fprintf(stderr, "'%s' is no statistic's name\n", mu_text_show(shown, name));
        return MU_FAULT_USAGE;
    }
    c->statistics_count++;
    return MU_OK;
}

mu_result compare_open(struct compare **out, unsigned runs_max, const char *by,
                       const char *const *statistics, size_t count)
{
    struct compare *c = mu_startup_alloc(sizeof *c);
    c->by = by;
    c->runs_max = runs_max;
    c->runs = mu_startup_array(runs_max, sizeof *c->runs);
    *out = c;
    for (size_t i = 0; i < count; i++) {
        mu_result added = statistic_add(c, statistics[i]);
        if (added != MU_OK) {
            return added;
        }
    }
    for (size_t i = 0; count == 0 && i < sizeof compare_usual / sizeof compare_usual[0]; i++) {
        MU_ASSERT(statistic_add(c, compare_usual[i]) == MU_OK);
    }
    return MU_OK;
}

bool compare_has(const struct compare *c, unsigned statistic)
{
    for (unsigned g = 0; g < c->groups_count; g++) {
        if (c->groups[g].statistics[statistic].count > 0) {
            return true;
        }
    }
    return false;
}

static bool number_of(const char *text, double *number)
{
    char *end;
    *number = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*number);
}

static struct compare_group *group_find(struct compare *c, const struct compare_run *run)
{
    for (unsigned g = 0; g < c->groups_count; g++) {
        if (c->groups[g].first->content == run->content) {
            return &c->groups[g];
        }
    }
    return NULL;
}

/* Numbers go up, whatever the order of the folders; words stay in that. */
static void groups_order(struct compare *c)
{
    double one, next;
    for (unsigned i = 1; i < c->groups_count; i++) {
        for (unsigned k = i; k > 0 && number_of(c->groups[k - 1].name, &one) &&
                             number_of(c->groups[k].name, &next) && next < one;
             k--) {
            struct compare_group group = c->groups[k];
            c->groups[k] = c->groups[k - 1];
            c->groups[k - 1] = group;
        }
    }
}

static bool part_is_of(const struct compare_part *part, const struct compare_run *run)
{
    for (unsigned i = 0; i < run->parts_count; i++) {
        if (run->parts[i].hash == part->hash) {
            return true;
        }
    }
    return false;
}

/* @return whether another group of that experiment is without it */
static bool part_differs(const struct compare *c, const struct compare_run *run,
                         const struct compare_part *part)
{
    bool differs = false;
    for (unsigned g = 0; g < c->groups_count && !differs; g++) {
        const struct compare_run *other = c->groups[g].first;
        differs = strcmp(other->experiment, run->experiment) == 0 && !part_is_of(part, other);
    }
    return differs;
}

static void group_name(const struct compare *c, struct compare_group *group, bool several)
{
    const struct compare_run *run = group->first;
    struct mu_text name = mu_text_in(group->name, sizeof group->name);
    mu_text_add(&name, several || !c->by ? run->experiment : "");
    mu_text_format(&name, "%s%s", several && c->by ? " " : "", run->value);
    for (unsigned i = 0; i < run->parts_count; i++) {
        if (part_differs(c, run, &run->parts[i])) {
            mu_text_format(&name, ", %s", run->parts[i].text);
        }
    }
}

static void groups_name(struct compare *c)
{
    bool several = false;
    for (unsigned i = 1; i < c->runs_count; i++) {
        several = several || strcmp(c->runs[i].experiment, c->runs[0].experiment) != 0;
    }
    for (unsigned g = 0; g < c->groups_count; g++) {
        group_name(c, &c->groups[g], several);
    }
}

/* @return whether there is room for all */
static bool groups_make(struct compare *c)
{
    for (unsigned i = 0; i < c->runs_count; i++) {
        if (group_find(c, &c->runs[i])) {
            continue;
        }
        if (c->groups_count == COMPARE_GROUPS_MAX) {
            return false;
        }
        c->groups[c->groups_count++] = (struct compare_group){.first = &c->runs[i]};
    }
    groups_name(c);
    groups_order(c);
    return true;
}

mu_result compare_close(struct compare *c)
{
    if (!groups_make(c)) {
        return MU_FULL;
    }
    for (unsigned i = 0; i < c->runs_count; i++) {
        struct compare_run *run = &c->runs[i];
        struct compare_group *group = group_find(c, run);
        run->group = group;
        group->runs++;
        group->as_expected += run->met == run->expected;
        for (unsigned k = 0; k < c->statistics_count; k++) {
            if (!isnan(run->values[k])) {
                interval_add(&group->statistics[k], run->values[k]);
            }
        }
    }
    return MU_OK;
}
