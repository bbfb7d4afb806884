/* SPDX-License-Identifier: Apache-2.0 */
/* muster compare: what several runs amount to. */
#include "report/compare/compare.h"

#include "cli/verbs.h"
#include "core/arithmetic.h"
#include "core/exits.h"
#include "core/options.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static struct {
    const char *by, *page;
    struct mu_option_list statistics;
    bool json;
} chosen;

static struct mu_option option_table[] = {
    MU_STRING("by", "KEY", chosen.by,
              "group runs by what --set gave this key, whatever it gave others (default: by all "
              "that was run but the seed)"),
    MU_NAMES("statistic", "NAME", chosen.statistics,
             "what to compare, as in summary.json: red.distance_m,mail.sent; robots.distance_m is "
             "the mean over the robots (default: a dozen that suit any team)"),
    MU_STRING("out", "FILE", chosen.page, "the page with the plots", .fallback = "compare.html"),
    MU_FLAG("json", chosen.json, "one object per line, and no page"),
};

/* A pattern such as out/follow-* also finds the page of a series, and runs that broke off.
 * @return why a path is left out, or NULL */
static const char *path_objection(const char *path)
{
    struct stat what;
    char summary[PATH_MAX + 32], recording[PATH_MAX + 32];
    if (stat(path, &what) != 0) {
        return NULL;
    }
    if (!S_ISDIR(what.st_mode)) {
        return "is no folder: left out";
    }
    snprintf(summary, sizeof summary, "%s/summary.json", path);
    snprintf(recording, sizeof recording, "%s/run.mcap", path);
    bool broke_off = access(summary, F_OK) != 0 && access(recording, F_OK) == 0;
    return broke_off ? "broke off: left out; `muster report` with that folder makes its report"
                     : NULL;
}

static mu_result folder_read(struct compare *c, const char *path)
{
    struct mu_fault fault;
    const char *objection = path_objection(path);
    mu_result added = objection ? MU_OK : compare_add(c, path, &fault);
    if (added == MU_DUPLICATE) {
        objection = "has a run that is there already: left out";
    } else if (added != MU_OK) {
        mu_fault_print(&fault);
        return added;
    }
    if (!objection && c->runs[c->runs_count - 1].broke_off) {
        objection = "has a run that broke off: it counts as far as it went";
    }
    if (objection) {
        fprintf(stderr, "muster compare: %s %s\n", path, objection);
    }
    return MU_OK;
}

static mu_result folders_read(struct compare *c, const struct mu_options *o)
{
    for (size_t i = 0; i < o->words_count; i++) {
        mu_result read = folder_read(c, o->words[i]);
        if (read != MU_OK) {
            return read;
        }
    }
    if (c->runs_count == 0) {
        fputs("muster compare: there is no report to compare\n", stderr);
        return MU_FAULT_FILE;
    }
    if (compare_close(c) != MU_OK) {
        fprintf(stderr, "muster compare: expected at most %d groups\n", COMPARE_GROUPS_MAX);
        return MU_FAULT_USAGE;
    }
    return MU_OK;
}

static const char *arithmetic_of(const struct compare_run *run)
{
    return run->arithmetic[0] ? run->arithmetic : MU_ARITHMETIC_BEFORE;
}

/* Before anything else: such runs have other hashes, whatever else is the same.  @return the exit
 * code */
static int arithmetic_tell(const struct compare *c)
{
    const struct compare_run *one = &c->runs[0], *other = compare_other_arithmetic(c);
    if (!other) {
        return MU_EXIT_DONE;
    }
    fprintf(stderr,
            "muster compare: the arithmetic differs, and hashes with it: %s was computed with %s, "
            "%s with %s\n",
            one->folder, arithmetic_of(one), other->folder, arithmetic_of(other));
    return MU_EXIT_OTHER;
}

static void missing_tell(const struct compare *c)
{
    for (unsigned i = 0; chosen.statistics.count > 0 && i < c->statistics_count; i++) {
        if (!compare_has(c, i)) {
            fprintf(stderr, "muster compare: no run has the statistic '%s'\n", c->statistics[i]);
        }
    }
}

static mu_result result_tell(const struct compare *c)
{
    struct mu_fault fault;
    missing_tell(c);
    compare_print(c, stdout, chosen.json);
    mu_result written = chosen.json ? MU_OK : compare_page(c, chosen.page, &fault);
    if (written != MU_OK) {
        mu_fault_print(&fault);
        fprintf(stderr, "muster compare: --out FILE puts the page elsewhere\n");
        return written;
    }
    if (!chosen.json) {
        printf("page   %s\n", chosen.page);
    }
    return MU_OK;
}

int compare_verb(int argc, char **argv)
{
    static struct mu_options options = {
        .program = "muster compare",
        .usage = "DIR... [OPTION...]",
        .about = "Compares runs by their reports: means with 95 % intervals, a table and plots.",
        MU_OPTION_TABLE(option_table)};
    mu_result done = mu_options_parse(&options, argc, argv);
    if (done != MU_OK) {
        return mu_exit_for(done);
    }
    if (options.words_count == 0) {
        fprintf(stderr, "muster compare: name the folders of runs, for example: "
                        "muster compare out/follow-*\n");
        return MU_EXIT_USAGE;
    }
    struct compare *c;
    done = compare_open(&c, (unsigned)options.words_count, chosen.by, chosen.statistics.items,
                        chosen.statistics.count);
    done = done == MU_OK ? folders_read(c, &options) : done;
    int code = done == MU_OK ? arithmetic_tell(c) : MU_EXIT_DONE;
    done = done == MU_OK ? result_tell(c) : done;
    return done == MU_OK ? code : mu_exit_for(done);
}
