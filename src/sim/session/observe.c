/* SPDX-License-Identifier: Apache-2.0 */
/* Tells observers of a run: the Scene once, and Frames while a reader or a recording wants them. */
#include "bus/wire/percept.h"
#include "sim/session/parts.h"

#include "core/clock.h"
#include "core/log.h"
#include "muster/memory.h"

/* Displays need at most 25 Frames a second. */
static const uint64_t LATEST_PERIOD_NS = 40000000;
static const int64_t DRAIN_NS = 200000000;

mu_result observe_open(struct session *s)
{
    s->observe.scene = scene_make(s->world);
    s->observe.frame = frame_open(s->world, s->name, s->totals_count - s->robot_count);
    s->observe.tallies = mu_startup_array(s->robot_count, sizeof *s->observe.tallies);
    MU_TRY(bus_writer_open(s->bus, BUS_SCENE, NULL, NULL, &s->observe.scenes));
    MU_TRY(bus_writer_open(s->bus, BUS_FRAME, "every", NULL, &s->observe.every));
    return bus_writer_open(s->bus, BUS_FRAME, "latest", NULL, &s->observe.latest);
}

void observe_scene(struct session *s)
{
    s->observe.scene->simulator = s->name;
    s->observe.scene->seed = s->options.seed;
    s->observe.scene->step_ns = s->options.step_ns;
    for (size_t i = 0; i < s->robot_count; i++) {
        s->observe.scene->robots._buffer[i].controlled = s->agents.at[i].controlled;
    }
    if (bus_write(&s->observe.scenes, s->observe.scene) != MU_OK) {
        mu_log(MU_LOG_WARNING, "scene-lost", "world=%s", s->observe.scene->world);
    }
    if (s->options.recording) {
        mcap_file_scene(s->options.recording, s->observe.scene);
    }
}

void observe_status(struct session *s, const muster_RunStatus *status)
{
    bool ended = status->state == muster_RUN_DONE || status->state == muster_RUN_FAULT;
    if (ended && !s->observe.end_recorded && s->options.recording) {
        mcap_file_end(s->options.recording, status);
        s->observe.end_recorded = true;
    }
}

/* --- what goes into a Frame ------------------------------------------------------------------- */

/* @return the readers for which the step's Frame is to be made */
static unsigned wanted_by(const struct session *s, bool last)
{
    bool due = last || mu_clock_ns() >= s->observe.latest_wall_ns + LATEST_PERIOD_NS;
    unsigned wanted = s->options.recording ? SESSION_FOR_RECORDING : 0;
    wanted |= bus_writer_matches(&s->observe.every) > 0 ? SESSION_FOR_EVERY : 0;
    wanted |= due && bus_writer_matches(&s->observe.latest) > 0 ? SESSION_FOR_LATEST : 0;
    return wanted;
}

static void robot_view(struct session *s, size_t robot)
{
    const struct session_robot *r = &s->robots[robot];
    frame_take_body(s->observe.frame, robot, &r->sensed, &s->observe.tallies[robot]);
    if (s->agents.at[robot].process >= 0) {
        muster_Percept percept = {.robot = s->world->robots[robot].name};
        percept_pack(&percept, &r->sensed.percept);
        frame_add_percept(s->observe.frame, &percept);
    }
}

void observe_begin(struct session *s, bool last)
{
    uint64_t time_ns = (uint64_t)s->step * s->options.step_ns;
    for (size_t r = 0; r < s->robot_count; r++) {
        tally_take(&s->observe.tallies[r], time_ns, s->options.step_ns, &s->robots[r].sensed);
    }
    if (!s->options.free) {
        frame_clear(s->observe.frame); /* a step that was broken off may have left acts */
    }
    s->observe.wanted = wanted_by(s, last);
    if (!s->observe.wanted) {
        return;
    }
    frame_begin(s->observe.frame, s->step, time_ns);
    for (size_t r = 0; r < s->robot_count; r++) {
        robot_view(s, r);
    }
    for (size_t i = 0; i < s->world->object_count; i++) {
        frame_take_object(s->observe.frame, i, engine_pose(s->engine, s->robot_count + i));
    }
}

