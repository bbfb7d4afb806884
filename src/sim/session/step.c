/* SPDX-License-Identifier: Apache-2.0 */
/* The parts of one step. */
#include "sim/session/parts.h"

#include "core/clock.h"
#include "core/log.h"

/* In free running a robot stops after this silence of its controller, or after three steps if they
 * take longer. */
static const uint64_t DEADMAN_NS = 300000000;

static void body_hash(struct session *s, size_t body)
{
    double state[ENGINE_STATE_DOUBLES];
    engine_state(s->engine, body, state);
    run_hash_fold_doubles(s->hash, state, ENGINE_STATE_DOUBLES);
}

void step_record(struct session *s)
{
    if (s->step < s->recorded) {
        return;
    }
    s->recorded = s->step + 1;
    run_hash_fold_number(s->hash, (uint64_t)s->step);
    for (size_t r = 0; r < s->robot_count; r++) {
        body_hash(s, r);
        if (s->options.tracks && s->agents.at[r].controlled) {
            tracks_add(s->options.tracks, (uint64_t)s->step * s->options.step_ns,
                       s->agents.at[r].name, &s->robots[r].sensed);
        }
    }
    for (size_t b = s->robot_count; b < engine_body_count(s->engine); b++) {
        body_hash(s, b);
    }
}

/* Command timeout.  @return whether a speed still holds: it was set within the last 10 steps, and
 * its process is not silent */
static bool robot_is_held(const struct session *s, size_t robot, uint64_t now_ns)
{
    int32_t process = s->agents.at[robot].process;
    if (process < 0 || s->robots[robot].quiet_steps >= SESSION_QUIET_STEPS) {
        return false;
    }
    uint64_t steps_ns = 3 * s->options.step_ns;
    uint64_t patience_ns = steps_ns > DEADMAN_NS ? steps_ns : DEADMAN_NS;
    return !s->options.free || now_ns - s->processes[process].answered_wall_ns < patience_ns;
}

/* Applies an order once.  The percept shows whether the gripper could carry it out. */
static void gripper_apply(struct session *s, size_t robot)
{
    struct session_robot *r = &s->robots[robot];
    if (r->paddles != 0 || r->lift != 0) {
        mu_result done = engine_grip(s->engine, robot, r->paddles, r->lift);
        if (done != MU_OK) {
            mu_log(MU_LOG_INFO, "gripper-refused", "robot=%s step=%lld: %s",
                   s->agents.at[robot].name, (long long)s->step,
                   done == MU_ABSENT ? "it has none" : "there is no room to let go");
        }
    }
    r->paddles = r->lift = 0;
}

static void commands_apply(struct session *s)
{
    uint64_t now_ns = s->options.free ? mu_clock_ns() : 0;
    for (size_t i = 0; i < s->robot_count; i++) {
        struct session_robot *r = &s->robots[i];
        r->quiet_steps = r->drives ? 0 : r->quiet_steps + 1;
        r->drives = false;
        bool held = robot_is_held(s, i, now_ns);
        double forward_m_s = held ? r->forward_m_s : 0.0;
        double turn_rad_s = held ? r->turn_rad_s : 0.0;
        /* inbox.c drops speeds that are not finite, so the engine accepts this one. */
        MU_ASSERT(engine_command(s->engine, i, &forward_m_s, &turn_rad_s) == MU_OK);
        r->command_forward_m_s = forward_m_s;
        r->command_turn_rad_s = turn_rad_s;
        gripper_apply(s, i);
    }
    for (uint32_t i = 0; i < s->agents.count; i++) {
        run_hash_fold(s->hash, s->agents.at[i].digest, RUN_HASH_BYTES);
    }
}

void step_fold_outside(struct session *s)
{
    run_hash_fold(s->hash, s->outside[(s->step - 1) & 1], RUN_HASH_BYTES);
}

void step_finish(struct session *s)
{
    step_fold_outside(s);
    commands_apply(s);
    edits_apply(s);
    observe_finish(s);
    engine_step(s->engine);
    agents_settle(&s->agents);
    s->step++;
    s->last_step_wall_ns = mu_clock_ns();
}
