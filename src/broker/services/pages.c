/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/services/pages.h"

#include "broker/control/parts.h"
#include "broker/membership/presence.h"
#include "broker/services/query.h"
#include "core/fields.h"
#include "muster/memory.h"

#include <string.h>

void pages_init(struct pages *p)
{
    *p = (struct pages){0};
    groups_init(&p->groups);
    services_init(&p->services);
    subscriptions_init(&p->subscriptions);
    p->services.told_to = &p->subscriptions;
    /* In lock step one Delivery holds everything. */
    p->memberships = mu_startup_array(MU_MEMBERSHIPS_MAX, sizeof *p->memberships);
    p->offers = mu_startup_array(MU_SERVICES_MAX, sizeof *p->offers);
}

/* --- what is shown ---------------------------------------------------------------------------- */

bool pages_inside(const struct broker *b, uint32_t agent)
{
    return b->lockstep.on && presence_in_lockstep(b, agent);
}

bool pages_shows(const struct broker *b, uint32_t line, bool inside)
{
    const struct services *s = &b->pages.services;
    if (!s->lines[line].offered) {
        return false;
    }
    uint32_t agent = registry_find(&b->registry, mu_pairs_second(&s->pairs, line));
    return agent != MU_NONE && b->registry.agents[agent].process != MU_NONE &&
           (!inside || pages_inside(b, agent));
}

/* --- changes ---------------------------------------------------------------------------------- */

static bool place_is_told(const struct place *at)
{
    return at->used && at->matched && (at->agents_count > 0 || at->is_broker) && !at->simulator;
}

/* The versions that every process has had: what is older may be forgotten. */
static void told_update(struct broker *b)
{
    struct pages *p = &b->pages;
    p->groups.told = p->groups.changes.version;
    p->services.told = p->services.changes.version;
    for (uint32_t i = 0; i < b->places.top; i++) {
        const struct place *at = &b->places.at[i];
        if (place_is_told(at)) {
            p->groups.told = at->groups_had < p->groups.told ? at->groups_had : p->groups.told;
            p->services.told =
                at->services_had < p->services.told ? at->services_had : p->services.told;
        }
    }
}

struct said pages_said(struct broker *b)
{
    if (groups_full(&b->pages.groups) || services_full(&b->pages.services)) {
        told_update(b);
    }
    return (struct said){
        .stamp_ns = b->lockstep.on ? runclock_run_ns(&b->clock) : presence_wall_ns(b),
        .origin = b->name,
        .inside = !b->lockstep.on || b->lockstep.applying,
    };
}

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
    query_inform(b, receiver, s->in_reply_to, s->conversation);
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
                 pages_shows(b, line, pages_inside(b, receiver));
    bool owed = !pages_inside(b, receiver) && subscriptions_owe(s, line, false);
    bool news = (owed && !found) || subscriptions_note(s, line, found);
    if (news && silently) {
        (void)subscriptions_owe(s, line, !found);
    } else if (news) {
        (void)subscriptions_owe(s, line, false);
        subscriber_send(b, receiver, s, line, found);
    }
}

void pages_review(struct broker *b, struct subscription *s, bool silently)
{
    const struct mu_pairs *pairs = &b->pages.services.pairs;
    for (uint32_t i = 0; i < pairs->count; i++) {
        subscriber_tell(b, s, pairs->order[i], silently);
    }
}

static void subscribers_tell(struct broker *b, uint64_t since)
{
    struct pages *p = &b->pages;
    for (uint32_t line = changes_after(&p->services.changes, since); line != MU_NONE;
         line = changes_next(&p->services.changes, line)) {
        for (uint32_t i = 0; i < p->subscriptions.count; i++) {
            subscriber_tell(b, subscriptions_at(&p->subscriptions, i), line, false);
        }
    }
}

void pages_tell(struct broker *b)
{
    struct pages *p = &b->pages;
    uint64_t services = p->services.changes.version, groups = p->groups.changes.version;
    if (p->services_seen == services && p->groups_seen == groups) {
        return;
    }
    uint64_t since = p->services_seen;
    pages_journal_mark(b, p->groups_seen, since);
    p->services_seen = services;
    p->groups_seen = groups;
    subscribers_tell(b, since);
    for (uint32_t i = 0; i < b->places.top; i++) {
        if (place_is_told(&b->places.at[i])) {
            places_wake(&b->places, i);
        }
    }
}

void pages_presence(struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    services_touch(&b->pages.services, a->name);
    pages_tell(b);
    for (uint32_t i = 0; i < b->pages.subscriptions.count && a->process != MU_NONE; i++) {
        struct subscription *s = subscriptions_at(&b->pages.subscriptions, i);
        if (strcmp(s->agent, a->name) == 0) {
            pages_review(b, s, false);
        }
    }
}

