/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/membership/presence.h"

#include "broker/base/border.h"
#include "broker/control/parts.h"
#include "broker/mail/journal.h"
#include "core/name.h"
#include "core/text.h"

#include <string.h>

uint64_t presence_wall_ns(const struct broker *b)
{
    return b->wall_ns + b->clock.now_ns;
}

bool presence_is_paced(const struct broker *b, uint32_t agent)
{
    uint32_t place = b->registry.agents[agent].process;
    return place != MU_NONE && b->places.at[place].rostered;
}

bool presence_in_lockstep(const struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    bool looks_on = a->process != MU_NONE && b->places.at[a->process].watches &&
                    a->is.kind == muster_KIND_SPECIAL;
    return presence_is_paced(b, agent) && !looks_on;
}

void presence_seated(struct broker *b, uint32_t agent, uint64_t number)
{
    struct agent *a = &b->registry.agents[agent];
    a->seated = a->seated || number > a->seated_above;
}

bool presence_is_beyond(const struct broker *b, uint32_t agent)
{
    uint32_t place = b->registry.agents[agent].process;
    return place != MU_NONE && b->places.at[place].is_broker;
}

/* The white pages have changed: whoever may be told at any time is. */
static void presence_changed(struct broker *b)
{
    if (b->places.all_awake) {
        return;
    }
    for (uint32_t i = 0; i < b->places.top; i++) {
        if (b->places.at[i].used && b->places.at[i].matched) {
            places_wake(&b->places, i);
        }
    }
    b->places.all_awake = true;
}

/* --- claims ----------------------------------------------------------------------------------- */

/* Who bore the name is on the way here: from a broker that is no more, or to another platform. */
static bool is_kept(const struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    return a->process == MU_NONE && a->kept_until_ns > b->clock.now_ns;
}

/* @return who holds a name, as the reason of a refusal */
static const char *holder_of(struct broker *b, uint32_t agent)
{
    const char *home = b->registry.agents[agent].is.home;
    return home[0] ? liaison_holder(b, home) : "held by another participant";
}

static struct claim claim_take(struct broker *b, uint32_t index)
{
    struct claim claim = b->claims.pool[index];
    claims_drop(&b->claims, &b->registry.agents[claim.agent].claim, index);
    b->places.at[claim.process].claims--;
    return claim;
}

static void claim_end(struct broker *b, uint32_t index)
{
    uint32_t place = claim_take(b, index).process;
    places_tidy(&b->places, place);
}

/* A copy of an agent that has set out anew since, or has stayed after all.  Who never moved is
 * another agent of that name. */
static bool is_out_of_date(const struct presence *copy, const struct presence *now)
{
    return copy->epoch > 0 && copy->epoch < now->epoch;
}

static void claim_refuse(struct broker *b, uint32_t index, muster_Refusal code, const char *reason)
{
    const struct claim *claim = &b->claims.pool[index];
    places_refuse(&b->places, claim->process, b->registry.agents[claim->agent].name, code, reason);
    claim_end(b, index);
}

/* Its holder waits for the name no longer, and may have moved on from copies that do. */
static void claims_review(struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    uint32_t behind = MU_NONE;
    for (uint32_t i = a->claim; i != MU_NONE; i = behind) {
        behind = b->claims.pool[i].behind;
        if (b->claims.pool[i].process == a->process) {
            claim_end(b, i);
        } else if (is_out_of_date(&b->claims.pool[i].presence, &a->is)) {
            claim_refuse(b, i, muster_REFUSAL_OUT_OF_DATE, "out of date");
        }
    }
}

/* @return when who begins to wait now has waited long enough */
static uint64_t hold_end_ns(const struct broker *b)
{
    uint64_t now_ns = b->clock.now_ns;
    return now_ns + b->hold_ns < now_ns ? UINT64_MAX : now_ns + b->hold_ns;
}

void presence_keep(struct broker *b, uint32_t agent)
{
    /* Commands bear theirs in turn, each for a moment. */
    if (b->registry.agents[agent].is.kind != muster_KIND_SPECIAL) {
        b->registry.agents[agent].kept_until_ns = hold_end_ns(b);
    }
}

/* All who wait for a name begin anew, in the order that they have. */
static void claims_renew(struct broker *b, uint32_t agent)
{
    uint32_t *first = &b->registry.agents[agent].claim, count = 0;
    for (uint32_t i = *first; i != MU_NONE; i = b->claims.pool[i].behind) {
        count++;
    }
    for (; count > 0; count--) {
        struct claim claim = b->claims.pool[*first];
        claims_drop(&b->claims, first, *first);
        claim.until_ns = hold_end_ns(b);
        bool fits = claims_add(&b->claims, first, &claim);
        MU_ASSERT(fits);
    }
}

