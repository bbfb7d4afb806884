/* SPDX-License-Identifier: Apache-2.0 */
/*
 * muster verify: does a recorded run again from what its recording has, and compares.
 *
 * The recording's files go into a folder of their own, as they stood to one another; `muster run`
 * lives through the experiment there, with what came from outside put in again; then two recordings
 * are compared step by step.
 */
#include "cli/unpack.h"
#include "cli/verbs.h"
#include "core/arithmetic.h"
#include "core/exits.h"
#include "core/json.h"
#include "core/options.h"
#include "core/text.h"
#include "muster/memory.h"
#include "operator/operator.h"
#include "run/run.h"
#include "story/story.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { WORDS_MAX = 16 + EXPERIMENT_OVERRIDES_MAX, STOP_PATIENCE_MS = 5000 };

static const struct timespec ROUND = {.tv_nsec = 10000000};

static struct {
    bool json, keep, programs, verbose;
} chosen;

static struct mu_option option_table[] = {
    MU_FLAG("keep", chosen.keep, "leave the folder of the second run, and say where it is"),
    MU_FLAG("programs", chosen.programs,
            "start the programs that the recording names as controllers"),
    MU_FLAG("verbose", chosen.verbose, "show what the second run says", .letter = 'v'),
    MU_FLAG("json", chosen.json, "say what came out as one line of JSON")};

struct verify {
    const char *file;
    char path[PATH_MAX]; /* of the recording, absolute */
    struct recording before, after;
    struct unpacked files;           /* of the recording; the second run lives there, too */
    char out[UNPACK_FOLDER_MAX + 8]; /* what that leaves */
    const char *argv[WORDS_MAX];     /* its command; NULL behind the last */
    size_t argc;
    bool others; /* a controller is another program than that of the recorded run */
};

static const char *note(const struct verify *v, const char *key)
{
    return recording_note(&v->before, key);
}

/* What a recording says, fit for a terminal; good until the next call. */
static const char *plain(const char *text)
{
    static char bytes[PATH_MAX];
    struct mu_text t = mu_text_in(bytes, sizeof bytes);
    mu_text_add_plain(&t, text, strlen(text));
    return t.at;
}

/* --- the second run --------------------------------------------------------------------------- */

static int64_t last_step(const struct recording *r)
{
    return r->steps_count > 0 ? r->steps[r->steps_count - 1].step : -1;
}

static double seconds(const struct verify *v, int64_t step)
{
    return (double)step * (double)v->before.step_ns * 1e-9;
}

/* As long as the recording is.  Where it says that there was more, a step of that, too: it is what
 * differs, or what ends a step in which a process was silent. */
static double duration_s(const struct verify *v)
{
    const char *said = mcap_reader_value(v->before.reader, "end", "steps");
    int64_t last = last_step(&v->before);
    bool more = said && strtoll(said, NULL, 10) > last;
    return seconds(v, last + more > 0 ? last + more : 1);
}

/* However long what a recording says is. */
static void word_add(struct verify *v, const char *option, const char *value)
{
    size_t size = strlen(option) + strlen(value) + 1;
    char *word = mu_startup_alloc(size);
    snprintf(word, size, "%s%s", option, value);
    MU_ASSERT(v->argc < WORDS_MAX - 1);
    v->argv[v->argc++] = word;
}

/* What the user's environment says of runs is not for this one. */
static void words_make(struct verify *v)
{
    const char *sets[EXPERIMENT_OVERRIDES_MAX];
    size_t sets_count = recording_sets(&v->before, sets, EXPERIMENT_OVERRIDES_MAX);
    char duration[32], root[sizeof v->files.folder + 8];
    snprintf(duration, sizeof duration, "%.17g", duration_s(v));
    snprintf(root, sizeof root, "%s/files", v->files.folder);
    snprintf(v->out, sizeof v->out, "%s/out", v->files.folder);
    word_add(v, "muster", "");
    word_add(v, "run", "");
    word_add(v, v->files.experiment, "");
    word_add(v, "--quiet", "");
    word_add(v, "--rate=", "0");
    word_add(v, "--seed=", note(v, "seed"));
    word_add(v, "--duration=", duration);
    word_add(v, "--out=", v->out);
    word_add(v, "--inputs=", v->path);
    word_add(v, "--root=", root);
    word_add(v, "--record=", strcmp(note(v, "record"), "run") == 0 ? "run" : "full");
    for (size_t i = 0; i < sets_count; i++) {
        word_add(v, "--set=", sets[i]);
    }
}

