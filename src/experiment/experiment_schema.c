/* SPDX-License-Identifier: Apache-2.0 */
/* The keys of an experiment file: what each is, where it goes, and whether --set may replace it. */
#include "experiment/experiment_source.h"
#include "muster/limits.h"

#include <math.h>

#define AT(kind_, structure, member) \
    .kind = YAML_KEY_##kind_, .offset = offsetof(struct structure, member)
#define LIST(kind_, structure, member, most)                                           \
    AT(kind_, structure, member), .count = offsetof(struct structure, member##_count), \
                                  .size = sizeof *((struct structure *)0)->member, .max = most
#define NUMBERS(structure, member, many) \
    AT(REAL, structure, member), .size = sizeof(double), .min = many, .max = many
#define PAIR(structure, first, of)                                                        \
    AT(TEXT, structure, first), .size = sizeof(char *), .min = 2, .max = 2, .pair = true, \
                                .what = "two " of

_Static_assert(sizeof(struct experiment_pose) == 3 * sizeof(double), "a pose is three numbers");
_Static_assert(sizeof(struct experiment_place) == 2 * sizeof(double), "a place is two numbers");
_Static_assert(offsetof(struct experiment_expectation, near_mate) ==
                   offsetof(struct experiment_expectation, near_robot) + sizeof(char *),
               "a pair");
_Static_assert(offsetof(struct experiment_chaos, whom) ==
                   offsetof(struct experiment_chaos, who) + sizeof(char *),
               "a pair");

static const char *const schema_on_crash[] = {
    [EXPERIMENT_STOP] = "stop", [EXPERIMENT_RESTART] = "restart", NULL};

#define ON_CRASH(structure) \
    AT(WORD, structure, on_crash), .words = schema_on_crash, .set = true, .what = "stop or restart"

static const struct yaml_key schema_controller[] = {
    {"program", AT(TEXT, experiment_controller, program), .needed = true, .set = true},
    {"args", LIST(TEXT, experiment_controller, args, EXPERIMENT_ARGS_MAX)},
    {.key = NULL},
};

/* clang-format off */
/* The keys of all that have a mind or a program, with a body and without. */
#define MIND_KEYS                                                                             \
    {"name", AT(TEXT, experiment_robot, name), .needed = true},                               \
    {"count", AT(COUNT, experiment_robot, count)},                                            \
    {"processes", AT(COUNT, experiment_robot, processes)},                                    \
    {"rules", AT(TEXT, experiment_robot, rules), .set = true},                                \
    {"controller", AT(KEYS, experiment_robot, controller), .keys = schema_controller},        \
    {"host", AT(TEXT, experiment_robot, host)},                                               \
    {"broker", AT(TEXT, experiment_robot, broker)},                                           \
    {"on-crash", ON_CRASH(experiment_robot)},                                                 \
    {"checkpoint", AT(REAL, experiment_robot, checkpoint_s), .set = true},                    \
    {"globals", .kind = YAML_KEY_ANY},                                                        \
    {"groups", LIST(TEXT, experiment_robot, groups, EXPERIMENT_GROUPS_MAX)},                  \
    {"services", LIST(TEXT, experiment_robot, services, EXPERIMENT_GROUPS_MAX)}
/* clang-format on */

static const struct yaml_key schema_robot[] = {
    MIND_KEYS,
    {"body", AT(TEXT, experiment_robot, body), .set = true},
    {"color", AT(TEXT, experiment_robot, color), .set = true},
    {"pose", NUMBERS(experiment_robot, pose, 3)},
    {"place", AT(TEXT, experiment_robot, place)},
    {.key = NULL},
};

static const struct yaml_key schema_agent[] = {
    MIND_KEYS,
    {"standby", AT(BOOL, experiment_robot, standby)},
    {.key = NULL},
};

static const struct yaml_key schema_monitor[] = {
    {"name", AT(TEXT, experiment_monitor, name)},
    {"rules", AT(TEXT, experiment_monitor, rules)},
    {"program", AT(TEXT, experiment_monitor, program)},
    {.key = NULL},
};

static const struct yaml_key schema_command[] = {
    {"at", AT(REAL, experiment_command, at), .needed = true},
    {"do", LIST(TEXT, experiment_command, targets, MU_ROBOTS_MAX), .min = 1, .single = true,
     .needed = true, .what = "a robot's name, all, or a list of names"},
    {"line", AT(TEXT, experiment_command, line)},
    {"move", AT(TEXT, experiment_command, move)},
    {"launch", AT(TEXT, experiment_command, launch)},
    {"rules", AT(TEXT, experiment_command, rules)},
    {.key = NULL},
};

static const struct yaml_key schema_expectation[] = {
    {"near", PAIR(experiment_expectation, near_robot, "robots, such as [blue, red]")},
    {"within", AT(REAL, experiment_expectation, within_m)},
    {"from", AT(REAL, experiment_expectation, from_s)},
    {"to", AT(REAL, experiment_expectation, to_s), .absent = EXPERIMENT_DURATION_MAX_S},
    {"share", AT(REAL, experiment_expectation, share), .absent = 1},
    {"inside", AT(TEXT, experiment_expectation, inside)},
    {"stall-max", AT(REAL, experiment_expectation, stall_max_s)},
    {"objects", AT(TEXT, experiment_expectation, objects)},
    {"at", NUMBERS(experiment_expectation, at, 2)},
    {"count", AT(COUNT, experiment_expectation, count)},
    {"statistic", AT(TEXT, experiment_expectation, statistic)},
    {"at_least", AT(REAL, experiment_expectation, at_least), .absent = -INFINITY},
    {"at_most", AT(REAL, experiment_expectation, at_most), .absent = INFINITY},
    {"sequence", LIST(TEXT, experiment_expectation, sequence, EXPERIMENT_SEQUENCE_MAX), .min = 1},
    {"within_s", AT(REAL, experiment_expectation, within_s)},
    {"never", AT(TEXT, experiment_expectation, never)},
    {.key = NULL},
};

#define PARTS PAIR(experiment_chaos, who, "parts of the run, such as [red, broker]")
static const struct yaml_key schema_chaos[] = {
    {"at", AT(REAL, experiment_chaos, at)},
    {"when", AT(TEXT, experiment_chaos, when)},
    {"push", AT(TEXT, experiment_chaos, who)},
    {"force", NUMBERS(experiment_chaos, force, 2)},
    {"torque", AT(REAL, experiment_chaos, torque_nm)},
    {"place", AT(TEXT, experiment_chaos, who)},
    {"pose", NUMBERS(experiment_chaos, pose, 3)},
    {"block", AT(TEXT, experiment_chaos, who)},
    {"sensor", AT(TEXT, experiment_chaos, sensor)},
    {"kill", AT(TEXT, experiment_chaos, who)},
    {"restart", AT(TEXT, experiment_chaos, who)},
    {"stop", AT(TEXT, experiment_chaos, who)},
    {"continue", AT(TEXT, experiment_chaos, who)},
    {"cut", PARTS},
    {"lose", PARTS},
    {"share", AT(REAL, experiment_chaos, share)},
    {"delay", PARTS},
    {"by_ms", AT(REAL, experiment_chaos, by_ms)},
    {"for", AT(REAL, experiment_chaos, for_s)},
    {"wall_s", AT(REAL, experiment_chaos, wall_s)},
    {.key = NULL},
};

static const struct yaml_key schema_broker[] = {
    {"delivery-interval", AT(REAL, experiment_broker, delivery_interval_ms)},
    {"store", AT(BOOL, experiment_broker, store)},
    {.key = NULL},
};

static const struct yaml_key schema_simulator[] = {
    {"threads", AT(WHOLE, experiment_simulator, threads), .set = true},
    {.key = NULL},
};

const struct yaml_key experiment_schema[] = {
    {"name", AT(TEXT, experiment, name), .set = true},
    {"world", AT(TEXT, experiment, world), .set = true},
    {"seed", AT(WHOLE, experiment, seed), .set = true, .absent = 1},
    {"duration", AT(REAL, experiment, duration), .needed = true, .set = true},
    {"step_ms", AT(REAL, experiment, step_ms), .set = true, .absent = (double)MU_STEP_NS / 1e6},
    {"on-crash", ON_CRASH(experiment)},
    {"checkpoint", AT(REAL, experiment, checkpoint_s), .set = true, .absent = 1},
    {"restarts", AT(COUNT, experiment, restarts), .set = true, .absent = 5},
    {"return-within", AT(REAL, experiment, return_within_s), .set = true, .absent = 20},
    {"brokers", LIST(TEXT, experiment, brokers, EXPERIMENT_BROKERS_MAX)},
    {"hosts", LIST(TEXT, experiment, hosts, EXPERIMENT_HOSTS_MAX)},
    {"resolvers", LIST(TEXT, experiment, resolvers, EXPERIMENT_RESOLVERS_MAX)},
    {"broker", AT(KEYS, experiment, broker), .keys = schema_broker},
    {"simulator", AT(KEYS, experiment, simulator), .keys = schema_simulator, .alone = "none"},
    {"policy", AT(TEXT, experiment, policy), .set = true},
    {"robots", LIST(KEYS, experiment, robots, MU_ROBOTS_MAX), .min = 1, .keys = schema_robot},
    {"agents", LIST(KEYS, experiment, agents, MU_ROBOTS_MAX), .min = 1, .keys = schema_agent},
    {"monitors", LIST(KEYS, experiment, monitors, EXPERIMENT_MONITORS_MAX), .keys = schema_monitor},
    {"observer", LIST(KEYS, experiment, observer, EXPERIMENT_COMMANDS_MAX), .keys = schema_command},
    {"expect", LIST(KEYS, experiment, expect, EXPERIMENT_EXPECTATIONS_MAX),
     .keys = schema_expectation},
    {"chaos", LIST(KEYS, experiment, chaos, EXPERIMENT_CHAOS_MAX), .keys = schema_chaos},
    {"free", AT(BOOL, experiment, free)},
    {.key = NULL},
};
