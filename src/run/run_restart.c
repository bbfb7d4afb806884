/* SPDX-License-Identifier: Apache-2.0 */
/* What dies under `on-crash: restart`: it is started again, a few times and each time later. */
#include "core/clock.h"
#include "core/exits.h"
#include "run/run.h"

#include <stdio.h>
#include <string.h>
#include <sys/wait.h>

static const uint64_t PAUSE_NS = 500000000; /* before the first time: a dead process is missed after
                                              a second; doubled for each one more */
static const uint64_t PAUSE_MAX_NS = 2000000000;
/* How long the word that the run is over may take, when a process has ended well, or not. */
static const uint64_t END_PATIENCE_NS = 5000000000u, CRASH_PATIENCE_NS = 100000000;

/* What is wrong with its files or its command line is so the next time, too. */
static bool is_hopeless(const struct child *child)
{
    int code = WIFEXITED(child->status) ? WEXITSTATUS(child->status) : 0;
    return code == MU_EXIT_FILE || code == MU_EXIT_USAGE || code == MU_EXIT_WRITE;
}

static uint64_t pause_ns(const struct child *child)
{
    uint64_t pause = child->restarts < 16 ? PAUSE_NS << child->restarts : PAUSE_MAX_NS;
    return pause < PAUSE_MAX_NS ? pause : PAUSE_MAX_NS;
}

static bool may_restart(const struct run *r, const struct child *child)
{
    return run_restarts(r, child) && (run_controller(r, child) || !is_hopeless(child)) &&
           child->restarts < r->experiment->restarts;
}

static void death_note(struct run *r, struct child *child)
{
    struct run_part part = run_part_of(r, child);
    uint64_t pause = pause_ns(child);
    supervise_explain(child);
    if (part.kind == RUN_BROKER) {
        run_mail_keep(r, child->name);
    }
    child->restart_ns = child->ended_ns + pause;
    child->restarts++;
    fprintf(stderr, "muster run: %s is started again in %.1f s (%u of %u)\n", child->name,
            (double)pause / 1e9, (unsigned)child->restarts, r->experiment->restarts);
}

static void given_up_note(const struct run *r, const struct child *child)
{
    if (run_restarts(r, child) && child->restarts > 0) {
        fprintf(stderr, "muster run: %s has been started again %u times: no more\n", child->name,
                (unsigned)child->restarts);
    }
}

/* A process may have ended because the run is over.  The simulator says so before, but on a busy
 * machine the word comes after the end is seen.  A broker does not end before the run. */
static bool end_may_come(const struct run *r, const struct child *child)
{
    bool well = WIFEXITED(child->status) && WEXITSTATUS(child->status) == 0;
    return run_part_of(r, child).kind != RUN_BROKER &&
           mu_clock_ns() - child->ended_ns < (well ? END_PATIENCE_NS : CRASH_PATIENCE_NS);
}

/* @return whether the child lives, is to, or may have ended with the run */
static bool child_restart(struct run *r, struct child *child)
{
    if (child->restart_ns == 0) {
        if (end_may_come(r, child)) {
            return true;
        }
        if (!may_restart(r, child)) {
            given_up_note(r, child);
            return false;
        }
        death_note(r, child);
    } else if (mu_clock_ns() >= child->restart_ns) {
        child->restart_ns = 0;
        child->returned = true;
        return run_start_again(r, child) == MU_OK;
    }
    return true;
}

/* --- processes without a checkpoint ----------------------------------------------------------- */

/* @return whether it is there, in its new process */
static bool robot_is_there(const struct run *r, const char *name, const struct child *child,
                           enum mu_state *state)
{
    const struct mu_member *m = mu_process_lookup(r->process, name);
    *state = m ? m->state : MU_GONE;
    return m && m->pid == (uint32_t)child->pid && m->state != MU_GONE && m->state != MU_MOVING;
}

static bool crew_is_there(const struct run *r, const struct experiment_crew *crew,
                          const struct child *child)
{
    enum mu_state state;
    bool all = true;
    for (unsigned i = 0; i < crew->count && all; i++) {
        all = robot_is_there(r, r->experiment->robots[crew->robot + i].name, child, &state);
    }
    return all;
}

/* While steps run no agent is in standby that was started once: this one begins anew. */
static void crew_begin(struct run *r, const struct experiment_crew *crew, const struct child *child)
{
    for (unsigned i = 0; i < crew->count; i++) {
        const char *name = r->experiment->robots[crew->robot + i].name;
        enum mu_state state;
        struct mu_mail mail = {.dst = name, .directive = true, .performative = "start"};
        if (!r->experiment->robots[crew->robot + i].standby &&
            robot_is_there(r, name, child, &state) && state == MU_STANDBY &&
            mu_agent_send(r->observer, &mail, NULL) != MU_OK) {
            fprintf(stderr, "muster run: %s cannot be told to start\n", name);
        }
    }
}

static void crew_returned(struct run *r, unsigned index, struct child *child)
{
    const struct experiment_crew *crew = &r->experiment->crews[index];
    if (crew_is_there(r, crew, child)) {
        child->returned = false;
        crew_begin(r, crew, child);
    }
}

/* With a host come those that begin on it and have not moved on. */
static void host_returned(struct run *r, const char *host, struct child *child)
{
    enum mu_state state;
    if (!robot_is_there(r, host, child, &state)) {
        return;
    }
    child->returned = false;
    for (unsigned i = 0; i < experiment_members(r->experiment); i++) {
        const struct experiment_robot *robot = &r->experiment->robots[i];
        if (robot->host && strcmp(robot->host, host) == 0) {
            struct experiment_crew one = {.robot = i, .count = 1};
            crew_begin(r, &one, child);
        }
    }
}

static void returned_look(struct run *r, struct child *child)
{
    struct run_part part = run_part_of(r, child);
    bool looked = part.kind == RUN_CREW || part.kind == RUN_HOST;
    if (!looked || r->state != muster_RUN_RUNNING) {
        child->returned = looked;
    } else if (part.kind == RUN_HOST) {
        host_returned(r, r->experiment->hosts[part.index], child);
    } else {
        crew_returned(r, part.index, child);
    }
}

const struct child *run_restart_look(struct run *r)
{
    const struct child *dead = NULL;
    for (uint32_t i = 0; i < r->children.count; i++) {
        struct child *child = &r->children.children[i];
        bool lives = !supervise_has_died(child) || child_restart(r, child);
        dead = dead || lives ? dead : child;
        if (child->returned && !child->ended && r->process) {
            returned_look(r, child);
        }
    }
    return dead;
}
