/* SPDX-License-Identifier: Apache-2.0 */
/* What has come: the next step, the next Delivery, and what they are for. */
#include "core/clock.h"
#include "runtime/process.h"

bool process_has_seen(const mu_process *p, int64_t step)
{
    return !p->sees || p->sees(p->sees_self, step);
}

/* Takes the step that is there: the reader keeps only the newest. */
static void next_step(mu_process *p)
{
    enum bus_life life = BUS_LOST;
    const muster_Sense *sense = NULL;
    while (process_takes_steps(p) && life != BUS_DATA && (sense = bus_next(&p->sense, &life))) {
        p->step = NULL; /* there is another one, or its writer is lost */
    }
    if (!sense) {
        return;
    }
    sense = p->step_kept = bus_keep(&p->sense, p->step_kept);
    if (sense->step < 0) {
        (void)process_step_on(p, STEP_GREETING);
        return;
    }
    p->step_wall_ns = mu_clock_ns();
    p->lockstep_step = sense->lockstep ? sense->step : p->lockstep_step;
    p->step = sense->last ? NULL : sense;
    bool serves_the_next = sense->last && p->role == PROCESS_WATCH;
    (void)process_step_on(p, serves_the_next   ? STEP_OVER
                             : sense->last     ? STEP_LAST
                             : sense->lockstep ? STEP_LOCKSTEP
                                               : STEP_FREE);
}

/* A robot in free running takes its mail in at the next step, if one is to be expected. */
static bool mail_is_held(const mu_process *p)
{
    return p->role == PROCESS_BODY && !process_in_lockstep(p) && !p->transfers.prompt &&
           !p->transfers.under_way && p->step_wall_ns &&
           mu_clock_ns() - p->step_wall_ns < PROCESS_STEP_PATIENCE_NS;
}

/* @return whether mail in hand belongs to no step, or to the end of a lock step that is over: no
 * step comes for that any more */
static bool mail_is_for_now(const mu_process *p)
{
    bool is_over = !process_in_lockstep(p) && p->lockstep_step > 0;
    return p->mail->step == muster_STEP_NOW || (is_over && p->mail->step >= p->lockstep_step - 1);
}

uint64_t process_samples_wanted(const mu_process *p)
{
    if (inbox_lacks(p) || p->up_state == UP_PENDING || (p->mail && mail_is_held(p))) {
        return 0; /* more mail may lie in the reader, and waits, too */
    }
    /* A step in lock step needs two: the senses, and the mail of the step before. */
    return process_in_lockstep(p) && !p->transfers.prompt && !p->mail && !p->step ? 2 : 1;
}

/* Mends a pair of step and mail that do not belong together: one of them is of an earlier lock
 * step, whose simulator or broker is gone.  Drops the mail if mail of another step lies behind it;
 * else drops the step if there is another one, or its writer is lost.
 * @return whether it has dropped one */
static bool pair_mend(mu_process *p)
{
    if (inbox_has_step_behind(p)) {
        inbox_drop(p);
        return true;
    }
    const muster_Sense *held = p->step;
    next_step(p);
    return p->step != held;
}

/* An earlier life may have died when its answer was with one of the two: then the broker is a step
 * ahead of the simulator, or a step behind.  @return whether the other one has been given it */
static bool repeats(mu_process *p)
{
    int64_t ahead = p->mail->step - p->step->step;
    if (p->steps != PROCESS_STEPPING || (ahead != 0 && ahead != -2)) {
        return false;
    }
    step_repeat(p, ahead == 0 ? UP_AGAIN_FOR_SIMULATOR : UP_AGAIN_FOR_BROKER);
    if (ahead == 0) {
        p->step = NULL;
    } else {
        inbox_drop(p);
    }
    return true;
}

bool process_handle_one(mu_process *p)
{
    inbox_fill(p);
    probes_look(p);
    if (p->up_state == UP_PENDING) {
        return false;
    }
    if (!p->mail) {
        inbox_next(p);
    }
    if (!p->step) {
        next_step(p);
    }
    if (p->step && !p->step->lockstep) {
        step_live_freely(p, p->step);
        p->step = NULL;
        return true;
    }
    if (p->mail && mail_is_for_now(p)) {
        if (mail_is_held(p)) {
            return false;
        }
        step_take_delivery(p, p->mail, NULL);
        inbox_next(p);
        return true;
    }
    if (!p->step || !p->mail) {
        return false;
    }
    if (p->mail->step != p->step->step - 1) {
        return repeats(p) || pair_mend(p);
    }
    if (!process_has_seen(p, p->mail->step)) {
        return false;
    }
    step_live(p, p->step, p->mail);
    p->step = NULL;
    inbox_drop(p);
    return true;
}