/* @return the exit code of the second run */
static int run_again(struct verify *v)
{
    static struct supervise children;
    char library[sizeof v->files.folder + sizeof "/library"];
    snprintf(library, sizeof library, "%s/library", v->files.folder);
    setenv("MUSTER_RULES", library, 1);
    words_make(v);
    supervise_init(&children, !chosen.verbose, false);
    if (supervise_start(&children, "run", "muster", v->argv) != MU_OK) {
        return MU_EXIT_CRASH;
    }
    const struct child *run = supervise_find(&children, "run");
    while (!run->ended && !run_signal) {
        nanosleep(&ROUND, NULL);
        supervise_look(&children);
    }
    supervise_stop_all(&children, STOP_PATIENCE_MS);
    if (run_signal) {
        return MU_EXIT_INTERRUPTED;
    }
    int code = WIFEXITED(run->status) ? WEXITSTATUS(run->status) : MU_EXIT_CRASH;
    bool ran = mu_exit_of_whole_run(code) ||
               (code == MU_EXIT_CRASH && recording_end(&v->before) == RECORDING_FAULT);
    if (!ran) {
        fprintf(stderr, "muster verify: the second run ended with exit code %d: %s%s\n", code,
                run->words,
                code == MU_EXIT_WRITE ? "muster verify: TMPDIR=DIR lets it write elsewhere" : "");
    }
    /* The words of its command are the recording's. */
    return ran ? MU_EXIT_DONE : code == MU_EXIT_USAGE ? MU_EXIT_FILE : code;
}

/* --- what came out ---------------------------------------------------------------------------- */

static const char *hash_of(struct recording *r)
{
    const char *hash = mcap_reader_value(r->reader, "end", "hash");
    return hash ? hash : "none";
}

/* How a recorded run ended, for scripts and for people. */
static const struct {
    const char *word, *sentence;
} ends[] = {[RECORDING_DONE] = {"done", ""},
            [RECORDING_STOPPED] = {"stopped", "the run was stopped there"},
            [RECORDING_FAULT] = {"fault", "the run broke off there"},
            [RECORDING_CUT] = {"cut", "the recording is cut off there"}};

static bool is_changed(const struct verify *v)
{
    return mcap_reader_broken(v->before.reader) > 0;
}

static void result_json(struct verify *v, const struct difference *d)
{
    struct mu_json j = mu_json_line(stdout);
    mu_json_string(&j, "file", v->file);
    mu_json_bool(&j, "equal", !d);
    mu_json_uint(&j, "steps", v->before.steps_count);
    mu_json_bool(&j, "changed", is_changed(v));
    mu_json_bool(&j, "same_controllers", !v->others);
    mu_json_bool(&j, "whole", mcap_reader_whole(v->before.reader));
    mu_json_string(&j, "ended", ends[recording_end(&v->before)].word);
    mu_json_string(&j, "hash", hash_of(&v->after));
    if (d) {
        mu_json_int(&j, "step", d->step);
        mu_json_real(&j, "time_s", seconds(v, d->step));
        mu_json_string(&j, "who", d->who);
        mu_json_string(&j, "what", d->what);
        mu_json_string(&j, "recorded", d->one);
        mu_json_string(&j, "now", d->other);
    }
    mu_json_end(&j);
}