static void claim_make(struct broker *b, uint32_t agent, uint32_t place, uint32_t slot,
                       const struct presence *is)
{
    struct agent *a = &b->registry.agents[agent];
    const struct claim claim = {.agent = agent,
                                .process = place,
                                .slot = slot,
                                .until_ns = hold_end_ns(b),
                                .presence = *is};
    uint32_t had = claims_find(&b->claims, a->claim, place);
    if (is_out_of_date(is, &a->is)) {
        places_refuse(&b->places, place, a->name, muster_REFUSAL_OUT_OF_DATE, "out of date");
    } else if (had != MU_NONE) {
        b->claims.pool[had].slot = slot;
        b->claims.pool[had].presence = *is;
    } else if (claims_add(&b->claims, &a->claim, &claim)) {
        b->places.at[place].claims++;
    } else {
        places_refuse(&b->places, place, a->name, muster_REFUSAL_NAME_HELD, holder_of(b, agent));
    }
}

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

/* Ends the claims of a place: of one part alone, if that is not MU_NONE, and only where a slot
 * bears another name now, if the part is given; nobody would take what is given to such a one. */
static void claims_end(struct broker *b, uint32_t place, uint32_t part,
                       const muster_Registration *now)
{
    uint32_t next = MU_NONE;
    uint32_t left = b->places.at[place].claims;
    for (uint32_t i = b->claims.first; i != MU_NONE && left > 0; i = next) {
        const struct claim *claim = &b->claims.pool[i];
        next = claim->next;
        if (claim->process != place) {
            continue;
        }
        left--;
        const char *name = b->registry.agents[claim->agent].name;
        if ((part == MU_NONE || claim->slot / MU_PART_AGENTS == part) &&
            (!now || slot_is_others(now, claim->slot, name))) {
            claim_end(b, i);
        }
    }
}

/* It is the last bearer itself, which has set out for there. */
static bool is_copy(const struct agent *a, const struct presence *is)
{
    return is->epoch > 0 && is->epoch == a->is.epoch;
}

/* @return the claim of the place for which the last bearer has set out, or MU_NONE */
static uint32_t copy_claim(const struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    uint32_t i = a->claim;
    while (i != MU_NONE && !is_copy(a, &b->claims.pool[i].presence)) {
        i = b->claims.pool[i].behind;
    }
    return i;
}

/* A name that nobody has any more goes to who waits for it, if a lock step lets it. */
static void claims_grant(struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    while (a->process == MU_NONE && a->claim != MU_NONE) {
        uint32_t copy = copy_claim(b, agent);
        struct claim heir = claim_take(b, copy != MU_NONE ? copy : a->claim);
        if (depot_overrules(b, agent, heir.process, &heir.presence)) {
            b->places.at[heir.process].overruled = true;
            places_tidy(&b->places, heir.process);
        } else {
            presence_seat(b, agent, heir.process, heir.slot, &heir.presence);
        }
    }
}

void presence_tick(struct broker *b)
{
    while (presence_deadline_ns(b) <= b->clock.now_ns) {
        uint32_t index = b->claims.first, agent = b->claims.pool[index].agent;
        if (b->registry.agents[agent].process == MU_NONE) {
            claims_grant(b, agent); /* whom the name was kept for has not come */
        } else {
            claim_refuse(b, index, muster_REFUSAL_NAME_HELD, holder_of(b, agent));
        }
    }
}

uint64_t presence_deadline_ns(const struct broker *b)
{
    uint32_t first = b->claims.first;
    return first != MU_NONE ? b->claims.pool[first].until_ns : UINT64_MAX;
}

/* --- who lives where -------------------------------------------------------------------------- */

/* The box obeys what its agent declares. */
static void box_follow(struct broker *b, uint32_t agent, const struct presence *is)
{
    const struct presence *was = &b->registry.agents[agent].is;
    if (is->full != was->full || is->box_mails != was->box_mails ||
        is->box_bytes != was->box_bytes) {
        uint32_t bytes = is->box_bytes < UINT32_MAX ? (uint32_t)is->box_bytes : UINT32_MAX;
        mailbox_set_limits(&b->mailbox, agent, is->full, is->box_mails, bytes);
    }
}

/* A process is told that it has the name; another broker, where a box goes on that others have had
 * something from. */
