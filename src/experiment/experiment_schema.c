/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/experiment_source.h"

#include "muster/limits.h"

/* CYAML_FIELD_*: key, flags, structure, member, ...; IGNORE: experiment_fill() reads it. */
enum { NEEDED = CYAML_FLAG_POINTER, MAY = CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL };

static const cyaml_schema_value_t schema_name = {
    CYAML_VALUE_STRING(CYAML_FLAG_POINTER, char, 1, EXPERIMENT_TEXT_MAX)};
static const cyaml_schema_value_t schema_real = {CYAML_VALUE_FLOAT(CYAML_FLAG_STRICT, double)};

#define TEXT(key, flags, structure, member) \
    CYAML_FIELD_STRING_PTR(key, flags, structure, member, 1, EXPERIMENT_TEXT_MAX)

static const cyaml_strval_t schema_on_crash[] = {{"stop", EXPERIMENT_STOP},
                                                 {"restart", EXPERIMENT_RESTART}};

#define ON_CRASH(structure)                                                                    \
    CYAML_FIELD_ENUM("on-crash", CYAML_FLAG_STRICT | CYAML_FLAG_OPTIONAL, structure, on_crash, \
                     schema_on_crash, CYAML_ARRAY_LEN(schema_on_crash)),                       \
        CYAML_FIELD_FLOAT("checkpoint", CYAML_FLAG_STRICT | CYAML_FLAG_OPTIONAL, structure,    \
                          checkpoint_s)

static const cyaml_schema_field_t schema_robot_fields[] = {
    TEXT("name", NEEDED, struct experiment_robot, name),
    TEXT("body", MAY, struct experiment_robot, body),
    TEXT("color", MAY, struct experiment_robot, color),
    {.key = "pose",
     .data_offset = offsetof(struct experiment_robot, pose),
     .value = {.type = CYAML_SEQUENCE_FIXED,
               .flags = (enum cyaml_flag)MAY,
               .data_size = sizeof(double),
               .sequence = {.entry = &schema_real, .min = 3, .max = 3}}},
    TEXT("place", MAY, struct experiment_robot, place),
    CYAML_FIELD_UINT("count", CYAML_FLAG_OPTIONAL, struct experiment_robot, count),
    CYAML_FIELD_UINT("processes", CYAML_FLAG_OPTIONAL, struct experiment_robot, processes),
    TEXT("rules", NEEDED, struct experiment_robot, rules),
    TEXT("host", MAY, struct experiment_robot, host),
    TEXT("broker", MAY, struct experiment_robot, broker),
    ON_CRASH(struct experiment_robot),
    CYAML_FIELD_IGNORE("globals", CYAML_FLAG_OPTIONAL),
    CYAML_FIELD_SEQUENCE("groups", MAY, struct experiment_robot, groups, &schema_name, 0,
                         EXPERIMENT_GROUPS_MAX),
    CYAML_FIELD_SEQUENCE("services", MAY, struct experiment_robot, services, &schema_name, 0,
                         EXPERIMENT_GROUPS_MAX),
    CYAML_FIELD_END};
_Static_assert(sizeof(struct experiment_pose) == 3 * sizeof(double), "a pose is three numbers");
_Static_assert(sizeof(struct experiment_place) == 2 * sizeof(double), "a place is two numbers");

static const cyaml_schema_value_t schema_robot = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct experiment_robot, schema_robot_fields)};

static const cyaml_schema_field_t schema_monitor_fields[] = {
    TEXT("name", MAY, struct experiment_monitor, name),
    TEXT("rules", MAY, struct experiment_monitor, rules),
    TEXT("program", MAY, struct experiment_monitor, program), CYAML_FIELD_END};

static const cyaml_schema_value_t schema_monitor = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct experiment_monitor, schema_monitor_fields)};