void observe_act(struct session *s, size_t robot, const muster_Act *act)
{
    if (s->observe.wanted) {
        frame_add_act(s->observe.frame, robot, act);
    }
}

void observe_outside(struct session *s, const muster_Delivery *d)
{
    if (s->observe.wanted) {
        frame_add_outside(s->observe.frame, d->step + 1, d->outside._buffer, d->outside._length);
    }
}

void observe_order(struct session *s, const muster_RunCommand *order)
{
    if (s->observe.wanted) {
        frame_add_order(s->observe.frame, order);
    }
}

/* --- Frames out ------------------------------------------------------------------------------- */

static muster_State state_of(const struct session_agent *agent)
{
    return agent && agent->process >= 0 ? agent->state : muster_STATE_ABSENT;
}

static void robot_finish(struct session *s, size_t robot)
{
    const struct session_robot *r = &s->robots[robot];
    const muster_RobotTotals *totals = &s->totals[robot].told;
    muster_RobotView *v = frame_robot(s->observe.frame, robot);
    const struct session_agent *agent = &s->agents.at[robot];
    v->state = state_of(agent);
    v->goal = (char *)(uintptr_t)(agent->process >= 0 ? r->goal : ""); /* it is only read */
    v->command_forward_m_s = r->command_forward_m_s;
    v->command_turn_rad_s = r->command_turn_rad_s;
    v->firings = totals->firings;
    v->mails_sent = totals->mails_sent;
    v->mails_received = totals->mails_received;
}

static void agent_finish(struct session *s, size_t agent)
{
    const muster_RobotTotals *totals = &s->totals[s->robot_count + agent].told;
    *frame_agent(s->observe.frame, agent) =
        (muster_AgentView){.name = totals->robot,
                           .state = state_of(agents_find(&s->agents, totals->robot)),
                           .firings = totals->firings,
                           .mails_sent = totals->mails_sent,
                           .mails_received = totals->mails_received};
}

/* A Frame that the network refuses is lost: the run does not wait for observers. */
static void frame_write(struct session *s, const muster_Frame *frame)
{
    if (s->observe.wanted & SESSION_FOR_EVERY) {
        s->observe.lost += bus_write(&s->observe.every, frame) != MU_OK;
    }
    if (s->observe.wanted & SESSION_FOR_LATEST) {
        s->observe.latest_wall_ns = mu_clock_ns();
        s->observe.lost += bus_write(&s->observe.latest, frame) != MU_OK;
    }
    if (s->observe.wanted & SESSION_FOR_RECORDING) {
        mcap_file_frame(s->options.recording, frame);
    }
}

void observe_finish(struct session *s)
{
    if (!s->observe.wanted) {
        frame_clear(s->observe.frame);
        return;
    }
    for (size_t r = 0; r < s->robot_count; r++) {
        robot_finish(s, r);
    }
    for (size_t i = s->robot_count; i < s->totals_count; i++) {
        agent_finish(s, i - s->robot_count);
    }
    muster_Frame *frame = frame_finish(s->observe.frame);
    frame->wall_ns = mu_clock_ns() - s->first_step_wall_ns;
    frame->digest = s->options.free ? 0 : run_hash_peek(s->hash);
    frame_write(s, frame);
    frame_clear(s->observe.frame);
}

void observe_close(struct session *s)
{
    uint64_t left_out = frame_left_out(s->observe.frame);
    if (left_out > 0 || s->observe.lost > 0) {
        mu_log(MU_LOG_WARNING, "frames-cut", "left_out=%llu lost=%llu",
               (unsigned long long)left_out, (unsigned long long)s->observe.lost);
    }
    (void)bus_drain(&s->observe.every, DRAIN_NS);
    (void)bus_drain(&s->observe.latest, DRAIN_NS);
}
