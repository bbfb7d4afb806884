/* SPDX-License-Identifier: Apache-2.0 */
/* --set key=value: what may be set, and how. */
#include "core/text.h"
#include "experiment/experiment_source.h"
#include "muster/memory.h"

#include <limits.h>
#include <string.h>

enum override_kind {
    OVERRIDE_TEXT,
    OVERRIDE_UINT,
    OVERRIDE_COUNT,
    OVERRIDE_REAL,
    OVERRIDE_ON_CRASH
};

struct override_key {
    const char *key;
    enum override_kind kind;
    size_t offset; /* in struct experiment, or struct experiment_robot */
};

static const struct override_key override_keys[] = {
    {"name", OVERRIDE_TEXT, offsetof(struct experiment, name)},
    {"world", OVERRIDE_TEXT, offsetof(struct experiment, world)},
    {"seed", OVERRIDE_UINT, offsetof(struct experiment, seed)},
    {"duration", OVERRIDE_REAL, offsetof(struct experiment, duration)},
    {"step_ms", OVERRIDE_REAL, offsetof(struct experiment, step_ms)},
    {"on-crash", OVERRIDE_ON_CRASH, offsetof(struct experiment, on_crash)},
    {"checkpoint", OVERRIDE_REAL, offsetof(struct experiment, checkpoint_s)},
    {"restarts", OVERRIDE_COUNT, offsetof(struct experiment, restarts)},
    {"return-within", OVERRIDE_REAL, offsetof(struct experiment, return_within_s)},
    {"policy", OVERRIDE_TEXT, offsetof(struct experiment, policy)},
    {"simulator.threads", OVERRIDE_UINT, offsetof(struct experiment, simulator.threads)},
};

static const struct override_key override_robot_keys[] = {
    {"body", OVERRIDE_TEXT, offsetof(struct experiment_robot, body)},
    {"color", OVERRIDE_TEXT, offsetof(struct experiment_robot, color)},
    {"rules", OVERRIDE_TEXT, offsetof(struct experiment_robot, rules)},
    {"on-crash", OVERRIDE_ON_CRASH, offsetof(struct experiment_robot, on_crash)},
    {"checkpoint", OVERRIDE_REAL, offsetof(struct experiment_robot, checkpoint_s)},
};

#define COUNT(table) (sizeof(table) / sizeof(table)[0])

/* Remembers whose field it is, so that every later fault names the override. */
static void override_note(struct experiment_source *s, const void *field, const char *set)
{
    s->overrides[s->overrides_count].field = field;
    s->overrides[s->overrides_count].text = set;
    s->overrides_count++;
}

static mu_result override_on_crash(struct experiment_source *s, enum experiment_on_crash *field,
                                   const char *value)
{
    bool restart = strcmp(value, "restart") == 0;
    *field = restart ? EXPERIMENT_RESTART : EXPERIMENT_STOP;
    return restart || strcmp(value, "stop") == 0
               ? MU_OK
               : experiment_fault(s, field, 0, "expected stop or restart");
}

static mu_result override_put(struct experiment_source *s, enum override_kind kind, void *field,
                              const char *value)
{
    unsigned long long whole;
    switch (kind) {
    case OVERRIDE_TEXT:
        *(char **)field = mu_startup_string(value);
        return value[0] ? MU_OK : experiment_fault(s, field, 0, "expected a text after '='");
    case OVERRIDE_UINT:
        if (!yaml_check_uint(value, &whole)) {
            return experiment_fault(s, field, 0, "expected a whole number from 0");
        }
        *(uint64_t *)field = whole;
        return MU_OK;
    case OVERRIDE_COUNT:
        if (!yaml_check_uint(value, &whole) || whole > UINT_MAX) {
            return experiment_fault(s, field, 0, "expected a whole number from 0");
        }
        *(unsigned *)field = (unsigned)whole;
        return MU_OK;
    case OVERRIDE_REAL:
        return yaml_check_real(value, field) ? MU_OK
                                             : experiment_fault(s, field, 0, "expected a number");
    case OVERRIDE_ON_CRASH: return override_on_crash(s, field, value);
    }
    return MU_OK;
}

/* @return the field that a key names in a table, or NULL */
static void *override_find(const struct override_key *table, size_t count, void *base,
                           const char *key, enum override_kind *kind)
{
    for (size_t i = 0; i < count; i++) {
        if (strcmp(table[i].key, key) == 0) {
            *kind = table[i].kind;
            return (char *)base + table[i].offset;
        }
    }
    return NULL;
}

/* @return the value of a robot's global, made if need be */
static void *override_find_global(struct experiment_robot *robot, const char *name)
{
    for (unsigned i = 0; i < robot->globals_count; i++) {
        if (strcmp(robot->globals[i].name, name) == 0) {
            return &robot->globals[i].value;
        }
    }
    struct experiment_global *global = &robot->globals[robot->globals_count++];
    global->name = mu_startup_string(name);
    return &global->value;
}

/* Names of robots may have dots, so each is tried. */
static void *override_find_robots(struct experiment *e, const char *key, enum override_kind *kind)
{
    for (unsigned i = 0; i < e->robots_count; i++) {
        struct experiment_robot *robot = &e->robots[i];
        size_t len = strlen(robot->name);
        if (strncmp(key, robot->name, len) != 0 || key[len] != '.') {
            continue;
        }
        const char *rest = key + len + 1;
        if (strncmp(rest, "globals.", 8) == 0) {
            *kind = OVERRIDE_TEXT;
            return override_find_global(robot, rest + 8);
        }
        void *field =
            override_find(override_robot_keys, COUNT(override_robot_keys), robot, rest, kind);
        if (field) {
            return field;
        }
    }
    return NULL;
}

static mu_result override_unknown(struct experiment_source *s, const char *set)
{
    char buffer[256];
    struct mu_text keys;
    mu_text_init(&keys, buffer, sizeof buffer);
    for (size_t i = 0; i < COUNT(override_keys); i++) {
        mu_text_format(&keys, "%s, ", override_keys[i].key);
    }
    for (size_t i = 0; i < COUNT(override_robot_keys); i++) {
        mu_text_format(&keys, "robots.NAME.%s, ", override_robot_keys[i].key);
    }
    return experiment_fault(s, set, 0,
                            "expected KEY=VALUE with one of the keys %s"
                            "robots.NAME.globals.NAME",
                            buffer);
}

mu_result experiment_override(struct experiment_source *source, const char *set)
{
    const char *equals = strchr(set, '=');
    char key[256] = "";
    struct mu_text text;
    mu_text_init(&text, key, sizeof key);
    if (equals) {
        mu_text_add_bytes(&text, set, (size_t)(equals - set));
    }
    enum override_kind kind = OVERRIDE_TEXT;
    struct experiment *e = source->experiment;
    if (source->overrides_count == EXPERIMENT_OVERRIDES_MAX) {
        mu_fault_at(source->fault, "--set", 0, 0, "expected at most %d overrides",
                    EXPERIMENT_OVERRIDES_MAX);
        return MU_FAULT_USAGE;
    }
    void *field = strncmp(key, "robots.", 7) == 0
                      ? override_find_robots(e, key + 7, &kind)
                      : override_find(override_keys, COUNT(override_keys), e, key, &kind);
    override_note(source, field ? field : set, set);
    return field ? override_put(source, kind, field, equals + 1) : override_unknown(source, set);
}
