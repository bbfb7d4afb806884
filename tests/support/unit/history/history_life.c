/* SPDX-License-Identifier: Apache-2.0 */
#include "history.h"

#include "broker/control/parts.h"
#include "broker/mail/mail.h"

#include <string.h>

#define WALL 1000000000000000000ull

uint64_t life_now_ns(void)
{
    return history.now_ns - history.life.began_ns;
}

muster_BrokerStatus life_status(void)
{
    muster_BrokerStatus s;
    broker_status(history.life.b, &s);
    return s;
}

bool life_member(int name, muster_Member *out)
{
    for (uint32_t i = 0; broker_member(history.life.b, i, out); i++) {
        if (history_name_index(out->name) == name) {
            return true;
        }
    }
    return false;
}

/* Somebody simulates freely all the while, so that there is a time of the run. */
static void run_begin(void)
{
    muster_Roster r = {
        .simulator = words("sim"), .step = (int64_t)(history.now_ns / MS), .step_ns = MS};
    broker_roster(history.life.b, &r, life_now_ns());
}

void life_begin(void)
{
    uint64_t wall_ns = WALL + history.now_ns;
    history.life = (struct life){.number = ++history.lives,
                                 .incarnation = wall_ns + history.lives,
                                 .began_ns = history.now_ns};
    struct broker_options options = {
        .name = "alpha",
        .incarnation = history.life.incarnation,
        .pid = 9,
        .wall_ns = wall_ns,
        .has_store = history.has_store,
        .receipt_pause_ns = history_chance(2) ? LIMITER_GOOD_PAUSE_NS : 0,
        .number_base = history.has_store ? history.life.incarnation : 0,
        .boxes = {history.box_policy, history.box_mails, 0}};
    history.life.b = broker_kept(&options);
    if (history.has_store) {
        disk_restore();
    }
    run_begin();
    history_note("the broker begins its life %lu", (unsigned long)history.life.number);
}

/* What was on its way to the broker dies with it; what it has written may still be read. */
void life_kill(void)
{
    history_note("the broker dies");
    history.forgot |= history.has_store && history.life.disk_fails;
    history.life.b = NULL;
    history.seen.kills++;
    for (int i = 0; i < PROCESSES; i++) {
        struct history_process *p = &history.processes[i];
        p->ups_count = 0;
        p->hears = false;
        p->deliveries_count = history_chance(2) ? p->deliveries_count : 0;
        inbox_orphan(p);
        p->registration_due = true;
    }
    if (history.has_store) {
        history.book = history.book_on_disk;
    } else {
        memset(&history.book, 0, sizeof history.book);
    }
}

void life_round(void)
{
    broker_tick(history.life.b, life_now_ns());
    book_expire();
    many_hear();
    if (history.has_store) {
        disk_write();
    }
    net_deliver();
}

/* --- what must hold at all times -------------------------------------------------------------- */

static void check_boxes(struct broker *b)
{
    for (int name = 0; name < NAMES; name++) {
        uint32_t agent = registry_find(&b->registry, history_name(name));
        if (agent == MU_NONE || !b->mailbox.boxes[agent].begun) {
            continue;
        }
        const struct box *box = mailbox_box(&b->mailbox, agent);
        history.life.acked[name] = box->acked;
        HOLD(box->lists[POST_FLIGHT].posts.count <= MU_WINDOW_MAX + MAILBOX_RESERVE);
        HOLD(box->use.mails <= MU_BOX_MAX + MAILBOX_RESERVE);
        if (history.box_mails && history.life.number == 1) { /* later, there was more before */
            uint32_t own = history.asked_most[name];
            uint32_t most = own > history.box_mails ? own : history.box_mails;
            HOLD(box->use.mails <= most + MAILBOX_RESERVE);
        }
        uint32_t posts = 0;
        for (int list = 0; list <= POST_FLIGHT; list++) {
            posts += box->lists[list].posts.count;
        }
        HOLD(posts == box->use.mails);
    }
}

/* The states of mails, of those that wait and of those that the next commit writes. */
static void check_mails(const struct broker *b)
{
    for (const struct mail *m = b->arrivals.first; m; m = m->next[MAIL_BOXED]) {
        HOLD(m->posts.count > 0);
        HOLD((m->row == 0) == (m->durable == DURABLE_NOT));
        HOLD(!m->stored_ends_it || m->row > 0);
    }
    for (const struct mail *m = b->journal.mails.first; m; m = m->next[MAIL_KEPT]) {
        HOLD(m->durable == DURABLE_MARKED || m->durable == DURABLE_MARKED_AGAIN);
        HOLD(m->posts.count > 0 || m->told == TOLD_LAST || m->fate == FATE_PASSED_ON);
    }
}

void life_check(void)
{
    muster_BrokerStatus s = life_status();
    HOLD(s.sent == s.delivered + s.waiting + s.expired + s.box_full + s.over_share +
                       s.unknown_name + s.refused + s.dropped + s.no_store);
    HOLD(s.waiting == history.life.b->mailbox.posts_pool.live);
    HOLD(s.stored <= s.waiting + (history.life.b->journal.mails.first ? MAILS : 0));
    check_boxes(history.life.b);
    check_mails(history.life.b);
}

void life_check_empty(void)
{
    struct broker *b = history.life.b;
    HOLD(life_status().waiting == 0);
    HOLD(b->pool.mails == 0);
    HOLD(b->mailbox.posts_pool.live == 0);
    HOLD(b->mailbox.quotas.pool.live == 0);
    HOLD(b->receipts.pool.live == 0);
    HOLD(b->due.count == 0 && b->expiry.count == 0);
    HOLD(b->arrivals.first == NULL);
    HOLD(b->claims.pool.live == 0);
    HOLD(b->multicast.count == 0);
    HOLD(b->mailbox.watched.count == 0);
    for (int side = 0; side < QUOTA_SIDES; side++) {
        HOLD(b->quotas.all[side].mails == 0 && b->quotas.all[side].bytes == 0 &&
             b->quotas.all[side].posts == 0);
    }
    if (history.has_store) {
        HOLD(b->journal.mails.first == NULL && b->journal.agents_count == 0);
        for (uint32_t i = 0; i < JOURNAL_BUCKETS; i++) {
            HOLD(b->journal.buckets[i] == NULL);
        }
    }
}
