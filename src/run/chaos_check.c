/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What of an experiment's chaos cannot be done, before anything starts.
 *
 * In lock step the clock waits for a process that is dead, stopped or cut off: no simulated time
 * passes until it is back. So nothing that is due later can bring it back, and no simulated time
 * can count how long it is away.
 */
#include "run/chaos.h"

#include <string.h>

static mu_result refuse(const struct run *r, struct experiment_mark mark, struct mu_fault *fault,
                        const char *who, const char *why)
{
    return mu_fault_at(fault, r->experiment->file, mark.line, mark.column, "'%.40s': %s", who, why);
}

static bool is_robot(const struct run *r, const char *part)
{
    return experiment_robot_find(r->experiment, part) >= 0;
}

static bool is_simulator(const char *part)
{
    return strcmp(part, "simulator") == 0;
}

static bool has_host(const struct run *r, const char *part)
{
    int robot = experiment_robot_find(r->experiment, part);
    return robot >= 0 && r->experiment->robots[robot].host;
}

static bool are_due_together(const struct experiment_chaos *one,
                             const struct experiment_chaos *other)
{
    return one->when && other->when ? strcmp(one->when, other->when) == 0
                                    : !one->when && !other->when && one->at == other->at;
}

/* @return whether something kills a part in the step in which this one, behind it in the file, is
 * due */
static bool is_killed_then(const struct run *r, unsigned index)
{
    const struct experiment_chaos *c = r->experiment->chaos;
    for (unsigned i = 0; i < index; i++) {
        if (c[i].kind == CHAOS_KILL && strcmp(c[i].who, c[index].who) == 0 &&
            are_due_together(&c[i], &c[index])) {
            return true;
        }
    }
    return false;
}

/* The process that the chaos is to start again. */
static mu_result return_check(const struct run *r, const struct experiment_chaos *c,
                              struct mu_fault *fault)
{
    bool lockstep = !r->options.free;
    if (is_simulator(c->who)) {
        return refuse(r, c->mark, fault, c->who, "it does not come back: the world is in it alone");
    }
    if (has_host(r, c->who)) {
        return refuse(r, c->mark, fault, c->who, "it does not come back: it lives on a host");
    }
    if (lockstep && !is_robot(r, c->who) && !experiment_is_resolver(r->experiment, c->who)) {
        return refuse(r, c->mark, fault, c->who,
                      "in lock step it does not come back: the mail of the step is in it alone");
    }
    return MU_OK;
}

static mu_result restart_check(const struct run *r, unsigned index, struct mu_fault *fault)
{
    const struct experiment_chaos *c = &r->experiment->chaos[index];
    mu_result returns = return_check(r, c, fault);
    if (returns != MU_OK || r->options.free || is_killed_then(r, index)) {
        return returns;
    }
    return refuse(r, c->mark, fault, c->who,
                  "in lock step the clock waits for what is killed, so that this time never comes: "
                  "expected a kill of it before, with the same `at` or `when`, or wall_s beside "
                  "the kill");
}

static bool is_broker(const struct run *r, const char *part)
{
    char name[RUN_CHILD_MAX];
    bool is = false;
    for (unsigned i = 0; i < run_brokers(r) && !is; i++) {
        run_child_name(r, i, name);
        is = strcmp(part, name) == 0 || strcmp(part, run_broker(r, i)) == 0;
    }
    return is;
}

/* In lock step a run ends with a process that does not come back. */
static mu_result kill_check(const struct run *r, unsigned index, struct mu_fault *fault)
{
    const struct experiment_chaos *c = &r->experiment->chaos[index];
    int robot = experiment_robot_find(r->experiment, c->who);
    if (chaos_restarts(r, index)) {
        return c->for_s > 0 || c->wall_s > 0 ? return_check(r, c, fault) : MU_OK;
    }
    if (r->options.free) {
        return MU_OK;
    }
    if (is_simulator(c->who) || is_broker(r, c->who)) {
        return return_check(r, c, fault);
    }
    const struct experiment *e = r->experiment;
    bool own = robot >= 0 && !has_host(r, c->who); /* a process of its own */
    bool restarts = (own ? e->robots[robot].on_crash : e->on_crash) == EXPERIMENT_RESTART;
    return restarts ? MU_OK
                    : refuse(r, c->mark, fault, c->who,
                             "in lock step the run would end with it, for nothing starts it again: "
                             "expected wall_s beside the kill, a restart that is due with it, or "
                             "on-crash: restart");
}

/* The clock stands while a process is away. */
static bool stops_clock(const struct experiment_chaos *c)
{
    return c->kind == CHAOS_KILL || c->kind == CHAOS_STOP || c->kind == CHAOS_CUT ||
           (c->kind == CHAOS_LOSE && c->share >= 1);
}

static mu_result piece_check(const struct run *r, unsigned index, struct mu_fault *fault)
{
    const struct experiment_chaos *c = &r->experiment->chaos[index];
    bool lockstep = !r->options.free;
    if (lockstep && c->for_s > 0 && stops_clock(c)) {
        return refuse(r, c->for_mark, fault, c->who,
                      "in lock step the clock waits for it, so that no simulated time passes: "
                      "expected wall_s, a time of the clock on the wall, instead of for");
    }
    if (lockstep && c->kind == CHAOS_CONTINUE) {
        return refuse(r, c->mark, fault, c->who,
                      "in lock step the clock waits for what is stopped, so that this time never "
                      "comes: expected wall_s beside the stop");
    }
    if (c->kind == CHAOS_RESTART) {
        return restart_check(r, index, fault);
    }
    return c->kind == CHAOS_KILL ? kill_check(r, index, fault) : MU_OK;
}

mu_result chaos_check(const struct run *r, struct mu_fault *fault)
{
    mu_result checked = MU_OK;
    for (unsigned i = 0; i < r->experiment->chaos_count && checked == MU_OK; i++) {
        checked = piece_check(r, i, fault);
    }
    return checked;
}

bool chaos_restarts_any(const struct run *r)
{
    bool any = false;
    for (unsigned i = 0; i < r->experiment->chaos_count; i++) {
        const struct experiment_chaos *c = &r->experiment->chaos[i];
        any = any || c->kind == CHAOS_RESTART || (c->kind == CHAOS_KILL && c->wall_s > 0);
    }
    return any;
}

bool chaos_restarts(const struct run *r, unsigned index)
{
    const struct experiment_chaos *c = r->experiment->chaos;
    bool restarts = c[index].for_s > 0 || c[index].wall_s > 0;
    for (unsigned i = index + 1; i < r->experiment->chaos_count; i++) {
        restarts = restarts || (c[i].kind == CHAOS_RESTART && strcmp(c[i].who, c[index].who) == 0);
    }
    return restarts;
}