static void verdict_owe(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    a->seated = false;
    a->seated_above = mailbox_last_number(&b->mailbox, agent);
    a->verdict_due = !b->places.at[a->process].is_broker || mailbox_is_begun(&b->mailbox, agent);
}

void presence_tell_number(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    if (a->process != MU_NONE && b->places.at[a->process].is_broker) {
        a->verdict_due = true;
    }
}

void presence_tell_again(struct broker *b, uint32_t place)
{
    pages_forget_told(&b->places.at[place]);
    for (uint32_t agent = tenants_first(&b->places, place); agent != TENANTS_NONE;
         agent = tenants_next(&b->registry, &b->places, agent)) {
        verdict_owe(b, agent);
        mailbox_repeat(&b->mailbox, agent);
        tenants_wake(&b->registry, &b->places, agent);
    }
    places_wake(&b->places, place);
}

/* What the agent has had in its box before is for its new process to have again. */
void presence_seat(struct broker *b, uint32_t agent, uint32_t place, uint32_t slot,
                   const struct presence *is)
{
    tenants_add(&b->registry, &b->places, place, slot, agent);
    places_accept(&b->places, place, b->registry.agents[agent].name);
    box_follow(b, agent, is);
    registry_seat(&b->registry, agent, place, b->places.at[place].name, is, presence_wall_ns(b));
    verdict_owe(b, agent);
    journal_agent(b, agent);
    mailbox_repeat(&b->mailbox, agent);
    presence_changed(b);
    pages_presence(b, agent);
    tenants_wake(&b->registry, &b->places, agent);
    claims_review(b, agent);
    depot_review(b, agent);
}

void presence_move(struct broker *b, uint32_t agent, uint32_t place, uint32_t slot,
                   const struct presence *is)
{
    uint32_t from = b->registry.agents[agent].process;
    tenants_remove(&b->registry, &b->places, agent);
    mailbox_unwatch(&b->mailbox, agent);
    b->registry.agents[agent].left = b->places.at[from].seat;
    b->registry.agents[agent].left_wall_ns = b->registry.agents[agent].is.since_wall_ns;
    b->registry.agents[agent].passed = true;
    presence_seat(b, agent, place, slot, is);
    places_tidy(&b->places, from);
}

void presence_depart(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    uint32_t place = a->process;
    tenants_remove(&b->registry, &b->places, agent);
    registry_unseat(&b->registry, agent, presence_wall_ns(b));
    a->ended = b->lockstep.applying;
    a->passed = a->ended;
    mailbox_unwatch(&b->mailbox, agent);
    mailbox_repeat(&b->mailbox, agent);
    if (b->places.at[place].is_broker) {
        a->awaited = true; /* it is only out of sight: what it is to be told waits */
    } else if (b->places.at[place].lost && a->claim == MU_NONE) {
        journal_await(b, agent);
    } else {
        receipts_drop(&b->receipts, agent, receipts_of(&b->receipts, agent)->count);
    }
    presence_changed(b);
    pages_presence(b, agent);
    if (!b->lockstep.on && depot_keeps(b, agent)) {
        presence_keep(b, agent);
    }
    if (is_kept(b, agent) && copy_claim(b, agent) == MU_NONE) {
        claims_renew(b, agent);
    } else {
        claims_grant(b, agent);
    }
    places_tidy(&b->places, place);
    liaison_review(b, agent);
}

/* --- coming and going ------------------------------------------------------------------------- */

void presence_set_state(struct broker *b, uint32_t agent, muster_State state)
{
    if (registry_set_state(&b->registry, agent, state, presence_wall_ns(b))) {
        presence_changed(b);
        tenants_wake(&b->registry, &b->places, agent);
    }
}

/* A lock step does not let go of an agent before it ends. */
static void presence_leave(struct broker *b, uint32_t agent)
{
    if (presence_is_paced(b, agent)) {
        b->registry.agents[agent].gone = true;
    } else {
        presence_depart(b, agent);
    }
}

/* What is said of it when a step has ended does not hide from the others what the step has changed.
 */
static void step_version_keep(struct broker *b, uint32_t agent)
{
    uint64_t version = changes_version(&b->registry.changes, agent);
    if (presence_in_lockstep(b, agent) && version <= b->lockstep.version) {
        b->registry.agents[agent].step_version = version;
    }
}