static const cyaml_schema_field_t schema_command_fields[] = {
    CYAML_FIELD_FLOAT("at", CYAML_FLAG_STRICT, struct experiment_command, at),
    CYAML_FIELD_IGNORE("do", CYAML_FLAG_DEFAULT),
    TEXT("line", MAY, struct experiment_command, line),
    TEXT("move", MAY, struct experiment_command, move),
    TEXT("launch", MAY, struct experiment_command, launch),
    TEXT("rules", MAY, struct experiment_command, rules),
    CYAML_FIELD_END};

static const cyaml_schema_value_t schema_command = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct experiment_command, schema_command_fields)};

#define NUMBER(key, member)                                                                        \
    CYAML_FIELD_FLOAT(key, CYAML_FLAG_STRICT | CYAML_FLAG_OPTIONAL, struct experiment_expectation, \
                      member)

static const cyaml_schema_field_t schema_expectation_fields[] = {
    CYAML_FIELD_IGNORE("near", CYAML_FLAG_OPTIONAL),
    NUMBER("within", within_m),
    NUMBER("from", from_s),
    NUMBER("to", to_s),
    NUMBER("share", share),
    TEXT("inside", MAY, struct experiment_expectation, inside),
    NUMBER("stall-max", stall_max_s),
    TEXT("objects", MAY, struct experiment_expectation, objects),
    {.key = "at",
     .data_offset = offsetof(struct experiment_expectation, at),
     .value = {.type = CYAML_SEQUENCE_FIXED,
               .flags = (enum cyaml_flag)MAY,
               .data_size = sizeof(double),
               .sequence = {.entry = &schema_real, .min = 2, .max = 2}}},
    CYAML_FIELD_UINT("count", CYAML_FLAG_OPTIONAL, struct experiment_expectation, count),
    TEXT("statistic", MAY, struct experiment_expectation, statistic),
    NUMBER("at_least", at_least),
    NUMBER("at_most", at_most),
    CYAML_FIELD_SEQUENCE("sequence", MAY, struct experiment_expectation, sequence, &schema_name, 1,
                         EXPERIMENT_SEQUENCE_MAX),
    NUMBER("within_s", within_s),
    TEXT("never", MAY, struct experiment_expectation, never),
    CYAML_FIELD_END};

#undef NUMBER

static const cyaml_schema_value_t schema_expectation = {CYAML_VALUE_MAPPING(
    CYAML_FLAG_DEFAULT, struct experiment_expectation, schema_expectation_fields)};

#define NUMBER(key, member) \
    CYAML_FIELD_FLOAT(key, CYAML_FLAG_STRICT | CYAML_FLAG_OPTIONAL, struct experiment_chaos, member)
static const cyaml_schema_field_t schema_chaos_fields[] = {
    NUMBER("at", at),
    TEXT("when", MAY, struct experiment_chaos, when),
    TEXT("push", MAY, struct experiment_chaos, push),
    {.key = "force",
     .data_offset = offsetof(struct experiment_chaos, force),
     .value = {.type = CYAML_SEQUENCE_FIXED,
               .flags = (enum cyaml_flag)MAY,
               .data_size = sizeof(double),
               .sequence = {.entry = &schema_real, .min = 2, .max = 2}}},
    NUMBER("torque", torque_nm),
    TEXT("place", MAY, struct experiment_chaos, place),
    {.key = "pose",
     .data_offset = offsetof(struct experiment_chaos, pose),
     .value = {.type = CYAML_SEQUENCE_FIXED,
               .flags = (enum cyaml_flag)MAY,
               .data_size = sizeof(double),
               .sequence = {.entry = &schema_real, .min = 3, .max = 3}}},
    TEXT("block", MAY, struct experiment_chaos, block),
    TEXT("sensor", MAY, struct experiment_chaos, sensor),
    TEXT("kill", MAY, struct experiment_chaos, kill),
    TEXT("restart", MAY, struct experiment_chaos, restart),
    TEXT("stop", MAY, struct experiment_chaos, stop),
    TEXT("continue", MAY, struct experiment_chaos, go_on),
    CYAML_FIELD_IGNORE("cut", CYAML_FLAG_OPTIONAL),
    CYAML_FIELD_IGNORE("lose", CYAML_FLAG_OPTIONAL),
    NUMBER("share", share),
    CYAML_FIELD_IGNORE("delay", CYAML_FLAG_OPTIONAL),
    NUMBER("by_ms", by_ms),
    NUMBER("for", for_s),
    NUMBER("wall_s", wall_s),
    CYAML_FIELD_END};

