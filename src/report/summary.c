/* SPDX-License-Identifier: Apache-2.0 */
#include "report/report.h"

#include "core/text_file.h"
#include "muster/memory.h"

#include <errno.h>
#include <jansson.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *text_of(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "";
}

static double number_of(const json_t *object, const char *key)
{
    return json_number_value(json_object_get(object, key));
}

static uint64_t count_of(const json_t *object, const char *key)
{
    double number = number_of(object, key);
    return number >= 0 && number < 1e19 ? (uint64_t)number : 0;
}

/* @return NULL: the list has no such item, or no more than `most` are read */
static const json_t *item_of(const struct summary *s, const char *list, size_t i, size_t most)
{
    return i < most ? json_array_get(json_object_get(s->document, list), i) : NULL;
}

static size_t texts_take(const struct summary *s, const char *list, const char **texts)
{
    size_t count = 0;
    for (const json_t *item; (item = item_of(s, list, count, SUMMARY_LIST_MAX)); count++) {
        texts[count] = json_is_string(item) ? json_string_value(item) : "";
    }
    return count;
}

static void run_take(struct summary *s)
{
    const json_t *run = s->document, *mail = json_object_get(run, "mail"), *item;
    s->experiment = text_of(run, "experiment");
    s->file = text_of(run, "file");
    s->hash = text_of(run, "hash");
    s->command = text_of(run, "command");
    s->made_with = text_of(run, "made_with");
    s->arithmetic = text_of(run, "arithmetic");
    s->architecture = text_of(run, "architecture");
    s->processor = text_of(run, "processor");
    s->free = json_is_true(json_object_get(run, "free"));
    s->broke_off = json_is_true(json_object_get(run, "broke_off"));
    s->seed = count_of(run, "seed");
    s->packets_struck = count_of(run, "packets_struck");
    s->duration_s = fmax(0, fmin(number_of(run, "duration_s"), SUMMARY_TIME_MAX_S));
    s->sim_time_s = fmax(0, fmin(number_of(run, "sim_time_s"), SUMMARY_TIME_MAX_S));
    s->wall_time_s = number_of(run, "wall_time_s");
    s->overrides_count = texts_take(s, "overrides", s->overrides);
    s->undone_count = texts_take(s, "undone", s->undone);
    s->mail_unknown = json_is_null(json_object_get(mail, "sent"));
    s->mail = (struct report_mail){.sent = count_of(mail, "sent"),
                                   .delivered = count_of(mail, "delivered"),
                                   .waiting = count_of(mail, "waiting"),
                                   .expired = count_of(mail, "expired"),
                                   .refused = count_of(mail, "refused"),
                                   .lost = count_of(mail, "lost"),
                                   .duplicated = count_of(mail, "duplicated")};
    for (size_t i = 0; (item = item_of(s, "expectations", i, SIZE_MAX)); i++) {
        s->expected += json_is_boolean(json_object_get(item, "met"));
        s->met += json_is_true(json_object_get(item, "met"));
    }
}

/* @return how many there are in the list */
static size_t agents_take(const struct summary *s, const char *list, struct report_robot *agents)
{
    const json_t *item;
    size_t count = 0;
    for (; (item = item_of(s, list, count, MU_ROBOTS_MAX)); count++) {
        agents[count] = (struct report_robot){.name = text_of(item, "name"),
                                              .mail_sent = count_of(item, "mail_sent"),
                                              .mail_received = count_of(item, "mail_received"),
                                              .rule_firings = count_of(item, "rule_firings")};
    }
    return count;
}

static void bodies_take(struct summary *s)
{
    const json_t *item;
    s->robots_count = agents_take(s, "robots", s->robots);
    s->agents_count = agents_take(s, "agents", s->agents);
    for (size_t i = 0; (item = item_of(s, "objects", i, MU_OBJECTS_MAX)); i++) {
        s->objects[s->objects_count++] = (struct report_object){
            text_of(item, "name"),
            {number_of(item, "x_m"), number_of(item, "y_m"), number_of(item, "heading_rad")}};
    }
}

static void monitor_take(struct report_monitor *m, const json_t *item)
{
    const char *ended = text_of(item, "ended");
    m->name = text_of(item, "name");
    m->program = json_string_value(json_object_get(item, "program"));
    m->rules = m->program ? NULL : text_of(item, "rules");
    m->fate = ended[0] && strcmp(ended, "with the run") != 0 ? ended : NULL;
}

