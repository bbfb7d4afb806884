/* SPDX-License-Identifier: Apache-2.0 */
/*
 * muster report: a run's pages and pictures once more, from what lies in its folder.
 *
 * The experiment and its world come out of run.mcap, or, of a run without one, from where its
 * summary says.  What the brokers counted is in summary.json alone; without one the run broke off,
 * and what there is to know is in the recording.
 */
#include "cli/remake.h"
#include "cli/unpack.h"
#include "cli/verbs.h"

#include "core/exits.h"
#include "core/options.h"
#include "core/text.h"
#include "muster/memory.h"
#include "operator/operator.h"
#include "report/report.h"
#include "world/world_load.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static struct {
    bool json;
} chosen;

static struct mu_option option_table[] = {
    MU_FLAG("json", chosen.json, "say what came out as one line of JSON")};

struct remaking {
    struct run *run; /* as far as a report needs one */
    struct recording recording;
    bool recorded; /* there is one */
    struct unpacked files;
    struct summary summary;
    const char *sets[EXPERIMENT_OVERRIDES_MAX];
    char path[PATH_MAX + 16]; /* of the recording */
};

static const char *note(const struct remaking *m, const char *key)
{
    return recording_note(&m->recording, key);
}

/* --- the experiment and its world ------------------------------------------------------------- */

/* The file as it was named on the command line; path: it is not known */
static const char *file_named(const struct remaking *m, const char *path)
{
    const char *file = m->recorded ? note(m, "file") : m->summary.file;
    return file[0] ? mu_startup_string(file) : path;
}

/* Paths as they were, for people. */
static void paths_restore(struct remaking *m)
{
    struct experiment *e = m->run->experiment;
    char path[sizeof m->run->world->file];
    e->file = mu_startup_string(file_named(m, unpack_path(&m->files, e->file)));
    if (mu_text_copy(path, sizeof path, unpack_path(&m->files, m->run->world->file))) {
        mu_text_copy(m->run->world->file, sizeof m->run->world->file, path);
    }
}

/* The robots that the simulator drove, which stood in the world, and agents without a body. */
static void driven_take(struct recording *recording, struct experiment *e, int64_t step)
{
    const muster_Scene *scene = recording->scene;
    const muster_Frame *f = recording_frame(recording, step);
    e->robots = mu_startup_array(scene->robots._length + f->agents._length, sizeof *e->robots);
    for (uint32_t i = 0; i < scene->robots._length; i++) {
        if (scene->robots._buffer[i].controlled) {
            e->robots[e->robots_count++].name = scene->robots._buffer[i].name;
        }
    }
    e->agents = e->robots + e->robots_count;
    for (; e->agents_count < f->agents._length; e->agents_count++) {
        e->agents[e->agents_count].name =
            mu_startup_string(f->agents._buffer[e->agents_count].name);
    }
}

/* Those that it put there. */
static mu_result placed_take(const struct remaking *m, struct mu_fault *fault)
{
    char key[32];
    for (size_t i = 1;; i++) {
        snprintf(key, sizeof key, "place.%zu", i);
        const char *place = note(m, key);
        if (!place[0]) {
            return MU_OK;
        }
        MU_TRY(world_add_placed(m->run->world, place, fault));
    }
}

/* `muster sim` ran by hand: the experiment is what its world and its recording say. */
static mu_result by_hand_take(struct remaking *m, struct mu_fault *fault)
{
    struct run *r = m->run;
    struct experiment *e = mu_startup_alloc(sizeof *e);
    const char *name = strrchr(m->files.world, '/');
    if (!name) {
        return mu_fault_at(fault, m->path, 0, 0, "there is no experiment in it, and no world");
    }
    const struct recording_step *last = &m->recording.steps[m->recording.steps_count - 1];
    r->experiment = e;
    e->name = mu_startup_string(name + 1);
    e->name[strcspn(e->name, ".")] = '\0';
    e->file = m->files.world;
    e->world = m->files.world;
    e->seed = strtoull(note(m, "seed"), NULL, 10);
    e->step_ms = (double)m->recording.step_ns * 1e-6;
    e->duration = strtod(note(m, "duration_s"), NULL);
    e->duration = e->duration > 0 ? e->duration : (double)last->step * e->step_ms * 1e-3;
    r->options.free = strcmp(note(m, "lockstep"), "no") == 0;
    MU_TRY(run_place(r, fault));
    MU_TRY(placed_take(m, fault));
    driven_take(&m->recording, e, last->step);
    paths_restore(m);
    return MU_OK;
}

