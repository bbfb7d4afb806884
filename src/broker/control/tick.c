/* SPDX-License-Identifier: Apache-2.0 */
/* What happens when its time has come. */
#include "broker/control/parts.h"
#include "broker/membership/membership.h"

/* An unacknowledged delivery item goes out again after this. */
static const uint64_t RESEND_AFTER_NS = 1000000000;

static uint64_t resend_deadline_ns(const struct broker *b)
{
    uint32_t agent = mu_list_first(&b->mailbox.watched);
    return agent != MU_NONE ? clock_after_ns(b->mailbox.boxes[agent].progress_ns, RESEND_AFTER_NS)
                            : UINT64_MAX;
}

static void resend_tick(struct broker *b)
{
    while (resend_deadline_ns(b) <= b->clock.now_ns) {
        uint32_t agent = mu_list_first(&b->mailbox.watched);
        mailbox_repeat(&b->mailbox, agent);
        names_tell_number(&b->registry, &b->processes,
                          agent); /* what said so may be what was lost */
        mailbox_watch(&b->mailbox, agent, b->clock.now_ns);
        processes_wake_agent(b, agent);
    }
}

void broker_tick(struct broker *b, uint64_t now_ns)
{
    broker_enter(b, now_ns);
    lifecycle_tick(b);
    resend_tick(b);
    outcome_tick(b);
    dispatch_tick(b);
    transfer_tick(b);
    outcome_await_tick(b);
    lifecycle_tick_routes(b);
    announce_tick(b);
    retire_tick(b);
    if (!clock_by_steps(&b->clock)) {
        outcome_expire(b, clock_mail_ns(&b->clock));
        notify_expire(b, clock_mail_ns(&b->clock));
        route_resolve_expire(b, clock_mail_ns(&b->clock));
        outcome_admit_due(b, clock_run_ns(&b->clock));
    }
}

static uint64_t earliest_ns(const uint64_t *times_ns, size_t count)
{
    uint64_t first_ns = UINT64_MAX;
    for (size_t i = 0; i < count; i++) {
        first_ns = times_ns[i] < first_ns ? times_ns[i] : first_ns;
    }
    return first_ns;
}

/* What ends on the mail clock.  @return in broker time */
static uint64_t mail_deadline_ns(const struct broker *b)
{
    const struct mail *expiry = timers_first(&b->expiry);
    const uint64_t times_ns[] = {
        expiry ? expiry->at_ns[TIMERS_EXPIRY] : UINT64_MAX, b->pages.services.soonest_ns,
        b->resolve.waits_asked.count > 0 ? b->resolve.soonest_ns : UINT64_MAX};
    uint64_t first_ns = earliest_ns(times_ns, sizeof times_ns / sizeof times_ns[0]);
    return first_ns != UINT64_MAX ? clock_then_ns(&b->clock, clock_mail_ns(&b->clock), first_ns)
                                  : UINT64_MAX;
}

/* @return when held mail is due, in broker time */
static uint64_t due_deadline_ns(const struct broker *b)
{
    const struct mail *due = timers_first(&b->due);
    return due && b->clock.runs
               ? clock_then_ns(&b->clock, clock_run_ns(&b->clock), due->at_ns[TIMERS_DUE])
               : UINT64_MAX;
}

uint64_t broker_deadline_ns(const struct broker *b)
{
    bool by_steps = clock_by_steps(&b->clock); /* then the end of a step does it */
    const uint64_t times_ns[] = {lifecycle_deadline_ns(b),
                                 resend_deadline_ns(b),
                                 dispatch_deadline_ns(b),
                                 snapshots_deadline_ns(b),
                                 limiter_deadline_ns(&b->bad_news),
                                 limiter_deadline_ns(&b->good_news),
                                 b->journal.awaits_ns,
                                 b->journal.failing ? b->journal.retry_ns : UINT64_MAX,
                                 remote_deadline_ns(b),
                                 announce_deadline_ns(b),
                                 retire_deadline_ns(b),
                                 by_steps ? UINT64_MAX : mail_deadline_ns(b),
                                 by_steps ? UINT64_MAX : due_deadline_ns(b)};
    return earliest_ns(times_ns, sizeof times_ns / sizeof times_ns[0]);
}