void pages_expire(struct broker *b, uint64_t mail_ns)
{
    services_expire(&b->pages.services, mail_ns);
    pages_tell(b);
}

uint64_t pages_deadline_mail_ns(const struct broker *b)
{
    return b->pages.services.soonest_ns;
}

/* --- the lock step ---------------------------------------------------------------------------- */

static void subscribers_review(struct broker *b, bool silently)
{
    for (uint32_t i = 0; i < b->pages.subscriptions.count; i++) {
        pages_review(b, subscriptions_at(&b->pages.subscriptions, i), silently);
    }
}

void pages_freeze(struct broker *b)
{
    groups_freeze(&b->pages.groups);
    subscribers_review(b, true); /* what is not seen inside goes without a word */
}

void pages_thaw(struct broker *b)
{
    groups_freeze(&b->pages.groups); /* there is one view now */
    subscribers_review(b, false);
}

void pages_enter(struct broker *b, uint32_t agent)
{
    const char *name = b->registry.agents[agent].name;
    groups_enter(&b->pages.groups, name);
    pages_presence(b, agent);
}

/* What was said in a lock step has a stamp of the run, and a lease that counts its time. */
uint64_t pages_lease_ns(const struct broker *b, uint32_t line)
{
    const struct service_line *l = &b->pages.services.lines[line];
    uint64_t wall_ns = presence_wall_ns(b), mail_ns = runclock_mail_ns(&b->clock);
    if (l->lease_ns == 0 || l->until_ns == UINT64_MAX || !l->offered) {
        return l->lease_ns;
    }
    uint64_t age_ns = wall_ns > l->stamp_ns ? wall_ns - l->stamp_ns : 0;
    uint64_t left_ns = l->until_ns > mail_ns ? l->until_ns - mail_ns : 1;
    return age_ns < INT64_MAX && left_ns < INT64_MAX - age_ns ? age_ns + left_ns : INT64_MAX;
}

/* --- deliveries ------------------------------------------------------------------------------- */

void pages_forget_told(struct place *at)
{
    at->groups_had = at->services_had = 0;
}

static void memberships_fill(struct broker *b, const struct place *at, muster_Delivery *d)
{
    struct pages *p = &b->pages;
    const struct changes *c = &p->groups.changes;
    uint32_t max = at->rostered ? MU_MEMBERSHIPS_MAX : PAGES_MEMBERSHIPS;
    p->groups_open = at->groups_had;
    for (uint32_t line = changes_after(c, at->groups_had);
         line != MU_NONE && d->memberships._length < max; line = changes_next(c, line)) {
        groups_line(&p->groups, line, at->rostered,
                    &d->memberships._buffer[d->memberships._length++]);
        p->groups_open = changes_version(c, line);
    }
}

static void offers_fill(struct broker *b, const struct place *at, muster_Delivery *d)
{
    struct pages *p = &b->pages;
    const struct changes *c = &p->services.changes;
    uint32_t max = at->rostered ? MU_SERVICES_MAX : PAGES_OFFERS;
    p->services_open = at->services_had;
    for (uint32_t line = changes_after(c, at->services_had);
         line != MU_NONE && d->offers._length < max; line = changes_next(c, line)) {
        /* Another broker sees for itself whom it shows. */
        muster_Offer *offer = &d->offers._buffer[d->offers._length++];
        services_line(&p->services, line, at->is_broker || pages_shows(b, line, at->rostered),
                      offer);
        offer->lease_ns = at->is_broker ? pages_lease_ns(b, line) : offer->lease_ns;
        p->services_open = changes_version(c, line);
    }
}

void pages_fill(struct broker *b, const struct place *at, muster_Delivery *d)
{
    struct pages *p = &b->pages;
    d->memberships._buffer = p->memberships;
    d->offers._buffer = p->offers;
    p->groups_open = at->groups_had;
    p->services_open = at->services_had;
    if (place_is_told(at)) {
        memberships_fill(b, at, d);
        offers_fill(b, at, d);
    }
    d->memberships._maximum = d->memberships._length;
    d->offers._maximum = d->offers._length;
}

bool pages_has_told(const struct broker *b, const struct place *at)
{
    const struct pages *p = &b->pages;
    return changes_after(&p->groups.changes, at->groups_had) == MU_NONE &&
           changes_after(&p->services.changes, at->services_had) == MU_NONE;
}

void pages_delivered(struct broker *b, struct place *at)
{
    at->groups_had = b->pages.groups_open;
    at->services_had = b->pages.services_open;
}
