/* SPDX-License-Identifier: Apache-2.0 */
/* What an earlier life of the broker has left on disk.  A file is no better than the network: all
 * of it is checked. */

#include "broker/control/parts.h"
#include "bus/check_fields.h"

#include <string.h>

static const uint64_t RETRY_NS = 1000000000;

/* --- and how that went ------------------------------------------------------------------------ */

static void mails_committed(struct broker *b)
{
    struct journal *j = &b->journal;
    for (struct mail *m; (m = pool_list_pop(&j->mails));) {
        (void)mail_durable_on(m, DURABLE_COMMITS);
        if (m->posts.count > 0) {
            outcome_on_disk(b, m);
        }
        pool_release(&b->pool, m);
    }
}

/* @return whether a receiver may have it already: that is not to be undone */
static bool mail_is_out(const struct broker *b, const struct mail *m)
{
    MU_LIST_EACH (post, &m->posts, MU_LINKS(b->mailbox.posts, links[LINKS_MAIL])) {
        if (b->mailbox.posts[post].list == POST_FLIGHT) {
            return true;
        }
    }
    return false;
}

/* It needs no disk, until the next durable mail of its sender. */
static void ram_leave(struct broker *b, struct mail *m)
{
    journal_note_ram(b, m);
    b->registry.agents[m->sender].durable_order = 0;
    m->row = 0;
}

/* New mails are not taken after all; what is on disk already, or under way, stays marked. */
static void mails_failed(struct broker *b)
{
    struct journal *j = &b->journal;
    struct mail_list marked = j->mails;
    j->mails = (struct mail_list){.count = 0};
    for (struct mail *m; (m = pool_list_pop(&marked));) {
        if (mail_is_written(m) || mail_is_out(b, m)) {
            pool_list_append(&j->mails, m);
            continue;
        }
        (void)mail_durable_on(m, DURABLE_UNDOES);
        if (m->posts.count > 0) {
            journal_remove(j, m);
            m->row = 0;
            m->letter.level == muster_LEVEL_RAM ? ram_leave(b, m) : outcome_undo(b, m);
        }
        pool_release(&b->pool, m);
    }
}

static void marks_clear(struct broker *b)
{
    struct journal *j = &b->journal;
    while (j->agents_count > 0) {
        b->registry.agents[j->agents[--j->agents_count]].unsaved = false;
    }
    for (int i = 0; i < LINES_KINDS; i++) {
        struct changelog *c = &journal_table(b, (enum lines_kind)i)->changes;
        j->lines[i] = (struct journal_lines){.saved = c->version};
        while (changelog_gone(c) != MU_NONE) {
        }
    }
    for (uint32_t i = 0; i < MU_CAPSULES_MAX; i++) {
        b->snapshots.snapshots[i].unsaved = false;
    }
    b->snapshots.unsaved = false;
    j->run_wall_ns = journal_run_wall_ns(b);
}

void durable_committed(struct broker *b, bool ok, uint64_t now_ns)
{
    struct journal *j = &b->journal;
    bool failed_before = j->failing;
    j->failing = !ok;
    if (ok) {
        j->commits++;
        for (uint32_t i = 0; i < b->registry.count && failed_before; i++) {
            processes_wake_agent(b, i); /* more may be handed out */
        }
        mails_committed(b);
        marks_clear(b);
    } else {
        j->failures++;
        j->retry_ns = clock_after_ns(now_ns, RETRY_NS);
        mails_failed(b);
    }
}

static bool name_is_good(const char *name)
{
    return mu_name_valid(name) && strcmp(name, "broker") != 0;
}

/* An agent of an earlier life is known again. */
static void agent_return(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    a->is.kind = a->saved_kind == JOURNAL_ENDED ? muster_KIND_AGENT : a->saved_kind;
    a->since_wall_ns = b->clock.wall_ns;
    names_hold(b, agent);
    if (a->process == MU_NONE) {
        outcome_await(b, agent);
    }
    registry_touch(&b->registry, agent);
}

/* Of names that had ended, and when there are more names than should be, the numbers are kept, for
 * when mail names them, or they come back. */
static void agent_bury(struct broker *b, const struct journal_entry *e)
{
    struct graveyard *g = &b->registry.graveyard;
    struct grave *grave = graveyard_find(g, e->name);
    grave = grave ? grave : graveyard_add(g, e->name);
    grave->saved_kind = e->agent_kind;
    grave->seq.durable = e->durable_seq;
    grave->seq.failed = e->failed_seq;
    grave->seq.earlier = grave->seq.reserved = e->reserved_seq;
}

static bool restore_agent(struct broker *b, const struct journal_entry *e)
{
    bool ended = e->agent_kind == JOURNAL_ENDED;
    bool good = name_is_good(e->name) && (ended || validate_kind_word(e->agent_kind)) &&
                e->durable_seq <= INT64_MAX && e->failed_seq <= INT64_MAX &&
                e->reserved_seq <= INT64_MAX;
    if (!good) {
        return false;
    }
    uint32_t agent = registry_find(&b->registry, e->name);
    if (agent == MU_NONE && (ended || registry_is_crowded(&b->registry))) {
        b->registry.roomless += !ended;
        agent_bury(b, e);
        return true;
    }
    agent = agent != MU_NONE ? agent : registry_add(&b->registry, e->name);
    if (agent == MU_NONE) {
        return false;
    }
    struct agent *a = &b->registry.agents[agent];
    a->saved_kind = e->agent_kind;
    a->seq.durable = e->durable_seq;
    a->seq.failed = e->failed_seq;
    a->seq.earlier = a->seq.reserved = e->reserved_seq;
    agent_return(b, agent);
    return true;
}

