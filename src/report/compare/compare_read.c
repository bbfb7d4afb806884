/* SPDX-License-Identifier: Apache-2.0 */
/* A run of a comparison, out of its summary. */
#include "core/hash.h"
#include "core/text.h"
#include "muster/memory.h"
#include "report/compare/compare.h"
#include "report/report.h"

#include <inttypes.h>
#include <string.h>

enum { COMPARE_PARTS_MAX = SUMMARY_FILES_MAX + SUMMARY_LIST_MAX + 2 };

/* The parts of a run while they are collected. */
struct parts {
    struct compare_part at[COMPARE_PARTS_MAX];
    unsigned count;
};

/* shown: the text for people; it tells less than the hash. */
static void part_add(struct parts *p, const char *shown, uint64_t hash)
{
    p->at[p->count++] = (struct compare_part){mu_startup_string(shown), mu_hash_number(hash)};
}

/* "KEY=VALUE", as --set has it. */
static void override_take(struct compare_run *run, struct parts *p, const char *by,
                          const char *text)
{
    char shown[MU_TEXT_SHOWN];
    size_t len = by ? strlen(by) : 0;
    if (by && strncmp(text, by, len) == 0 && text[len] == '=') {
        mu_text_copy(run->value, sizeof run->value, mu_text_show(shown, text + len + 1));
    } else if (!by && strncmp(text, "seed=", 5) != 0) {
        part_add(p, mu_text_show(shown, text), mu_hash_string(text));
    }
}

/* The folder of a file makes no difference. */
static void file_take(struct parts *p, const struct report_source *file)
{
    char text[2 * COMPARE_NAME_MAX], name[MU_TEXT_SHOWN], hash[20];
    const char *slash = strrchr(file->name, '/');
    mu_text_show(name, slash ? slash + 1 : file->name);
    snprintf(hash, sizeof hash, "%016" PRIx64, file->hash);
    snprintf(text, sizeof text, "%s %.7s", name, hash);
    part_add(p, text, mu_hash_string(name) ^ mu_hash_string(hash));
}

static void parts_take(struct compare_run *run, const struct summary *s, const char *by)
{
    static struct parts p;
    p.count = 0;
    if (s->duration_s > 0) {
        char text[32];
        snprintf(text, sizeof text, "%.12g s", s->duration_s);
        part_add(&p, text, mu_hash_string(text));
    }
    if (s->free) {
        part_add(&p, "free", mu_hash_string("free"));
    }
    for (size_t i = 0; i < s->overrides_count; i++) {
        override_take(run, &p, by, s->overrides[i]);
    }
    for (size_t i = 0; i < s->files_count; i++) {
        file_take(&p, &s->files[i]);
    }
    struct compare_part *parts = mu_startup_array(p.count, sizeof *parts);
    memcpy(parts, p.at, p.count * sizeof *parts);
    run->parts = parts;
    run->parts_count = p.count;
    run->content = mu_hash_string(run->experiment) * 31 + mu_hash_string(run->value);
    for (unsigned i = 0; i < p.count; i++) {
        run->content += parts[i].hash;
    }
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

mu_result compare_add(struct compare *c, const char *folder, struct mu_fault *fault)
{
    static struct summary s;
    char shown[MU_TEXT_SHOWN];
    if (c->runs_count == c->runs_max) {
        return MU_FULL;
    }
    if (summary_read(&s, folder, fault) != MU_OK) {
        return MU_FAULT_FILE;
    }
    struct compare_run *run = &c->runs[c->runs_count];
    *run = (struct compare_run){.folder = folder,
                                .seed = s.seed,
                                .broke_off = s.broke_off,
                                .expected = s.expected,
                                .met = s.met};
    mu_text_copy(run->experiment, sizeof run->experiment, mu_text_show(shown, s.experiment));
    mu_text_copy(run->hash, sizeof run->hash, s.hash);
    mu_text_copy(run->arithmetic, sizeof run->arithmetic, mu_text_show(shown, s.arithmetic));
    mu_text_copy(run->value, sizeof run->value, c->by ? "-" : "");
    for (unsigned i = 0; i < c->statistics_count; i++) {
        run->values[i] = summary_statistic(&s, c->statistics[i]);
    }
    parts_take(run, &s, c->by);
    summary_close(&s);
    if (is_there(c, run)) {
        return MU_DUPLICATE;
    }
    c->runs_count++;
    return MU_OK;
}

const struct compare_run *compare_other_arithmetic(const struct compare *c)
{
    for (unsigned i = 1; i < c->runs_count; i++) {
        if (strcmp(c->runs[i].arithmetic, c->runs[0].arithmetic) != 0) {
            return &c->runs[i];
        }
    }
    return NULL;
}
