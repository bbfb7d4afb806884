/* SPDX-License-Identifier: Apache-2.0 */
/* What is marked, row by row, for the owner of the disk. */
#include "broker/control/parts.h"

uint64_t journal_run_wall_ns(const struct broker *b)
{
    bool by_the_wall = b->clock.runs && !clock_by_steps(&b->clock);
    return by_the_wall ? b->clock.wall_ns + b->clock.base_ns - b->clock.run_ns : 0;
}

static bool something_is_marked(struct broker *b)
{
    const struct journal *j = &b->journal;
    bool marked = j->mails.first || j->agents_count || b->snapshots.unsaved ||
                  j->run_wall_ns != journal_run_wall_ns(b);
    for (int i = 0; i < LINES_KINDS; i++) {
        const struct changelog *c = &journal_table(b, (enum lines_kind)i)->changes;
        marked = marked || c->version > j->lines[i].saved || c->gone.count || j->lines[i].reset;
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
    for (const struct mail *m = j->mails.first; m; m = m->next[MAIL_KEPT]) {
        if (!mail_is_written(m) && m->letter.level > *level) {
            *level = m->letter.level;
        }
    }
    j->at = (struct journal_cursor){.mail = j->mails.first};
    return true;
}

/* The names of those that a mail still waits for, and behind a slash what of its end is certain. */
static const char *waiting_of(struct broker *b, const struct mail *m)
{
    struct mu_text t = mu_text_in(b->journal.text, JOURNAL_WAITING_BYTES);
    MU_LIST_EACH (post, &m->posts, MU_LINKS(b->mailbox.posts, links[LINKS_MAIL])) {
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
    e->durable_seq = a->seq.durable;
    e->failed_seq = a->seq.failed;
    e->reserved_seq = a->seq.reserved;
    return true;
}

/* Rows that follow each other go together. */
static void gone_extend(struct journal *j, struct journal_entry *e)
{
    struct mail *m = j->at.mail;
    while (m && mail_is_written(m) && m->posts.count == 0 && m->row == e->last_row + 1) {
        e->last_row = m->row;
        m = m->next[MAIL_KEPT];
    }
    j->at.mail = m;
}

static bool next_mail(struct broker *b, struct journal_entry *e)
{
    struct journal *j = &b->journal;
    while (j->at.mail && !mail_is_written(j->at.mail) && j->at.mail->posts.count == 0) {
        j->at.mail = j->at.mail->next[MAIL_KEPT]; /* came and went */
    }
    const struct mail *m = j->at.mail;
    if (!m) {
        return false;
    }
    j->at.mail = m->next[MAIL_KEPT];
    e->row = e->last_row = m->row;
    if (m->posts.count == 0) {
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
    struct journal_cursor *at = &b->journal.at;
    for (; at->lines < LINES_KINDS; at->lines++, at->begun = false) {
        const struct journal_lines *l = &b->journal.lines[at->lines];
        const struct changelog *c = &journal_table(b, at->lines)->changes;
        e->lines = at->lines;
        if (!at->begun) {
            at->begun = true;
            at->line = changelog_after(c, l->saved);
            at->gone = mu_list_first(&c->gone);
            if (l->reset) {
                e->kind = JOURNAL_RESET;
                return true;
            }
        }
        uint32_t slot = at->gone != MU_NONE ? at->gone : at->line;
        if (slot != MU_NONE) {
            if (at->gone != MU_NONE) {
                at->gone = mu_list_next(MU_LINKS(c->lines, gone), slot);
            } else {
                at->line = changelog_next(c, slot);
            }
            e->kind = JOURNAL_LINE;
            e->slot = slot;
            e->line = line_kept(b, e->lines, slot);
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

static bool next_snapshot(struct broker *b, struct journal_entry *e)
{
    struct journal *j = &b->journal;
    while (j->at.snapshot < MU_CAPSULES_MAX) {
        uint32_t i = j->at.snapshot++;
        const struct snapshot *c = &b->snapshots.snapshots[i];
        if (c->unsaved) {
            e->kind = JOURNAL_SNAPSHOT;
            e->name = b->registry.agents[c->agent].name;
            e->epoch = c->epoch;
            e->snapshot = c->phase == SNAPSHOT_FREE ? "" : b->snapshots.texts[i];
            return true;
        }
    }
    return false;
}

bool journal_next(struct broker *b, struct journal_entry *entry)
{
    return next_agent(b, entry) || next_mail(b, entry) || next_line(b, entry) ||
           next_clock(b, entry) || next_snapshot(b, entry);
}
