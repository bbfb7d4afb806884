/* SPDX-License-Identifier: Apache-2.0 */
/* The lines of groups and services as the journal has them: a changed line is marked there, and
 * those of an earlier life of the broker are taken in from there. */
#include "broker/services/services.h"

#include "broker/control/parts.h"
#include "core/fields.h"
#include "muster/memory.h"

#include <string.h>

/* --- changes ---------------------------------------------------------------------------------- */

static void subscriber_send(struct broker *b, uint32_t receiver, const struct subscription *s,
                            uint32_t line, bool came)
{
    const struct mu_pairs *pairs = &b->pages.services.pairs;
    struct mu_text t;
    mu_text_init(&t, b->text, sizeof b->text);
    mu_text_add(&t, came ? "came" : "went");
    mu_fields_add(&t, mu_pairs_first(pairs, line));
    mu_fields_add(&t, mu_pairs_second(pairs, line));
    if (came) {
        mu_fields_add_string(&t, b->pages.services.lines[line].attributes);
    }
    answer_inform(b, receiver, s->in_reply_to, s->conversation);
}

static void subscriber_tell(struct broker *b, struct subscription *s, uint32_t line, bool silently)
{
    uint32_t receiver = registry_find(&b->registry, s->agent);
    if (receiver == MU_NONE || b->registry.agents[receiver].process == MU_NONE) {
        return; /* is told when it is back */
    }
    const struct services *all = &b->pages.services;
    bool found = mu_attributes_match(&s->query, mu_pairs_first(&all->pairs, line),
                                     all->lines[line].attributes) &&
                 view_shows(b, line, view_inside(b, receiver));
    bool owed = !view_inside(b, receiver) && subscriptions_owe(s, line, false);
    bool news = (owed && !found) || subscriptions_note(s, line, found);
    if (news && silently) {
        (void)subscriptions_owe(s, line, !found);
    } else if (news) {
        (void)subscriptions_owe(s, line, false);
        subscriber_send(b, receiver, s, line, found);
    }
}

void notify_review(struct broker *b, struct subscription *s, bool silently)
{
    const struct mu_pairs *pairs = &b->pages.services.pairs;
    for (uint32_t i = 0; i < pairs->count; i++) {
        subscriber_tell(b, s, pairs->order[i], silently);
    }
}

static void subscribers_tell(struct broker *b, uint64_t since)
{
    struct pages *p = &b->pages;
    for (uint32_t line = changelog_after(&p->services.changes, since); line != MU_NONE;
         line = changelog_next(&p->services.changes, line)) {
        for (uint32_t i = 0; i < p->subscriptions.count; i++) {
            subscriber_tell(b, subscriptions_at(&p->subscriptions, i), line, false);
        }
    }
}

void notify_tell(struct broker *b)
{
    struct pages *p = &b->pages;
    uint64_t services = p->services.changes.version, groups = p->groups.changes.version;
    if (p->services_seen == services && p->groups_seen == groups) {
        return;
    }
    uint64_t since = p->services_seen;
    notify_mark_journal(b, p->groups_seen, since);
    p->services_seen = services;
    p->groups_seen = groups;
    subscribers_tell(b, since);
    for (uint32_t i = 0; i < b->processes.top; i++) {
        if (view_place_is_told(&b->processes.at[i])) {
            processes_wake(&b->processes, i);
        }
    }
}

void notify_presence(struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    services_touch(&b->pages.services, a->name);
    notify_tell(b);
    for (uint32_t i = 0; i < b->pages.subscriptions.count && a->process != MU_NONE; i++) {
        struct subscription *s = subscriptions_at(&b->pages.subscriptions, i);
        if (strcmp(s->agent, a->name) == 0) {
            notify_review(b, s, false);
        }
    }
}

void notify_expire(struct broker *b, uint64_t mail_ns)
{
    services_expire(&b->pages.services, mail_ns);
    notify_tell(b);
}

/* --- the lock step ---------------------------------------------------------------------------- */

static void subscribers_review(struct broker *b, bool silently)
{
    for (uint32_t i = 0; i < b->pages.subscriptions.count; i++) {
        notify_review(b, subscriptions_at(&b->pages.subscriptions, i), silently);
    }
}

