/* SPDX-License-Identifier: Apache-2.0 */
#include "web/web.h"

#include "muster/memory.h"
#include "story/story.h"
#include "web/json.h"

#include <math.h>
#include <string.h>

/* --- reading it through ----------------------------------------------------------------------- */

static void stall_take(struct past *p, uint32_t robot, int64_t step)
{
    size_t last = p->stalls_last[robot];
    if (last > 0 && p->stalls[last - 1].to == step - 1) {
        p->stalls[last - 1].to = step;
    } else if (p->stalls_count < PAST_STALLS_MAX) {
        p->stalls[p->stalls_count++] = (struct past_stall){robot, step, step};
        p->stalls_last[robot] = p->stalls_count;
    } else {
        p->stalls_lost++;
    }
}

static void tracks_init(struct past *p)
{
    struct past_tracks *t = &p->tracks;
    t->robots = p->recording.scene->robots._length;
    t->rows_max = t->robots > 0 ? PAST_PLACES_MAX / t->robots + 1 : 0;
    t->every = t->rows_max > 0 ? p->recording.steps_count / t->rows_max + 1 : 1;
    t->steps = mu_startup_array(t->rows_max, sizeof *t->steps);
    t->places = mu_startup_array(t->rows_max * t->robots, sizeof *t->places);
}

static int32_t millimetres(double metres)
{
    double mm = metres * 1e3;
    return mm > -1e9 && mm < 1e9 ? (int32_t)lround(mm) : 0;
}

static void tracks_take(struct past_tracks *t, const muster_Frame *f)
{
    if (t->rows == t->rows_max || f->robots._length != t->robots) {
        return;
    }
    struct past_place *row = t->places + t->rows * t->robots;
    for (size_t i = 0; i < t->robots; i++) {
        const muster_RobotView *r = &f->robots._buffer[i];
        row[i] = (struct past_place){millimetres(r->x_m), millimetres(r->y_m)};
    }
    t->steps[t->rows++] = f->step;
}

static void stalls_take(struct past *p, const muster_Frame *f)
{
    for (uint32_t i = 0; i < f->robots._length && i < MU_ROBOTS_MAX; i++) {
        if (f->robots._buffer[i].stalled) {
            stall_take(p, i, f->step);
        }
    }
}

static void robots_read(struct past *p)
{
    const muster_Frame *f;
    recording_rewind(&p->recording);
    for (size_t n = 0; (f = recording_next(&p->recording)); n++) {
        stalls_take(p, f);
        if (n % p->tracks.every == 0) {
            tracks_take(&p->tracks, f);
        }
    }
}

mu_result past_open(struct past *p, const char *path, struct mu_fault *fault)
{
    *p = (struct past){.name = path};
    mu_text_init(&p->text, mu_startup_alloc(PAST_TEXT_MAX), PAST_TEXT_MAX);
    MU_TRY(recording_create(&p->recording, path, fault));
    MU_TRY(recording_open(&p->recording, path, fault));
    if (!p->recording.scene) {
        return mu_fault_at(fault, path, 0, 0, "expected a recording with a Scene");
    }
    tracks_init(p);
    robots_read(p);
    return MU_OK;
}

void past_show(const struct past *p, struct board *board)
{
    scene_json_write(&board->scene, p->recording.scene);
    struct mu_json *j = board_begin(board, BOARD_SCENE);
    mu_json_object(j, NULL);
    mu_json_uint(j, "number", 1);
    mu_json_end(j);
    (void)board_end(board);
}

/* --- the whole -------------------------------------------------------------------------------- */

static void answer_begin(struct past *p, struct mu_json *j)
{
    mu_text_clear(&p->text);
    mu_json_to_text(j, &p->text, MU_JSON_LINE);
}

static void stalls_write(struct mu_json *j, const struct past *p)
{
    mu_json_list(j, "stalls");
    for (size_t i = 0; i < p->stalls_count; i++) {
        mu_json_list(j, NULL);
        mu_json_uint(j, NULL, p->stalls[i].robot);
        mu_json_int(j, NULL, p->stalls[i].from);
        mu_json_int(j, NULL, p->stalls[i].to);
        mu_json_end(j);
    }
    mu_json_end(j);
}

static void diaries_write(struct mu_json *j, const struct minds *m)
{
    mu_json_list(j, "robots");
    for (int32_t i = 0; i < m->robots_count; i++) {
        mu_json_string(j, NULL, m->robots[i].name);
    }
    mu_json_end(j);
}

