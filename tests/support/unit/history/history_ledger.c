/* SPDX-License-Identifier: Apache-2.0 */
#include "history.h"

#include <string.h>

uint32_t ledger_open(int src, uint32_t sender_life)
{
    HOLD(history.mails < MAILS);
    struct entry *e = &history.ledger[history.mails];
    *e = (struct entry){.src = src, .sender_life = sender_life, .layer = 3, .due_ns = -1};
    return history.mails++;
}

static uint32_t count(names set)
{
    return (uint32_t)__builtin_popcount(set);
}

static bool is_addressed(const struct entry *e, int name)
{
    switch (e->to) {
    case TO_NAMES: return e->addressed & 1u << name;
    case TO_ALL: return name != e->src;
    case TO_ROBOTS: return name != e->src && name % 2 == 0;
    case TO_GROUP: return name != e->src && book_group(e->key) & 1u << name;
    case TO_BROKER: break;
    }
    return false;
}

uint32_t ledger_audience(const struct entry *e, names *to)
{
    uint32_t unknown = e->to_unknown;
    *to = 0;
    for (int name = 0; name < NAMES; name++) {
        muster_Member m;
        bool known = life_member(name, &m);
        bool there = known && m.state != muster_STATE_ABSENT;
        if (!is_addressed(e, name)) {
            continue;
        }
        bool gets = e->to == TO_ALL || e->to == TO_ROBOTS ? there : known;
        *to |= gets ? 1u << name : 0;
        unknown += !known && e->to == TO_NAMES;
    }
    return unknown + (e->to == TO_GROUP && !history.book.exists[e->key]);
}

static bool may_drop(const struct entry *e)
{
    return history.box_policy != muster_BOX_REFUSE_NEW || e->meant & history.drops;
}

/* @return whether a durable mail of its sender came behind it to a life of the broker; perhaps: or
 *         it may have come */
static bool goes_along(const struct entry *e, bool perhaps)
{
    for (uint32_t i = 0; i < history.mails; i++) {
        const struct entry *o = &history.ledger[i];
        bool sure = o->life == history.life.number && o->live && !o->refused_some && !o->undone;
        if (o->sender_life == e->sender_life && o->seq > e->seq && o->to != TO_BROKER &&
            o->level != muster_LEVEL_RAM && o->accepted > 0 && (perhaps || sure)) {
            return true;
        }
    }
    return false;
}

/* --- at the broker ---------------------------------------------------------------------------- */

/* It said that it has had the mail: it must have. */
static void ledger_repeated(struct entry *e, bool again)
{
    if (history.contested[e->sender_life]) {
        return; /* the number may be that of another one's mail */
    }
    uint32_t hasty = history.hasty[e->sender_life];
    HOLD(e->accepted > 0 || (hasty && hasty < history.life.number));
    if (e->life != history.life.number) {
        HOLD(again && (e->level != muster_LEVEL_RAM || goes_along(e, true)));
        HOLD(hasty || e->committed || e->undone || e->refused_some || e->to == TO_BROKER ||
             e->live == 0 || e->level == muster_LEVEL_RAM);
        e->vague = true;
    }
}

static void ledger_accept(struct entry *e, const muster_BrokerStatus *was,
                          const muster_BrokerStatus *is)
{
    names to;
    uint32_t unknown = ledger_audience(e, &to);
    uint64_t no_store = is->no_store - was->no_store, refused = is->refused - was->refused;
    const struct actor *a = agent_of(e->src);
    if (a && a->life == e->sender_life && a->incarnation != history.life.incarnation) {
        history.hasty[e->sender_life] = history.life.number;
    }
    HOLD(e->life != history.life.number); /* new once in a life */
    e->accepted++;
    e->life = history.life.number;
    e->undone = no_store > 0;
    e->unknown_some = unknown > 0;
    e->refused_some = is->box_full + is->over_share > was->box_full + was->over_share;
    e->forbidden_some = refused > 0;
    e->heard = e->heard || e->told || e->stored;
    e->told = e->stored = false;
    e->committed = e->committed && e->live; /* what nobody was to have is on no disk */
    HOLD(!no_store || e->level != muster_LEVEL_RAM);
    if (e->to == TO_BROKER) {
        HOLD(is->sent == was->sent + 1 + (e->asks == ASK_FIND));
        e->refused_some = false; /* that was the answer */
        e->answer = e->asks == ASK_FIND && e->accepted == 1 ? book_answer(e->key) : 0;
        book_change(e);
        return;
    }
    history_note("  for %lu, %lu unknown; sent %lu more", (unsigned long)count(to),
                 (unsigned long)unknown, (unsigned long)(is->sent - was->sent));
    /* A directive for nobody is refused once if its sender may direct nobody. */
    HOLD(is->sent == was->sent + count(to) + unknown + (to ? 0 : refused));
    HOLD(no_store || is->unknown_name == was->unknown_name + unknown);
    e->meant |= to;
    e->live = no_store || refused ? 0 : to;
    if (e->refused_some && count(to) == 1) {
        e->live = 0;
    }
    e->expected |= refused > 0 && refused < count(to) ? to : e->live;
}

