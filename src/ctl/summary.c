/* SPDX-License-Identifier: Apache-2.0 */
#include "ctl/summary.h"

#include "core/json_read.h"
#include "core/text.h"
#include "muster/memory.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Splits "12.name": an item of a list, and what of it.  @return false: none, or past the most */
static bool item_split(const char *path, size_t most, size_t *index, const char **key)
{
    char *end;
    *index = strtoul(path, &end, 10);
    *key = end + (*end == '.');
    return end != path && *index < most;
}

static uint64_t count_of(const struct mu_json_value *value)
{
    return value->number >= 0 && value->number < 1e19 ? (uint64_t)value->number : 0;
}

static void grow(size_t *count, size_t index)
{
    *count = index + 1 > *count ? index + 1 : *count;
}

static void mail_take(struct summary *s, const char *key, const struct mu_json_value *value)
{
    struct report_mail *m = &s->mail;
    const struct {
        const char *key;
        uint64_t *count;
    } counters[] = {{"sent", &m->sent},
                    {"delivered", &m->delivered},
                    {"waiting", &m->waiting},
                    {"expired", &m->expired},
                    {"refused", &m->refused},
                    {"lost", &m->lost},
                    {"duplicated", &m->duplicated}};
    for (size_t i = 0; i < sizeof counters / sizeof counters[0]; i++) {
        if (strcmp(key, counters[i].key) == 0) {
            *counters[i].count = count_of(value);
            s->mail_unknown = s->mail_unknown || value->kind == MU_JSON_NULL;
        }
    }
}

static void text_take(const char *texts[SUMMARY_LIST_MAX], size_t *count, const char *path,
                      const struct mu_json_value *value)
{
    size_t index;
    const char *key;
    if (item_split(path, SUMMARY_LIST_MAX, &index, &key)) {
        texts[index] = mu_startup_string(value->text);
        grow(count, index);
    }
}

static void override_take(struct summary *s, const char *path, const struct mu_json_value *value)
{
    text_take(s->overrides, &s->overrides_count, path, value);
}

static void undone_take(struct summary *s, const char *path, const struct mu_json_value *value)
{
    text_take(s->undone, &s->undone_count, path, value);
}

static void file_take(struct summary *s, const char *path, const struct mu_json_value *value)
{
    size_t index;
    const char *key;
    if (!item_split(path, SUMMARY_FILES_MAX, &index, &key)) {
        return;
    }
    grow(&s->files_count, index);
    if (strcmp(key, "file") == 0) {
        s->files[index].name = mu_startup_string(value->text);
    } else if (strcmp(key, "hash") == 0) {
        s->files[index].hash = strtoull(value->text, NULL, 16);
    }
}

static void restart_take(struct summary *s, const char *path, const struct mu_json_value *value)
{
    size_t index;
    const char *key;
    if (!item_split(path, MU_ROBOTS_MAX, &index, &key)) {
        return;
    }
    struct report_restarts *r = &s->restarts[index];
    grow(&s->restarts_count, index);
    if (strcmp(key, "process") == 0) {
        r->name = mu_startup_string(value->text);
    } else if (strcmp(key, "count") == 0) {
        r->count = (uint32_t)count_of(value);
    }
}

static void chaos_take(struct summary *s, const char *path, const struct mu_json_value *value)
{
    size_t index;
    const char *key;
    if (!item_split(path, EXPERIMENT_CHAOS_MAX, &index, &key)) {
        return;
    }
    struct report_chaos *c = &s->chaos[index];
    if (strcmp(key, "at_s") == 0) {
        c->at_s = value->number;
    } else if (strcmp(key, "done") == 0) {
        c->done = value->number > 0;
    } else if (strcmp(key, "reason") == 0) {
        c->reason = mu_startup_string(value->text);
    }
}

static void monitor_take(struct summary *s, const char *path, const struct mu_json_value *value)
{
    size_t index;
    const char *key;
    if (!item_split(path, EXPERIMENT_MONITORS_MAX, &index, &key)) {
        return;
    }
    struct report_monitor *m = &s->monitors[index];
    grow(&s->monitors_count, index);
    if (strcmp(key, "name") == 0) {
        m->name = mu_startup_string(value->text);
    } else if (strcmp(key, "rules") == 0) {
        m->rules = mu_startup_string(value->text);
    } else if (strcmp(key, "program") == 0) {
        m->program = mu_startup_string(value->text);
    } else if (strcmp(key, "ended") == 0 && strcmp(value->text, "with the run") != 0) {
        m->fate = mu_startup_string(value->text);
    }
}

static void robot_take(struct summary *s, const char *path, const struct mu_json_value *value)
{
    size_t index;
    const char *key;
    if (!item_split(path, MU_ROBOTS_MAX, &index, &key)) {
        return;
    }
    struct report_robot *r = &s->robots[index];
    grow(&s->robots_count, index);
    if (strcmp(key, "name") == 0) {
        r->name = mu_startup_string(value->text);
    } else if (strcmp(key, "mail_sent") == 0) {
        r->mail_sent = count_of(value);
    } else if (strcmp(key, "mail_received") == 0) {
        r->mail_received = count_of(value);
    } else if (strcmp(key, "rule_firings") == 0) {
        r->rule_firings = count_of(value);
    }
}