void notify_freeze(struct broker *b)
{
    groups_freeze(&b->pages.groups);
    subscribers_review(b, true); /* what is not seen inside goes without a word */
}

void notify_thaw(struct broker *b)
{
    groups_freeze(&b->pages.groups); /* there is one view now */
    subscribers_review(b, false);
}

void notify_enter(struct broker *b, uint32_t agent)
{
    const char *name = b->registry.agents[agent].name;
    groups_enter(&b->pages.groups, name);
    notify_presence(b, agent);
}

/* The journal never writes through these; idlc makes no const members. */
static char *unconst(const char *s)
{
    return (char *)(uintptr_t)s;
}

static bool membership_line(struct broker *b, uint32_t slot, struct journal_line *out)
{
    const struct groups *g = &b->pages.groups;
    if (changelog_version(&g->changes, slot) == 0) {
        return false;
    }
    muster_Membership m;
    groups_line(g, slot, false, &m);
    *out = (struct journal_line){.key = m.group,
                                 .agent = m.agent,
                                 .present = m.joined,
                                 .attributes = "",
                                 .origin = m.origin,
                                 .stamp_ns = m.stamp_ns};
    return true;
}

static bool membership_restore(struct broker *b, const struct journal_line *line)
{
    muster_Membership m = {.group = unconst(line->key),
                           .agent = unconst(line->agent),
                           .joined = line->present,
                           .stamp_ns = line->stamp_ns,
                           .origin = unconst(line->origin)};
    bool taken = groups_merge(&b->pages.groups, &m, true) == MU_OK;
    notify_tell(b);
    return taken;
}

static bool offer_line(struct broker *b, uint32_t slot, struct journal_line *out)
{
    const struct services *s = &b->pages.services;
    if (changelog_version(&s->changes, slot) == 0) {
        return false;
    }
    muster_Offer o;
    services_line(s, slot, true, &o);
    *out = (struct journal_line){.key = o.service,
                                 .agent = o.agent,
                                 .present = o.offered,
                                 .attributes = o.attributes,
                                 .origin = o.origin,
                                 .lease_ns = view_lease_ns(b, slot),
                                 .stamp_ns = o.stamp_ns};
    return true;
}

static bool offer_restore(struct broker *b, const struct journal_line *line)
{
    muster_Offer o = {.service = unconst(line->key),
                      .agent = unconst(line->agent),
                      .offered = line->present,
                      .attributes = unconst(line->attributes),
                      .lease_ns = line->lease_ns,
                      .stamp_ns = line->stamp_ns,
                      .origin = unconst(line->origin)};
    struct said said = view_said(b);
    uint64_t mail_ns = clock_mail_ns(&b->clock);
    bool taken = services_merge(&b->pages.services, &o, &said, mail_ns) == MU_OK;
    notify_tell(b);
    return taken;
}

void notify_attach_journal(struct broker *b)
{
    static const struct journal_source groups = {
        .capacity = MU_MEMBERSHIPS_MAX, .line = membership_line, .restore = membership_restore};
    static const struct journal_source services = {
        .capacity = MU_SERVICES_MAX, .line = offer_line, .restore = offer_restore};
    journal_attach(b, JOURNAL_GROUPS, &groups);
    journal_attach(b, JOURNAL_SERVICES, &services);
}

static void lines_mark(struct broker *b, enum journal_lines lines, struct changelog *c,
                       uint64_t since)
{
    for (uint32_t line = changelog_gone(c); line != MU_NONE; line = changelog_gone(c)) {
        journal_line_changed(b, lines, line);
    }
    for (uint32_t line = changelog_after(c, since); line != MU_NONE;
         line = changelog_next(c, line)) {
        journal_line_changed(b, lines, line);
    }
}

void notify_mark_journal(struct broker *b, uint64_t groups_since, uint64_t services_since)
{
    lines_mark(b, JOURNAL_GROUPS, &b->pages.groups.changes, groups_since);
    lines_mark(b, JOURNAL_SERVICES, &b->pages.services.changes, services_since);
}
