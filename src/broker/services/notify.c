/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "core/fields.h"

/* --- changes ---------------------------------------------------------------------------------- */

static void subscriber_send(struct broker *b, uint32_t receiver, const struct subscription *s,
                            uint32_t line, bool came)
{
    const struct mu_pairs *pairs = &b->pages.services.pairs;
    struct mu_text t = answer_begin(b, came ? "came" : "went");
    mu_fields_add(&t, mu_pairs_first(pairs, line));
    mu_fields_add(&t, mu_pairs_second(pairs, line));
    if (came) {
        mu_fields_add_string(&t, b->pages.services.offers[line].attributes);
    }
    muster_Mail news = {.performative = sample_text("inform"),
                        .in_reply_to = sample_text(s->in_reply_to),
                        .conversation = sample_text(s->conversation)};
    answer_post(b, REGISTRY_BROKER, receiver, &news);
}

static void subscriber_tell(struct broker *b, struct subscription *s, uint32_t line, bool silently)
{
    uint32_t receiver = registry_find(&b->registry, s->agent);
    if (receiver == MU_NONE || b->registry.agents[receiver].process == MU_NONE) {
        return; /* is told when it is back */
    }
    const struct lines *all = &b->pages.services;
    bool found = mu_attributes_match(&s->query, mu_pairs_first(&all->pairs, line),
                                     all->offers[line].attributes) &&
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
    CHANGELOG_EACH (line, &p->services.changes, since) {
        for (uint32_t i = 0; i < p->subscriptions.count; i++) {
            subscriber_tell(b, subscriptions_at(&p->subscriptions, i), line, false);
        }
    }
}

void notify_tell(struct broker *b)
{
    struct pages *p = &b->pages;
    uint64_t since = p->services.seen;
    if (since == p->services.changes.version && p->groups.seen == p->groups.changes.version) {
        return;
    }
    p->groups.seen = p->groups.changes.version;
    p->services.seen = p->services.changes.version;
    subscribers_tell(b, since);
    for (uint32_t i = 0; i < b->processes.top; i++) {
        if (view_process_is_told(&b->processes.at[i])) {
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

/* --- a run by steps --------------------------------------------------------------------------- */

void notify_run(struct broker *b, bool begins)
{
    groups_freeze(&b->pages.groups); /* behind a run there is one view */
    for (uint32_t i = 0; i < b->pages.subscriptions.count; i++) {
        bool silently = begins; /* what is not seen inside goes without a word */
        notify_review(b, subscriptions_at(&b->pages.subscriptions, i), silently);
    }
}
