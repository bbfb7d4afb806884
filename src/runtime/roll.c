/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/roll.h"

#include "muster/version.h"
#include "runtime/process.h"

#include <unistd.h>

static char nothing[1];
static char version[] = MU_VERSION;

static void part_mark(mu_process *p, uint32_t part)
{
    p->roll.due_count += !p->roll.due[part];
    p->roll.due[part] = true;
}

static uint32_t parts_used(const mu_process *p)
{
    return (p->agent_count + MU_PART_AGENTS - 1) / MU_PART_AGENTS;
}

void roll_mark(struct mu_agent *a)
{
    part_mark(a->process, (uint32_t)(a - a->process->agents) / MU_PART_AGENTS);
}

void roll_mark_all(mu_process *p)
{
    for (uint32_t part = 0; part < parts_used(p); part++) {
        part_mark(p, part);
    }
}

/* @return whether a full broker has refused the name, and is asked again; no run has room for it */
static bool is_asked_again(const struct mu_agent *a)
{
    return a->name_state == NAME_REFUSED && a->refusal == MU_REFUSAL_FULL &&
           !process_in_lockstep(a->process);
}

void roll_refresh(mu_process *p)
{
    for (uint32_t i = 0; i < p->agent_count; i++) {
        if (i == 0 || is_asked_again(&p->agents[i])) {
            roll_mark(&p->agents[i]);
        }
    }
}

static muster_State state_of(const struct mu_agent *a)
{
    /* An agent that was refused gives the name up: it may have asked once more before it heard of
     * the refusal, and would get a name that it does not use. */
    if ((a->name_state == NAME_REFUSED && !is_asked_again(a)) || a->name_state == NAME_FOLLOWS) {
        return muster_STATE_ABSENT;
    }
    return (muster_State)(life_is_leaving(a) ? a->last_state : a->state);
}

static char *reason_of(struct mu_agent *a)
{
    if (a->exit == EXIT_LEFT) {
        return (char *)(uintptr_t)muster_REASON_DISPOSED; /* nothing is written there */
    }
    return a->reason[0] ? a->reason : a->process->busy;
}

static muster_Entry entry_of(struct mu_agent *a)
{
    return (muster_Entry){.name = a->name_state == NAME_FOLLOWS ? nothing : a->name,
                          .kind = (muster_Kind)a->kind,
                          .state = state_of(a),
                          .no_broadcasts = a->no_broadcasts,
                          .senses = a->senses,
                          .full = (muster_BoxPolicy)a->box_policy,
                          .box_mails = a->box_mails,
                          .box_bytes = a->box_bytes,
                          .home = nothing,
                          .via = nothing,
                          .host = nothing,
                          .since_wall_ns = a->since_wall_ns,
                          .epoch = a->epoch,
                          .newcomer =
                              a->name_state != NAME_ACCEPTED && a->name_state != NAME_ASKED_AGAIN,
                          .busy_since_wall_ns = a->process->busy_since_wall_ns,
                          .reason = reason_of(a)};
}

static muster_Registration part_of(mu_process *p, uint32_t part)
{
    muster_Registration r = {.process = p->name,
                             .part = part,
                             .wire = muster_WIRE,
                             .version = version,
                             .broker = p->link.broker,
                             .incarnation = p->incarnation,
                             .host = p->platform,
                             .pid = (uint32_t)getpid(),
                             .watches = p->role == PROCESS_WATCH,
                             .ready = p->steps >= PROCESS_READY};
    uint32_t first = part * MU_PART_AGENTS;
    uint32_t count = p->agent_count - first;
    count = count < MU_PART_AGENTS ? count : MU_PART_AGENTS;
    for (uint32_t i = 0; i < count; i++) {
        p->roll.entries[i] = entry_of(&p->agents[first + i]);
    }
    r.agents._buffer = p->roll.entries;
    r.agents._length = r.agents._maximum = count;
    return r;
}

static void part_said(mu_process *p, uint32_t part)
{
    uint32_t first = part * MU_PART_AGENTS;
    for (uint32_t i = first; i < p->agent_count && i < first + MU_PART_AGENTS; i++) {
        (void)life_name_on(&p->agents[i], NAME_WRITTEN);
    }
}

void roll_write(mu_process *p)
{
    if (p->link.broker[0] == '\0') {
        return; /* there is no receiver */
    }
    for (uint32_t part = 0; part < ROLL_PARTS && p->roll.due_count > 0; part++) {
        if (!p->roll.due[part]) {
            continue;
        }
        muster_Registration r = part_of(p, part);
        if (bus_write(&p->registration, &r) != MU_OK) {
            return;
        }
        part_said(p, part);
        p->roll.due[part] = false;
        p->roll.due_count--;
    }
}

void roll_end(mu_process *p)
{
    for (uint32_t part = 0; part < parts_used(p); part++) {
        muster_Registration r = {
            .process = p->name, .part = part, .version = version, .broker = nothing};
        r.host = nothing;
        bus_dispose(&p->registration, &r);
    }
}
