/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/mail/mail.h"

#include "broker/control/parts.h"
#include "core/hash.h"
#include "core/text.h"
#include "muster/memory.h"

enum { BUCKETS_RUN = 64 };

void journal_init(struct journal *j, bool on)
{
    *j = (struct journal){.on = on};
    if (on) {
        j->agents = mu_startup_array(REGISTRY_MAX, sizeof *j->agents);
        j->buckets = mu_startup_array(JOURNAL_BUCKETS, sizeof *j->buckets);
        j->text = mu_startup_alloc(JOURNAL_WAITING_BYTES);
        for (int i = 0; i < LINES_KINDS; i++) {
            struct journal_slots *s = &j->slots[i];
            uint32_t capacity = lines_capacity((enum lines_kind)i);
            s->marked = mu_startup_array(capacity, sizeof *s->marked);
            s->is_marked = mu_startup_array(capacity, sizeof *s->is_marked);
        }
    }
}

bool journal_takes(const struct broker *b)
{
    return b->journal.on && !b->journal.failing;
}

/* --- durable mails by their names ------------------------------------------------------------- */

/* Mails that follow each other are beside each other, as they come and go. */
static struct mail **bucket_of(const struct journal *j, uint32_t sender, uint64_t seq)
{
    uint64_t where = mu_hash_number((seq / BUCKETS_RUN) ^ (uint64_t)sender << 40) * BUCKETS_RUN;
    return &j->buckets[(where + seq % BUCKETS_RUN) % JOURNAL_BUCKETS];
}

