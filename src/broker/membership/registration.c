/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/membership/membership.h"

#include "broker/control/parts.h"
#include "core/name.h"
#include "muster/version.h"

#include <string.h>

/* --- claims ----------------------------------------------------------------------------------- */

/* @return whether the part says that the slot bears another name than this */
static bool slot_is_others(const muster_Registration *r, uint32_t slot, const char *name)
{
    uint32_t index = slot % MU_PART_AGENTS;
    if (slot / MU_PART_AGENTS != r->part || index >= r->agents._length) {
        return false;
    }
    const char *now = r->agents._buffer[index].name;
    return now[0] != '\0' && strcmp(now, name) != 0;
}

/* Ends the claims of a process: of one part alone, if that is not MU_NONE, and only where a slot
 * bears another name now, if the part is given; what is given to such a one would not be taken. */
static void claims_end(struct broker *b, uint32_t place, uint32_t part,
                       const muster_Registration *now)
{
    uint32_t next = MU_NONE;
    uint32_t left = b->processes.at[place].claims;
    for (uint32_t i = mu_list_first(&b->claims.list); i != MU_NONE && left > 0; i = next) {
        const struct claim *claim = &b->claims.at[i];
        next = mu_list_next(MU_LINKS(b->claims.at, link), i);
        if (claim->process != place) {
            continue;
        }
        left--;
        const char *name = b->registry.agents[claim->agent].name;
        if ((part == MU_NONE || claim->slot / MU_PART_AGENTS == part) &&
            (!now || slot_is_others(now, claim->slot, name))) {
            lifecycle_end_claim(b, i);
        }
    }
}

/* --- coming and going ------------------------------------------------------------------------- */

/* A run that goes by steps does not let go of an agent before it ends. */
static void presence_leave(struct broker *b, uint32_t agent)
{
    if (scope_is_paced(b->registry.agents[agent].scope)) {
        b->registry.agents[agent].report = REPORT_GONE;
    } else {
        lifecycle_depart(b, agent);
    }
}

/* Copies what is shown on terminals; other bytes than least to ~ become ?. */
static void shown_copy(char to[MU_FIELD_MAX + 1], const char *text, char least)
{
    (void)mu_text_copy(to, MU_FIELD_MAX + 1, text);
    for (char *c = to; *c; c++) {
        *c = *c >= least && *c <= '~' ? *c : '?';
    }
}

void registration_presence(const muster_Entry *e, const char *host, uint32_t pid,
                           struct presence *is)
{
    uint32_t box_bytes = e->box_bytes < UINT32_MAX ? (uint32_t)e->box_bytes : UINT32_MAX;
    *is = (struct presence){.kind = e->kind,
                            .state = e->state,
                            .no_broadcasts = e->no_broadcasts,
                            .box = {e->full, e->box_mails, box_bytes},
                            .hops = e->hops,
                            .since_wall_ns = e->since_wall_ns,
                            .epoch = e->epoch,
                            .newcomer = e->newcomer,
                            .pid = pid,
                            .busy_since_wall_ns = e->busy_since_wall_ns};
    (void)mu_text_copy(is->home, sizeof is->home, e->home);
    /* The host stands in lines whose fields a space parts, the reason is words of rules. */
    shown_copy(is->host, e->kind == muster_KIND_HOST ? "" : host, '!');
    shown_copy(is->reason, e->reason, ' ');
}

/* A broker that has just begun, and knows of no bearer, gives a name to the first process that
 * comes. */
static bool outlived_a_broker(const struct broker *b, uint32_t agent, const struct presence *is)
{
    const struct agent *a = &b->registry.agents[agent];
    return !is->newcomer && b->clock.now_ns < NAMES_HOLD_NS && is->since_wall_ns > 0 &&
           is->since_wall_ns < a->is.since_wall_ns && a->is.home[0] == '\0' &&
           !scope_is_inside(a->scope);
}

