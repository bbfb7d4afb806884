/* SPDX-License-Identifier: Apache-2.0 */
/* `count: 100, processes: 2` beside a robot's name: a hundred robots in two processes. */
#include "experiment/experiment_source.h"
#include "muster/limits.h"
#include "muster/memory.h"

#include <stdio.h>
#include <string.h>

/* How many robots an entry of the file stands for. */
static unsigned crew_robots(const struct experiment_robot *robot)
{
    return robot->count > 0 ? robot->count : 1;
}

/* In how many processes: of a controller each has one, unless the file says otherwise. */
static unsigned crew_processes(const struct experiment_robot *robot)
{
    unsigned usual = robot->controller.program ? crew_robots(robot) : 1;
    return robot->processes > 0 ? robot->processes : usual;
}

static mu_result crew_check(struct experiment_source *s, size_t index)
{
    const struct experiment_robot *robot = &s->experiment->robots[index];
    int node = experiment_member(s, index);
    int count = yaml_tree_child(s->tree, node, "count");
    int processes = yaml_tree_child(s->tree, node, "processes");
    if (count && (robot->count < 1 || robot->count > MU_ROBOTS_MAX)) {
        return experiment_fault(s, NULL, count, "expected a count of 1 to %d, not %u",
                                MU_ROBOTS_MAX, robot->count);
    }
    if (processes && !count) {
        return experiment_fault(s, NULL, processes, "expected 'processes' beside 'count' only");
    }
    if (processes && (robot->processes < 1 || robot->processes > EXPERIMENT_PROCESSES_MAX ||
                      robot->processes > robot->count)) {
        return experiment_fault(s, NULL, processes,
                                "expected 1 to %d processes, and no more than robots, not %u",
                                EXPERIMENT_PROCESSES_MAX, robot->processes);
    }
    if (count && snprintf(NULL, 0, "%s_%u", robot->name, robot->count - 1) > MU_NAME_MAX) {
        return experiment_fault(s, NULL, yaml_tree_child(s->tree, node, "name"),
                                "expected a shorter name: with _%u behind it, it has more than %d "
                                "bytes",
                                robot->count - 1, MU_NAME_MAX);
    }
    return MU_OK;
}

/* @return how many robots, agents and processes all entries amount to, in one of each */
static mu_result crew_count(struct experiment_source *s, size_t *robots, size_t *agents,
                            size_t *crews)
{
    const struct experiment *e = s->experiment;
    *robots = *agents = *crews = 0;
    for (size_t i = 0; i < experiment_members(e); i++) {
        bool has_body = i < e->robots_count;
        size_t *members = has_body ? robots : agents;
        MU_TRY(crew_check(s, i));
        *members += crew_robots(&e->robots[i]);
        *crews += crew_processes(&e->robots[i]);
        if (*members > MU_ROBOTS_MAX) {
            return experiment_fault(s, NULL, experiment_member(s, i),
                                    "expected at most %d %s in all entries together", MU_ROBOTS_MAX,
                                    has_body ? "robots" : "agents");
        }
    }
    return MU_OK;
}

/* Divides an entry's robots among its processes, the first ones taking one more if need be. */
static void crew_divide(struct experiment *e, const struct experiment_robot *entry, unsigned robot)
{
    unsigned count = crew_robots(entry);
    unsigned processes = crew_processes(entry);
    for (unsigned p = 0; p < processes; p++) {
        unsigned begin = count * p / processes;
        e->crews[e->crews_count++] =
            (struct experiment_crew){.name = entry->name,
                                     .robot = robot + begin,
                                     .count = count * (p + 1) / processes - begin,
                                     .first = begin,
                                     .numbered = entry->count > 0};
    }
}

static char *crew_name(const struct experiment_robot *entry, unsigned number)
{
    char name[MU_NAME_MAX + 1];
    snprintf(name, sizeof name, "%s_%u", entry->name, number);
    return entry->count > 0 ? mu_startup_string(name) : entry->name;
}

/* Of two robots with one name, at least one has a number. */
static mu_result crew_names_differ(struct experiment_source *s, const struct experiment_robot *one,
                                   size_t entry)
{
    const struct experiment *e = s->experiment;
    for (const struct experiment_robot *other = e->robots; other < one; other++) {
        if (strcmp(other->name, one->name) == 0) {
            return experiment_fault(s, NULL, experiment_member(s, entry),
                                    "a second %s with the name '%s'",
                                    one < e->agents ? "robot" : "robot or agent", one->name);
        }
    }
    return MU_OK;
}

mu_result experiment_multiply(struct experiment_source *source)
{
    struct experiment *e = source->experiment;
    const struct experiment_robot *entries = e->robots;
    unsigned entries_count = experiment_members(e), count = 0;
    size_t robots, agents, crews;
    MU_TRY(crew_count(source, &robots, &agents, &crews));
    e->robots = mu_startup_array(robots + agents, sizeof *e->robots);
    e->agents = e->robots + robots;
    e->crews = mu_startup_array(crews, sizeof *e->crews);
    e->robots_count = (unsigned)robots;
    e->agents_count = (unsigned)agents;
    for (unsigned i = 0; i < entries_count; i++) {
        crew_divide(e, &entries[i], count);
        for (unsigned k = 0; k < crew_robots(&entries[i]); k++) {
            struct experiment_robot *robot = &e->robots[count++];
            *robot = entries[i];
            robot->name = crew_name(&entries[i], k);
            MU_TRY(crew_names_differ(source, robot, i));
        }
    }
    return MU_OK;
}