void ledger_offer(uint32_t mail, bool again, const muster_BrokerStatus *was,
                  const muster_BrokerStatus *is)
{
    struct entry *e = &history.ledger[mail];
    HOLD(is->malformed == was->malformed);
    if (is->duplicates_dropped > was->duplicates_dropped) {
        HOLD(is->sent == was->sent && is->waiting == was->waiting);
        ledger_repeated(e, again);
    } else {
        ledger_accept(e, was, is);
    }
    history.seen.refused += e->refused_some;
}

void ledger_committed(bool ok)
{
    for (uint32_t i = 0; i < history.mails; i++) {
        struct entry *e = &history.ledger[i];
        bool is_ram = e->level == muster_LEVEL_RAM;
        if (e->life != history.life.number || e->committed || e->undone || e->to == TO_BROKER ||
            (is_ram && !(ok && goes_along(e, false)))) {
            continue;
        }
        if (ok) {
            e->committed = true;
        } else if (e->live) { /* it leaves all boxes */
            e->undone = true;
            e->expected = e->live = 0;
        }
    }
}

/* --- at the receiver -------------------------------------------------------------------------- */

static void check_order(struct actor *a, const struct entry *e, const struct item *p)
{
    int kind = p->layer == 0 ? PRIORITIES - 1 : p->priority + 1;
    uint32_t *life = &a->last_life[e->src][kind];
    uint64_t *seq = &a->last_seq[e->src][kind];
    if (e->due_ns >= 0) {
        return; /* has its own time */
    }
    bool late = e->sender_life == *life && p->seq < *seq;
    HOLD(!late || p->again);
    if (!late) {
        *life = e->sender_life;
        *seq = p->seq;
    }
}

void ledger_hand(struct actor *a, const struct item *p, uint32_t life)
{
    struct entry *e = &history.ledger[p->mail];
    history.seen.taken++;
    if (p->src == NOBODY) {
        HOLD(e->to == TO_BROKER && e->src == a->name);
        HOLD(e->answer == 0 || e->accepted > 1 || e->answer == p->text);
        return;
    }
    history_note("%s takes #%lu of %s", history_name(a->name), (unsigned long)p->mail,
                 history_name(p->src));
    HOLD(p->src == e->src);
    HOLD(e->expected & 1u << a->name);
    HOLD(!e->closed || e->told_life != life);
    HOLD(a->had[p->mail]++ == 0); /* nothing twice */
    check_order(a, e, p);
    e->taken |= 1u << a->name;
}

/* --- at the sender ---------------------------------------------------------------------------- */

static struct entry *entry_of(const struct actor *a, uint64_t seq)
{
    for (uint32_t i = history.mails; i > 0; i--) {
        struct entry *e = &history.ledger[i - 1];
        if (e->sender_life == a->life && e->seq == seq) {
            return e;
        }
    }
    return NULL;
}

/*
 * Whom a mail has reached as far as they can tell: a broker whose disk failed lets a sender's next
 * life begin with numbers that have been, and one that has taken them takes what the store keeps
 * for old.
 */
static uint32_t reached(const struct entry *e)
{
    uint32_t had = e->taken;
    for (uint32_t i = 0; history.forgot && i < history.mails; i++) {
        const struct entry *o = &history.ledger[i];
        bool same = o->src == e->src && o->seq == e->seq && o->sender_life != e->sender_life;
        had |= same ? o->taken : 0;
    }
    return had;
}

