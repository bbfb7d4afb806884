/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"

/* --- scopes ----------------------------------------------------------------------------------- */

void steps_rescope(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    if (a->process == MU_NONE) {
        a->scope = registry_is_own(agent) ? a->scope : SCOPE_OPEN;
        return;
    }
    const struct process *at = &b->processes.at[a->process];
    a->scope = scope_of_agent(at->scope,
                              at->kind == PROCESS_ONLOOKERS && a->is.kind == muster_KIND_SPECIAL,
                              b->steps.held && (a->is.kind == muster_KIND_ROBOT || a->let_go));
}

void steps_mark_residents(struct broker *b, uint32_t place)
{
    PROCESSES_EACH_AGENT (b, agent, place) {
        steps_rescope(b, agent);
    }
}

void steps_role_on(struct broker *b, uint32_t place, enum role_event event)
{
    struct member *m = &b->steps.members[place];
    m->role = role_next(m->role, event);
    MU_ASSERT(m->role < ROLES);
    if (event == ROLE_JOINS || event == ROLE_SIMULATES) {
        m->step_had = INT64_MIN;
    }
    if (b->processes.at[place].scope != role_scope(m->role)) {
        b->processes.at[place].scope = role_scope(m->role);
        steps_mark_residents(b, place);
    }
}

/* --- collecting ------------------------------------------------------------------------------- */

static struct turn *turn_open(struct steps *l, uint32_t agent)
{
    struct turn *turn = &l->turns[agent];
    if (!turn->active) {
        turn->active = true;
        l->active[l->active_count++] = agent;
    }
    return turn;
}

static bool mail_is_durable(const struct mail *m)
{
    return m->letter.level != muster_LEVEL_RAM && m->letter.hops == 0;
}

static bool mail_is_for_many(const struct mail *m)
{
    bool is_for_names = mu_address_kind(m->letter.dst) == MU_ADDRESS_NAMES;
    return m->only == MU_NONE && !(is_for_names && !strchr(m->letter.dst, ','));
}

/* @return the one receiver of a mail, or MU_NONE */
static uint32_t mail_receiver(const struct broker *b, const struct mail *m)
{
    if (m->only != MU_NONE || mail_is_for_many(m)) {
        return m->only;
    }
    return registry_find(&b->registry, m->letter.dst);
}

void steps_count_outside(struct steps *l, const struct mail *m, bool kept)
{
    struct turn *turn = &l->turns[m->sender];
    struct quota_use use = {.mails = 1, .bytes = pool_bytes(m)};
    uint32_t by = kept ? 1 : UINT32_MAX; /* one less */
    bool is_relayed = m->letter.hops > 0 && m->letter.level != muster_LEVEL_RAM;
    (kept ? quota_add : quota_subtract)(&turn->outside_use, &use);
    (kept ? quota_add : quota_subtract)(&l->outside_use, &use);
    turn->many += mail_is_for_many(m) ? by : 0;
    if (m->kept_for != MU_NONE) {
        l->turns[m->kept_for].awaited += by;
        l->turns[m->kept_for].relayed += is_relayed ? by : 0;
    }
}

bool steps_keep(struct broker *b, struct mail *m, bool from_outside)
{
    struct steps *l = &b->steps;
    static const struct quota_use most = {.mails = UINT32_MAX, .bytes = STEPS_OUTSIDE_BYTES};
    static const struct quota_use least = {.mails = UINT32_MAX, .bytes = STEPS_OUTSIDE_BYTES / 64};
    struct turn *turn = turn_open(l, m->sender);
    struct quota_use want = {.mails = 1, .bytes = pool_bytes(m)};
    if (from_outside) {
        if (quota_ask(&turn->outside_use, &l->outside_use, &want, &most, &least) != QUOTA_FITS) {
            return false;
        }
        m->kept_for = mail_receiver(b, m);
        steps_count_outside(l, m, true);
    } else if (want.bytes > l->turn_bytes) {
        return false;
    } else {
        l->turn_bytes -= want.bytes;
    }
    pool_list_append(from_outside ? &turn->outside : &turn->mails, m);
    return true;
}

bool steps_keeps_before(const struct broker *b, const struct mail *m, uint32_t receiver)
{
    const struct steps *l = &b->steps;
    const struct turn *turn = &l->turns[m->sender];
    bool may_overtake = l->turns[receiver].awaited > 0 || mail_is_durable(m);
    return turn->many > 0 || (turn->outside.first && may_overtake);
}

void steps_keep_ack(struct steps *l, uint32_t agent, uint64_t number)
{
    struct turn *turn = turn_open(l, agent);
    if (!turn->has_ack || number > turn->ack) {
        turn->ack = number;
    }
    turn->has_ack = true;
}

void steps_keep_state(struct steps *l, uint32_t agent, muster_State state)
{
    struct turn *turn = turn_open(l, agent);
    turn->has_state = true;
    turn->state = state;
}

void steps_told(struct broker *b)
{
    struct steps *l = &b->steps;
    while (l->told_count > 0) {
        pool_release(&b->pool, l->told[--l->told_count]);
    }
}

bool steps_view(const struct broker *b, uint32_t place, uint64_t interval_ns,
                struct steps_view *view)
{
    const struct steps *l = &b->steps;
    enum role role = l->members[place].role;
    uint64_t step_ns = b->clock.step_ns;
    uint64_t steps = interval_ns / step_ns + (interval_ns % step_ns > 0);
    *view = (struct steps_view){.scope = role_scope(role),
                                .step = l->step - 1,
                                .version = l->version,
                                .start_version = l->start_version,
                                .round_ns = steps * step_ns,
                                .is_round = steps == 0 || (uint64_t)l->step % steps == 0,
                                .told = l->told,
                                .told_count = place == l->simulator ? l->told_count : 0};
    bool owed = role_next(role, ROLE_IS_TOLD) != ROLES;
    return owed && !l->awaits_moves;
}

void steps_delivered(struct broker *b, uint32_t place)
{
    steps_role_on(b, place, ROLE_IS_TOLD);
    b->steps.members[place].step_had = b->steps.step - 1;
    if (place == b->steps.simulator) {
        steps_told(b);
    }
}

void steps_owe_delivery(struct broker *b, uint32_t place)
{
    steps_role_on(b, place, ROLE_IS_OWED);
    processes_wake(&b->processes, place);
}

void steps_release(struct broker *b)
{
    struct steps *l = &b->steps;
    if (!l->awaits_moves) {
        return;
    }
    l->awaits_moves = false;
    l->version = b->registry.changes.version;
    for (uint32_t i = 0; i < l->roster_count; i++) {
        steps_owe_delivery(b, l->roster[i]);
    }
    steps_owe_delivery(b, l->simulator);
}
