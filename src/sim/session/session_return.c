/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A process of the lock step that dies and is started again: the clock stands still until it is
 * back, and with it everybody else.  docs/lockstep.md says what is lost.
 */
#include "sim/session/session.h"

#include "core/clock.h"
#include "core/log.h"
#include "core/text.h"

#include <stdio.h>
#include <string.h>

static const int64_t RETURN_WAIT_NS = 2000000;

static struct session_process *process_named(struct session *s, const char *name)
{
    uint32_t index = mu_table_find(&s->process_names, name);
    return index == MU_NONE ? NULL : &s->processes[index];
}

static bool is_gone(const struct session_process *p)
{
    return p->lost && p->followed;
}

/* Nobody follows himself: who has come back says again who he is. */
static void followed_note(struct session *s, uint32_t process, const char *by)
{
    struct session_process *p = &s->processes[process];
    p->followed = p->followed || strcmp(p->name, by) != 0;
}

static void follow_watchers(struct session *s, const char *by)
{
    for (uint32_t i = 0; i < s->process_count; i++) {
        if (s->processes[i].watches && !s->processes[i].onlooks) {
            followed_note(s, i, by);
        }
    }
}

/* @return the process of a robot, of an agent without a body, or of a host of that name; -1 */
static int32_t process_of(const struct session *s, const muster_Entry *e)
{
    uint32_t robot = mu_table_find(&s->robot_names, e->name);
    const struct guest *guest = guests_find(s->guests, e->name);
    int32_t process = robot != MU_NONE ? s->robots[robot].process : guest ? guest->process : -1;
    for (uint32_t i = 0; i < s->process_count && e->kind == muster_KIND_HOST; i++) {
        const struct session_process *p = &s->processes[i];
        process = p->hosts && strcmp(p->host, e->name) == 0 ? (int32_t)i : process;
    }
    return process;
}

/* Who is stopped may go on; who has a successor does not. */
static void follow(struct session *s, const muster_Registration *r)
{
    for (uint32_t i = 0; i < r->agents._length; i++) {
        const muster_Entry *e = &r->agents._buffer[i];
        int32_t process = process_of(s, e);
        if (process >= 0 && e->state != muster_STATE_ABSENT) {
            followed_note(s, (uint32_t)process, r->process);
        }
    }
    if (r->watches && !session_onlooks(r)) {
        follow_watchers(s, r->process);
    }
}

void session_return_hear(struct session *s, const muster_Registration *r, enum bus_life life)
{
    struct session_process *p = process_named(s, r->process);
    if (s->options.return_ns == 0) {
        return; /* whoever does not answer is found by its silence */
    }
    if (p && !p->comes) {
        p->lost = is_gone(p) || life != BUS_DATA;
        return;
    }
    if (life == BUS_DATA) {
        follow(s, r);
    }
    if (s->held) {
        session_register(s, r, life);
        p = process_named(s, r->process);
        if (p) {
            p->comes = true;
        }
    }
}

uint64_t session_return_patience_ns(const struct session *s)
{
    bool lost = false;
    for (uint32_t i = 0; i < s->process_count; i++) {
        lost = lost || s->processes[i].lost;
    }
    bool longer = lost && s->options.return_ns > s->options.silence_ns;
    return longer ? s->options.return_ns : s->options.silence_ns;
}

bool session_return_due(const struct session *s)
{
    bool due = false;
    for (uint32_t i = 0; i < s->process_count; i++) {
        due = due || (is_gone(&s->processes[i]) && s->processes[i].answered < s->step);
    }
    return due;
}

/* Its robots stand still, and are free for another process. */
static void process_let_go(struct session *s, uint32_t process)
{
    session_rest(s, process);
    guests_renumber(s->guests, (int32_t)process, -1);
    s->processes[process].watches = s->processes[process].hosts = false;
    s->processes[process].let_go = true;
    for (size_t i = 0; i < s->robot_count; i++) {
        struct session_robot *r = &s->robots[i];
        r->process = r->next_process >= 0 ? r->next_process : r->process; /* it has moved on */
        r->next_process = -1;
        if (r->process == (int32_t)process) {
            mu_log(MU_LOG_WARNING, "controller-lost", "robot=%s step=%lld", r->name,
                   (long long)s->step);
            r->process = -1;
            r->returned = true;
        }
    }
}

