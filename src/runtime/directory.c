/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/directory.h"

#include "core/text.h"
#include "muster/memory.h"
#include "runtime/process.h"

#include <string.h>

void directory_init(struct directory *d)
{
    *d = (struct directory){0};
    mu_pairs_init(&d->groups, MU_GROUPS_MAX);
    d->said = mu_startup_array(MU_GROUPS_MAX, sizeof *d->said);
    mu_pairs_init(&d->members, MU_MEMBERSHIPS_MAX);
    mu_pairs_init(&d->offers, MU_SERVICES_MAX);
    d->lines = mu_startup_array(MU_SERVICES_MAX, sizeof *d->lines);
    d->cursor = mu_startup_alloc(sizeof *d->cursor);
    d->watches = mu_startup_array(MU_WATCHES_MAX, sizeof *d->watches);
}

/* --- groups ----------------------------------------------------------------------------------- */

/* A group is there when the broker says so, or when it has members. */
static void group_refresh(struct directory *d, const char *name, bool said)
{
    uint32_t group = mu_pairs_find(&d->groups, name, "");
    uint32_t first = mu_pairs_start(&d->members, name);
    bool there = said || mu_pairs_of(&d->members, first, name) != MU_NONE;
    if (there && group == MU_NONE) {
        group = mu_pairs_add(&d->groups, name, "");
    } else if (!there && group != MU_NONE) {
        mu_pairs_remove(&d->groups, group);
        group = MU_NONE;
    }
    if (group != MU_NONE) {
        d->said[group] = said;
    }
}

void directory_set_membership(struct directory *d, const muster_Membership *line)
{
    if (line->agent[0] == '\0') {
        group_refresh(d, line->group, line->joined);
        return;
    }
    uint32_t member = mu_pairs_find(&d->members, line->group, line->agent);
    if (line->joined && member == MU_NONE) {
        (void)mu_pairs_add(&d->members, line->group, line->agent); /* full: it is left out */
    } else if (!line->joined && member != MU_NONE) {
        mu_pairs_remove(&d->members, member);
    }
    uint32_t group = mu_pairs_find(&d->groups, line->group, "");
    group_refresh(d, line->group, group != MU_NONE && d->said[group]);
}

const char *mu_process_group(const mu_process *p, size_t index)
{
    const struct mu_pairs *groups = &p->directory.groups;
    return index < groups->count ? mu_pairs_first(groups, groups->order[index]) : NULL;
}

static bool is_short(const char *name, size_t max)
{
    return name && strnlen(name, max + 1) <= max;
}

const char *mu_process_group_member(const mu_process *p, const char *group, size_t index)
{
    const struct mu_pairs *members = &p->directory.members;
    if (index >= members->count || !is_short(group, MU_NAME_MAX)) {
        return NULL;
    }
    uint32_t place = mu_pairs_start(members, group) + (uint32_t)index;
    uint32_t member = mu_pairs_of(members, place, group);
    return member == MU_NONE ? NULL : mu_pairs_second(members, member);
}

bool mu_process_in_group(const mu_process *p, const char *group, const char *agent)
{
    return is_short(group, MU_NAME_MAX) && is_short(agent, MU_NAME_MAX) &&
           mu_pairs_find(&p->directory.members, group, agent) != MU_NONE;
}

/* --- services --------------------------------------------------------------------------------- */

static bool watch_knows(const struct directory_watch *w, uint32_t line)
{
    return (w->told[line / 64] >> (line % 64) & 1u) != 0;
}

static void watch_tell(struct directory_watch *w, uint32_t line, const struct mu_service *service,
                       bool there)
{
    if (!w->agent) {
        return;
    }
    bool found = there && mu_attributes_match(&w->query, service->service, service->attributes);
    if (found == watch_knows(w, line)) {
        return;
    }
    w->told[line / 64] ^= 1ull << (line % 64);
    const struct mu_handlers *h = &w->agent->handlers;
    if (h->on_service) {
        h->on_service(h->self, w->agent, service, found);
    }
}