static void lists_take(struct summary *s)
{
    const json_t *item;
    for (size_t i = 0; (item = item_of(s, "made_of", i, SUMMARY_FILES_MAX)); i++) {
        s->files[s->files_count++] = (struct report_source){
            text_of(item, "file"), strtoull(text_of(item, "hash"), NULL, 16)};
    }
    for (size_t i = 0; (item = item_of(s, "restarts", i, MU_ROBOTS_MAX)); i++) {
        s->restarts[s->restarts_count++] =
            (struct report_restarts){text_of(item, "process"), (uint32_t)count_of(item, "count")};
    }
    for (size_t i = 0; (item = item_of(s, "monitors", i, EXPERIMENT_MONITORS_MAX)); i++) {
        monitor_take(&s->monitors[s->monitors_count++], item);
    }
    for (size_t i = 0; i < EXPERIMENT_CHAOS_MAX; i++) {
        item = item_of(s, "chaos", i, EXPERIMENT_CHAOS_MAX);
        s->chaos[i] = (struct report_chaos){.done = json_is_true(json_object_get(item, "done")),
                                            .at_s = number_of(item, "at_s"),
                                            .reason = text_of(item, "reason")};
    }
}

/* Counts are read as doubles: a seed may be larger than an integer of the library. */
static mu_result document_load(struct summary *s, const char *path, struct mu_fault *fault)
{
    static struct mu_text text;
    json_error_t error;
    if (!text.at) {
        mu_text_init(&text, mu_startup_alloc(SUMMARY_BYTES_MAX + 1), SUMMARY_BYTES_MAX + 1);
    }
    mu_result read = mu_text_file_read(path, &text, fault);
    if (read == MU_ABSENT && errno != ENOENT) {
        return MU_FAULT_FILE;
    }
    if (read != MU_OK || text.cut) {
        return read == MU_OK
                   ? mu_fault_at(fault, path, 0, 0, "expected a summary of at most %d bytes",
                                 SUMMARY_BYTES_MAX)
                   : read;
    }
    s->document = json_loadb(text.at, text.len, JSON_DECODE_INT_AS_REAL, &error);
    if (!s->document) {
        return mu_fault_at(fault, path, error.line, error.column, "%s", error.text);
    }
    if (!json_is_string(json_object_get(s->document, "experiment")) ||
        !json_is_string(json_object_get(s->document, "hash"))) {
        summary_close(s);
        return mu_fault_at(fault, path, 0, 0, "expected the summary of a run");
    }
    return MU_OK;
}

mu_result summary_read(struct summary *s, const char *folder, struct mu_fault *fault)
{
    char path[PATH_MAX + 32];
    snprintf(path, sizeof path, "%.*s/summary.json", PATH_MAX, folder);
    *s = (struct summary){.document = NULL};
    mu_result loaded = document_load(s, path, fault);
    run_take(s);
    bodies_take(s);
    lists_take(s);
    return loaded;
}

void summary_close(struct summary *s)
{
    json_decref(s->document);
    s->document = NULL;
}

/* --- statistics ------------------------------------------------------------------------------- */

/* The value at a path such as final.x_m or restarts.0.count.  @return NaN: no number is there */
static double number_at(const json_t *value, const char *path)
{
    for (size_t len; value && *path; path += len + (path[len] == '.')) {
        char *end;
        size_t index = strtoul(path, &end, 10);
        len = strcspn(path, ".");
        value = json_is_object(value) ? json_object_getn(value, path, len)
                : end == path + len   ? json_array_get(value, index)
                                      : NULL;
    }
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

static double robots_mean(const struct summary *s, const char *key)
{
    double sum = 0;
    unsigned count = 0;
    const json_t *robot;
    for (size_t i = 0; (robot = item_of(s, "robots", i, SIZE_MAX)); i++) {
        double number = number_at(robot, key);
        sum += isnan(number) ? 0 : number;
        count += !isnan(number);
    }
    return count > 0 ? sum / count : (double)NAN;
}

double summary_statistic(const struct summary *s, const char *name)
{
    if (strncmp(name, "robots.", 7) == 0) {
        return robots_mean(s, name + 7);
    }
    if (strcmp(name, "expectations.met") == 0) {
        return s->expected > 0 ? (double)s->met / s->expected : (double)NAN;
    }
    double number = number_at(s->document, name);
    const json_t *robot;
    for (size_t i = 0; isnan(number) && (robot = item_of(s, "robots", i, SIZE_MAX)); i++) {
        const char *own = text_of(robot, "name");
        size_t len = strlen(own);
        if (strncmp(name, own, len) == 0 && name[len] == '.') {
            number = number_at(robot, name + len + 1);
        }
    }
    return number;
}
