/* SPDX-License-Identifier: Apache-2.0 */
/* --set key=value: what may be set, and how. */
#include "core/spell.h"
#include "core/text.h"
#include "experiment/experiment_source.h"
#include "muster/limits.h"
#include "muster/memory.h"

#include <stdio.h>
#include <string.h>

/* Remembers whose field it is, so that every later fault names the override. */
static void override_note(struct experiment_source *s, const void *field, const char *set)
{
    s->overrides[s->overrides_count].field = field;
    s->overrides[s->overrides_count].text = set;
    s->overrides_count++;
}

/* @return the key that --set may replace, with its field in a struct, or NULL */
static const struct yaml_key *override_find(const struct yaml_key *keys, const char *name,
                                            char *base, void **field)
{
    for (const struct yaml_key *k = keys; k->key; k++) {
        size_t len = strlen(k->key);
        *field = base + k->offset;
        if (k->set && strcmp(k->key, name) == 0) {
            return k;
        }
        if (k->kind == YAML_KEY_KEYS && !k->max && strncmp(name, k->key, len) == 0 &&
            name[len] == '.') {
            return override_find(k->keys, name + len + 1, *field, field);
        }
    }
    *field = NULL;
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

static const struct yaml_key override_global = {.kind = YAML_KEY_TEXT};

/* Is the key `name.` and more? */
static bool override_names(const char *key, const char *name)
{
    size_t len = strlen(name);
    return strncmp(key, name, len) == 0 && key[len] == '.';
}

/* The lists of agents that --set knows: "robots.NAME.", "agents.NAME.". */
struct override_list {
    const char *key;
    size_t len; /* of "robots." */
    struct experiment_robot *at;
    unsigned count;
};

/* @return the list that a key is about; at NULL: none */
static struct override_list override_list_of(const struct experiment *e, const char *key)
{
    const struct override_list lists[] = {{"robots", 7, e->robots, e->robots_count},
                                          {"agents", 7, e->agents, e->agents_count}};
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
        if (override_names(key, lists[i].key)) {
            return lists[i];
        }
    }
    return (struct override_list){.at = NULL};
}

/* Names of robots may have dots, so each is tried. */
static const struct yaml_key *override_find_robots(const struct override_list *list,
                                                   const char *key, void **field)
{
    const struct yaml_key *robots = experiment_schema;
    while (strcmp(robots->key, list->key) != 0) {
        robots++;
    }
    const struct yaml_key *found = NULL;
    for (unsigned i = 0; i < list->count && !found; i++) {
        struct experiment_robot *robot = &list->at[i];
        if (!override_names(key, robot->name)) {
            continue;
        }
        const char *rest = key + strlen(robot->name) + 1;
        if (strncmp(rest, "globals.", 8) == 0) {
            *field = override_find_global(robot, rest + 8);
            return &override_global;
        }
        found = override_find(robots->keys, rest, (char *)robot, field);
    }
    return found;
}

/* Lists what may be set, and looks among it for what was meant. */
static void override_add(const struct yaml_key *keys, const char *before, struct mu_text *list,
                         struct mu_spell *meant)
{
    for (const struct yaml_key *k = keys; k->key; k++) {
        char inside[64];
        snprintf(inside, sizeof inside, "%s%s.", k->key, k->max ? ".NAME" : "");
        if (k->kind == YAML_KEY_KEYS) {
            override_add(k->keys, inside, list, meant);
        } else if (k->set) {
            mu_text_format(list, "%s%s, ", before, k->key);
            mu_spell_offer(meant, k->key);
        }
    }
}

/* Refuses a key of a robot that the experiment does not have: NAME.KEY. */
static mu_result override_no_robot(struct experiment_source *s, const char *set,
                                   const struct override_list *list, const char *key)
{
    struct mu_spell meant;
    char name[MU_NAME_MAX + 1];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(key, "."), key);
    mu_spell_init(&meant, name);
    for (unsigned i = 0; i < list->count; i++) {
        if (override_names(key, list->at[i].name)) {
            return MU_OK;
        }
        mu_spell_offer(&meant, list->at[i].name);
    }
    return experiment_fault(s, set, 0, "no %.5s '%s' in this experiment%s%s%s", list->key, name,
                            meant.nearest ? "; did you mean '" : "",
                            meant.nearest ? meant.nearest : "", meant.nearest ? "'?" : "");
}

static mu_result override_unknown(struct experiment_source *s, const char *set, const char *key)
{
    struct override_list list = override_list_of(s->experiment, key);
    mu_result known = list.at ? override_no_robot(s, set, &list, key + list.len) : MU_OK;
    if (known != MU_OK) {
        return known;
    }
    char buffer[256];
    struct mu_text keys = mu_text_in(buffer, sizeof buffer);
    struct mu_spell meant;
    const char *dot = strrchr(key, '.');
    mu_spell_init(&meant, dot ? dot + 1 : key);
    override_add(experiment_schema, "", &keys, &meant);
    return experiment_fault(s, set, 0,
                            "expected KEY=VALUE with one of the keys %srobots.NAME.globals.NAME"
                            "%s%s%s",
                            buffer, meant.nearest ? "; did you mean '" : "",
                            meant.nearest ? meant.nearest : "", meant.nearest ? "'?" : "");
}

mu_result experiment_override(struct experiment_source *source, const char *set)
{
    const char *equals = strchr(set, '=');
    char buffer[256];
    struct mu_text key = mu_text_in(buffer, sizeof buffer);
    if (equals) {
        mu_text_add_bytes(&key, set, (size_t)(equals - set));
    }
    struct experiment *e = source->experiment;
    if (source->overrides_count == EXPERIMENT_OVERRIDES_MAX) {
        mu_fault_at(source->fault, "--set", 0, 0, "expected at most %d overrides",
                    EXPERIMENT_OVERRIDES_MAX);
        return MU_FAULT_USAGE;
    }
    void *field = NULL;
    const struct override_list list = override_list_of(e, buffer);
    const struct yaml_key *found =
        list.at ? override_find_robots(&list, buffer + list.len, &field)
                : override_find(experiment_schema, buffer, (char *)e, &field);
    override_note(source, found ? field : set, set);
    if (!found) {
        return override_unknown(source, set, buffer);
    }
    const char *expected = yaml_keys_put(found, field, equals + 1);
    return expected ? experiment_fault(source, field, 0, "expected %s", expected) : MU_OK;
}