static void object_take(struct summary *s, const char *path, const struct mu_json_value *value)
{
    size_t index;
    const char *key;
    if (!item_split(path, MU_OBJECTS_MAX, &index, &key)) {
        return;
    }
    struct report_object *o = &s->objects[index];
    grow(&s->objects_count, index);
    if (strcmp(key, "name") == 0) {
        o->name = mu_startup_string(value->text);
    } else if (strcmp(key, "x_m") == 0) {
        o->pose.x_m = value->number;
    } else if (strcmp(key, "y_m") == 0) {
        o->pose.y_m = value->number;
    } else if (strcmp(key, "heading_rad") == 0) {
        o->pose.heading_rad = value->number;
    }
}

static void run_take(struct summary *s, const char *path, const struct mu_json_value *value)
{
    if (strcmp(path, "hash") == 0) {
        s->there = value->kind == MU_JSON_STRING;
        mu_text_copy(s->hash, sizeof s->hash, value->text);
    } else if (strcmp(path, "command") == 0) {
        mu_text_copy(s->command, sizeof s->command, value->text);
    } else if (strcmp(path, "file") == 0) {
        mu_text_copy(s->file, sizeof s->file, value->text);
    } else if (strcmp(path, "duration_s") == 0) {
        s->duration_s = fmax(0, fmin(value->number, SUMMARY_TIME_MAX_S));
    } else if (strcmp(path, "free") == 0) {
        s->free = value->number > 0;
    } else if (strcmp(path, "made_with") == 0) {
        mu_text_copy(s->made_with, sizeof s->made_with, value->text);
    } else if (strcmp(path, "seed") == 0) {
        s->seed = count_of(value);
    } else if (strcmp(path, "sim_time_s") == 0) {
        s->sim_time_s = fmax(0, fmin(value->number, SUMMARY_TIME_MAX_S));
    } else if (strcmp(path, "wall_time_s") == 0) {
        s->wall_time_s = value->number;
    } else if (strcmp(path, "broke_off") == 0) {
        s->broke_off = value->number > 0;
    } else if (strcmp(path, "packets_struck") == 0) {
        s->packets_struck = count_of(value);
    }
}

static void value_take(void *self, const char *path, const struct mu_json_value *value)
{
    static const struct {
        const char *list;
        void (*take)(struct summary *s, const char *path, const struct mu_json_value *value);
    } lists[] = {
        {"mail.", mail_take},        {"overrides.", override_take}, {"undone.", undone_take},
        {"restarts.", restart_take}, {"chaos.", chaos_take},        {"monitors.", monitor_take},
        {"robots.", robot_take},     {"objects.", object_take},     {"made_of.", file_take}};
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
        size_t len = strlen(lists[i].list);
        if (strncmp(path, lists[i].list, len) == 0) {
            lists[i].take(self, path + len, value);
            return;
        }
    }
    run_take(self, path, value);
}

/* What a broken or a hand-made file leaves out. */
static void absent_fill(struct summary *s)
{
    for (size_t i = 0; i < s->overrides_count; i++) {
        s->overrides[i] = s->overrides[i] ? s->overrides[i] : "";
    }
    for (size_t i = 0; i < s->files_count; i++) {
        s->files[i].name = s->files[i].name ? s->files[i].name : "";
    }
    for (size_t i = 0; i < s->restarts_count; i++) {
        s->restarts[i].name = s->restarts[i].name ? s->restarts[i].name : "";
    }
    for (size_t i = 0; i < EXPERIMENT_CHAOS_MAX; i++) {
        s->chaos[i].reason = s->chaos[i].reason ? s->chaos[i].reason : "";
    }
    for (size_t i = 0; i < s->monitors_count; i++) {
        struct report_monitor *m = &s->monitors[i];
        m->name = m->name ? m->name : "";
        m->rules = m->rules || m->program ? m->rules : "";
    }
    for (size_t i = 0; i < s->robots_count; i++) {
        s->robots[i].name = s->robots[i].name ? s->robots[i].name : "";
    }
    for (size_t i = 0; i < s->objects_count; i++) {
        s->objects[i].name = s->objects[i].name ? s->objects[i].name : "";
    }
}

mu_result summary_read(struct summary **out, const char *folder, struct mu_fault *fault)
{
    char path[PATH_MAX + 32];
    struct summary *s = mu_startup_alloc(sizeof *s);
    *out = s;
    snprintf(path, sizeof path, "%s/summary.json", folder);
    FILE *file = fopen(path, "re");
    if (!file && errno == ENOENT) {
        absent_fill(s);
        return MU_OK;
    }
    char *text = mu_startup_alloc(SUMMARY_BYTES_MAX + 2);
    s->objects = mu_startup_array(MU_OBJECTS_MAX, sizeof *s->objects);
    size_t len = file ? fread(text, 1, SUMMARY_BYTES_MAX + 1, file) : 0;
    if (!file || fclose(file) != 0 || len > SUMMARY_BYTES_MAX) {
        return mu_fault_at(fault, path, 0, 0, "cannot read the summary: %s",
                           len > SUMMARY_BYTES_MAX ? "it is too long" : strerror(errno));
    }
    text[len] = '\0';
    mu_result read = mu_json_read(path, text, value_take, s, fault);
    absent_fill(s);
    if (read == MU_OK && !s->there) {
        return mu_fault_at(fault, path, 0, 0, "expected the summary of a run");
    }
    return read;
}