static const cyaml_schema_value_t schema_chaos = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct experiment_chaos, schema_chaos_fields)};

static const cyaml_schema_field_t schema_broker_fields[] = {
    CYAML_FIELD_FLOAT("delivery-interval", CYAML_FLAG_STRICT | CYAML_FLAG_OPTIONAL,
                      struct experiment_broker, delivery_interval_ms),
    CYAML_FIELD_BOOL("store", CYAML_FLAG_OPTIONAL, struct experiment_broker, store),
    CYAML_FIELD_END};

static const cyaml_schema_field_t schema_simulator_fields[] = {
    CYAML_FIELD_UINT("threads", CYAML_FLAG_OPTIONAL, struct experiment_simulator, threads),
    CYAML_FIELD_END};

static const cyaml_schema_field_t schema_fields[] = {
    TEXT("name", MAY, struct experiment, name),
    TEXT("world", NEEDED, struct experiment, world),
    CYAML_FIELD_UINT("seed", CYAML_FLAG_OPTIONAL, struct experiment, seed),
    CYAML_FIELD_FLOAT("duration", CYAML_FLAG_STRICT, struct experiment, duration),
    CYAML_FIELD_FLOAT("step_ms", CYAML_FLAG_STRICT | CYAML_FLAG_OPTIONAL, struct experiment,
                      step_ms),
    ON_CRASH(struct experiment),
    CYAML_FIELD_UINT("restarts", CYAML_FLAG_OPTIONAL, struct experiment, restarts),
    CYAML_FIELD_FLOAT("return-within", CYAML_FLAG_STRICT | CYAML_FLAG_OPTIONAL, struct experiment,
                      return_within_s),
    CYAML_FIELD_SEQUENCE("brokers", MAY, struct experiment, brokers, &schema_name, 0,
                         EXPERIMENT_BROKERS_MAX),
    CYAML_FIELD_SEQUENCE("hosts", MAY, struct experiment, hosts, &schema_name, 0,
                         EXPERIMENT_HOSTS_MAX),
    CYAML_FIELD_SEQUENCE("resolvers", MAY, struct experiment, resolvers, &schema_name, 0,
                         EXPERIMENT_RESOLVERS_MAX),
    CYAML_FIELD_MAPPING("broker", CYAML_FLAG_OPTIONAL, struct experiment, broker,
                        schema_broker_fields),
    CYAML_FIELD_MAPPING("simulator", CYAML_FLAG_OPTIONAL, struct experiment, simulator,
                        schema_simulator_fields),
    TEXT("policy", MAY, struct experiment, policy),
    CYAML_FIELD_SEQUENCE("robots", NEEDED, struct experiment, robots, &schema_robot, 1,
                         MU_ROBOTS_MAX),
    CYAML_FIELD_SEQUENCE("monitors", MAY, struct experiment, monitors, &schema_monitor, 0,
                         EXPERIMENT_MONITORS_MAX),
    CYAML_FIELD_SEQUENCE("observer", MAY, struct experiment, observer, &schema_command, 0,
                         EXPERIMENT_COMMANDS_MAX),
    CYAML_FIELD_SEQUENCE("expect", MAY, struct experiment, expect, &schema_expectation, 0,
                         EXPERIMENT_EXPECTATIONS_MAX),
    CYAML_FIELD_SEQUENCE("chaos", MAY, struct experiment, chaos, &schema_chaos, 0,
                         EXPERIMENT_CHAOS_MAX),
    CYAML_FIELD_BOOL("free", CYAML_FLAG_OPTIONAL, struct experiment, free),
    CYAML_FIELD_END};

const cyaml_schema_value_t experiment_schema = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, struct experiment, schema_fields)};
