/* SPDX-License-Identifier: Apache-2.0 */
/* What one summary.json says. */
#include "core/hash.h"
#include "core/json_read.h"
#include "core/text.h"
#include "muster/memory.h"
#include "report/compare.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COMPARE_PARTS_MAX = 640 };

/* A summary while it is read. */
struct reading {
    struct compare *compare;
    struct compare_run *run;
    char robot[COMPARE_NAME_MAX];        /* whose values come: its name stands first */
    double sums[COMPARE_STATISTICS_MAX]; /* over the robots */
    unsigned counts[COMPARE_STATISTICS_MAX];
    struct compare_part parts[COMPARE_PARTS_MAX];
    unsigned parts_count;
    char file[COMPARE_NAME_MAX]; /* whose hash comes */
    bool is_summary;
};

static void statistic_take(struct reading *r, const char *name, double value)
{
    for (unsigned i = 0; i < r->compare->statistics_count; i++) {
        if (strcmp(r->compare->statistics[i], name) == 0) {
            r->run->values[i] = value;
        }
    }
}

/* "robots.3.final.x_m": of that robot, and of all. */
static void robot_take(struct reading *r, const char *rest, const struct mu_json_value *value)
{
    char name[2 * COMPARE_NAME_MAX];
    const char *key = rest + strspn(rest, "0123456789");
    if (strcmp(key, ".name") == 0) {
        mu_text_copy(r->robot, sizeof r->robot, value->text);
    }
    if (value->kind != MU_JSON_NUMBER) {
        return;
    }
    snprintf(name, sizeof name, "%s%.*s", r->robot, COMPARE_NAME_MAX, key);
    statistic_take(r, name, value->number);
    for (unsigned i = 0; i < r->compare->statistics_count; i++) {
        const char *wanted = r->compare->statistics[i];
        if (strncmp(wanted, "robots.", 7) == 0 && strcmp(wanted + 6, key) == 0) {
            r->sums[i] += value->number;
            r->counts[i]++;
        }
    }
}

/* shown: what people are told of it; the last of what it is hashed to is at least that. */
static void part_add(struct reading *r, const char *shown, uint64_t hash)
{
    if (r->parts_count < COMPARE_PARTS_MAX) {
        r->parts[r->parts_count++] =
            (struct compare_part){mu_startup_string(shown), mu_hash_number(hash)};
    }
}

/* "KEY=VALUE", as --set has it. */
static void override_take(struct reading *r, const char *text)
{
    char shown[MU_TEXT_SHOWN];
    const char *by = r->compare->by;
    size_t len = by ? strlen(by) : 0;
    if (by && strncmp(text, by, len) == 0 && text[len] == '=') {
        mu_text_copy(r->run->value, sizeof r->run->value, mu_text_show(shown, text + len + 1));
    } else if (!by && strncmp(text, "seed=", 5) != 0) {
        part_add(r, mu_text_show(shown, text), mu_hash_string(text));
    }
}

/* "made_of.3.file" and ".hash": where a file lies makes no difference. */
static void file_take(struct reading *r, const char *path, const char *text)
{
    char bytes[2 * COMPARE_NAME_MAX], shown[MU_TEXT_SHOWN];
    const char *key = strrchr(path, '.'), *slash = strrchr(text, '/');
    if (strcmp(key, ".file") == 0) {
        mu_text_copy(r->file, sizeof r->file, mu_text_show(shown, slash ? slash + 1 : text));
    } else if (strcmp(key, ".hash") == 0) {
        snprintf(bytes, sizeof bytes, "%s %.7s", r->file, mu_text_show(shown, text));
        part_add(r, bytes, mu_hash_string(r->file) ^ mu_hash_string(text));
    }
}

static void duration_take(struct reading *r, double duration_s)
{
    char text[32];
    snprintf(text, sizeof text, "%.12g s", duration_s);
    part_add(r, text, mu_hash_string(text));
}

static bool ends_with(const char *text, const char *end)
{
    size_t len = strlen(text), end_len = strlen(end);
    return len >= end_len && strcmp(text + len - end_len, end) == 0;
}