/* A registration from the process that has the name already. */
void presence_reregister(struct broker *b, uint32_t agent, uint32_t slot, struct presence *is)
{
    struct agent *a = &b->registry.agents[agent];
    a->gone = false;
    if (presence_in_lockstep(b, agent)) {
        is->state = a->is.state;
    }
    if (a->tenant.slot != slot) {
        uint32_t place = a->process;
        tenants_remove(&b->registry, &b->places, agent);
        tenants_add(&b->registry, &b->places, place, slot, agent);
        tenants_wake(&b->registry, &b->places, agent);
    }
    box_follow(b, agent, is);
    step_version_keep(b, agent);
    if (registry_update(&b->registry, agent, is, presence_wall_ns(b))) {
        journal_agent(b, agent);
        presence_changed(b);
        tenants_wake(&b->registry, &b->places, agent);
    }
    claims_review(b, agent);
    depot_review(b, agent);
}

/* The host is shown, in lines whose fields a space parts: what is no part of a host's name is not.
 */
static void host_copy(char to[MU_FIELD_MAX + 1], const char *host)
{
    (void)mu_text_copy(to, MU_FIELD_MAX + 1, host);
    for (char *c = to; *c; c++) {
        *c = *c > ' ' && *c <= '~' ? *c : '?';
    }
}

/* Words of somebody's rules, which end on a terminal. */
static void reason_copy(char to[MU_FIELD_MAX + 1], const char *reason)
{
    (void)mu_text_copy(to, MU_FIELD_MAX + 1, reason ? reason : "");
    for (char *c = to; *c; c++) {
        *c = *c >= ' ' && *c <= '~' ? *c : '?';
    }
}

static void presence_of(const muster_Registration *r, const muster_Entry *e, struct presence *is)
{
    *is = (struct presence){.kind = e->kind,
                            .state = e->state,
                            .no_broadcasts = e->no_broadcasts,
                            .full = e->full,
                            .box_mails = e->box_mails,
                            .box_bytes = e->box_bytes,
                            .hops = e->hops,
                            .since_wall_ns = e->since_wall_ns,
                            .epoch = e->epoch,
                            .newcomer = e->newcomer,
                            .pid = r->pid,
                            .busy_since_wall_ns = e->busy_since_wall_ns};
    (void)mu_text_copy(is->home, sizeof is->home, e->home);
    host_copy(is->host, e->kind == muster_KIND_HOST ? "" : r->host);
    reason_copy(is->reason, e->reason);
}

/* A broker that has just begun, and knows of no bearer, gives a name to whoever comes first. */
static bool outlived_a_broker(const struct broker *b, uint32_t agent, const struct presence *is)
{
    const struct agent *a = &b->registry.agents[agent];
    return !is->newcomer && b->clock.now_ns < b->hold_ns && is->since_wall_ns > 0 &&
           is->since_wall_ns < a->is.since_wall_ns && a->is.home[0] == '\0' &&
           !presence_in_lockstep(b, agent);
}

static void presence_admit(struct broker *b, uint32_t agent, uint32_t place, uint32_t slot,
                           struct presence *is)
{
    const struct agent *a = &b->registry.agents[agent];
    if (a->process != place && depot_overrules(b, agent, place, is)) {
        b->places.at[place].overruled = true;
        return;
    }
    bool is_other =
        a->tenant.slot != slot || (!a->handed && a->is.since_wall_ns != is->since_wall_ns);
    if (a->process == place && is_other && !b->places.at[place].rostered) {
        b->registry.agents[agent].kept_until_ns = 0; /* whom it was kept for had come */
        presence_depart(b, agent); /* the name went to another agent of the same process */
    }
    if (a->process == MU_NONE && depot_has_later(b, agent, is->epoch)) {
        places_refuse(&b->places, place, a->name, muster_REFUSAL_OUT_OF_DATE, "out of date");
    } else if (is->newcomer && is_kept(b, agent) && !is_copy(a, is)) {
        claim_make(b, agent, place, slot, is);
    } else if (a->process == MU_NONE) {
        presence_seat(b, agent, place, slot, is);
        liaison_review(b, agent);
    } else if (a->process == place) {
        presence_reregister(b, agent, slot, is);
    } else if (b->places.at[a->process].is_broker &&
               a->is.since_wall_ns == is->since_wall_ns) { /* it has moved here */
        presence_move(b, agent, place, slot, is);
    } else if (outlived_a_broker(b, agent, is)) {
        places_refuse(&b->places, a->process, a->name, muster_REFUSAL_NAME_HELD,
                      holder_of(b, agent));
        presence_move(b, agent, place, slot, is);
    } else {
        claim_make(b, agent, place, slot, is);
    }
}

