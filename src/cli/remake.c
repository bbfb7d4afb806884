/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/remake.h"

#include "core/csv.h"
#include "core/text_file.h"
#include "muster/memory.h"
#include "world/condition/condition.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- run.csv ---------------------------------------------------------------------------------- */

static bool is_controlled(const struct recording *recording, uint32_t robot)
{
    const muster_Scene *scene = recording->scene;
    return scene && robot < scene->robots._length && scene->robots._buffer[robot].controlled;
}

static void rows_write(FILE *file, const struct recording *recording, const muster_Frame *f)
{
    for (uint32_t i = 0; i < f->robots._length; i++) {
        const muster_RobotView *v = &f->robots._buffer[i];
        const struct mu_percept body = {.x_m = v->x_m,
                                        .y_m = v->y_m,
                                        .heading_rad = v->heading_rad,
                                        .forward_m_s = v->forward_m_s,
                                        .turn_rad_s = v->turn_rad_s,
                                        .stalled = v->stalled};
        if (is_controlled(recording, i)) {
            mu_csv_row(file, (uint64_t)f->time_ns, v->name, &body);
        }
    }
}

mu_result remake_csv(struct recording *recording, const char *folder, struct mu_fault *fault)
{
    struct mu_draft d;
    MU_TRY(mu_draft_open(&d, folder, "run.csv", fault));
    mu_csv_head(d.file);
    recording_rewind(recording);
    for (const muster_Frame *f = recording_next(recording); f; f = recording_next(recording)) {
        rows_write(d.file, recording, f);
    }
    return mu_draft_close(&d, true, fault);
}

/* --- placements.csv ----------------------------------------------------------------------------
 */

static size_t placements_write(FILE *file, const struct recording *recording, const muster_Frame *f)
{
    size_t count = 0;
    for (uint32_t i = 0; i < f->robots._length; i++) {
        const muster_RobotView *v = &f->robots._buffer[i];
        if (v->placed && is_controlled(recording, i)) {
            mu_csv_placement(file, (uint64_t)f->time_ns, v->name);
            count++;
        }
    }
    return count;
}

mu_result remake_placements(struct recording *recording, const char *folder, struct mu_fault *fault)
{
    struct mu_draft d;
    size_t count = 0;
    MU_TRY(mu_draft_open(&d, folder, "placements.csv", fault));
    fputs(MU_CSV_PLACEMENTS_HEAD, d.file);
    recording_rewind(recording);
    for (const muster_Frame *f = recording_next(recording); f; f = recording_next(recording)) {
        count += placements_write(d.file, recording, f);
    }
    if (count == 0) {
        remove(d.path);
    }
    return mu_draft_close(&d, count > 0, fault);
}

/* --- events.csv ------------------------------------------------------------------------------- */

/* The last Frame of a run that has an end is how the world was left: no condition was looked at any
 * more. */
static bool is_step(const struct recording *recording, const muster_Frame *f)
{
    if (f->step != recording->steps[recording->steps_count - 1].step) {
        return true;
    }
    enum recording_end end = recording_end(recording);
    return end != RECORDING_DONE && end != RECORDING_STOPPED;
}

/* A Frame as conditions look at it; the bodies are those of the Scene. */
struct view {
    const struct recording *recording;
    const muster_Frame *frame;
};

static int body_find(const void *self, const char *name)
{
    const struct view *v = self;
    const muster_Scene *scene = v->recording->scene;
    uint32_t robots = scene->robots._length;
    for (uint32_t i = 0; i < robots; i++) {
        if (strcmp(scene->robots._buffer[i].name, name) == 0) {
            return (int)i;
        }
    }
    for (uint32_t i = 0; i < scene->objects._length; i++) {
        if (strcmp(scene->objects._buffer[i].name, name) == 0) {
            return (int)(robots + i);
        }
    }
    return -1;
}

static void body_numbers(const void *self, int body, struct condition_numbers *out)
{
    const muster_Frame *f = ((const struct view *)self)->frame;
    uint32_t index = (uint32_t)body, robots = f->robots._length;
    *out = (struct condition_numbers){.x_m = 0};
    if (index < robots) {
        const muster_RobotView *v = &f->robots._buffer[index];
        *out = (struct condition_numbers){.x_m = v->x_m,
                                          .y_m = v->y_m,
                                          .heading_rad = v->heading_rad,
                                          .distance_m = v->distance_m,
                                          .stalls = v->stalls,
                                          .stalled_s = v->stalled_s,
                                          .mail_sent = (double)v->mails_sent,
                                          .mail_received = (double)v->mails_received,
                                          .rule_firings = (double)v->firings};
    } else if (index - robots < f->objects._length) {
        const muster_ObjectPlace *o = &f->objects._buffer[index - robots];
        *out =
            (struct condition_numbers){.x_m = o->x_m, .y_m = o->y_m, .heading_rad = o->heading_rad};
    }
}

static bool robot_stalled(const void *self, int robot)
{
    const muster_Frame *f = ((const struct view *)self)->frame;
    return (uint32_t)robot < f->robots._length && f->robots._buffer[robot].stalled;
}