/* What is told can be so. */
static void check_told(const struct entry *e, muster_Outcome result)
{
    bool vague = e->vague && (may_drop(e) || e->ttl_ns || e->refused_some || e->undone ||
                              e->forbidden_some || e->unknown_some);
    switch (result) {
    case muster_OUTCOME_DELIVERED:
        HOLD(vague || !(e->live & ~reached(e)));
        HOLD(vague || !(e->refused_some || e->undone || e->forbidden_some || e->unknown_some));
        break;
    case muster_OUTCOME_EXPIRED: HOLD(e->ttl_ns > 0); break;
    case muster_OUTCOME_DROPPED: HOLD(may_drop(e)); break;
    case muster_OUTCOME_BOX_FULL: HOLD(e->refused_some); break;
    case muster_OUTCOME_UNKNOWN_NAME: HOLD(e->unknown_some); break;
    case muster_OUTCOME_REFUSED: HOLD(e->forbidden_some); break;
    case muster_OUTCOME_NO_STORE: HOLD(e->undone || !e->live); break;
    case muster_OUTCOME_STORED:
    case muster_OUTCOME_DUPLICATE: break;
    }
}

/* Who asks about a mail of the broker's earlier life may ask twice, and hear twice what is certain.
 */
static bool can_be_told_again(muster_Outcome result)
{
    return result == muster_OUTCOME_DELIVERED || result == muster_OUTCOME_BOX_FULL ||
           result == muster_OUTCOME_UNKNOWN_NAME || result == muster_OUTCOME_REFUSED;
}

void ledger_told(struct actor *a, uint64_t seq, muster_Outcome result, uint32_t life)
{
    struct entry *e = entry_of(a, seq);
    if (!e || history.contested[a->life]) {
        return; /* of another sender of that name */
    }
    if (result == muster_OUTCOME_DUPLICATE) { /* its real outcome is still to come, */
        e->stored = true;                     /* unless the broker dies before */
        e->stored_life = life;
        return;
    }
    if (e->accepted == 0 && history.hasty[a->life]) {
        return;
    }
    history_note("%s hears %d of #%lu: live %x taken %x", history_name(a->name), (int)result,
                 (unsigned long)(e - history.ledger), e->live, e->taken);
    history.seen.receipts++;
    history.seen.expired += result == muster_OUTCOME_EXPIRED;
    history.seen.dropped += result == muster_OUTCOME_DROPPED;
    HOLD(e->accepted > 0);
    if (result == muster_OUTCOME_STORED) {
        HOLD(e->level == muster_LEVEL_RAM || e->committed); /* a receipt follows the commit */
        e->stored = true;
        e->stored_life = life;
        return;
    }
    /* One last word in a life, or the same once more for who has asked again. */
    HOLD(!e->told || e->told_life != life || (e->vague && can_be_told_again(result)));
    if (life == e->life || e->vague) {
        check_told(e, result);
    }
    e->told = true;
    e->told_life = life;
    e->closed = count(e->expected) == 1 && !e->unknown_some && !e->forbidden_some &&
                result != muster_OUTCOME_DELIVERED;
}

/* --- at the end ------------------------------------------------------------------------------- */

static bool sender_is_there(const struct entry *e)
{
    const struct actor *a = agent_of(e->src);
    return a && a->life == e->sender_life;
}

void ledger_check_end(void)
{
    for (uint32_t i = 0; i < history.mails; i++) {
        const struct entry *e = &history.ledger[i];
        bool kept = e->accepted > 0 && (e->committed || e->life == history.life.number);
        bool may_end =
            e->refused_some || e->undone || may_drop(e) || e->ttl_ns || e->forbidden_some;
        bool lost = e->stored && e->stored_life != history.life.number;
        bool kept_word = !kept || may_end || !(e->live & ~reached(e));
        /* What has an answer goes out again with what was sent before it and has none. */
        bool in_vain = e->heard && e->life != history.life.number;
        bool had_word = !sender_is_there(e) || e->told || lost || in_vain || e->vague ||
                        history.cut[e->sender_life] ||
                        (e->accepted == 0 && history.hasty[e->sender_life]);
        if (history.contested[e->sender_life]) {
            continue;
        }
        if (!kept_word || !had_word) {
            history_note("#%lu of %s: live %x taken %x", (unsigned long)i, history_name(e->src),
                         e->live, e->taken);
        }
        HOLD(kept_word); /* nothing is lost */
        HOLD(had_word);  /* each has an outcome */
    }
}
