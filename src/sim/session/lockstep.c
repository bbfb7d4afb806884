/* SPDX-License-Identifier: Apache-2.0 */
/* Runs step after step: in lock step when all processes have answered, in free running by time. */
#include "sim/session/parts.h"

#include "core/clock.h"
#include "core/text.h"

#include <math.h>

static const int64_t WAIT_NS = 50000000;
static const int64_t RETRY_NS = 1000000;

/* A process that the network reports as gone, and that has no robot, may only be slow: the step
 * waits for it this long. */
static const uint64_t LOSS_NS = 1000000000;

/* Bounds the wait for a step, about thirty years, so that it fits an integer. */
static const double PACE_MAX_NS = 1e18;

/* --- lock step -------------------------------------------------------------------------------- */

static mu_result silence_report(struct session *s)
{
    struct mu_text who = mu_text_in(s->waits_for, sizeof s->waits_for);
    mu_text_format(&who, "silent for %llu s at step %lld:",
                   (unsigned long long)(recover_patience_ns(s) / 1000000000u), (long long)s->step);
    /* No process can answer a step before it has the mail of the last one. */
    bool broker_is_late = s->mail_step < s->step - 1;
    if (broker_is_late) {
        mu_text_add(&who, " the broker");
    }
    for (uint32_t i = 0; !broker_is_late && i < s->agents.count; i++) {
        int32_t process = s->agents.at[i].process;
        if (process >= 0 && s->processes[process].answered < s->step) {
            mu_text_format(&who, " %s", s->agents.at[i].name);
        }
    }
    for (uint32_t i = 0; !broker_is_late && i < s->process_count; i++) {
        const struct session_process *p = &s->processes[i];
        if (member_attends(p) && member_is_in_steps(p) && p->answered < s->step) {
            mu_text_format(&who, " %s", p->name);
        }
    }
    return MU_TIMEOUT;
}

/* @return how many samples the step still needs; fewer need not wake the session */
static uint64_t samples_missing(const struct session *s)
{
    uint64_t missing = s->answers_missing + (s->mail_step < s->step - 1);
    return missing > 0 ? missing : 1;
}

/* Waits for the answers of this step, and for the mail of the one before. */
static mu_result answers_wait(struct session *s)
{
    uint64_t began_ns = s->last_step_wall_ns;
    for (;;) {
        inbox_take(s);
        if (s->answers_missing == 0 && s->mail_step >= s->step - 1) {
            return MU_OK;
        }
        if (phase_ends(s)) {
            return MU_DONE;
        }
        if (recover_is_due(s)) {
            mu_result back = recover_await(s);
            if (back != MU_OK) {
                return back;
            }
            began_ns = s->last_step_wall_ns;
            continue;
        }
        uint64_t waited_ns = mu_clock_ns() - began_ns;
        if (waited_ns > recover_patience_ns(s)) {
            return silence_report(s);
        }
        if (waited_ns > LOSS_NS && s->answers_missing > 0) {
            roster_leave_out(s);
        }
        bus_wait(s->bus, samples_missing(s), percepts_retry(s) ? WAIT_NS : RETRY_NS);
        (void)status_tell(s, false);
    }
}

static bool goes_on(struct session *s)
{
    bool in_time = s->options.duration_ns == 0 ||
                   (uint64_t)s->step * s->options.step_ns < s->options.duration_ns;
    return in_time && !phase_ends(s);
}

/* @return the wall time at which the step may begin or, in free running, may end */
static uint64_t due_ns(const struct session *s)
{
    double rate = s->options.free ? 1.0 : s->options.rate;
    double steps = (double)(s->step - s->pace_step + s->options.free);
    double due_ns = rate > 0.0 ? steps * (double)s->options.step_ns / rate : 0.0;
    return s->pace_wall_ns + (uint64_t)fmin(due_ns, PACE_MAX_NS);
}

/* Waits until the step is due, and takes what comes meanwhile, such as another rate. */
static void pace(struct session *s)
{
    for (uint64_t now_ns = mu_clock_ns(); now_ns < due_ns(s) && !phase_ends(s);
         now_ns = mu_clock_ns()) {
        int64_t wait_ns = (int64_t)(due_ns(s) - now_ns);
        bus_wait(s->bus, 1, wait_ns < WAIT_NS ? wait_ns : WAIT_NS);
        inbox_take(s);
        (void)status_tell(s, false);
    }
    s->last_step_wall_ns = mu_clock_ns(); /* the patience with silent processes starts here */
}

/* After an agent has departed, waits until the broker has said where it is. */
static mu_result moves_wait(struct session *s)
{
    if (s->phase != PHASE_SETTLING) {
        return MU_OK;
    }
    s->answers_missing = 0;
    mu_result waited = answers_wait(s);
    if (waited == MU_OK) {
        (void)phase_on(s, PHASE_SETTLED);
    }
    roster_change_processes(s);
    s->last_step_wall_ns = mu_clock_ns();
    return waited;
}

mu_result lockstep_run(struct session *s)
{
    mu_result waited = MU_OK;
    while (goes_on(s) && waited == MU_OK) {
        pace(s);
        percepts_read(s);
        /* The first step waits until the broker knows the roster. */
        if (s->step > 0) {
            percepts_send(s, false);
        }
        step_record(s);
        observe_begin(s, false);
        if (s->step == 0) {
            s->answers_missing = 0;
            waited = answers_wait(s);
            s->first_step_wall_ns = s->last_step_wall_ns = s->pace_wall_ns = mu_clock_ns();
            percepts_send(s, false);
        }
        waited = waited == MU_OK ? answers_wait(s) : waited;
        if (waited == MU_OK) {
            step_finish(s);
            waited = moves_wait(s);
            (void)status_tell(s, false);
        }
    }
    if (waited == MU_OK && !phase_ends(s)) {
        s->answers_missing = 0; /* the mail of the last step is part of the hash */
        waited = answers_wait(s);
    }
    return waited == MU_DONE ? MU_OK : waited;
}

/* --- free running ----------------------------------------------------------------------------- */

/* A broker that joins during the run, such as one that was started again, finds an old Roster and
 * would take its step for the time of the run. */
static void roster_renew(struct session *s)
{
    uint32_t readers = bus_writer_matched_ever(&s->roster);
    if (readers != s->roster_readers && roster_tell(s, false) == MU_OK) {
        s->roster_readers = readers;
    }
}

mu_result lockstep_run_free(struct session *s)
{
    while (goes_on(s)) {
        percepts_read(s);
        s->skipped += s->answers_missing;
        percepts_send(s, false);
        step_record(s);
        observe_begin(s, false);
        pace(s);
        step_finish(s);
        roster_renew(s);
        (void)status_tell(s, false);
    }
    return MU_OK;
}