static void equal_print(struct verify *v)
{
    enum recording_end end = recording_end(&v->before);
    if (end == RECORDING_DONE) {
        printf("equal  %zu steps\n", v->before.steps_count);
        printf("hash   %s\n", hash_of(&v->after));
    } else {
        int64_t last = last_step(&v->before), again = last_step(&v->after);
        last = again < last ? again : last;
        printf("equal  to step %lld (%.1f s); %s\n", (long long)last, seconds(v, last),
               ends[end].sentence);
    }
}

static void result_print(struct verify *v, const struct difference *d)
{
    if (is_changed(v)) {
        printf("the recording has been changed: a checksum in it is wrong\n");
    }
    if (d) {
        printf("different at step %lld (%.1f s): %s%s%s is ", (long long)d->step,
               seconds(v, d->step), plain(d->who), d->who[0] ? " " : "", d->what);
        printf("%s in the recording, ", plain(d->one));
        printf("and %s now\n", plain(d->other));
    } else {
        equal_print(v);
    }
}

/* @return whether the second run was computed by other versions than the recording names; said */
static bool versions_differ(const struct verify *v)
{
    static const char *const keys[] = {"muster", "ode", "clips"};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        const char *now = recording_note(&v->after, keys[i]);
        if (strcmp(note(v, keys[i]), now) != 0) {
            fprintf(stderr, "muster verify: the recording was made with %s %s", keys[i],
                    plain(note(v, keys[i])));
            fprintf(stderr, ", and this is %s\n", plain(now));
            return true;
        }
    }
    return false;
}

static int compare(struct verify *v)
{
    struct mu_fault fault;
    struct difference d;
    char record[sizeof v->out + 16];
    snprintf(record, sizeof record, "%s/run.mcap", v->out);
    if (recording_create(&v->after, record, &fault) != MU_OK ||
        recording_open(&v->after, record, &fault) != MU_OK) {
        mu_fault_print(&fault);
        return MU_EXIT_FILE;
    }
    bool differ = differ_find(&v->before, &v->after, &d);
    if (chosen.json) {
        result_json(v, differ ? &d : NULL);
    } else {
        result_print(v, differ ? &d : NULL);
    }
    if (differ && !is_changed(v) && (v->others || versions_differ(v))) {
        return MU_EXIT_OTHER;
    }
    return differ || is_changed(v) ? MU_EXIT_EXPECTATION : MU_EXIT_DONE;
}

/* --- the verb --------------------------------------------------------------------------------- */

/* @return the exit code of what cannot be verified; what is wrong is said */
static int recording_check(const struct verify *v)
{
    if (strcmp(note(v, "lockstep"), "no") == 0) {
        fprintf(stderr, "%s: a run with --free goes another way each time: it cannot be verified\n",
                v->file);
        return MU_EXIT_USAGE;
    }
    if (!note(v, "seed")[0]) {
        fprintf(stderr, "%s: expected a recording of `muster run`\n", v->file);
        return MU_EXIT_FILE;
    }
    if (v->before.steps_count == 0) {
        fprintf(stderr,
                "%s: it has no step: the run was stopped, or the file is cut off, before the "
                "first one; there is nothing to do again\n",
                v->file);
        return MU_EXIT_FILE;
    }
    return MU_EXIT_DONE;
}

static int recording_read(struct verify *v)
{
    struct mu_fault fault;
    bool there = recording_create(&v->before, v->file, &fault) == MU_OK;
    if (there) {
        mcap_reader_believe(v->before.reader);
    }
    if (!there || recording_open(&v->before, v->file, &fault) != MU_OK) {
        mu_fault_print(&fault);
        return v->before.foreign ? MU_EXIT_OTHER : MU_EXIT_FILE;
    }
    if (!realpath(v->file, v->path)) {
        fprintf(stderr, "%s: %s\n", v->file, strerror(errno));
        return MU_EXIT_FILE;
    }
    return recording_check(v);
}

/* A run that is computed another way has another hash from its first sine on: said before it is
 * done again for nothing.  @return the exit code */