static mu_result recorded_take(struct remaking *m, struct mu_fault *fault)
{
    static char root[sizeof m->files.folder + sizeof "/files"];
    struct run *r = m->run;
    snprintf(root, sizeof root, "%s/files", m->files.folder);
    experiment_root(root);
    r->options.set = m->sets;
    r->options.set_count = recording_sets(&m->recording, m->sets, EXPERIMENT_OVERRIDES_MAX);
    MU_TRY(
        experiment_load(&r->experiment, m->files.experiment, m->sets, r->options.set_count, fault));
    r->options.free = strcmp(note(m, "lockstep"), "no") == 0;
    r->experiment->seed = strtoull(note(m, "seed"), NULL, 10);
    r->experiment->duration = strtod(note(m, "duration_s"), NULL);
    MU_TRY(run_place(r, fault));
    paths_restore(m);
    return MU_OK;
}

/* Of a run without a recording: the file may be another one by now, which run.csv shows if it has
 * other robots. */
static mu_result named_take(struct remaking *m, struct mu_fault *fault)
{
    struct run *r = m->run;
    const struct summary *s = &m->summary;
    const char *file = file_named(m, NULL);
    if (!file || s->duration_s <= 0) {
        return mu_fault_at(fault, m->path, 0, 0,
                           "there is no recording, and summary.json does not say how the run was "
                           "made");
    }
    MU_TRY(experiment_load(&r->experiment, file, s->overrides, s->overrides_count, fault));
    r->options.set = s->overrides;
    r->options.set_count = s->overrides_count;
    r->options.free = s->free || r->experiment->free;
    r->experiment->seed = s->seed;
    r->experiment->duration = s->duration_s;
    return run_place(r, fault);
}

static mu_result recording_take(struct remaking *m, struct mu_fault *fault)
{
    snprintf(m->path, sizeof m->path, "%s/run.mcap", m->run->folder);
    m->recorded = access(m->path, F_OK) == 0 || !m->summary.document;
    if (!m->recorded) {
        return MU_OK;
    }
    mu_result opened = recording_create(&m->recording, m->path, fault);
    opened = opened == MU_OK ? recording_open(&m->recording, m->path, fault) : opened;
    if (opened != MU_OK) {
        return opened;
    }
    if (m->recording.steps_count == 0 || !m->recording.scene || !note(m, "seed")[0]) {
        return mu_fault_at(fault, m->path, 0, 0,
                           "expected a recording of a run, of a step at least");
    }
    return MU_OK;
}

/* --- what came of it -------------------------------------------------------------------------- */

static void summary_use(const struct remaking *m, struct report_input *in)
{
    const struct summary *s = &m->summary;
    in->hash = s->hash;
    in->sim_time_s = s->sim_time_s;
    in->wall_time_s = s->wall_time_s;
    in->command = s->command;
    in->versions = s->made_with;
    in->arithmetic = s->arithmetic;
    in->architecture = s->architecture;
    in->processor = s->processor;
    in->mail = s->mail;
    in->mail_unknown = s->mail_unknown;
    in->restarts = s->restarts;
    in->restarts_count = s->restarts_count;
    in->monitors = s->monitors;
    in->monitors_count = s->monitors_count;
    in->packets_struck = s->packets_struck;
    in->undone = s->undone;
    in->undone_count = s->undone_count;
    if (s->objects_count > 0) {
        in->objects = s->objects;
        in->objects_count = s->objects_count;
    }
}

/* The brokers' counters died with the run; robots' own are in the recording. */
static void recording_use(const struct remaking *m, struct report_input *in)
{
    static char versions[256];
    const char *clips = note(m, "clips");
    snprintf(versions, sizeof versions, "muster %s, Cyclone DDS %s%s%s", note(m, "muster"),
             note(m, "cyclonedds"), clips[0] ? ", CLIPS " : "", clips);
    in->command = note(m, "command");
    in->versions = versions;
    in->arithmetic = note(m, "arithmetic");
    in->architecture = note(m, "architecture");
    in->processor = note(m, "processor");
    in->mail_unknown = true;
}

/* In free running totals are those of the summary: a Frame has what it was told in time. */
static void robots_use(const struct summary *s, struct report_input *in)
{
    struct report_robot *robots = mu_startup_array(in->robots_count, sizeof *robots);
    for (size_t i = 0; i < in->robots_count; i++) {
        robots[i] = in->robots[i];
        for (size_t k = 0; k < s->robots_count; k++) {
            if (strcmp(s->robots[k].name, robots[i].name) == 0) {
                robots[i].mail_sent = s->robots[k].mail_sent;
                robots[i].mail_received = s->robots[k].mail_received;
                robots[i].rule_firings = s->robots[k].rule_firings;
            }
        }
    }
    in->robots = robots;
    if (s->agents_count == in->agents_count) { /* both are in the order of the experiment */
        in->agents = s->agents;
    }
}

