/* SPDX-License-Identifier: Apache-2.0 */
#include "run/run.h"

#include "core/clock.h"
#include "core/exits.h"
#include "muster/memory.h"
#include "report/compare/compare.h"
#include "run/supervise.h"

#include <inttypes.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum {
    SERIES_STOP_MS = 5000, /* a run ends its own children first */
    SERIES_NAP_NS = 10000000
};

static const uint64_t SERIES_PROGRESS_NS = 200000000;

struct series_run {
    uint64_t seed;
    char folder[PATH_MAX];
    const struct child *child; /* NULL: not begun */
    unsigned place;            /* among those that live at once: its domain, its processor */
    bool ended;
    int code;
};

struct series {
    const struct run_options *options;
    const struct experiment *experiment;
    struct supervise children;
    struct series_run *runs;
    size_t count, begun, ended;
    unsigned jobs, failed;   /* runs that ended with a code that is not 0 */
    bool taken[CPU_SETSIZE]; /* places */
    bool spread;             /* each run stays on one processor */
    cpu_set_t processors;
    uint64_t began_ns, shown_ns;
    struct compare *compare;
};

/* --- seeds ------------------------------------------------------------------------------------ */

/* A whole number without a sign.  @return false: there is none, or it is too large */
static bool seed_read(const char **at, uint64_t *seed)
{
    char *end;
    bool digit = **at >= '0' && **at <= '9';
    *seed = digit ? strtoull(*at, &end, 10) : 0;
    *at = digit ? end : *at;
    return digit && *seed <= 1000000000000000;
}

static bool seed_add(uint64_t seeds[SERIES_RUNS_MAX], size_t *count, uint64_t seed)
{
    for (size_t i = 0; i < *count; i++) {
        if (seeds[i] == seed) {
            return false;
        }
    }
    if (*count == SERIES_RUNS_MAX) {
        return false;
    }
    seeds[(*count)++] = seed;
    return true;
}

size_t series_seeds(const char *text, uint64_t seeds[SERIES_RUNS_MAX])
{
    size_t count = 0;
    for (const char *at = text;;) {
        uint64_t first, last;
        if (!seed_read(&at, &first)) {
            return 0;
        }
        last = first;
        if (strncmp(at, "..", 2) == 0) {
            at += 2;
            if (!seed_read(&at, &last) || last < first) {
                return 0;
            }
        }
        for (uint64_t seed = first; seed <= last; seed++) {
            if (!seed_add(seeds, &count, seed)) {
                return 0;
            }
        }
        if (*at == '\0') {
            return count;
        }
        if (*at++ != ',') {
            return 0;
        }
    }
}

/* --- one run ---------------------------------------------------------------------------------- */

/* @return the words of a run's command line */
static const char *const *words_make(const struct series *s, const struct series_run *run)
{
    const struct run_options *o = s->options;
    supervise_words("muster");
    supervise_word("run");
    supervise_word("%s", o->file);
    supervise_word("--quiet");
    supervise_word("--seed=%" PRIu64, run->seed);
    supervise_word("--out=%s", run->folder);
    supervise_word("--rate=%.17g", o->rate);
    supervise_word("--limit=%.17g", o->limit_s);
    if (o->duration_s >= 0) {
        supervise_word("--duration=%.17g", o->duration_s);
    }
    if (o->domain >= 0) {
        supervise_word("--domain=%d", (int)o->domain + (int)run->place);
    }
    if (o->record) {
        supervise_word("--record=%s", o->record);
    }
    if (o->root) {
        supervise_word("--root=%s", o->root);
    }
    if (o->no_diary) {
        supervise_word("--no-diary");
    }
    if (o->programs) {
        supervise_word("--programs");
    }
    if (o->free) {
        supervise_word("--free");
    }
    if (o->no_spread) {
        supervise_word("--no-spread");
    }
    for (size_t i = 0; i < o->set_count; i++) {
        supervise_word("--set=%s", o->set[i]);
    }
    return supervise_words_end();
}

/* The processes of a run in lock step work in turns, so that one processor is enough for it, and
 * none of them waits until another one has woken up.  A child begins where its parent is. */
static void processor_choose(const struct series *s, unsigned place, cpu_set_t *one)
{
    CPU_ZERO(one);
    for (int cpu = 0; cpu < CPU_SETSIZE; cpu++) {
        if (CPU_ISSET(cpu, &s->processors) && place-- == 0) {
            CPU_SET(cpu, one);
        }
    }
}

static mu_result run_begin(struct series *s, struct series_run *run)
{
    char name[MU_PROCESS_MAX + 1];
    while (s->taken[run->place]) {
        run->place++;
    }
    snprintf(name, sizeof name, "seed %" PRIu64, run->seed);
    if (s->spread) {
        cpu_set_t one;
        processor_choose(s, run->place, &one);
        sched_setaffinity(0, sizeof one, &one);
    }
    mu_result started = supervise_start(&s->children, name, "muster", words_make(s, run));
    if (s->spread) {
        sched_setaffinity(0, sizeof s->processors, &s->processors);
    }
    MU_TRY(started);
    s->taken[run->place] = true;
    run->child = &s->children.children[s->children.count - 1];
    s->begun++;
    return MU_OK;
}

/* Its report goes into the comparison; what has none says why. */
static void run_end(struct series *s, struct series_run *run)
{
    struct mu_fault fault;
    int status = run->child->status;
    run->ended = true;
    run->code = WIFEXITED(status) ? WEXITSTATUS(status) : MU_EXIT_CRASH;
    s->taken[run->place] = false;
    s->ended++;
    s->failed += run->code != MU_EXIT_DONE;
    bool reported = mu_exit_of_whole_run(run->code);
    if (!reported && !run_signal) {
        supervise_explain(run->child);
    } else if (reported && compare_add(s->compare, run->folder, &fault) < 0) {
        mu_fault_print(&fault);
    } else if (reported && s->options->json) {
        run_summary_print(run->folder);
    }
}

