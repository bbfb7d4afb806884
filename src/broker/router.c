/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/router.h"

#include "broker/address.h"
#include "broker/border.h"
#include "broker/journal.h"
#include "broker/parts.h"
#include "broker/policy.h"
#include "broker/presence.h"
#include "broker/query.h"

#include <string.h>

/* Whom a mail is for, each once. */
struct audience {
    uint32_t agents[REGISTRY_MAX];
    uint32_t count;
    uint32_t unknown; /* names that nobody ever had */
};

enum mailbox_gate router_gate(const struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    if (a->process == MU_NONE) {
        return GATE_SHUT;
    }
    switch (a->is.state) {
    case muster_STATE_STANDBY:
    case muster_STATE_RUNNING: return GATE_OPEN;
    case muster_STATE_SUSPENDED: return GATE_URGENT;
    case muster_STATE_MOVING:
    case muster_STATE_ABSENT: break;
    }
    return GATE_SHUT;
}

/* --- receivers -------------------------------------------------------------------------------- */

static void audience_of_names(struct broker *b, const char *names, struct audience *to)
{
    char name[MU_NAME_MAX + 1];
    uint64_t mark = ++b->registry.mark;
    while (*names && address_next(&names, name)) {
        uint32_t agent = registry_find(&b->registry, name);
        if (agent == MU_NONE) {
            to->unknown++;
        } else if (b->registry.agents[agent].mark != mark) {
            b->registry.agents[agent].mark = mark;
            to->agents[to->count++] = agent;
        }
    }
}

static bool kind_is_addressed(enum address_kind kind, muster_Kind of)
{
    return kind == ADDRESS_ALL || (kind == ADDRESS_ROBOTS && of == muster_KIND_ROBOT) ||
           (kind == ADDRESS_SPECIAL && of == muster_KIND_SPECIAL);
}

/* A directive to all finds those, too, that want no broadcasts. */
static void audience_of(struct broker *b, const muster_Mail *letter, uint32_t sender,
                        struct audience *to)
{
    to->count = to->unknown = 0;
    enum address_kind kind = address_kind(letter->dst);
    if (kind == ADDRESS_NAMES) {
        audience_of_names(b, letter->dst, to);
        return;
    }
    for (uint32_t i = 0; i < b->registry.count; i++) {
        uint32_t agent = b->registry.order[i];
        const struct agent *a = &b->registry.agents[agent];
        if (agent != REGISTRY_BROKER && agent != sender && a->process != MU_NONE &&
            kind_is_addressed(kind, a->is.kind) &&
            !(kind == ADDRESS_ALL && a->is.no_broadcasts && letter->layer != 0)) {
            to->agents[to->count++] = agent;
        }
    }
}

bool router_meets_lockstep(struct broker *b, const struct mail *m)
{
    struct audience to;
    audience_of(b, &m->letter, m->sender, &to);
    bool meets = false;
    for (uint32_t i = 0; i < to.count && !meets; i++) {
        meets = presence_in_lockstep(b, to.agents[i]);
    }
    return meets;
}

/* --- what becomes of a mail ------------------------------------------------------------------- */

static void tell_sender(struct broker *b, uint32_t sender, uint64_t seq, muster_Outcome result)
{
    uint32_t place = b->registry.agents[sender].process;
    if (place != MU_NONE) { /* the absent are told nothing, the broker neither */
        receipts_add(&b->receipts, sender, seq, result);
        places_wake(&b->places, place);
    } else if (b->registry.agents[sender].awaited) {
        receipts_add(&b->receipts, sender, seq, result);
    }
}

/* The last word on a mail; what its other receivers do is not told any more. */
static void answer(struct broker *b, struct mail *m, muster_Outcome result)
{
    if (!m->answered) {
        m->answered = true;
        tell_sender(b, m->sender, m->letter.seq, result);
    }
}

/* One receiver is through with it. */
static void settle(struct broker *b, struct mail *m)
{
    b->counters.waiting--;
    MU_ASSERT(m->unsettled > 0);
    m->unsettled--;
    journal_settled(b, m);
    if (m->unsettled == 0) {
        schedule_remove(&b->due, m);
        schedule_remove(&b->expiry, m);
        answer(b, m, m->expired ? muster_OUTCOME_EXPIRED : muster_OUTCOME_DELIVERED);
        store_release(&b->store, m);
    }
}

void router_acknowledge(struct broker *b, uint32_t agent, uint64_t number)
{
    struct box *box = mailbox_box(&b->mailbox, agent);
    if (!mailbox_number_valid(&b->mailbox, agent, number)) {
        b->counters.malformed++;
        return;
    }
    if (number <= box->acked) {
        return;
    }
    while (box->acked < number) {
        struct mail *m = mailbox_pop(&b->mailbox, agent);
        b->counters.delivered++;
        settle(b, m);
    }
    uint32_t place = b->registry.agents[agent].process;
    if (!presence_in_lockstep(b, agent)) {
        mailbox_watch(&b->mailbox, agent, b->clock.now_ns);
    }
    if (place != MU_NONE) {
        places_wake(&b->places, place);
    }
}

