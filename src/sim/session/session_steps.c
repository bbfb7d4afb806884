/* SPDX-License-Identifier: Apache-2.0 */
/* How a run goes on: one step after the other. */
#include "core/clock.h"
#include "core/log.h"
#include "core/text.h"
#include "sim/session/session.h"

#include <math.h>
#include <string.h>

static const int64_t WAIT_NS = 50000000;
static const int64_t RETRY_NS = 1000000;
static const int64_t STATUS_DRAIN_NS = 500000000;
static const int64_t STATUS_ROUND_NS = 20000000;
static const uint64_t STARTER_PATIENCE_NS = 10000000000;

/* In free running a controller that has not answered for this long, or for three steps if they are
 * longer, has let go of its robot. */
static const uint64_t DEADMAN_NS = 300000000;

/* Who is gone by the network's word, and has no robot, is waited for so long: it may be slow. */
static const uint64_t LOSS_NS = 1000000000;

/* No step is due later than in thirty years, however slow the pace is. */
static const double PACE_MAX_NS = 1e18;

/* --- senses out ------------------------------------------------------------------------------- */

/* The lists of a percept go out as the engine has them. */
_Static_assert(sizeof(struct engine_blob) == sizeof(muster_Blob) &&
                   offsetof(struct engine_blob, bearing_rad) ==
                       offsetof(muster_Blob, bearing_rad) &&
                   offsetof(struct engine_blob, width_rad) == offsetof(muster_Blob, width_rad) &&
                   offsetof(struct engine_blob, range_m) == offsetof(muster_Blob, range_m),
               "blobs");
_Static_assert(
    sizeof(struct engine_fiducial) == sizeof(muster_Fiducial) &&
        offsetof(struct engine_fiducial, bearing_rad) == offsetof(muster_Fiducial, bearing_rad) &&
        offsetof(struct engine_fiducial, range_m) == offsetof(muster_Fiducial, range_m) &&
        offsetof(struct engine_fiducial, heading_rad) == offsetof(muster_Fiducial, heading_rad),
    "fiducials");

/* What nobody asks for is not read; a robot without a controller asks for nothing. */
static void wanted_set(struct session *s)
{
    for (size_t r = 0; r < s->robot_count; r++) {
        const struct session_robot *robot = &s->robots[r];
        s->wanted[r] = robot->process >= 0 ? robot->senses & ~robot->off : 0;
    }
}

static void percepts_read(struct session *s)
{
    wanted_set(s);
    const struct engine_percept *percepts = engine_sense_all(s->engine, s->wanted);
    for (size_t r = 0; r < s->robot_count; r++) {
        s->robots[r].percept = percepts[r];
    }
}

/* What is not wanted is empty in the engine's percept. */
static void readings_fill(muster_Percept *to, const struct engine_percept *from)
{
    /* Nobody writes through these. */
    to->sonar_m._buffer = (float *)(uintptr_t)from->sonar_m;
    to->sonar_m._length = to->sonar_m._maximum = (uint32_t)from->sonar_count;
    to->laser_m._buffer = (float *)(uintptr_t)from->laser_m;
    to->laser_m._length = to->laser_m._maximum = (uint32_t)from->laser_count;
    to->blobs._buffer = (muster_Blob *)(uintptr_t)from->blobs;
    to->blobs._length = to->blobs._maximum = (uint32_t)from->blob_count;
    to->fiducials._buffer = (muster_Fiducial *)(uintptr_t)from->fiducials;
    to->fiducials._length = to->fiducials._maximum = (uint32_t)from->fiducial_count;
}

static void body_fill(muster_Percept *to, const struct engine_percept *from)
{
    to->x_m = from->position.x_m;
    to->y_m = from->position.y_m;
    to->heading_rad = from->position.heading_rad;
    to->forward_m_s = from->forward_m_s;
    to->turn_rad_s = from->turn_rad_s;
    to->stalled = from->stalled;
    to->fault = from->fault;
    to->gps_x_m = from->gps_x_m;
    to->gps_y_m = from->gps_y_m;
    to->compass_rad = from->compass_rad;
    to->odometer_x_m = from->odometer.x_m;
    to->odometer_y_m = from->odometer.y_m;
    to->odometer_heading_rad = from->odometer.heading_rad;
    to->bumpers = from->bumpers;
    to->gripper = from->gripper;
    to->battery_share = from->battery_share;
}

void session_percept_fill(muster_Percept *to, const struct engine_percept *from)
{
    body_fill(to, from);
    readings_fill(to, from);
}

