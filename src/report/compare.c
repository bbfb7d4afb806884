/* SPDX-License-Identifier: Apache-2.0 */
/* Which statistics, which groups, and what the runs of each amount to. */
#include "report/compare.h"

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

static struct compare_group *group_find(struct compare *c, const char *name)
{
    for (unsigned g = 0; g < c->groups_count; g++) {
        if (strcmp(c->groups[g].name, name) == 0) {
            return &c->groups[g];
        }
    }
    if (c->groups_count == COMPARE_GROUPS_MAX) {
        return NULL;
    }
    struct compare_group *group = &c->groups[c->groups_count++];
    mu_text_copy(group->name, sizeof group->name, name);
    return group;
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

/* One value of a key may stand for runs of several experiments. */
static void groups_tell_apart(struct compare *c)
{
    bool several = false;
    for (unsigned i = 1; c->by && i < c->runs_count; i++) {
        several = several || strcmp(c->runs[i].experiment, c->runs[0].experiment) != 0;
    }
    for (unsigned i = 0; several && i < c->runs_count; i++) {
        char value[COMPARE_NAME_MAX];
        struct compare_run *run = &c->runs[i];
        mu_text_copy(value, sizeof value, run->group);
        snprintf(run->group, sizeof run->group, "%.60s %.60s", run->experiment, value);
    }
}

mu_result compare_close(struct compare *c)
{
    groups_tell_apart(c);
    for (unsigned i = 0; i < c->runs_count; i++) {
        const struct compare_run *run = &c->runs[i];
        struct compare_group *group = group_find(c, run->group);
        if (!group) {
            return MU_FULL;
        }
        group->runs++;
        group->as_expected += run->met == run->expected;
        for (unsigned k = 0; k < c->statistics_count; k++) {
            if (!isnan(run->values[k])) {
                interval_add(&group->statistics[k], run->values[k]);
            }
        }
    }
    groups_order(c);
    return MU_OK;
}