/* The agent in that slot, and no other of its name, has left, or no longer wants its name. */
static void slot_leave(struct broker *b, uint32_t agent, uint32_t place, uint32_t slot)
{
    const struct agent *a = &b->registry.agents[agent];
    uint32_t claim = claims_find(&b->claims, a->claim, place);
    if (claim != MU_NONE) {
        if (b->claims.pool[claim].slot == slot) {
            claim_end(b, claim);
        }
    } else if (a->process == place && a->tenant.slot == slot) {
        presence_leave(b, agent);
    }
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
            slot_leave(b, agent, place, slot);
        }
        return;
    }
    if (!objection && agent == MU_NONE) {
        agent = registry_add(&b->registry, e->name);
        objection = agent == MU_NONE ? "the white pages are full" : NULL;
        code = muster_REFUSAL_FULL;
    }
    if (objection) {
        b->counters.malformed += !mu_name_valid(e->name);
        places_refuse(&b->places, place, e->name, code, objection);
        return;
    }
    struct presence is;
    presence_of(r, e, &is);
    presence_admit(b, agent, place, slot, &is);
}

/* Lets go of the agents of a part; if that is given, of those whose slots bear other names now. */
static void agents_leave(struct broker *b, uint32_t place, uint32_t part,
                         const muster_Registration *now)
{
    uint32_t next = TENANTS_NONE;
    for (uint32_t agent = tenants_first_of(&b->places, place, part); agent != TENANTS_NONE;
         agent = next) {
        next = tenants_next_of(&b->registry, agent);
        const struct agent *a = &b->registry.agents[agent];
        if (!now || slot_is_others(now, a->tenant.slot, a->name)) {
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

static void place_leave(struct broker *b, uint32_t place)
{
    uint32_t top = b->places.at[place].parts_top;
    claims_end(b, place, MU_NONE, NULL);
    for (uint32_t part = 0; part < top; part++) {
        agents_leave(b, place, part, NULL);
    }
}

/* Finds or makes the place of a process that registers.  @return MU_NONE: it is not to be heard */
static uint32_t place_hear(struct broker *b, const muster_Registration *r)
{
    uint32_t place = places_get(&b->places, r->process);
    if (place == MU_NONE) {
        b->counters.malformed++;
        return MU_NONE;
    }
    struct place *at = &b->places.at[place];
    if (r->incarnation < at->incarnation) {
        return MU_NONE; /* late, from a process that is no more */
    }
    at->speaks = true; /* it stays, whoever leaves it */
    /* Its pages are empty, if we saw its agents go, too. */
    if (r->incarnation > at->incarnation) {
        if (at->agents_count > 0) {
            place_leave(b, place);
        }
        at->version_had = 0;
        pages_forget_told(at);
    }
    at->incarnation = r->incarnation;
    at->watches = r->watches;
    if (at->lost) {
        at->lost = false;
        at->roll_call_due = r->part > 0 || at->parts_top > 1;
        places_wake(&b->places, place);
    }
    return place;
}

void presence_register(struct broker *b, const muster_Registration *r)
{
    if (r->broker[0] != '\0' && strcmp(r->broker, b->name) != 0) {
        uint32_t left = places_find(&b->places, r->process);
        if (left != MU_NONE) {
            if (r->part == 0) {
                glances_gone(b, left); /* it answers to the other one now */
            }
            part_leave(b, left, r->part, NULL);
        }
        return;
    }
    uint32_t place = place_hear(b, r);
    if (place == MU_NONE) {
        return;
    }
    part_leave(b, place, r->part, r);
    for (uint32_t i = 0; i < r->agents._length; i++) {
        const muster_Entry *e = &r->agents._buffer[i];
        if (!border_entry(e, false)) {
            b->counters.malformed++;
        } else if (e->name[0] != '\0' || e->state != muster_STATE_ABSENT) {
            entry_take(b, place, r, i);
        }
    }
    b->places.at[place].speaks = false;
    places_tidy(&b->places, place);
}

void presence_gone(struct broker *b, uint32_t place, uint32_t part, bool crashed)
{
    if (crashed) {
        b->places.at[place].lost = true;
        depot_gone(b, place);
        glances_gone(b, place);
        place_leave(b, place);
    } else if (part < PLACES_PARTS) {
        if (part == 0) {
            depot_gone(b, place);
            glances_gone(b, place);
        }
        part_leave(b, place, part, NULL);
    }
}

void presence_settle(struct broker *b, uint32_t place)
{
    uint32_t next = TENANTS_NONE;
    for (uint32_t agent = tenants_first(&b->places, place); agent != TENANTS_NONE; agent = next) {
        next = tenants_next(&b->registry, &b->places, agent);
        if (b->registry.agents[agent].gone) {
            presence_depart(b, agent);
        } else {
            liaison_review(b, agent);
        }
    }
}