/* Who watches sees where each body is and how it moves, and nothing of what its sensors read. */
static void bodies_fill(struct session *s)
{
    for (size_t r = 0; r < s->robot_count; r++) {
        const struct engine_percept *percept = &s->robots[r].percept;
        body_fill(&s->bodies[r], percept);
        s->bodies[r].x_m = percept->pose.x_m;
        s->bodies[r].y_m = percept->pose.y_m;
        s->bodies[r].heading_rad = percept->pose.heading_rad;
    }
}

bool session_write_sense(struct session_process *p)
{
    p->sample_pending = bus_write(&p->sense, &p->sample) != MU_OK;
    return !p->sample_pending;
}

void session_fill_senses(struct session *s, bool last)
{
    uint32_t next = 0;
    bodies_fill(s);
    for (uint32_t i = 0; i < s->process_count; i++) {
        for (size_t r = 0; r < s->robot_count; r++) {
            if (s->robots[r].process == (int32_t)i) {
                body_fill(&s->percepts[next], &s->robots[r].percept);
                readings_fill(&s->percepts[next++], &s->robots[r].percept);
            }
        }
        struct session_process *p = &s->processes[i];
        p->sample.step = s->step;
        p->sample.time_ns = (uint64_t)s->step * s->options.step_ns;
        p->sample.last = last;
    }
}

static void senses_send(struct session *s, bool last)
{
    session_fill_senses(s, last);
    s->answers_missing = 0;
    for (uint32_t i = 0; i < s->process_count; i++) {
        struct session_process *p = &s->processes[i];
        if (!p->left_out) {
            (void)session_write_sense(p);
            s->answers_missing++;
        }
    }
    s->sent_step = s->step;
}

/* @return whether every process has its step */
static bool senses_retry(struct session *s)
{
    bool all = true;
    for (uint32_t i = 0; i < s->process_count; i++) {
        struct session_process *p = &s->processes[i];
        all = (!p->sample_pending || session_write_sense(p)) && all;
    }
    if (s->roster_due) {
        s->roster_due = session_tell_roster(s, true) != MU_OK;
    }
    return all && !s->roster_due;
}

/* --- one step --------------------------------------------------------------------------------- */

static void body_hash(struct session *s, size_t body)
{
    double state[ENGINE_STATE_DOUBLES];
    engine_state(s->engine, body, state);
    run_hash_fold(s->hash, state, sizeof state);
}

/* Hashes and records the world as this step found it; done while the controllers think.  A step
 * that is broken off has found it once. */
static void world_record(struct session *s)
{
    if (s->step < s->recorded) {
        return;
    }
    s->recorded = s->step + 1;
    run_hash_fold_number(s->hash, (uint64_t)s->step);
    for (size_t r = 0; r < s->robot_count; r++) {
        body_hash(s, r);
        if (s->tracks && s->robots[r].controlled) {
            tracks_add(s->tracks, (uint64_t)s->step * s->options.step_ns, s->robots[r].name,
                       &s->robots[r].percept);
        }
    }
    for (size_t b = s->robot_count; b < engine_body_count(s->engine); b++) {
        body_hash(s, b);
    }
}

/* The dead-man: a speed that nobody renews for 10 steps, or whose owner is silent, is no speed. */
static bool robot_is_held(const struct session *s, const struct session_robot *r, uint64_t now_ns)
{
    if (r->process < 0 || r->quiet_steps >= SESSION_QUIET_STEPS) {
        return false;
    }
    uint64_t steps_ns = 3 * s->options.step_ns;
    uint64_t patience_ns = steps_ns > DEADMAN_NS ? steps_ns : DEADMAN_NS;
    return !s->options.free || now_ns - s->processes[r->process].answered_wall_ns < patience_ns;
}