struct mail *journal_find(const struct journal *j, uint32_t sender, uint64_t seq)
{
    struct mail *m = j->on ? *bucket_of(j, sender, seq) : NULL;
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

void journal_list(struct journal *j, struct mail *m)
{
    m->journal_next = NULL;
    if (j->last) {
        j->last->journal_next = m;
    } else {
        j->first = m;
    }
    j->last = m;
}

static void mail_mark(struct journal *j, struct mail *m)
{
    if (mail_durable_on(m, DURABLE_MARKS)) {
        pool_keep(m);
        journal_list(j, m);
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
    for (uint32_t post = mu_list_first(&m->posts); post != MU_NONE;
         post = mailbox_sibling(&b->mailbox, post)) {
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
    for (struct mail *m = durable->older; m && m->order > a->durable_order; m = m->older) {
        first = is_in_ram(m, durable->sender) ? m : first;
    }
    for (struct mail *m = first; m && m != durable; m = m->newer) {
        if (is_in_ram(m, durable->sender)) {
            row_give(b, m);
        }
    }
}

void journal_put(struct broker *b, struct mail *m)
{
    struct agent *a = &b->registry.agents[m->sender];
    bool is_ram = m->letter.level == muster_LEVEL_RAM;
    if (is_ram || !b->journal.on) {
        a->ram_behind = a->ram_behind || (is_ram && m->letter.hops == 0);
        return;
    }
    /* What came by another broker says nothing of what the sender has sent here. */
    if (m->letter.hops == 0 && a->ram_behind) {
        ram_take_along(b, m);
        a->ram_behind = false;
    }
    row_give(b, m);
    a->durable_order = m->letter.hops == 0 ? m->order : a->durable_order;
    if (m->letter.hops == 0 && m->letter.seq > a->durable_seq) {
        a->durable_seq = m->letter.seq;
        agent_mark(b, m->sender);
    }
}

void journal_acknowledged(struct broker *b, uint32_t agent, const struct mail *m)
{
    struct box *box = mailbox_box(&b->mailbox, agent);
    if (!mail_is_written(m)) {
        return;
    }
    if (box->unsaved_commits != b->journal.commits) {
        box->unsaved_commits = b->journal.commits;
        box->unsaved = 0;
    }
    box->unsaved++;
}

uint32_t journal_room(const struct broker *b, uint32_t agent)
{
    const struct box *box = &b->mailbox.boxes[agent];
    if (!b->journal.failing) {
        return UINT32_MAX;
    }
    uint32_t may_come_again = box->unsaved_commits == b->journal.commits ? box->unsaved : 0;
    for (uint32_t post = mu_list_first(&box->lists[POST_FLIGHT].posts); post != MU_NONE;
         post = mailbox_next(&b->mailbox, post)) {
        may_come_again += mail_is_written(b->mailbox.posts[post].mail);
    }
    return may_come_again < MU_WINDOW_MAX ? MU_WINDOW_MAX - may_come_again : 0;
}

void journal_failed(struct broker *b, uint32_t sender, const muster_Mail *letter)
{
    struct agent *a = &b->registry.agents[sender];
    if (letter->hops > 0 || letter->seq <= a->failed_seq) {
        return;
    }
    a->failed_seq = letter->seq;
    if (letter->seq <= a->durable_seq) { /* else none is asked before one has gone to the store */
        agent_mark(b, sender);
    }
}

void journal_settled(struct broker *b, struct mail *m)
{
    if (m->row == 0) {
        return;
    }
    mail_mark(&b->journal, m);
    if (m->unsettled == 0) {
        journal_remove(&b->journal, m);
    }
}

void journal_agent(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    if (a->reserved_seq == 0 || a->saved_kind != a->is.kind) {
        a->reserved_seq = a->reserved_seq ? a->reserved_seq : JOURNAL_RESERVE;
        a->saved_kind = a->is.kind;
        agent_mark(b, agent);
    }
}

void journal_seq(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    bool far = a->seen_seq < INT64_MAX - 2 * (uint64_t)JOURNAL_RESERVE;
    if (far && a->seen_seq + JOURNAL_RESERVE / 2 > a->reserved_seq) {
        a->reserved_seq = a->seen_seq + JOURNAL_RESERVE;
        agent_mark(b, agent);
    }
}

struct lines *journal_table(struct broker *b, enum lines_kind lines)
{
    return lines == LINES_GROUPS ? &b->pages.groups : &b->pages.services;
}

void journal_line_changed(struct broker *b, enum lines_kind lines, uint32_t slot)
{
    struct journal_slots *s = &b->journal.slots[lines];
    if (s->marked && !s->is_marked[slot]) {
        s->is_marked[slot] = true;
        s->marked[s->count++] = slot;
    }
}

/* --- to the disk ------------------------------------------------------------------------------ */

uint64_t journal_run_wall_ns(const struct broker *b)
{
    bool by_the_wall = b->clock.runs && !clock_by_steps(&b->clock);
    return by_the_wall ? b->clock.wall_ns + b->clock.base_ns - b->clock.run_ns : 0;
}

static bool something_is_marked(const struct broker *b)
{
    const struct journal *j = &b->journal;
    bool marked = j->first || j->agents_count || j->run_wall_ns != journal_run_wall_ns(b);
    for (int i = 0; i < LINES_KINDS; i++) {
        marked = marked || j->slots[i].count || j->slots[i].reset;
    }
    for (uint32_t i = 0; i < MU_CAPSULES_MAX; i++) {
        marked = marked || b->snapshots.snapshots[i].unsaved;
    }
    return marked;
}

bool journal_wanted(struct broker *b, muster_Level *level)
{
    struct journal *j = &b->journal;
    if (!j->on || (j->failing && b->clock.now_ns < j->retry_ns)) {
        return false;
    }
    if (!something_is_marked(b)) {
        j->failing = false; /* the next durable mail will show whether it works again */
        return false;
    }
    *level = muster_LEVEL_LOGGED;
    for (const struct mail *m = j->first; m; m = m->journal_next) {
        if (!mail_is_written(m) && m->letter.level > *level) {
            *level = m->letter.level;
        }
    }
    j->at = (struct journal_cursor){.mail = j->first};
    return true;
}

/* The names of those that a mail still waits for, and behind a slash what of its end is certain. */
static const char *waiting_of(struct broker *b, const struct mail *m)
{
    struct mu_text t;
    mu_text_init(&t, b->journal.text, JOURNAL_WAITING_BYTES);
    for (uint32_t post = mu_list_first(&m->posts); post != MU_NONE;
         post = mailbox_sibling(&b->mailbox, post)) {
        mu_text_add(&t, t.len ? "," : "");
        mu_text_add(&t, b->registry.agents[b->mailbox.posts[post].agent].name);
    }
    const char *so_far = pool_mail_standing(m);
    mu_text_add(&t, so_far[0] ? "/" : "");
    mu_text_add(&t, so_far);
    return t.at;
}

static uint64_t expires_wall_ns(const struct broker *b, const struct mail *m)
{
    if (m->at_ns[TIMERS_EXPIRY] == 0) { /* in flight it may be due already */
        return 0;
    }
    uint64_t mail_ns = clock_mail_ns(&b->clock), at_ns = m->at_ns[TIMERS_EXPIRY];
    uint64_t left_ns = at_ns > mail_ns ? at_ns - mail_ns : 0, wall_ns = clock_wall_ns(&b->clock);
    bool fits = wall_ns < INT64_MAX && left_ns < INT64_MAX - wall_ns; /* what SQLite can hold */
    return fits ? wall_ns + left_ns : INT64_MAX;
}

static bool next_agent(struct broker *b, struct journal_entry *e)
{
    struct journal *j = &b->journal;
    if (j->at.agent == j->agents_count) {
        return false;
    }
    const struct agent *a = &b->registry.agents[j->agents[j->at.agent++]];
    e->kind = JOURNAL_AGENT;
    e->name = a->name;
    e->agent_kind = a->saved_kind;
    e->durable_seq = a->durable_seq;
    e->failed_seq = a->failed_seq;
    e->reserved_seq = a->reserved_seq;
    return true;
}

/* Rows that follow each other go together. */
static void gone_extend(struct journal *j, struct journal_entry *e)
{
    struct mail *m = j->at.mail;
    while (m && mail_is_written(m) && m->unsettled == 0 && m->row == e->last_row + 1) {
        e->last_row = m->row;
        m = m->journal_next;
    }
    j->at.mail = m;
}

static bool next_mail(struct broker *b, struct journal_entry *e)
{
    struct journal *j = &b->journal;
    while (j->at.mail && !mail_is_written(j->at.mail) && j->at.mail->unsettled == 0) {
        j->at.mail = j->at.mail->journal_next; /* came and went */
    }
    const struct mail *m = j->at.mail;
    if (!m) {
        return false;
    }
    j->at.mail = m->journal_next;
    e->row = e->last_row = m->row;
    if (m->unsettled == 0) {
        e->kind = JOURNAL_GONE;
        gone_extend(j, e);
        return true;
    }
    e->kind = mail_is_written(m) ? JOURNAL_WAITING : JOURNAL_MAIL;
    e->letter = m->letter;
    e->waiting = waiting_of(b, m);
    e->expires_wall_ns = expires_wall_ns(b, m);
    return true;
}

/* @return a line with its lease as others count it; no key: the slot is free */
static struct line_word line_kept(struct broker *b, enum lines_kind lines, uint32_t slot)
{
    const struct lines *table = journal_table(b, lines);
    struct line_word word = {.key = NULL};
    if (changelog_version(&table->changes, slot) > 0) {
        word = lines_word(table, slot, false);
        word.lease_ns = lines == LINES_SERVICES ? view_lease_ns(b, slot) : 0;
    }
    return word;
}

static bool next_line(struct broker *b, struct journal_entry *e)
{
    struct journal *j = &b->journal;
    for (; j->at.lines < LINES_KINDS; j->at.lines++, j->at.line = 0, j->at.begun = false) {
        struct journal_slots *s = &j->slots[j->at.lines];
        e->lines = j->at.lines;
        if (s->reset && !j->at.begun) {
            j->at.begun = true;
            e->kind = JOURNAL_RESET;
            return true;
        }
        if (j->at.line < s->count) {
            e->kind = JOURNAL_LINE;
            e->slot = s->marked[j->at.line++];
            e->line = line_kept(b, e->lines, e->slot);
            return true;
        }
    }
    return false;
}

static bool next_clock(struct broker *b, struct journal_entry *e)
{
    struct journal *j = &b->journal;
    bool wanted = !j->at.clock_done && j->run_wall_ns != journal_run_wall_ns(b);
    j->at.clock_done = true;
    e->kind = JOURNAL_CLOCK;
    e->run_wall_ns = journal_run_wall_ns(b);
    return wanted;
}

static bool next_capsule(struct broker *b, struct journal_entry *e)
{
    struct journal *j = &b->journal;
    while (j->at.snapshot < MU_CAPSULES_MAX) {
        const struct snapshot *c = &b->snapshots.snapshots[j->at.snapshot++];
        if (c->unsaved) {
            e->kind = JOURNAL_SNAPSHOT;
            e->name = b->registry.agents[c->agent].name;
            e->epoch = c->epoch;
            e->snapshot = c->phase == SNAPSHOT_FREE ? "" : c->text;
            return true;
        }
    }
    return false;
}

bool journal_next(struct broker *b, struct journal_entry *entry)
{
    return next_agent(b, entry) || next_mail(b, entry) || next_line(b, entry) ||
           next_clock(b, entry) || next_capsule(b, entry);
}
