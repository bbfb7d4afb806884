/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"

#include <stdio.h>
#include <string.h>

/* --- what is shown ---------------------------------------------------------------------------- */

bool view_inside(const struct broker *b, uint32_t agent)
{
    return scope_is_inside(b->registry.agents[agent].scope);
}

bool view_shows(const struct broker *b, uint32_t line, bool inside)
{
    const struct lines *s = &b->pages.services;
    if (!s->at[line].holds) {
        return false;
    }
    uint32_t agent = registry_find(&b->registry, mu_pairs_second(&s->pairs, line));
    return agent != MU_NONE && b->registry.agents[agent].process != MU_NONE &&
           (!inside || view_inside(b, agent));
}

bool view_process_is_told(const struct process *at)
{
    return processes_is_matched(at) && (at->agents_count > 0 || at->kind == PROCESS_BROKER) &&
           scope_is_shown_lines(at->scope);
}

/* The versions that every process has had: what is older may be forgotten. */
static void told_update(struct broker *b)
{
    struct pages *p = &b->pages;
    p->groups.told = p->groups.changes.version;
    p->services.told = p->services.changes.version;
    for (uint32_t i = 0; i < b->processes.top; i++) {
        const struct process *at = &b->processes.at[i];
        if (view_process_is_told(at)) {
            p->groups.told = at->groups_had < p->groups.told ? at->groups_had : p->groups.told;
            p->services.told =
                at->services_had < p->services.told ? at->services_had : p->services.told;
        }
    }
}

struct said view_said(struct broker *b)
{
    if (lines_full(&b->pages.groups) || lines_full(&b->pages.services)) {
        told_update(b);
    }
    return (struct said){.stamp_ns = clock_stamp_ns(&b->clock),
                         .origin = b->name,
                         .inside = !clock_collects(&b->clock),
                         .mail_ns = clock_mail_ns(&b->clock)};
}

/* What was said inside has a stamp of the run, and a lease that counts its time. */
uint64_t view_lease_ns(const struct broker *b, uint32_t line)
{
    const struct line *at = &b->pages.services.at[line];
    const struct line_offer *l = &b->pages.services.offers[line];
    uint64_t wall_ns = clock_wall_ns(&b->clock), mail_ns = clock_mail_ns(&b->clock);
    if (l->lease_ns == 0 || l->until_ns == UINT64_MAX || !at->holds) {
        return l->lease_ns;
    }
    uint64_t age_ns = wall_ns > at->stamp_ns ? wall_ns - at->stamp_ns : 0;
    uint64_t left_ns = l->until_ns > mail_ns ? l->until_ns - mail_ns : 1;
    return age_ns < INT64_MAX && left_ns < INT64_MAX - age_ns ? age_ns + left_ns : INT64_MAX;
}

/* --- deliveries ------------------------------------------------------------------------------- */

static void memberships_fill(struct lines *g, const struct process *at, muster_Delivery *d)
{
    bool inside = scope_is_inside(at->scope);
    uint32_t max = inside ? MU_MEMBERSHIPS_MAX : PAGES_MEMBERSHIPS;
    for (uint32_t line = changelog_after(&g->changes, at->groups_had);
         line != MU_NONE && d->memberships._length < max;
         line = changelog_next(&g->changes, line)) {
        struct line_word w = lines_word(g, line, inside);
        d->memberships._buffer[d->memberships._length++] = (muster_Membership){
            sample_text(w.key), sample_text(w.agent), w.present, w.stamp_ns, sample_text(w.origin)};
        g->open = changelog_version(&g->changes, line);
    }
}

static void offers_fill(struct broker *b, const struct process *at, muster_Delivery *d)
{
    struct lines *s = &b->pages.services;
    bool inside = scope_is_inside(at->scope);
    uint32_t max = inside ? MU_SERVICES_MAX : PAGES_OFFERS;
    for (uint32_t line = changelog_after(&s->changes, at->services_had);
         line != MU_NONE && d->offers._length < max; line = changelog_next(&s->changes, line)) {
        /* Another broker sees for itself what it shows. */
        struct line_word w = lines_word(s, line, inside);
        d->offers._buffer[d->offers._length++] = (muster_Offer){
            .service = sample_text(w.key),
            .agent = sample_text(w.agent),
            .offered = at->kind == PROCESS_BROKER ? w.present : view_shows(b, line, inside),
            .attributes = sample_text(w.attributes),
            .lease_ns = at->kind == PROCESS_BROKER ? view_lease_ns(b, line) : w.lease_ns,
            .stamp_ns = w.stamp_ns,
            .origin = sample_text(w.origin)};
        s->open = changelog_version(&s->changes, line);
    }
}

void view_fill(struct broker *b, const struct process *at, muster_Delivery *d)
{
    if (view_process_is_told(at)) {
        memberships_fill(&b->pages.groups, at, d);
        offers_fill(b, at, d);
    }
}

uint32_t view_resolver(const struct broker *b, const char *dst)
{
    char text[MU_QUERY_MAX + 1];
    struct mu_query query;
    const struct lines *s = &b->pages.services;
    const struct mu_pairs *pairs = &s->pairs;
    snprintf(text, sizeof text, "resolver scheme=%.*s", (int)strcspn(dst, ":"), dst);
    if (mu_attributes_query(&query, text) != MU_OK) {
        return MU_NONE;
    }
    uint32_t place = mu_pairs_start(pairs, "resolver"), line;
    while ((line = mu_pairs_of(pairs, place++, "resolver")) != MU_NONE) {
        uint32_t agent = registry_find(&b->registry, mu_pairs_second(pairs, line));
        /* An agent of another broker answers to that one. */
        if (agent != MU_NONE && b->registry.agents[agent].is.home[0] == '\0' &&
            mu_attributes_match(&query, "resolver", s->offers[line].attributes) &&
            view_shows(b, line, clock_by_steps(&b->clock))) {
            return agent;
        }
    }
    return MU_NONE;
}