/* An order counts once; what cannot be done is not, and the percept shows it. */
static void gripper_apply(struct session *s, size_t robot)
{
    struct session_robot *r = &s->robots[robot];
    if (r->paddles != 0 || r->lift != 0) {
        mu_result done = engine_grip(s->engine, robot, r->paddles, r->lift);
        if (done != MU_OK) {
            mu_log(MU_LOG_INFO, "gripper-refused", "robot=%s step=%lld: %s", r->name,
                   (long long)s->step,
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
        bool held = robot_is_held(s, r, now_ns);
        double forward_m_s = held ? r->forward_m_s : 0.0;
        double turn_rad_s = held ? r->turn_rad_s : 0.0;
        /* The border has refused what is not finite, so the engine cannot. */
        MU_ASSERT(engine_command(s->engine, i, &forward_m_s, &turn_rad_s) == MU_OK);
        r->command_forward_m_s = forward_m_s;
        r->command_turn_rad_s = turn_rad_s;
        gripper_apply(s, i);
        run_hash_fold(s->hash, r->digest, sizeof r->digest);
    }
    session_guests_fold(s);
}

/* The mails from outside that the step before this one took in. */
static void outside_fold(struct session *s)
{
    run_hash_fold(s->hash, s->outside[(s->step - 1) & 1], RUN_HASH_BYTES);
}

static void step_finish(struct session *s)
{
    outside_fold(s);
    commands_apply(s);
    session_orders_apply(s);
    session_view_finish(s);
    engine_step(s->engine);
    guests_settle(s->guests);
    s->step++;
    s->last_step_wall_ns = mu_clock_ns();
}

/* --- lock step -------------------------------------------------------------------------------- */

static mu_result silence_report(struct session *s)
{
    struct mu_text who;
    mu_text_init(&who, s->waits_for, sizeof s->waits_for);
    mu_text_format(&who, "silent for %llu s at step %lld:",
                   (unsigned long long)(session_return_patience_ns(s) / 1000000000u),
                   (long long)s->step);
    /* Without the mail of the last step no robot can answer. */
    bool broker_is_late = s->mail_step < s->step - 1;
    if (broker_is_late) {
        mu_text_add(&who, " the broker");
    }
    for (size_t i = 0; !broker_is_late && i < s->robot_count; i++) {
        int32_t process = s->robots[i].process;
        if (process >= 0 && s->processes[process].answered < s->step) {
            mu_text_format(&who, " %s", s->robots[i].name);
        }
    }
    for (uint32_t i = 0; !broker_is_late && i < s->process_count; i++) {
        bool attends = s->processes[i].watches || s->processes[i].hosts;
        if (attends && !s->processes[i].left_out && s->processes[i].answered < s->step) {
            mu_text_format(&who, " %s", s->processes[i].name);
        }
    }
    return MU_TIMEOUT;
}

/* How many samples this step still needs: so many, and nothing is done for fewer. */
static uint64_t samples_missing(const struct session *s)
{
    uint64_t missing = s->answers_missing + (s->mail_step < s->step - 1);
    return missing > 0 ? missing : 1;
}

/* Waits for the answers of this step, and for the mail of the one before. */
static mu_result answers_wait(struct session *s, const volatile sig_atomic_t *signal_came)
{
    uint64_t began_ns = s->last_step_wall_ns;
    for (;;) {
        session_take(s);
        if (s->answers_missing == 0 && s->mail_step >= s->step - 1) {
            return MU_OK;
        }
        if (s->end || *signal_came) {
            return MU_DONE;
        }
        if (session_return_due(s)) {
            mu_result back = session_return_await(s, signal_came);
            if (back != MU_OK) {
                return back;
            }
            began_ns = s->last_step_wall_ns;
            continue;
        }
        uint64_t waited_ns = mu_clock_ns() - began_ns;
        if (waited_ns > session_return_patience_ns(s)) {
            return silence_report(s);
        }
        if (waited_ns > LOSS_NS && s->answers_missing > 0) {
            session_leave_out(s);
        }
        bus_wait(&s->bus, samples_missing(s), senses_retry(s) ? WAIT_NS : RETRY_NS);
        (void)session_tell(s, muster_RUN_RUNNING, false);
    }
}

static bool goes_on(const struct session *s, const volatile sig_atomic_t *signal_came)
{
    bool in_time = s->options.duration_ns == 0 ||
                   (uint64_t)s->step * s->options.step_ns < s->options.duration_ns;
    return in_time && !s->end && !*signal_came;
}

/* Waits until its time has come on the monotonic clock, taking in what comes meanwhile. */
static void wait_until(struct session *s, uint64_t due_ns, const volatile sig_atomic_t *signal_came)
{
    for (uint64_t now_ns = mu_clock_ns();
         now_ns < due_ns && !s->end && !*signal_came && !s->paced_anew; now_ns = mu_clock_ns()) {
        int64_t wait_ns = (int64_t)(due_ns - now_ns);
        bus_wait(&s->bus, 1, wait_ns < WAIT_NS ? wait_ns : WAIT_NS);
        session_take(s);
        (void)session_tell(s, muster_RUN_RUNNING, false);
    }
}

/* Paces the run: a step may begin when its time has come on the clock of the rate. */
static void pace(struct session *s, const volatile sig_atomic_t *signal_came)
{
    if (s->options.rate <= 0.0) {
        return;
    }
    do {
        s->paced_anew = false;
        double due_ns =
            (double)(s->step - s->pace_step) * (double)s->options.step_ns / s->options.rate;
        wait_until(s, s->pace_wall_ns + (uint64_t)fmin(due_ns, PACE_MAX_NS), signal_came);
    } while (s->paced_anew && s->options.rate > 0.0);
    s->last_step_wall_ns = mu_clock_ns(); /* silence counts from here */
}

/* A robot has set out: the next step begins when the broker has said where it is. */
static mu_result moves_wait(struct session *s, const volatile sig_atomic_t *signal_came)
{
    if (!s->moves) {
        return MU_OK;
    }
    s->answers_missing = 0;
    mu_result waited = answers_wait(s, signal_came);
    s->moves = false;
    session_change_processes(s);
    s->last_step_wall_ns = mu_clock_ns();
    return waited;
}

static mu_result lockstep_run(struct session *s, const volatile sig_atomic_t *signal_came)
{
    mu_result waited = MU_OK;
    while (goes_on(s, signal_came) && waited == MU_OK) {
        pace(s, signal_came);
        percepts_read(s);
        /* The very first step waits for the broker: it must know the roster. */
        if (s->step > 0) {
            senses_send(s, false);
        }
        world_record(s);
        session_view_begin(s, false);
        if (s->step == 0) {
            s->answers_missing = 0;
            waited = answers_wait(s, signal_came);
            s->first_step_wall_ns = s->last_step_wall_ns = s->pace_wall_ns = mu_clock_ns();
            senses_send(s, false);
        }
        waited = waited == MU_OK ? answers_wait(s, signal_came) : waited;
        if (waited == MU_OK) {
            step_finish(s);
            waited = moves_wait(s, signal_came);
            (void)session_tell(s, muster_RUN_RUNNING, false);
        }
    }
    if (waited == MU_OK && !s->end && !*signal_came) {
        s->answers_missing = 0; /* the mail of the last step is part of the hash */
        waited = answers_wait(s, signal_came);
    }
    return waited == MU_DONE ? MU_OK : waited;
}

/* --- free running ----------------------------------------------------------------------------- */

/* A broker that has come since, as one that was started again, has found the Roster of an earlier
 * step, and takes it for the time of the run. */
static void roster_renew(struct session *s)
{
    uint32_t readers = bus_writer_matched_ever(&s->roster);
    if (readers != s->roster_readers && session_tell_roster(s, false) == MU_OK) {
        s->roster_readers = readers;
    }
}

static mu_result free_run(struct session *s, const volatile sig_atomic_t *signal_came)
{
    uint64_t due_ns = mu_clock_ns();
    while (goes_on(s, signal_came)) {
        percepts_read(s);
        s->skipped += s->answers_missing;
        senses_send(s, false);
        world_record(s);
        session_view_begin(s, false);
        due_ns += s->options.step_ns;
        wait_until(s, due_ns, signal_came);
        step_finish(s);
        roster_renew(s);
        (void)session_tell(s, muster_RUN_RUNNING, false);
    }
    return MU_OK;
}

/* What must not be lost: how the run ended, and that nobody waits for its steps any more. */
static void last_words(struct session *s, muster_RunState state)
{
    bool told = false;
    bool released = false;
    for (int i = 0; i < 1000 && !(told && released); i++) {
        told = told || session_tell(s, state, true);
        released = released || session_tell_roster(s, false) == MU_OK;
        bus_wait(&s->bus, 1, told && released ? 0 : RETRY_NS);
    }
    (void)bus_drain(&s->roster, 200000000);
}

/* Who looks has half a second for the last word.  Who has started the run must have it, and gets
 * little time on a busy machine: it is waited for. */
static void status_drain(struct session *s, const volatile sig_atomic_t *signal_came)
{
    bool heard = bus_drain(&s->status, STATUS_DRAIN_NS);
    uint64_t until_ns = mu_clock_ns() + STARTER_PATIENCE_NS;
    while (!heard && s->options.waits_for_go && !*signal_came && mu_clock_ns() < until_ns) {
        heard = bus_drain(&s->status, STATUS_ROUND_NS);
    }
}

mu_result session_run(struct session *s, const volatile sig_atomic_t *signal_came)
{
    mu_result ran = s->options.free ? free_run(s, signal_came) : lockstep_run(s, signal_came);
    s->interrupted = *signal_came != 0;
    percepts_read(s);
    if (ran == MU_OK) {
        s->waits_for[0] = '\0';
        world_record(s);
        session_view_begin(s, true);
        outside_fold(s);
        session_view_finish(s);
    }
    senses_send(s, true);
    run_hash_end(s->hash, s->hash_text);
    last_words(s, ran == MU_OK ? muster_RUN_DONE : muster_RUN_FAULT);
    for (uint32_t i = 0; i < s->process_count; i++) {
        (void)bus_drain(&s->processes[i].sense, 200000000);
    }
    (void)bus_drain(&s->answers, 200000000);
    session_view_close(s);
    status_drain(s, signal_came);
    return ran;
}
