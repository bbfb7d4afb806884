/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "core/hash.h"

enum { BUCKETS_RUN = 64 };

/* clang-format off */
enum {
    X = 255, R = DURABLE_NOT, M = DURABLE_MARKED, W = DURABLE_WRITTEN, A = DURABLE_MARKED_AGAIN
};

static const unsigned char next_durable[DURABLE_STATES][DURABLE_EVENTS] = {
    /*                       marks commits restores undoes */
    [DURABLE_NOT]          = {M,   X,      W,       X},
    [DURABLE_MARKED]       = {M,   W,      X,       R},
    [DURABLE_WRITTEN]      = {A,   X,      X,       X},
    [DURABLE_MARKED_AGAIN] = {A,   W,      X,       X},
};
/* clang-format on */

bool mail_durable_on(struct mail *m, enum mail_durable_event event)
{
    enum mail_durable before = m->durable;
    unsigned next = next_durable[before][event];
    MU_ASSERT(next != X);
    m->durable = (enum mail_durable)next;
    return m->durable != before;
}

bool journal_takes(const struct broker *b)
{
    return b->journal.on && !b->journal.failing;
}

/* --- durable mails by their names ------------------------------------------------------------- */

/* Mails that follow each other are beside each other, as they come and go. */
static struct mail **bucket_of(struct journal *j, uint32_t sender, uint64_t seq)
{
    uint64_t where = mu_hash_number((seq / BUCKETS_RUN) ^ (uint64_t)sender << 40) * BUCKETS_RUN;
    return &j->buckets[(where + seq % BUCKETS_RUN) % JOURNAL_BUCKETS];
}

struct mail *journal_look(struct journal *j, uint32_t sender, uint64_t seq)
{
    struct mail *m = *bucket_of(j, sender, seq);
    while (m && (m->sender != sender || m->letter.seq != seq)) {
        m = m->journal_same;
    }
    return m;
}

void journal_enter(struct journal *j, struct mail *m)
{
    struct mail **bucket = bucket_of(j, m->sender, m->letter.seq);
    m->journal_same = *bucket;
    *bucket = m;
}

void journal_remove(struct journal *j, struct mail *m)
{
    struct mail **at = bucket_of(j, m->sender, m->letter.seq);
    while (*at != m) {
        at = &(*at)->journal_same;
    }
    *at = m->journal_same;
}

/* --- marks ------------------------------------------------------------------------------------ */

static void mail_mark(struct journal *j, struct mail *m)
{
    if (mail_durable_on(m, DURABLE_MARKS)) {
        pool_keep(m);
        pool_list_append(&j->mails, m);
    }
}

static void agent_mark(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    if (b->journal.on && !a->unsaved) {
        a->unsaved = true;
        b->journal.agents[b->journal.agents_count++] = agent;
    }
}

static void row_give(struct broker *b, struct mail *m)
{
    struct journal *j = &b->journal;
    MU_LIST_EACH (post, &m->posts, MU_LINKS(b->mailbox.posts, links[LINKS_MAIL])) {
        journal_agent(b, b->mailbox.posts[post].agent); /* if others alone have told of it */
    }
    m->row = ++j->rows;
    journal_enter(j, m);
    mail_mark(j, m);
}

/* @return whether it would be lost with this life, and sent again behind what was not */
static bool is_in_ram(const struct mail *m, uint32_t sender)
{
    return m->sender == sender && m->row == 0 && m->letter.hops == 0;
}

/* What its sender has sent before a durable mail, and still waits, goes to the store with it: what
 * has outlived the broker must not overtake what its sender sends once more. */
static void ram_take_along(struct broker *b, const struct mail *durable)
{
    struct agent *a = &b->registry.agents[durable->sender];
    struct mail *first = NULL;
    for (struct mail *m = durable->prev[MAIL_BOXED]; m && m->order > a->durable_order;
         m = m->prev[MAIL_BOXED]) {
        first = is_in_ram(m, durable->sender) ? m : first;
    }
    for (struct mail *m = first; m && m != durable; m = m->next[MAIL_BOXED]) {
        if (is_in_ram(m, durable->sender)) {
            row_give(b, m);
        }
    }
}

void journal_note_ram(struct broker *b, const struct mail *m)
{
    struct agent *a = &b->registry.agents[m->sender];
    if (m->letter.hops == 0 && m->order > a->ram_order) {
        a->ram_order = m->order;
    }
}

void journal_put(struct broker *b, struct mail *m)
{
    struct agent *a = &b->registry.agents[m->sender];
    bool is_ram = m->letter.level == muster_LEVEL_RAM;
    if (is_ram) {
        journal_note_ram(b, m);
        return;
    }
    /* What came by another broker says nothing of what the sender has sent here. */
    if (m->letter.hops == 0 && a->ram_order > a->durable_order) {
        ram_take_along(b, m);
    }
    row_give(b, m);
    a->durable_order = m->letter.hops == 0 ? m->order : a->durable_order;
    if (m->letter.hops == 0 && m->letter.seq > a->seq.durable) {
        a->seq.durable = m->letter.seq;
        agent_mark(b, m->sender);
    }
}

void journal_acknowledged(struct broker *b, uint32_t agent)
{
    struct box *box = mailbox_box(&b->mailbox, agent);
    if (box->unsaved_commits != b->journal.commits) {
        box->unsaved_commits = b->journal.commits;
        box->unsaved = 0;
    }
    box->unsaved++;
}

uint32_t journal_room_left(const struct journal *j, const struct mailbox *m, uint32_t agent)
{
    const struct box *box = &m->boxes[agent];
    uint32_t may_come_again = box->unsaved_commits == j->commits ? box->unsaved : 0;
    MU_LIST_EACH (post, &box->lists[POST_FLIGHT].posts, MU_LINKS(m->posts, links[LINKS_BOX])) {
        may_come_again += mail_is_written(m->posts[post].mail);
    }
    return may_come_again < MU_WINDOW_MAX ? MU_WINDOW_MAX - may_come_again : 0;
}

void journal_failed(struct broker *b, uint32_t sender, const muster_Mail *letter)
{
    struct agent *a = &b->registry.agents[sender];
    if (letter->hops > 0 || letter->seq <= a->seq.failed) {
        return;
    }
    a->seq.failed = letter->seq;
    if (letter->seq <= a->seq.durable) { /* else none is asked before one has gone to the store */
        agent_mark(b, sender);
    }
}

void journal_settled(struct broker *b, struct mail *m)
{
    mail_mark(&b->journal, m);
    if (m->posts.count == 0) {
        journal_remove(&b->journal, m);
    }
}

void journal_agent(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    if (a->seq.reserved == 0 || a->saved_kind != a->is.kind) {
        a->seq.reserved = a->seq.reserved ? a->seq.reserved : JOURNAL_RESERVE;
        a->saved_kind = a->is.kind;
        agent_mark(b, agent);
    }
}

bool journal_end(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    if (a->seq.reserved > 0 && a->saved_kind != JOURNAL_ENDED) {
        a->saved_kind = JOURNAL_ENDED;
        agent_mark(b, agent);
    }
    return !a->unsaved;
}

void journal_seq(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    bool far = a->seq.seen < INT64_MAX - 2 * (uint64_t)JOURNAL_RESERVE;
    if (far && a->seq.seen + JOURNAL_RESERVE / 2 > a->seq.reserved) {
        a->seq.reserved = a->seq.seen + JOURNAL_RESERVE;
        agent_mark(b, agent);
    }
}

struct lines *journal_table(struct broker *b, enum lines_kind lines)
{
    return lines == LINES_GROUPS ? &b->pages.groups : &b->pages.services;
}
