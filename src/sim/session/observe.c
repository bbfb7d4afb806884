/* SPDX-License-Identifier: Apache-2.0 */
/* What observers are told of a run: the Scene once, and Frames as long as somebody wants them. */
#include "bus/percept.h"
#include "bus/raw/raw.h"
#include "sim/session/parts.h"

#include "core/clock.h"
#include "core/log.h"
#include "muster/memory.h"

/* Who shows Frames to people needs no more than 25 in a second. */
static const uint64_t LATEST_PERIOD_NS = 40000000;
static const int64_t DRAIN_NS = 200000000;

mu_result observe_open(struct session *s)
{
    s->scene = scene_make(s->world);
    s->view = frame_open(s->world, s->name);
    s->tallies = mu_startup_array(s->robot_count, sizeof *s->tallies);
    MU_TRY(bus_writer_open(&s->bus, BUS_SCENE, NULL, NULL, &s->scenes));
    MU_TRY(bus_writer_open(&s->bus, BUS_FRAME, "every", NULL, &s->every));
    return bus_writer_open(&s->bus, BUS_FRAME, "latest", NULL, &s->latest);
}

void session_listen(struct session *s, const struct record_listener *listener)
{
    s->listener = *listener;
}

void observe_scene(struct session *s)
{
    s->scene->simulator = s->name;
    s->scene->seed = s->options.seed;
    s->scene->step_ns = s->options.step_ns;
    for (size_t i = 0; i < s->robot_count; i++) {
        s->scene->robots._buffer[i].controlled = s->agents.at[i].controlled;
    }
    if (bus_write(&s->scenes, s->scene) != MU_OK) {
        mu_log(MU_LOG_WARNING, "scene-lost", "world=%s", s->scene->world);
    }
    if (s->listener.scene && bus_encode(BUS_SCENE, s->scene, &s->view_bytes) == MU_OK) {
        s->listener.scene(s->listener.self, s->scene, &s->view_bytes);
    }
}

void observe_status(struct session *s, const muster_RunStatus *status)
{
    bool ended = status->state == muster_RUN_DONE || status->state == muster_RUN_FAULT;
    if (ended && !s->end_told && s->listener.status &&
        bus_encode(BUS_RUN_STATUS, status, &s->view_bytes) == MU_OK) {
        s->listener.status(s->listener.self, status, &s->view_bytes);
        s->end_told = true;
    }
}

/* --- what goes into a Frame ------------------------------------------------------------------- */

/* @return for whom the step's Frame is to be made */
static unsigned wanted_by(const struct session *s, bool last)
{
    bool due = last || mu_clock_ns() >= s->latest_wall_ns + LATEST_PERIOD_NS;
    unsigned wanted = s->listener.frame ? SESSION_FOR_LISTENER : 0;
    wanted |= bus_writer_matches(&s->every) > 0 ? SESSION_FOR_EVERY : 0;
    wanted |= due && bus_writer_matches(&s->latest) > 0 ? SESSION_FOR_LATEST : 0;
    return wanted;
}

static void robot_view(struct session *s, size_t robot)
{
    const struct session_robot *r = &s->robots[robot];
    frame_take_body(s->view, robot, &r->sensed, &s->tallies[robot]);
    if (s->agents.at[robot].process >= 0) {
        muster_Percept percept = {.robot = s->world->robots[robot].name};
        percept_pack(&percept, &r->sensed.percept);
        frame_add_percept(s->view, &percept);
    }
}

void observe_begin(struct session *s, bool last)
{
    uint64_t time_ns = (uint64_t)s->step * s->options.step_ns;
    for (size_t r = 0; r < s->robot_count; r++) {
        tally_take(&s->tallies[r], time_ns, s->options.step_ns, &s->robots[r].sensed);
    }
    if (!s->options.free) {
        frame_clear(s->view); /* of a step that was broken off */
    }
    s->view_for = wanted_by(s, last);
    if (!s->view_for) {
        return;
    }
    frame_begin(s->view, s->step, time_ns);
    for (size_t r = 0; r < s->robot_count; r++) {
        robot_view(s, r);
    }
    for (size_t i = 0; i < s->world->object_count; i++) {
        frame_take_object(s->view, i, engine_pose(s->engine, s->robot_count + i));
    }
}

void observe_act(struct session *s, size_t robot, const muster_Act *act)
{
    if (s->view_for) {
        frame_add_act(s->view, robot, act);
    }
}

void observe_outside(struct session *s, const muster_Delivery *d)
{
    if (s->view_for) {
        frame_add_outside(s->view, d->step + 1, d->outside._buffer, d->outside._length);
    }
}

void observe_order(struct session *s, const muster_RunCommand *order)
{
    if (s->view_for) {
        frame_add_order(s->view, order);
    }
}

/* --- Frames out ------------------------------------------------------------------------------- */

static void robot_finish(struct session *s, size_t robot)
{
    const struct session_robot *r = &s->robots[robot];
    muster_RobotView *v = frame_robot(s->view, robot);
    const struct session_agent *agent = &s->agents.at[robot];
    bool lives = agent->process >= 0;
    v->state = lives ? agent->state : muster_STATE_ABSENT;
    v->goal = (char *)(uintptr_t)(lives ? r->goal : ""); /* nobody writes there */
    v->command_forward_m_s = r->command_forward_m_s;
    v->command_turn_rad_s = r->command_turn_rad_s;
    v->firings = r->firings;
    v->mails_sent = r->mails_sent;
    v->mails_received = r->mails_received;
}

static void listener_tell(struct session *s, const muster_Frame *frame)
{
    muster_Frame part = *frame;
    part.percepts._length = s->listener.without_percepts ? 0 : part.percepts._length;
    if (bus_encode(BUS_FRAME, &part, &s->view_bytes) == MU_OK) {
        s->listener.frame(s->listener.self, frame, &s->view_bytes);
    }
}

/* What the network does not take is lost: nobody waits for who looks. */
static void frame_write(struct session *s, const muster_Frame *frame)
{
    if (s->view_for & SESSION_FOR_EVERY) {
        s->frames_lost += bus_write(&s->every, frame) != MU_OK;
    }
    if (s->view_for & SESSION_FOR_LATEST) {
        s->latest_wall_ns = mu_clock_ns();
        s->frames_lost += bus_write(&s->latest, frame) != MU_OK;
    }
    if (s->view_for & SESSION_FOR_LISTENER) {
        listener_tell(s, frame);
    }
}

void observe_finish(struct session *s)
{
    if (!s->view_for) {
        frame_clear(s->view);
        return;
    }
    for (size_t r = 0; r < s->robot_count; r++) {
        robot_finish(s, r);
    }
    muster_Frame *frame = frame_finish(s->view);
    frame->wall_ns = mu_clock_ns() - s->first_step_wall_ns;
    frame->digest = s->options.free ? 0 : run_hash_peek(s->hash);
    frame_write(s, frame);
    frame_clear(s->view);
}

void observe_close(struct session *s)
{
    uint64_t left_out = frame_left_out(s->view);
    if (left_out > 0 || s->frames_lost > 0) {
        mu_log(MU_LOG_WARNING, "frames-cut", "left_out=%llu lost=%llu",
               (unsigned long long)left_out, (unsigned long long)s->frames_lost);
    }
    (void)bus_drain(&s->every, DRAIN_NS);
    (void)bus_drain(&s->latest, DRAIN_NS);
}
