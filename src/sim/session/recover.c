/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Recovery of a process that dies in lock step and is started again.  The clock stands still until
 * it is back, and all other processes wait.  docs/crashes.md says what is lost.
 */
#include "sim/session/parts.h"

#include "core/clock.h"
#include "core/log.h"
#include "core/text.h"

#include <stdio.h>
#include <string.h>

static const int64_t RETURN_WAIT_NS = 2000000;

uint64_t recover_patience_ns(const struct session *s)
{
    bool lost = false;
    for (uint32_t i = 0; i < s->process_count; i++) {
        enum member_state state = s->processes[i].state;
        lost = lost || state == MEMBER_LOST || state == MEMBER_SUPERSEDED;
    }
    bool longer = lost && s->options.return_ns > s->options.silence_ns;
    return longer ? s->options.return_ns : s->options.silence_ns;
}

bool recover_is_due(const struct session *s)
{
    bool due = false;
    for (uint32_t i = 0; i < s->process_count; i++) {
        const struct session_process *p = &s->processes[i];
        due = due || (p->state == MEMBER_SUPERSEDED && p->answered < s->step);
    }
    return due;
}

/* Stops the robots of a dead process, and frees its agents for its successor. */
static void process_release(struct session *s, uint32_t process)
{
    roster_rest(s, process);
    for (size_t i = 0; i < s->agents.count; i++) {
        const struct session_agent *agent = &s->agents.at[i];
        if (agent->totals >= 0 && agents_home(agent) == (int32_t)process) {
            mu_log(MU_LOG_WARNING, "controller-lost", "robot=%s step=%lld", agent->name,
                   (long long)s->step);
            s->totals[agent->totals].returned = true;
        }
    }
    agents_renumber(&s->agents, (int32_t)process, -1);
    s->processes[process].sight = MEMBER_HAS_BODIES;
    s->processes[process].host[0] = '\0';
    (void)member_on(&s->processes[process], MEMBER_RELEASES);
}

/* @return whether the broker must hear of a release */
static bool superseded_release(struct session *s)
{
    bool any = false;
    for (uint32_t i = 0; i < s->process_count; i++) {
        if (s->processes[i].state == MEMBER_SUPERSEDED) {
            process_release(s, i);
            any = true;
        }
    }
    return any;
}

/* Gives the last step that went out to the processes that have joined: if it has ended, the broker
 * may lack the answer of their earlier lives.  A watcher answers from what it sees, so it gets the
 * step that the broker waits for, and the last one when the broker has its answer. */
static void steps_give(struct session *s)
{
    bool under_way = s->sent_step == s->step;
    bool gives = under_way || (s->sent_step >= 0 && s->mail_step < s->sent_step);
    s->answers_missing = 0;
    for (uint32_t i = 0; i < s->process_count; i++) {
        struct session_process *p = &s->processes[i];
        bool joins = p->state == MEMBER_JOINING;
        if (joins && gives) {
            bool behind = p->sight != MEMBER_HAS_BODIES && s->mail_step < s->sent_step - 1;
            percepts_set_step(s, p, s->sent_step - behind);
            (void)percepts_write(p);
        }
        if (joins) {
            (void)member_on(p, MEMBER_JOINS);
        }
        s->answers_missing += under_way && member_is_in_steps(p) && p->answered < s->step;
    }
}

static mu_result nobody_report(struct session *s)
{
    char who[sizeof s->waits_for];
    (void)mu_text_copy(who, sizeof who, s->waits_for);
    struct mu_text said = mu_text_in(s->waits_for, sizeof s->waits_for);
    mu_text_format(&said, "died at step %lld and not back within %g s: %s", (long long)s->step,
                   (double)s->options.return_ns / 1e9, who);
    return MU_TIMEOUT;
}

/* @return whether only the mail of the last step is missing, which needs no process */
static bool is_last(const struct session *s)
{
    return s->options.duration_ns > 0 &&
           (uint64_t)s->step * s->options.step_ns >= s->options.duration_ns;
}

static mu_result others_await(struct session *s)
{
    uint64_t began_ns = mu_clock_ns();
    bool told = superseded_release(s) && roster_tell(s, true) == MU_OK;
    while (true) {
        inbox_take(s);
        told = told && !superseded_release(s); /* more processes may die meanwhile */
        told = told || roster_tell(s, true) == MU_OK;
        bool there = (is_last(s) && s->mail_step >= s->step - 1) || roster_is_complete(s);
        if (told && there) {
            return MU_OK;
        }
        if (phase_ends(s)) {
            return MU_DONE;
        }
        if (mu_clock_ns() - began_ns > s->options.return_ns) {
            return nobody_report(s);
        }
        (void)status_tell(s, false);
        bus_wait(s->bus, 1, RETURN_WAIT_NS);
    }
}

static void roster_tell_surely(struct session *s)
{
    while (roster_tell(s, true) != MU_OK && !phase_ends(s)) {
        bus_wait(s->bus, 1, RETURN_WAIT_NS);
    }
}

mu_result recover_await(struct session *s)
{
    (void)phase_on(s, PHASE_HOLDS);
    mu_result waited = others_await(s);
    if (waited != MU_OK) {
        return waited;
    }
    (void)phase_on(s, PHASE_RESUMES);
    mu_log(MU_LOG_INFO, "controllers-back", "step=%lld", (long long)s->step);
    roster_prune(s);
    roster_lay_out(s);
    percepts_fill_samples(s, false);
    steps_give(s);
    roster_tell_surely(s);
    s->last_step_wall_ns = s->pace_wall_ns = mu_clock_ns(); /* the patience starts here, */
    s->pace_step = s->step;                                 /* and so does the pace */
    return MU_OK;
}