static int arithmetic_check(const struct verify *v)
{
    const char *recorded = note(v, "arithmetic");
    recorded = recorded[0] ? recorded : MU_ARITHMETIC_BEFORE;
    if (strcmp(recorded, MU_ARITHMETIC) == 0) {
        return MU_EXIT_DONE;
    }
    if (chosen.json) {
        struct mu_json j = mu_json_line(stdout);
        mu_json_string(&j, "file", v->file);
        mu_json_string(&j, "what", "arithmetic");
        mu_json_string(&j, "recorded", recorded);
        mu_json_string(&j, "now", MU_ARITHMETIC);
        mu_json_end(&j);
    }
    fprintf(stderr, "%s: the arithmetic differs: %s in the recording, ", v->file, plain(recorded));
    fprintf(stderr, "and %s now; verify it with the muster %s that made it\n", MU_ARITHMETIC,
            plain(note(v, "muster")));
    return MU_EXIT_OTHER;
}

/* Its files, in a folder of their own. */
static int recording_unpack(struct verify *v)
{
    mu_result done = unpack_open(&v->files, v->before.reader, v->file, chosen.keep);
    if (done == MU_OK && !v->files.experiment[0]) {
        fprintf(stderr,
                "%s: `muster sim` was run by hand: the recording has the world, and lacks the "
                "experiment with the robots' rules that it takes to run it again; record a run "
                "of `muster run`\n",
                v->file);
        return MU_EXIT_FILE;
    }
    return mu_exit_for(done);
}

/* Compares a controller with that of the recorded run, and lets the second run find it.
 * @param said  its hash and its path */
static int controller_find(struct verify *v, const char *said)
{
    char *path;
    uint64_t hash = strtoull(said, &path, 16);
    path += *path == ' ';
    if (!chosen.programs) {
        fprintf(stderr,
                "%s: the run had a controller of its user's, %s; a recording from others could "
                "name any program: --programs starts it\n",
                v->file, plain(path));
        return MU_EXIT_USAGE;
    }
    if (access(path, X_OK) != 0) {
        fprintf(stderr, "%s: the controller %s is not here: %s\n", v->file, plain(path),
                strerror(errno));
        return MU_EXIT_FILE;
    }
    if (run_file_hash(path) != hash) {
        v->others = true;
        fprintf(stderr, "muster verify: the controller %s is another program than in the run\n",
                plain(path));
    }
    mu_result linked = unpack_program(&v->files, path);
    if (linked == MU_MALFORMED) {
        fprintf(stderr, "%s: expected the path of a controller, not '%s'\n", v->file, plain(path));
        return MU_EXIT_FILE;
    }
    return mu_exit_for(linked);
}

static int controllers_find(struct verify *v)
{
    int code = MU_EXIT_DONE;
    for (unsigned i = 1; code == MU_EXIT_DONE; i++) {
        char key[32];
        snprintf(key, sizeof key, "controller.%u", i);
        if (!note(v, key)[0]) {
            break;
        }
        code = controller_find(v, note(v, key));
    }
    return code;
}

int verify_verb(int argc, char **argv)
{
    static struct mu_options o = {.program = "muster verify",
                                  .usage = "FILE [OPTION...]",
                                  .about = "Does a recorded run again and says whether it went the "
                                           "same way, or where it did not.",
                                  MU_OPTION_TABLE(option_table),
                                  .one = "recording",
                                  .example = "out/follow-1/run.mcap"};
    mu_result parsed = mu_options_parse(&o, argc, argv);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    supervise_signals_note();
    struct verify *v = mu_startup_alloc(sizeof *v);
    v->file = o.words[0];
    int code = recording_read(v);
    code = code == MU_EXIT_DONE ? arithmetic_check(v) : code;
    code = code == MU_EXIT_DONE ? recording_unpack(v) : code;
    code = code == MU_EXIT_DONE ? controllers_find(v) : code;
    code = code == MU_EXIT_DONE ? run_again(v) : code;
    code = code == MU_EXIT_DONE ? compare(v) : code;
    if (v->files.folder[0] && chosen.keep) {
        fprintf(stderr, "muster verify: the second run is in %s\n", v->files.folder);
    }
    unpack_close(&v->files);
    return code;
}