/* --- the series ------------------------------------------------------------------------------- */

static void progress_show(struct series *s)
{
    uint64_t now_ns = mu_clock_ns();
    bool is_last = s->ended == s->count;
    if (s->options->quiet || !isatty(STDERR_FILENO) ||
        (now_ns - s->shown_ns < SERIES_PROGRESS_NS && !is_last)) {
        return;
    }
    s->shown_ns = now_ns;
    fprintf(stderr, "\r\033[K%s: %zu of %zu runs done, %zu under way", s->experiment->name,
            s->ended, s->count, s->begun - s->ended);
    if (s->failed > 0) {
        fprintf(stderr, ", %u not as expected", s->failed);
    }
    if (s->ended > 0 && !is_last) {
        double each_s = (double)(now_ns - s->began_ns) / 1e9 / (double)s->ended;
        fprintf(stderr, ", %.0f s to go", each_s * (double)(s->count - s->ended));
    }
    fputs(is_last ? "\r\033[K" : "", stderr);
}

static void runs_look(struct series *s)
{
    supervise_look(&s->children);
    for (size_t i = 0; i < s->begun; i++) {
        struct series_run *run = &s->runs[i];
        if (!run->ended && run->child->ended) {
            run_end(s, run);
        }
    }
}

static mu_result series_live(struct series *s)
{
    const struct timespec nap = {.tv_nsec = SERIES_NAP_NS};
    while (s->ended < s->count && !run_signal) {
        while (s->begun < s->count && s->begun - s->ended < s->jobs) {
            MU_TRY(run_begin(s, &s->runs[s->begun]));
        }
        progress_show(s);
        nanosleep(&nap, NULL);
        runs_look(s);
    }
    progress_show(s);
    return MU_OK;
}

static void series_interrupted(struct series *s)
{
    supervise_stop_all(&s->children, SERIES_STOP_MS);
    size_t done = 0;
    for (size_t i = 0; i < s->begun; i++) {
        done += s->runs[i].ended;
    }
    fprintf(stderr, "%smuster run: interrupted: %zu of %zu runs are done, in %s\n",
            isatty(STDERR_FILENO) && !s->options->quiet ? "\r\033[K" : "", done, s->count,
            s->options->out ? s->options->out : "out");
}

static int worst_code(const struct series *s)
{
    int worst = run_signal ? MU_EXIT_INTERRUPTED : MU_EXIT_DONE;
    for (size_t i = 0; i < s->begun && !run_signal; i++) {
        worst = s->runs[i].code > worst ? s->runs[i].code : worst;
    }
    return worst;
}

/* The seeds whose runs did not end with 0, by code. */
static void failures_print(const struct series *s)
{
    for (size_t i = 0; i < s->begun; i++) {
        if (s->runs[i].ended && s->runs[i].code != MU_EXIT_DONE) {
            printf("seed %" PRIu64 ": exit code %d, %s\n", s->runs[i].seed, s->runs[i].code,
                   s->runs[i].folder);
        }
    }
}

static int series_report(struct series *s)
{
    char page[PATH_MAX + 64];
    struct mu_fault fault;
    int worst = worst_code(s);
    if (s->options->json || s->compare->runs_count == 0) {
        return worst;
    }
    MU_ASSERT(compare_close(s->compare) == MU_OK);
    compare_print(s->compare, stdout, false);
    failures_print(s);
    snprintf(page, sizeof page, "%s/%s-series.html", s->options->out ? s->options->out : "out",
             s->experiment->name);
    if (compare_page(s->compare, page, &fault) != MU_OK) {
        mu_fault_print(&fault);
        return worst > MU_EXIT_WRITE ? worst : MU_EXIT_WRITE;
    }
    printf("page   %s\n", page);
    return worst;
}

static void jobs_choose(struct series *s)
{
    const struct run_options *o = s->options;
    bool known = sched_getaffinity(0, sizeof s->processors, &s->processors) == 0;
    unsigned processors = known ? (unsigned)CPU_COUNT(&s->processors) : 1;
    s->jobs = o->jobs > 0 ? (unsigned)o->jobs : processors;
    s->spread = known && s->jobs <= processors && !o->free && o->rate <= 0 && !o->no_spread;
}

int series_run(const struct run_options *options, const struct experiment *experiment)
{
    struct series *s = mu_startup_alloc(sizeof *s);
    s->options = options;
    s->experiment = experiment;
    s->count = options->seeds_count;
    jobs_choose(s);
    s->runs = mu_startup_array(s->count, sizeof *s->runs);
    for (size_t i = 0; i < s->count; i++) {
        s->runs[i].seed = options->seeds[i];
        snprintf(s->runs[i].folder, sizeof s->runs[i].folder, "%.3000s/%s-%" PRIu64,
                 options->out ? options->out : "out", experiment->name, options->seeds[i]);
    }
    MU_ASSERT(compare_open(&s->compare, (unsigned)s->count, NULL, NULL, 0) == MU_OK);
    supervise_init(&s->children, true, false);
    s->began_ns = mu_clock_ns();
    mu_result lived = series_live(s);
    if (run_signal || lived != MU_OK) {
        series_interrupted(s);
    }
    int worst = series_report(s);
    return lived == MU_OK ? worst : MU_EXIT_CRASH;
}