/* Chaos that was done to the world stands in the Frames; what became of the rest is not known. */
static void orders_note(struct remaking *m)
{
    const struct experiment *e = m->run->experiment;
    recording_rewind(&m->recording);
    for (const muster_Frame *f = recording_next(&m->recording); f;
         f = recording_next(&m->recording)) {
        for (uint32_t i = 0; i < f->orders._length; i++) {
            unsigned index;
            bool ours = sscanf(f->orders._buffer[i].source, "chaos.%u", &index) == 1;
            if (ours && index < e->chaos_count && !m->summary.chaos[index].done) {
                m->summary.chaos[index].done = true;
                m->summary.chaos[index].at_s = (double)f->time_ns * 1e-9;
            }
        }
    }
}

static bool broke_off(const struct remaking *m)
{
    return m->summary.document ? m->summary.broke_off
                               : recording_end(&m->recording) != RECORDING_DONE;
}

/* What run.csv and events.csv lack when a run breaks off stands in the recording. */
static mu_result files_make(struct remaking *m, struct mu_fault *fault)
{
    struct run *r = m->run;
    char csv[PATH_MAX + 16];
    r->time_ns = (uint64_t)(m->summary.sim_time_s * 1e9);
    if (m->recorded) {
        remake_end(&m->recording, r);
    }
    if (broke_off(m)) { /* what was to come later is not judged */
        r->experiment->duration = fmin(r->experiment->duration, (double)r->time_ns * 1e-9);
    }
    snprintf(csv, sizeof csv, "%s/run.csv", r->folder);
    if (m->summary.document && access(csv, F_OK) == 0) {
        return MU_OK;
    }
    if (!m->recorded) {
        return mu_fault_at(fault, csv, 0, 0, "%s, and there is no run.mcap that it can be made of",
                           strerror(errno));
    }
    if (!m->summary.document) {
        orders_note(m);
    }
    MU_TRY(remake_csv(&m->recording, r->folder, fault));
    MU_TRY(remake_placements(&m->recording, r->folder, fault));
    return remake_events(&m->recording, r, fault);
}

static int report_make(struct remaking *m)
{
    struct report_input input;
    run_report_input(m->run, &input);
    input.file = file_named(m, "");
    input.free = m->run->options.free;
    input.files = m->recorded ? m->files.files : m->summary.files;
    input.files_count = m->recorded ? m->files.files_count : m->summary.files_count;
    input.chaos = m->summary.chaos;
    input.broke_off = broke_off(m);
    if (m->summary.document) {
        summary_use(m, &input);
        robots_use(&m->summary, &input);
    } else {
        recording_use(m, &input);
    }
    m->run->options.json = chosen.json;
    int code = run_report_write(m->run, &input);
    report_folder_release(m->run->folder);
    return code;
}

/* --- the verb --------------------------------------------------------------------------------- */

static mu_result folder_take(struct remaking *m, const char *folder, struct mu_fault *fault)
{
    size_t len = strlen(folder);
    while (len > 1 && folder[len - 1] == '/') {
        len--;
    }
    snprintf(m->run->folder, sizeof m->run->folder, "%.*s", (int)len, folder);
    if (report_folder_lives(m->run->folder)) {
        (void)mu_fault_at(fault, m->run->folder, 0, 0,
                          "a run is writing there: it makes its report "
                          "when it has ended");
        return MU_FAULT_OS;
    }
    mu_result read = summary_read(&m->summary, m->run->folder, fault);
    return read == MU_ABSENT ? MU_OK : read;
}

/* The experiment with its world, and the files that the report is made of. */
static mu_result run_take(struct remaking *m, struct mu_fault *fault)
{
    mu_result done = !m->recorded             ? named_take(m, fault)
                     : m->files.experiment[0] ? recorded_take(m, fault)
                                              : by_hand_take(m, fault);
    return done == MU_OK ? files_make(m, fault) : done;
}

static int report_run(const char *folder)
{
    struct mu_fault fault;
    struct remaking *m = mu_startup_alloc(sizeof *m);
    m->run = mu_startup_alloc(sizeof *m->run);
    mu_result done = folder_take(m, folder, &fault);
    done = done == MU_OK ? recording_take(m, &fault) : done;
    if (done != MU_OK) {
        mu_fault_print(&fault);
        return mu_exit_for(done);
    }
    done = m->recorded ? unpack_open(&m->files, m->recording.reader, m->path, false) : MU_OK;
    if (done == MU_OK) {
        done = run_take(m, &fault);
        if (done != MU_OK) {
            mu_fault_print(&fault);
        }
    }
    int code = done == MU_OK ? report_make(m) : mu_exit_for(done);
    unpack_close(&m->files);
    return code;
}

int report_verb(int argc, char **argv)
{
    static struct mu_options o = {
        .program = "muster report",
        .usage = "DIR [OPTION...]",
        .about = "Makes the report of a run again from what lies in its folder; of a run that "
                 "broke off, as far as its run.mcap goes.",
        MU_OPTION_TABLE(option_table),
        .one = "folder",
        .example = "out/follow-1"};
    mu_result parsed = mu_options_parse(&o, argc, argv);
    return parsed == MU_OK ? report_run(o.words[0]) : mu_exit_for(parsed);
}
