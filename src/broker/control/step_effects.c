/* SPDX-License-Identifier: Apache-2.0 */
/* What was kept until a step ends takes effect, in a fixed order. */
#include "broker/control/step.h"
#include "broker/membership/membership.h"
#include "core/sort.h"

static void acks_apply(struct broker *b)
{
    for (uint32_t i = 0; i < b->steps.active_count; i++) {
        uint32_t agent = b->steps.active[i];
        struct turn *turn = &b->steps.turns[agent];
        if (turn->has_ack) {
            turn->has_ack = false;
            outcome_acknowledge(b, agent, turn->ack);
        }
    }
}

static void states_apply(struct broker *b)
{
    for (uint32_t i = 0; i < b->steps.active_count; i++) {
        uint32_t agent = b->steps.active[i];
        struct turn *turn = &b->steps.turns[agent];
        bool changes = turn->has_state && b->registry.agents[agent].process != MU_NONE;
        turn->has_state = false;
        if (changes && turn->state == muster_STATE_ABSENT) {
            lifecycle_depart(b, agent);
        } else if (changes) {
            lifecycle_set_state(b, agent, turn->state);
        }
    }
}

static void mails_apply(struct broker *b)
{
    for (uint32_t i = 0; i < b->steps.active_count; i++) {
        struct turn *turn = &b->steps.turns[b->steps.active[i]];
        for (struct mail *m = pool_list_pop(&turn->mails); m; m = pool_list_pop(&turn->mails)) {
            (void)route_mail(b, m);
        }
    }
}

static void outside_take(struct broker *b, struct turn *turn)
{
    struct steps *l = &b->steps;
    struct mail *m = pool_list_pop(&turn->outside);
    steps_count_outside(l, m, false);
    pool_keep(m);
    if (route_mail(b, m)) {
        l->told[l->told_count++] = m;
    } else {
        pool_release(&b->pool, m);
    }
}

/* @return how many mails of one sender have room in a step if all senders get as much */
static uint32_t outside_quota(const struct steps *l)
{
    uint32_t senders = 0;
    for (uint32_t i = 0; i < l->active_count; i++) {
        senders += l->turns[l->active[i]].outside.first != NULL;
    }
    return senders < STEPS_OUTSIDE_MAX ? STEPS_OUTSIDE_MAX / (senders + !senders) : 1;
}

/* @return how many have room beyond the shares: of the first sender by name */
static uint32_t outside_spare(const struct steps *l, uint32_t share)
{
    uint32_t used = l->told_count;
    for (uint32_t i = 0; i < l->active_count; i++) {
        uint32_t count = l->turns[l->active[i]].outside.count;
        used += count < share ? count : share;
    }
    return used < STEPS_OUTSIDE_MAX ? STEPS_OUTSIDE_MAX - used : 0;
}

/* The next step begins with what is left. */
static void turns_close(struct steps *l)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < l->active_count; i++) {
        struct turn *turn = &l->turns[l->active[i]];
        turn->active = turn->outside.first != NULL;
        if (turn->active) {
            l->active[kept++] = l->active[i];
        }
    }
    l->active_count = kept;
}

/* Those that have room go in order of (sender, number), as a recording is put in again. */
static void outside_apply(struct broker *b)
{
    struct steps *l = &b->steps;
    uint32_t share = outside_quota(l), spare = outside_spare(l, share);
    for (uint32_t i = 0; i < l->active_count && l->outside_use.mails > 0; i++) {
        struct turn *turn = &l->turns[l->active[i]];
        uint32_t left = share;
        while (turn->outside.first && left + spare > 0 && l->told_count < STEPS_OUTSIDE_MAX) {
            outside_take(b, turn);
            *(left > 0 ? &left : &spare) -= 1;
        }
    }
}

void step_drop_replays(struct broker *b)
{
    for (struct mail *m; (m = timers_first(&b->replays));) {
        timers_remove(&b->replays, m);
        outcome_drop(b, m);
    }
}

/* What came in with this step when it was recorded comes in with it again. */
static void replays_keep(struct broker *b, uint64_t run_ns)
{
    for (struct mail *m = timers_first(&b->replays); m && m->at_ns[TIMERS_DUE] <= run_ns;
         m = timers_first(&b->replays)) {
        timers_remove(&b->replays, m);
        if (!steps_keep(b, m, true)) {
            outcome_turn_away(b, m);
        }
    }
}

void step_apply(struct broker *b)
{
    struct steps *l = &b->steps;
    MU_ASSERT(b->clock.mode == CLOCK_COLLECTS);
    b->clock.mode = CLOCK_COMMITS;
    replays_keep(b, clock_run_ns(&b->clock));
    /* What was collected first depends on the clock; what takes effect first does not. */
    mu_sort(l->active, l->active_count, sizeof l->active[0], registry_compare, &b->registry);
    acks_apply(b);
    outcome_expire(b, clock_mail_ns(&b->clock));
    notify_expire(b, clock_mail_ns(&b->clock));
    states_apply(b);
    mails_apply(b);
    outside_apply(b);
    route_resolve_expire(b, clock_mail_ns(&b->clock));
    turns_close(l);
    outcome_admit_due(b, clock_run_ns(&b->clock));
    b->clock.mode = CLOCK_COLLECTS;
}