static void value_take(void *self, const char *path, const struct mu_json_value *value)
{
    struct reading *r = self;
    struct compare_run *run = r->run;
    if (strcmp(path, "experiment") == 0 && value->kind == MU_JSON_STRING) {
        char shown[MU_TEXT_SHOWN];
        r->is_summary = true;
        mu_text_copy(run->experiment, sizeof run->experiment, mu_text_show(shown, value->text));
    } else if (strcmp(path, "hash") == 0) {
        mu_text_copy(run->hash, sizeof run->hash, value->text);
    } else if (strcmp(path, "seed") == 0) {
        run->seed = value->number >= 0 && value->number < 1e19 ? (uint64_t)value->number : 0;
    } else if (strcmp(path, "broke_off") == 0) {
        run->broke_off = value->kind == MU_JSON_BOOL && value->number > 0;
    } else if (strncmp(path, "overrides.", 10) == 0) {
        override_take(r, value->text);
    } else if (strncmp(path, "made_of.", 8) == 0) {
        file_take(r, path, value->text);
    } else if (strcmp(path, "free") == 0 && value->number > 0) {
        part_add(r, "free", mu_hash_string("free"));
    } else if (strncmp(path, "expectations.", 13) == 0) {
        bool verdict = ends_with(path, ".met") && value->kind == MU_JSON_BOOL;
        run->expected += verdict;
        run->met += verdict && value->number > 0;
    } else if (strncmp(path, "robots.", 7) == 0) {
        robot_take(r, path + 7, value);
    } else if (value->kind == MU_JSON_NUMBER) {
        statistic_take(r, path, value->number);
        if (strcmp(path, "duration_s") == 0) {
            duration_take(r, value->number);
        }
    }
}

static mu_result file_read(const char *path, char *text, struct mu_fault *fault)
{
    FILE *file = fopen(path, "re");
    size_t len = file ? fread(text, 1, COMPARE_FILE_MAX + 1, file) : 0;
    bool bad = !file || ferror(file);
    int why = errno;
    if (file) {
        fclose(file);
    }
    if (bad) {
        return mu_fault_at(fault, path, 0, 0, "cannot read the summary: %s", strerror(why));
    }
    if (len > COMPARE_FILE_MAX) {
        return mu_fault_at(fault, path, 0, 0, "expected a summary of at most %d bytes",
                           COMPARE_FILE_MAX);
    }
    text[len] = '\0';
    return MU_OK;
}

/* Two folders with one seed and one hash are one run, and would make the mean surer than it is. */
static bool is_there(const struct compare *c, const struct compare_run *run)
{
    for (unsigned i = 0; i < c->runs_count; i++) {
        const struct compare_run *other = &c->runs[i];
        bool same = strcmp(other->folder, run->folder) == 0 ||
                    (other->seed == run->seed && strcmp(run->hash, "none") != 0 &&
                     strcmp(other->hash, run->hash) == 0);
        if (same && other->content == run->content) {
            return true;
        }
    }
    return false;
}

static void reading_end(struct reading *r)
{
    for (unsigned i = 0; i < r->compare->statistics_count; i++) {
        if (r->counts[i] > 0) {
            r->run->values[i] = r->sums[i] / r->counts[i];
        }
    }
    if (r->run->expected > 0) {
        statistic_take(r, "expectations.met", (double)r->run->met / r->run->expected);
    }
    struct compare_part *parts = mu_startup_array(r->parts_count, sizeof *parts);
    r->run->content = mu_hash_string(r->run->experiment) * 31 + mu_hash_string(r->run->value);
    for (unsigned i = 0; i < r->parts_count; i++) {
        parts[i] = r->parts[i];
        r->run->content += parts[i].hash;
    }
    r->run->parts = parts;
    r->run->parts_count = r->parts_count;
}

mu_result compare_add(struct compare *c, const char *folder, struct mu_fault *fault)
{
    static char *text;
    static struct reading r;
    char path[PATH_MAX];
    if (c->runs_count == c->runs_max) {
        return MU_FULL;
    }
    text = text ? text : mu_startup_alloc(COMPARE_FILE_MAX + 2);
    snprintf(path, sizeof path, "%.*s/summary.json", PATH_MAX - 32, folder);
    mu_result done = file_read(path, text, fault);
    r = (struct reading){.compare = c, .run = &c->runs[c->runs_count]};
    *r.run = (struct compare_run){.folder = folder};
    mu_text_copy(r.run->value, sizeof r.run->value, c->by ? "-" : "");
    for (unsigned i = 0; i < c->statistics_count; i++) {
        r.run->values[i] = NAN;
    }
    done = done == MU_OK ? mu_json_read(path, text, value_take, &r, fault) : done;
    if (done != MU_OK) {
        return done;
    }
    if (!r.is_summary) {
        return mu_fault_at(fault, path, 0, 0, "expected the summary of a run");
    }
    reading_end(&r);
    if (is_there(c, r.run)) {
        return MU_DUPLICATE;
    }
    c->runs_count++;
    return MU_OK;
}