static bool robot_counts(const void *self, int robot)
{
    return is_controlled(((const struct view *)self)->recording, (uint32_t)robot);
}

static void act_note(struct condition_watch *w, int robot, const muster_Act *act)
{
    condition_note_rules(w, robot, act->rules);
    for (uint32_t i = 0; i < act->mails._length; i++) {
        const muster_Mail *mail = &act->mails._buffer[i];
        condition_note_mail(w, robot, mail->content, mail->dst);
    }
}

static void events_look(struct condition_watch *watches, const struct experiment *e,
                        const struct view *v, FILE *file)
{
    const muster_Frame *f = v->frame;
    const struct condition_view view = {.time_s = (double)f->time_ns * 1e-9,
                                        .self = v,
                                        .numbers = body_numbers,
                                        .stalled = robot_stalled,
                                        .counts = robot_counts,
                                        .robots = (int)f->robots._length};
    for (unsigned i = 0; i < e->events_count; i++) {
        for (uint32_t k = 0; k < f->acts._length; k++) {
            const muster_Act *act = &f->acts._buffer[k];
            int agent = experiment_agent_find(e, act->agent);
            int body = agent >= 0 ? CONDITION_AGENTS + agent : body_find(v, act->agent);
            act_note(&watches[i], body, act);
        }
        if (condition_watch_look(&watches[i], &view)) {
            mu_csv_event(file, (uint64_t)f->time_ns, e->events[i]);
        }
    }
}

static mu_result events_read(struct condition_watch *watches, const struct run *r,
                             const struct view *v, struct mu_fault *fault)
{
    const struct experiment *e = r->experiment;
    char why[CONDITION_WHY_MAX];
    const struct condition_names names = {.find = body_find,
                                          .self = v,
                                          .robots = (int)v->recording->scene->robots._length,
                                          .find_agent = experiment_agent_find,
                                          .agents = e};
    for (unsigned i = 0; i < e->events_count; i++) {
        if (condition_read(&watches[i].condition, e->events[i], &names, why) != MU_OK) {
            return mu_fault_at(fault, e->file, e->event_marks[i].line, e->event_marks[i].column,
                               "%s", why);
        }
    }
    return MU_OK;
}

mu_result remake_events(struct recording *recording, const struct run *r, struct mu_fault *fault)
{
    const struct experiment *e = r->experiment;
    struct view v = {.recording = recording};
    struct mu_draft d;
    if (e->events_count == 0) {
        return MU_OK;
    }
    struct condition_watch *watches = mu_startup_array(e->events_count, sizeof *watches);
    MU_TRY(events_read(watches, r, &v, fault));
    MU_TRY(mu_draft_open(&d, r->folder, "events.csv", fault));
    fputs(MU_CSV_EVENTS_HEAD, d.file);
    recording_rewind(recording);
    while ((v.frame = recording_next(recording))) {
        if (is_step(recording, v.frame)) {
            events_look(watches, e, &v, d.file);
        }
    }
    return mu_draft_close(&d, true, fault);
}

/* --- how it ended ----------------------------------------------------------------------------- */

static void totals_add(struct run *r, const muster_RobotTotals *totals)
{
    if (r->totals_count < RUN_TOTALS_MAX) {
        r->totals[r->totals_count] = *totals;
        r->totals[r->totals_count++].robot = run_robot_name(r, totals->robot);
    }
}

static void totals_fill(struct run *r, const struct recording *recording, const muster_Frame *f)
{
    r->totals_count = 0;
    for (uint32_t i = 0; i < f->robots._length; i++) {
        const muster_RobotView *v = &f->robots._buffer[i];
        if (is_controlled(recording, i)) {
            totals_add(r, &(muster_RobotTotals){.robot = v->name,
                                                .firings = v->firings,
                                                .mails_sent = v->mails_sent,
                                                .mails_received = v->mails_received});
        }
    }
    for (uint32_t i = 0; i < f->agents._length; i++) {
        const muster_AgentView *v = &f->agents._buffer[i];
        totals_add(r, &(muster_RobotTotals){.robot = v->name,
                                            .firings = v->firings,
                                            .mails_sent = v->mails_sent,
                                            .mails_received = v->mails_received});
    }
}

void remake_end(struct recording *recording, struct run *r)
{
    const muster_Frame *f =
        recording_frame(recording, recording->steps[recording->steps_count - 1].step);
    bool done = recording_end(recording) == RECORDING_DONE;
    const char *hash = done ? mcap_reader_value(recording->reader, "end", "hash") : NULL;
    const char *wall = mcap_reader_value(recording->reader, "end", "wall_ns");
    mu_text_copy(r->hash, sizeof r->hash, hash ? hash : "none");
    r->time_ns = f->time_ns;
    r->wall_ns = wall ? strtoull(wall, NULL, 10) : f->wall_ns;
    totals_fill(r, recording, f);
    run_objects_take(r, f->objects._buffer, f->objects._length);
}