/* @return the agent of a name that stands in a mail, entered if need be; or MU_NONE */
static uint32_t agent_named(struct broker *b, const char *name)
{
    if (!name_is_good(name)) {
        return MU_NONE;
    }
    uint32_t agent = registry_find(&b->registry, name);
    if (agent == MU_NONE && (agent = registry_add(&b->registry, name)) != MU_NONE) {
        agent_return(b, agent);
    }
    return agent;
}

/* Agents that a mail waits for come out of the graveyard. */
static void agents_named(struct broker *b, const char *names)
{
    char name[MU_NAME_MAX + 1];
    while (*names && mu_address_next(&names, name)) {
        if (graveyard_find(&b->registry.graveyard, name)) {
            (void)agent_named(b, name);
        }
    }
}

static uint64_t left_ns(const struct broker *b, const struct journal_entry *e)
{
    uint64_t wall_ns = clock_wall_ns(&b->clock);
    if (e->expires_wall_ns == 0) {
        return UINT64_MAX;
    }
    return e->expires_wall_ns > wall_ns ? e->expires_wall_ns - wall_ns : 0;
}

/* Takes note of what was certain of its end, that stands behind a slash.
 * @return the names before it; "": there is no such end */
static const char *waiting_read(struct broker *b, struct mail *m, const char *waiting)
{
    const char *slash = strchr(waiting, '/');
    if (!slash) {
        return waiting;
    }
    struct mu_text t = mu_text_in(b->journal.text, JOURNAL_WAITING_BYTES);
    mu_text_add_bytes(&t, waiting, (size_t)(slash - waiting));
    return pool_mail_go_on(m, slash + 1) ? t.at : "";
}

static bool restore_mail(struct broker *b, const struct journal_entry *e)
{
    struct journal *j = &b->journal;
    if (e->row == 0 || e->row > JOURNAL_NUMBER_MAX) {
        return false;
    }
    j->rows = e->row > j->rows ? e->row : j->rows; /* taken, whatever becomes of it */
    uint32_t sender = agent_named(b, e->letter.src);
    if (sender == MU_NONE || !check_mails(&e->letter, 1) || !mu_address_valid(e->letter.dst) ||
        strlen(e->waiting) >= JOURNAL_WAITING_BYTES ||
        (e->letter.hops == 0 && journal_find(j, sender, e->letter.seq))) {
        return false;
    }
    muster_Mail letter = e->letter;
    letter.again = true;
    struct mail *m = pool_put(&b->pool, &letter);
    if (!m) {
        journal_failed(b, sender, &letter);
        return false;
    }
    m->sender = m->payer = sender;
    m->row = e->row;
    (void)mail_durable_on(m, DURABLE_RESTORES);
    const char *waiting = waiting_read(b, m, e->waiting);
    agents_named(b, waiting);
    if (!deliver_restore(b, m, waiting, left_ns(b, e))) {
        journal_failed(b, sender, &letter);
        return false;
    }
    journal_enter(j, m);
    struct agent *a = &b->registry.agents[sender];
    if (letter.hops == 0 && letter.seq > a->seq.durable) {
        a->seq.durable = letter.seq;
    }
    return true;
}

static bool restore_line(struct broker *b, const struct journal_entry *e)
{
    if ((unsigned)e->lines >= LINES_KINDS || !b->journal.on ||
        e->line.stamp_ns > JOURNAL_NUMBER_MAX) {
        return false;
    }
    struct said now = view_said(b);
    bool taken = lines_merge(journal_table(b, e->lines), &e->line, &now) == MU_OK;
    notify_tell(b);
    b->journal.lines[e->lines].reset = b->journal.lines[e->lines].reset || taken;
    if (taken && e->lines == LINES_GROUPS && e->line.present) {
        agents_named(b, e->line.agent);
    }
    return taken;
}

/* A run that went on by the wall has gone on. */
static bool restore_clock(struct broker *b, const struct journal_entry *e)
{
    uint64_t wall_ns = clock_wall_ns(&b->clock);
    if (e->run_wall_ns == 0 || e->run_wall_ns > wall_ns) {
        return false;
    }
    clock_start(&b->clock, 0, wall_ns - e->run_wall_ns);
    b->journal.run_wall_ns = e->run_wall_ns;
    return true;
}

static bool restore_snapshot(struct broker *b, const struct journal_entry *e)
{
    uint32_t agent = agent_named(b, e->name);
    return agent != MU_NONE && e->epoch <= JOURNAL_NUMBER_MAX && e->snapshot &&
           snapshots_restore(b, agent, e->epoch, e->snapshot);
}

bool durable_restore(struct broker *b, const struct journal_entry *entry)
{
    switch (entry->kind) {
    case JOURNAL_AGENT: return restore_agent(b, entry);
    case JOURNAL_MAIL: return restore_mail(b, entry);
    case JOURNAL_LINE: return restore_line(b, entry);
    case JOURNAL_CLOCK: return restore_clock(b, entry);
    case JOURNAL_SNAPSHOT: return restore_snapshot(b, entry);
    case JOURNAL_WAITING:
    case JOURNAL_GONE:
    case JOURNAL_RESET: break;
    }
    return false;
}
