/* SPDX-License-Identifier: Apache-2.0 */
/* The lines of groups and services as the journal has them: a changed line is marked there, and
 * those of an earlier life of the broker are taken in from there. */
#include "broker/services/pages.h"

#include "broker/control/parts.h"
#include "broker/mail/journal.h"

/* The journal never writes through these; idlc makes no const members. */
static char *unconst(const char *s)
{
    return (char *)(uintptr_t)s;
}

static bool membership_line(struct broker *b, uint32_t slot, struct journal_line *out)
{
    const struct groups *g = &b->pages.groups;
    if (changes_version(&g->changes, slot) == 0) {
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
    pages_tell(b);
    return taken;
}

static bool offer_line(struct broker *b, uint32_t slot, struct journal_line *out)
{
    const struct services *s = &b->pages.services;
    if (changes_version(&s->changes, slot) == 0) {
        return false;
    }
    muster_Offer o;
    services_line(s, slot, true, &o);
    *out = (struct journal_line){.key = o.service,
                                 .agent = o.agent,
                                 .present = o.offered,
                                 .attributes = o.attributes,
                                 .origin = o.origin,
                                 .lease_ns = pages_lease_ns(b, slot),
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
    struct said said = pages_said(b);
    uint64_t mail_ns = runclock_mail_ns(&b->clock);
    bool taken = services_merge(&b->pages.services, &o, &said, mail_ns) == MU_OK;
    pages_tell(b);
    return taken;
}

void pages_journal_attach(struct broker *b)
{
    static const struct journal_source groups = {
        .capacity = MU_MEMBERSHIPS_MAX, .line = membership_line, .restore = membership_restore};
    static const struct journal_source services = {
        .capacity = MU_SERVICES_MAX, .line = offer_line, .restore = offer_restore};
    journal_attach(b, JOURNAL_GROUPS, &groups);
    journal_attach(b, JOURNAL_SERVICES, &services);
}

static void lines_mark(struct broker *b, enum journal_lines lines, struct changes *c,
                       uint64_t since)
{
    for (uint32_t line = changes_gone(c); line != MU_NONE; line = changes_gone(c)) {
        journal_line_changed(b, lines, line);
    }
    for (uint32_t line = changes_after(c, since); line != MU_NONE; line = changes_next(c, line)) {
        journal_line_changed(b, lines, line);
    }
}

void pages_journal_mark(struct broker *b, uint64_t groups_since, uint64_t services_since)
{
    lines_mark(b, JOURNAL_GROUPS, &b->pages.groups.changes, groups_since);
    lines_mark(b, JOURNAL_SERVICES, &b->pages.services.changes, services_since);
}