const struct mu_text *past_whole(struct past *p)
{
    struct mu_json j;
    const struct recording *r = &p->recording;
    const char *slash = strrchr(p->name, '/');
    answer_begin(p, &j);
    mu_json_object(&j, NULL);
    mu_json_string(&j, "name", slash ? slash + 1 : p->name);
    mu_json_int(&j, "first", r->steps_count > 0 ? r->steps[0].step : 0);
    mu_json_int(&j, "last", r->steps_count > 0 ? r->steps[r->steps_count - 1].step : 0);
    mu_json_real(&j, "step_ms", (double)r->step_ns / 1e6);
    diaries_write(&j, r->minds);
    stalls_write(&j, p);
    mu_json_end(&j);
    return &p->text;
}

static void track_write(struct mu_json *j, const struct past_tracks *t, size_t robot)
{
    mu_json_list(j, NULL);
    for (size_t row = 0; row < t->rows; row++) {
        mu_json_int(j, NULL, t->places[row * t->robots + robot].x_mm);
        mu_json_int(j, NULL, t->places[row * t->robots + robot].y_mm);
    }
    mu_json_end(j);
}

const struct mu_text *past_tracks(struct past *p)
{
    struct mu_json j;
    const struct past_tracks *t = &p->tracks;
    answer_begin(p, &j);
    mu_json_object(&j, NULL);
    mu_json_list(&j, "steps");
    for (size_t row = 0; row < t->rows; row++) {
        mu_json_int(&j, NULL, t->steps[row]);
    }
    mu_json_end(&j);
    mu_json_list(&j, "robots");
    for (size_t i = 0; i < t->robots; i++) {
        track_write(&j, t, i);
    }
    mu_json_end(&j);
    mu_json_end(&j);
    return p->text.cut ? NULL : &p->text;
}

/* --- a moment --------------------------------------------------------------------------------- */

/* @return the last step that there is up to one; else the first */
static int64_t step_near(const struct past *p, int64_t step)
{
    return recording_step_at(&p->recording, (double)step * (double)p->recording.step_ns * 1e-9);
}

static void mails_add(struct mu_json *j, int64_t step, const dds_sequence_muster_Mail *mails,
                      uint32_t *count)
{
    for (uint32_t i = 0; i < mails->_length && *count < PAST_MAILS_MAX; i++, ++*count) {
        frame_json_mail(j, step, &mails->_buffer[i]);
    }
}

/* Writes the mails of the steps before one.  @return its Frame; NULL: there is none */
static const muster_Frame *lately_write(struct mu_json *j, struct past *p, int64_t step)
{
    uint32_t count = 0;
    const muster_Frame *f;
    mu_json_list(j, "lately");
    recording_seek(&p->recording, step - PAST_LATELY_STEPS);
    while ((f = recording_next(&p->recording)) && f->step < step) {
        mails_add(j, f->step, &f->outside, &count);
        for (uint32_t i = 0; i < f->acts._length; i++) {
            mails_add(j, f->step, &f->acts._buffer[i].mails, &count);
        }
    }
    mu_json_end(j);
    return f && f->step == step ? f : recording_frame(&p->recording, step);
}

const struct mu_text *past_moment(struct past *p, int64_t step, const char *robot)
{
    struct mu_json j;
    step = step_near(p, step);
    answer_begin(p, &j);
    mu_json_object(&j, NULL);
    const muster_Frame *f = lately_write(&j, p, step);
    if (!f) {
        return NULL;
    }
    frame_json_write(&j, "frame", f, false);
    frame_json_totals(&j, "statistics", f);
    if (robot[0]) {
        mind_json_write(&j, "mind", p->recording.minds, robot, (uint32_t)step);
    }
    mu_json_end(&j);
    return p->text.cut ? NULL : &p->text;
}

/* --- why -------------------------------------------------------------------------------------- */

const struct mu_text *past_why(struct past *p, int64_t step, const char *robot)
{
    int32_t mind = minds_robot(p->recording.minds, robot);
    mu_text_clear(&p->text);
    if (mind == MINDS_NONE) {
        return NULL;
    }
    struct why why = {.minds = p->recording.minds,
                      .interventions = p->recording.interventions,
                      .step_s = (double)p->recording.step_ns * 1e-9,
                      .out = &p->text};
    if (why_speed(&why, mind, (uint32_t)step_near(p, step)) == 0) {
        mu_text_add(&p->text, "no rule had set a speed yet\n");
    }
    return &p->text;
}

void past_close(struct past *p)
{
    recording_close(&p->recording);
}