/* The service that handlers get stays as it is, whatever they change. */
static void watches_tell(struct directory *d, uint32_t line, bool there)
{
    struct mu_service service = d->lines[line];
    for (uint32_t i = 0; i < d->watches_count; i++) {
        if (!d->watches[i].fresh) {
            watch_tell(&d->watches[i], line, &service, there);
        }
    }
}

void directory_forget(struct directory *d, const mu_agent *a)
{
    for (uint32_t i = 0; i < d->watches_count; i++) {
        if (d->watches[i].agent == a) {
            d->watches[i].agent = NULL;
            d->watches[i].fresh = false;
        }
    }
}

void directory_settle(struct directory *d)
{
    while (d->fresh) {
        d->fresh = false;
        for (uint32_t i = 0; i < d->watches_count; i++) {
            struct directory_watch *w = &d->watches[i];
            bool fresh = w->fresh;
            w->fresh = false; /* until a handler ends it, and another begins in its place */
            for (uint32_t place = 0; fresh && place < d->offers.count; place++) {
                uint32_t line = d->offers.order[place];
                struct mu_service service = d->lines[line];
                watch_tell(w, line, &service, true);
            }
        }
    }
}

void directory_set_offer(struct directory *d, const muster_Offer *offer)
{
    uint32_t line = mu_pairs_find(&d->offers, offer->service, offer->agent);
    if (line == MU_NONE && !offer->offered) {
        return;
    }
    d->version++;
    if (!offer->offered) {
        watches_tell(d, line, false);
        mu_pairs_remove(&d->offers, line);
        return;
    }
    if (line == MU_NONE) {
        line = mu_pairs_add(&d->offers, offer->service, offer->agent);
    }
    if (line == MU_NONE) {
        return;
    }
    struct mu_service *service = &d->lines[line];
    mu_text_copy(service->service, sizeof service->service, offer->service);
    mu_text_copy(service->agent, sizeof service->agent, offer->agent);
    mu_text_copy(service->attributes, sizeof service->attributes, offer->attributes);
    watches_tell(d, line, true);
}

void directory_clear(struct directory *d, bool silently)
{
    while (d->members.count > 0) {
        mu_pairs_remove(&d->members, d->members.order[d->members.count - 1]);
    }
    while (d->groups.count > 0) {
        mu_pairs_remove(&d->groups, d->groups.order[d->groups.count - 1]);
    }
    for (uint32_t i = 0; i < d->watches_count && silently; i++) {
        memset(d->watches[i].told, 0, sizeof d->watches[i].told);
    }
    while (d->offers.count > 0) {
        uint32_t line = d->offers.order[d->offers.count - 1];
        if (!silently) {
            watches_tell(d, line, false);
        }
        mu_pairs_remove(&d->offers, line);
    }
    d->version++;
}

/* @return whether the cursor stands in this search, not behind the line that is wanted */
static bool cursor_serves(const struct directory *d, const char *query, size_t index)
{
    const struct directory_cursor *c = d->cursor;
    return c->begun && c->version == d->version && c->index <= index && strcmp(c->text, query) == 0;
}

static bool cursor_begin(const struct directory *d, const char *query)
{
    struct directory_cursor *c = d->cursor;
    c->begun = false;
    if (mu_attributes_query(&c->query, query) != MU_OK) {
        return false;
    }
    mu_text_copy(c->text, sizeof c->text, query);
    c->begun = true;
    c->version = d->version;
    c->place = 0;
    c->index = 0;
    return true;
}

const struct mu_service *mu_process_find_service(const mu_process *p, const char *query,
                                                 size_t index)
{
    const struct directory *d = &p->directory;
    struct directory_cursor *c = d->cursor;
    if (!is_short(query, MU_QUERY_MAX) ||
        (!cursor_serves(d, query, index) && !cursor_begin(d, query))) {
        return NULL;
    }
    for (; c->place < d->offers.count; c->place++) {
        const struct mu_service *s = &d->lines[d->offers.order[c->place]];
        if (!mu_attributes_match(&c->query, s->service, s->attributes)) {
            continue;
        }
        if (c->index == index) {
            return s;
        }
        c->index++;
    }
    return NULL;
}