void router_expire(struct broker *b, uint64_t mail_ns)
{
    struct mail *m;
    while ((m = schedule_first(&b->expiry)) && m->at_ns[SCHEDULE_EXPIRY] <= mail_ns) {
        schedule_remove(&b->expiry, m);
        uint32_t next = MU_NONE;
        store_keep(m);
        for (uint32_t post = m->posts; post != MU_NONE; post = next) {
            next = b->mailbox.posts[post].sibling_next;
            if (b->mailbox.posts[post].list != POST_FLIGHT) {
                mailbox_withdraw(&b->mailbox, post);
                b->counters.expired++;
                m->expired = true;
                settle(b, m);
            }
        }
        store_release(&b->store, m);
    }
}

/* --- on its way ------------------------------------------------------------------------------- */

static void wake_receiver(struct broker *b, uint32_t agent)
{
    uint32_t place = b->registry.agents[agent].process;
    if (place != MU_NONE) {
        places_wake(&b->places, place);
    }
}

void router_admit_due(struct broker *b, uint64_t run_ns)
{
    struct mail *m;
    while (b->clock.runs && (m = schedule_first(&b->due)) && m->at_ns[SCHEDULE_DUE] <= run_ns) {
        schedule_remove(&b->due, m);
        for (uint32_t post = m->posts; post != MU_NONE;
             post = b->mailbox.posts[post].sibling_next) {
            mailbox_admit(&b->mailbox, post);
            wake_receiver(b, b->mailbox.posts[post].agent);
        }
    }
}

static bool mail_must_wait(const struct broker *b, const struct mail *m)
{
    return m->letter.due_ns >= 0 &&
           (!b->clock.runs || (uint64_t)m->letter.due_ns > runclock_run_ns(&b->clock));
}

/* Puts it into one box.  @return false when that is full */
static bool post(struct broker *b, struct mail *m, uint32_t agent, bool held)
{
    if (mailbox_put(&b->mailbox, agent, m, held) != MU_OK) {
        b->counters.box_full++;
        return false;
    }
    b->counters.waiting++;
    m->unsettled++;
    wake_receiver(b, agent);
    return true;
}

static void put_on_schedules(struct broker *b, struct mail *m, bool held, uint64_t left_ns)
{
    uint64_t now_ns = runclock_mail_ns(&b->clock);
    if (held) {
        m->at_ns[SCHEDULE_DUE] = (uint64_t)m->letter.due_ns;
        schedule_add(&b->due, m);
    }
    if (m->letter.ttl_ns > 0 && now_ns + left_ns >= now_ns) {
        m->at_ns[SCHEDULE_EXPIRY] = now_ns + left_ns;
        schedule_add(&b->expiry, m);
    }
}

/* Puts it into every box.  @return whether all is well; the sender is told if not */
static void post_to_all(struct broker *b, struct mail *m, const struct audience *to)
{
    bool held = mail_must_wait(b, m), all_fit = true, stored = held;
    enum mailbox_gate needs = m->letter.layer == 0 ? GATE_URGENT : GATE_OPEN;
    for (uint32_t i = 0; i < to->count; i++) {
        uint32_t agent = to->agents[i];
        if (agent == REGISTRY_BROKER) {
            b->counters.delivered++;
            query_answer(b, m);
        } else if (!post(b, m, agent, held)) {
            all_fit = false;
        } else {
            /* When somebody outside the lock step acknowledges is no business of those inside. */
            stored = stored || router_gate(b, agent) < needs ||
                     (presence_in_lockstep(b, m->sender) && !presence_in_lockstep(b, agent));
        }
    }
    if (to->unknown > 0) {
        answer(b, m, muster_OUTCOME_UNKNOWN_NAME);
    } else if (!all_fit) {
        answer(b, m, muster_OUTCOME_BOX_FULL);
    } else if (m->unsettled == 0) {
        answer(b, m, muster_OUTCOME_DELIVERED);
    } else if (stored && m->letter.level != muster_LEVEL_RAM) {
        m->tell_stored = true; /* when it is */
    } else if (stored && !m->answered) {
        tell_sender(b, m->sender, m->letter.seq, muster_OUTCOME_STORED);
    }
    if (m->unsettled == 0) {
        store_release(&b->store, m);
    } else {
        put_on_schedules(b, m, held, m->letter.ttl_ns);
        journal_put(b, m);
    }
}

void router_stored(struct broker *b, struct mail *m)
{
    if (m->tell_stored && !m->answered) {
        tell_sender(b, m->sender, m->letter.seq, muster_OUTCOME_STORED);
    }
    m->tell_stored = false;
}