/* @return whether there are any whom the broker does not know of yet */
static bool lost_let_go(struct session *s)
{
    bool any = false;
    for (uint32_t i = 0; i < s->process_count; i++) {
        if (is_gone(&s->processes[i]) && !s->processes[i].let_go) {
            process_let_go(s, i);
            any = true;
        }
    }
    return any;
}

/* The broker has ended this step with an answer that has not come here: in it, the robots of
 * whoever comes do nothing. */
static void step_pass(struct session *s, uint32_t process)
{
    s->processes[process].answered = s->step;
    session_guests_pass(s, process);
    for (size_t i = 0; i < s->robot_count; i++) {
        struct session_robot *r = &s->robots[i];
        if (r->process == (int32_t)process) {
            r->drives = true;
            r->forward_m_s = r->turn_rad_s = 0.0;
            memset(r->digest, 0, sizeof r->digest);
        }
    }
}

/* Those who have come get the step that the others have. */
static void steps_give(struct session *s)
{
    bool under_way = s->sent_step == s->step;
    s->answers_missing = 0;
    for (uint32_t i = 0; i < s->process_count; i++) {
        struct session_process *p = &s->processes[i];
        if (p->comes && under_way && s->mail_step >= s->step) {
            step_pass(s, i);
        } else if (p->comes && under_way) {
            (void)session_write_sense(p);
        }
        p->comes = false;
        s->answers_missing += under_way && !p->left_out && p->answered < s->step;
    }
}

static mu_result nobody_report(struct session *s)
{
    char who[sizeof s->waits_for];
    struct mu_text said;
    (void)mu_text_copy(who, sizeof who, s->waits_for);
    mu_text_init(&said, s->waits_for, sizeof s->waits_for);
    mu_text_format(&said, "died at step %lld and not back within %g s: %s", (long long)s->step,
                   (double)s->options.return_ns / 1e9, who);
    return MU_TIMEOUT;
}

/* After the last step only its mail is awaited, which the dead have no part in. */
static bool is_last(const struct session *s)
{
    return s->options.duration_ns > 0 &&
           (uint64_t)s->step * s->options.step_ns >= s->options.duration_ns;
}

static mu_result others_await(struct session *s, const volatile sig_atomic_t *signal_came)
{
    uint64_t began_ns = mu_clock_ns();
    bool told = lost_let_go(s) && session_tell_roster(s, true) == MU_OK;
    while (true) {
        session_take(s);
        told = told && !lost_let_go(s); /* others may die, too */
        told = told || session_tell_roster(s, true) == MU_OK;
        bool there = is_last(s) ? s->mail_step >= s->step - 1 : session_is_complete(s);
        if (told && there) {
            return MU_OK;
        }
        if (s->end || *signal_came) {
            return MU_DONE;
        }
        if (mu_clock_ns() - began_ns > s->options.return_ns) {
            return nobody_report(s);
        }
        (void)session_tell(s, muster_RUN_RUNNING, false);
        bus_wait(&s->bus, 1, RETURN_WAIT_NS);
    }
}

static void roster_tell(struct session *s, const volatile sig_atomic_t *signal_came)
{
    while (session_tell_roster(s, true) != MU_OK && !*signal_came) {
        bus_wait(&s->bus, 1, RETURN_WAIT_NS);
    }
}

mu_result session_return_await(struct session *s, const volatile sig_atomic_t *signal_came)
{
    s->held = true;
    mu_result waited = others_await(s, signal_came);
    s->held = false;
    if (waited != MU_OK) {
        return waited;
    }
    mu_log(MU_LOG_INFO, "controllers-back", "step=%lld", (long long)s->step);
    session_prune(s);
    session_lay_out(s);
    session_fill_senses(s, false);
    steps_give(s);
    roster_tell(s, signal_came);
    s->last_step_wall_ns = s->pace_wall_ns = mu_clock_ns(); /* silence counts from here, */
    s->pace_step = s->step;                                 /* and the run's pace */
    return MU_OK;
}