static void claim_admit(struct broker *b, struct claim *c)
{
    uint32_t agent = c->agent, place = c->process;
    struct agent *a = &b->registry.agents[agent];
    const struct presence *is = &c->presence;
    if (a->process != place && snapshots_overrule(b, agent, place, is)) {
        b->processes.at[place].overruled = true;
        return;
    }
    bool is_other = a->resident.slot != c->slot ||
                    (a->report != REPORT_AWAITED && a->is.since_wall_ns != is->since_wall_ns);
    if (a->process == place && is_other && !scope_is_inside(b->processes.at[place].scope)) {
        a->kept_until_ns = 0;       /* the agent that it was kept for had come */
        lifecycle_depart(b, agent); /* the name went to another agent of the same process */
    }
    if (a->process == MU_NONE && is->epoch > 0 && snapshots_epoch(b, agent) > is->epoch) {
        processes_refuse(&b->processes, place, a->name, muster_REFUSAL_OUT_OF_DATE, "out of date");
    } else if (is->newcomer && names_is_held(b, agent) && !lifecycle_is_copy(b, agent, is)) {
        lifecycle_claim(b, c);
    } else if (a->process == MU_NONE) {
        lifecycle_seat(b, c);
        lifecycle_review(b, agent);
    } else if (a->process == place) {
        lifecycle_reregister(b, c);
    } else if (b->processes.at[a->process].kind == PROCESS_BROKER &&
               a->is.since_wall_ns == is->since_wall_ns) { /* it has moved here */
        lifecycle_move(b, c);
    } else if (outlived_a_broker(b, agent, is)) {
        lifecycle_refuse_held(b, agent, a->process, a->is.home);
        lifecycle_move(b, c);
    } else {
        lifecycle_claim(b, c);
    }
}

/* The agent in that slot, and no other of its name, has left, or no longer wants its name. */
static void slot_leave(struct broker *b, uint32_t agent, uint32_t place, uint32_t slot,
                       bool disposed)
{
    const struct agent *a = &b->registry.agents[agent];
    uint32_t claim = claims_find(&b->claims, &a->claims, place);
    if (claim != MU_NONE) {
        if (b->claims.at[claim].slot == slot) {
            lifecycle_end_claim(b, claim);
        }
    } else if (a->process == place && a->resident.slot == slot) {
        if (disposed) {
            registry_named_on(&b->registry, agent, NAMED_DISPOSED);
        }
        presence_leave(b, agent);
    }
}

/* What is left of a nearly full store is first for the agents that it knew: a newcomer asks again.
 */
static bool room_is_kept(const struct broker *b, const muster_Entry *e)
{
    return b->registry.roomless > 0 && e->newcomer && b->clock.now_ns < NAMES_HOLD_NS;
}

/* What a part says of one slot. */
static void entry_take(struct broker *b, uint32_t place, const muster_Registration *r,
                       uint32_t index)
{
    const muster_Entry *e = &r->agents._buffer[index];
    uint32_t slot = r->part * MU_PART_AGENTS + index;
    const char *objection = registry_objection(e->name, e->kind);
    muster_Refusal code = muster_REFUSAL_NOT_A_NAME;
    uint32_t agent = objection ? MU_NONE : registry_find(&b->registry, e->name);
    if (e->state == muster_STATE_ABSENT) {
        if (agent != MU_NONE) {
            slot_leave(b, agent, place, slot, strcmp(e->reason, muster_REASON_DISPOSED) == 0);
        }
        return;
    }
    if (!objection && agent == MU_NONE) {
        agent = room_is_kept(b, e) ? MU_NONE : registry_add(&b->registry, e->name);
        if (agent == MU_NONE && e->kind == muster_KIND_SPECIAL) {
            agent = registry_add_command(&b->registry, e->name);
        }
        objection = agent == MU_NONE ? "the white pages are full" : NULL;
        code = muster_REFUSAL_FULL;
    }
    if (objection) {
        b->counters.malformed += !mu_name_valid(e->name);
        processes_refuse(&b->processes, place, e->name, code, objection);
        return;
    }
    struct claim claim = {.agent = agent, .process = place, .slot = slot};
    registration_presence(e, r->host, r->pid, &claim.presence);
    claim_admit(b, &claim);
}