void router_undo(struct broker *b, struct mail *m)
{
    uint32_t next = MU_NONE;
    for (uint32_t post = m->posts; post != MU_NONE; post = next) {
        next = b->mailbox.posts[post].sibling_next;
        mailbox_withdraw(&b->mailbox, post);
        b->counters.waiting--;
        b->counters.no_store++;
        m->unsettled--;
    }
    MU_ASSERT(m->unsettled == 0);
    schedule_remove(&b->due, m);
    schedule_remove(&b->expiry, m);
    answer(b, m, muster_OUTCOME_NO_STORE);
    store_release(&b->store, m);
}

bool router_restore(struct broker *b, struct mail *m, const char *waiting, uint64_t left_ns)
{
    struct audience to = {.count = 0};
    audience_of_names(b, waiting, &to);
    m->order = ++b->orders;
    bool held = mail_must_wait(b, m);
    for (uint32_t i = 0; i < to.count; i++) {
        b->counters.sent++;
        (void)post(b, m, to.agents[i], held);
    }
    if (m->unsettled == 0) {
        store_release(&b->store, m);
        return false;
    }
    put_on_schedules(b, m, held, left_ns);
    return true;
}

bool router_route(struct broker *b, struct mail *m)
{
    struct audience to;
    audience_of(b, &m->letter, m->sender, &to);
    m->order = ++b->orders;
    if (m->letter.layer == 0 && !policy_may_direct(m->letter.src)) {
        uint32_t count = to.count + to.unknown ? to.count + to.unknown : 1;
        b->counters.sent += count;
        b->counters.refused += count;
        answer(b, m, muster_OUTCOME_REFUSED);
        store_release(&b->store, m);
        return false;
    }
    b->counters.sent += to.count + to.unknown;
    b->counters.unknown_name += to.unknown;
    post_to_all(b, m, &to);
    return true;
}

void router_post(struct broker *b, uint32_t receiver, const muster_Mail *letter)
{
    struct audience to = {.count = 1};
    to.agents[0] = receiver;
    struct mail *m = store_put(&b->store, letter);
    b->counters.sent++;
    if (!m) {
        b->counters.box_full++;
        return;
    }
    m->sender = REGISTRY_BROKER;
    m->order = ++b->orders;
    post_to_all(b, m, &to);
}

/* Has the broker had this mail before?  What an earlier life of it has had is known of durable mail
 * alone, and asked only of what may have come to that life. */
static bool was_had(const struct broker *b, uint32_t sender, const muster_Mail *letter,
                    muster_Outcome *outcome)
{
    const struct agent *a = &b->registry.agents[sender];
    *outcome = muster_OUTCOME_DUPLICATE;
    if (letter->seq <= a->seen_seq) {
        return true;
    }
    if (!letter->again || letter->level == muster_LEVEL_RAM || letter->seq > a->durable_seq) {
        return false;
    }
    bool waits = journal_find(&b->journal, sender, letter->seq) != NULL;
    *outcome = waits ? muster_OUTCOME_STORED : muster_OUTCOME_DELIVERED;
    return true;
}

/* There is no room for it, whoever it is for. */
static void turn_away(struct broker *b, uint32_t sender, const muster_Mail *letter,
                      uint64_t *counter, muster_Outcome outcome)
{
    struct audience to;
    audience_of(b, letter, sender, &to);
    b->counters.sent += to.count + to.unknown;
    *counter += to.count + to.unknown;
    tell_sender(b, sender, letter->seq, outcome);
}

struct mail *router_admit(struct broker *b, uint32_t sender, const muster_Mail *letter)
{
    struct agent *a = &b->registry.agents[sender];
    if (!border_string(letter->src, MU_NAME_MAX) || strcmp(letter->src, a->name) != 0) {
        b->counters.malformed++;
        return NULL;
    }
    muster_Outcome had;
    if (was_had(b, sender, letter, &had)) {
        b->counters.duplicates_dropped++;
        tell_sender(b, sender, letter->seq, had);
        return NULL;
    }
    a->seen_seq = letter->seq;
    journal_seq(b, sender);
    if (!border_mail(letter)) {
        b->counters.malformed++;
        tell_sender(b, sender, letter->seq, muster_OUTCOME_REFUSED);
        return NULL;
    }
    if (letter->level != muster_LEVEL_RAM && !journal_takes(b)) {
        turn_away(b, sender, letter, &b->counters.no_store, muster_OUTCOME_NO_STORE);
        return NULL;
    }
    struct mail *m = store_put(&b->store, letter);
    if (!m) {
        turn_away(b, sender, letter, &b->counters.box_full, muster_OUTCOME_BOX_FULL);
        return NULL;
    }
    m->sender = sender;
    return m;
}