/* Lets go of the agents of a part; if that is given, of those whose slots bear other names now. */
static void agents_leave(struct broker *b, uint32_t place, uint32_t part,
                         const muster_Registration *now)
{
    uint32_t next = MU_NONE;
    const struct mu_list *agents = &b->processes.at[place].parts[part];
    for (uint32_t agent = mu_list_first(agents); agent != MU_NONE; agent = next) {
        next = processes_next_agent_of(b, agent);
        const struct agent *a = &b->registry.agents[agent];
        if (!now || slot_is_others(now, a->resident.slot, a->name)) {
            presence_leave(b, agent);
        }
    }
}

static void part_leave(struct broker *b, uint32_t place, uint32_t part,
                       const muster_Registration *now)
{
    claims_end(b, place, part, now);
    agents_leave(b, place, part, now);
}

static void process_leave(struct broker *b, uint32_t place)
{
    uint32_t top = b->processes.at[place].parts_top;
    claims_end(b, place, MU_NONE, NULL);
    for (uint32_t part = 0; part < top; part++) {
        agents_leave(b, place, part, NULL);
    }
}

/* Finds or enters a process that registers.  @return MU_NONE: it is not to be heard */
static uint32_t process_hear(struct broker *b, const muster_Registration *r)
{
    uint32_t place = processes_get(&b->processes, r->process);
    if (place == MU_NONE) {
        b->counters.malformed++;
        return MU_NONE;
    }
    struct process *at = &b->processes.at[place];
    if (r->incarnation < at->incarnation) {
        return MU_NONE; /* late, from a process that is no more */
    }
    at->speaks = true; /* it stays, if agents leave it or not */
    /* Its pages are empty, if we saw its agents go, too. */
    if (r->incarnation > at->incarnation) {
        if (at->agents_count > 0) {
            process_leave(b, place);
        }
        at->version_had = at->groups_had = at->services_had = 0;
    }
    at->incarnation = r->incarnation;
    enum process_kind kind = r->watches ? PROCESS_ONLOOKERS : PROCESS_PLAIN;
    if (at->kind != kind) {
        at->kind = kind;
        steps_mark_residents(b, place);
    }
    if (processes_is_silent(at)) {
        processes_session_on(&b->processes, place, SESSION_HEARD);
        at->roll_call_due = r->part > 0 || at->parts_top > 1;
        processes_wake(&b->processes, place);
    }
    return place;
}

void registration_take(struct broker *b, const muster_Registration *r)
{
    if (r->broker[0] != '\0' && strcmp(r->broker, b->name) != 0) {
        uint32_t left = processes_find(&b->processes, r->process);
        if (left != MU_NONE) {
            if (r->part == 0) {
                probes_gone(b, left); /* it answers to the other one now */
            }
            part_leave(b, left, r->part, NULL);
        }
        return;
    }
    uint32_t place = process_hear(b, r);
    if (place == MU_NONE) {
        return;
    }
    part_leave(b, place, r->part, r);
    for (uint32_t i = 0; i < r->agents._length; i++) {
        const muster_Entry *e = &r->agents._buffer[i];
        if (r->wire != muster_WIRE) {
            processes_refuse(&b->processes, place, e->name, muster_REFUSAL_VERSION,
                             "this broker is muster " MU_VERSION "; use programs of that version");
        } else if (!validate_entry(e, false)) {
            b->counters.malformed++;
        } else if (e->name[0] != '\0' || e->state != muster_STATE_ABSENT) {
            entry_take(b, place, r, i);
        }
    }
    b->processes.at[place].speaks = false;
    processes_tidy(&b->processes, place);
}

void registration_gone(struct broker *b, uint32_t place, uint32_t part, bool crashed)
{
    if (crashed) {
        processes_session_on(&b->processes, place, SESSION_SILENT);
        snapshots_process_gone(b, place);
        probes_gone(b, place);
        process_leave(b, place);
    } else if (part < PROCESSES_PARTS) {
        if (part == 0) {
            snapshots_process_gone(b, place);
            probes_gone(b, place);
        }
        part_leave(b, place, part, NULL);
    }
}
