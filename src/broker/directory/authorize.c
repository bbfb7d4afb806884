/* SPDX-License-Identifier: Apache-2.0 */
/* What a trust policy asks of groups and services. */
#include "broker/control/parts.h"

static struct audit_record *record_of(struct broker *b, uint32_t sender, const char *performative,
                                      const char *line, bool allowed)
{
    struct audit_record *r = audit_add(&b->audit);
    if (r) {
        r->allowed = allowed;
        r->simulated = clock_by_steps(&b->clock);
        r->time_ns = clock_stamp_ns(&b->clock);
        (void)mu_text_copy(r->sender, sizeof r->sender, b->registry.agents[sender].name);
        (void)mu_text_copy(r->process, sizeof r->process, b->registry.agents[sender].place);
        (void)mu_text_copy(r->performative, sizeof r->performative, performative);
        (void)mu_text_copy(r->line, sizeof r->line, line);
    }
    return r;
}

static struct audit_record *record_begin(struct broker *b, const struct mail *m, bool allowed)
{
    return record_of(b, m->sender, m->letter.performative, m->letter.content, allowed);
}

/* The sender, and what of the pages is asked in its matter. */
static struct trust_agent who_asks(struct broker *b, uint32_t sender)
{
    b->pages.asked_inside = view_inside(b, sender);
    return (struct trust_agent){b->registry.agents[sender].name,
                                b->registry.agents[sender].is.kind};
}

/* It has no receiver that is there; a sender that may direct none is not told so. */
static uint32_t sift_nobody(struct broker *b, const struct mail *m, const struct trust_agent *who)
{
    bool allowed = trust_allows_some(&b->trust, who);
    struct audit_record *r = record_begin(b, m, allowed);
    if (r) {
        (void)mu_text_copy(r->receiver, sizeof r->receiver, m->letter.dst);
    }
    return allowed ? 0 : 1;
}

static bool is_housemate(const struct broker *b, uint32_t agent, uint32_t other)
{
    uint32_t process = b->registry.agents[agent].process;
    return process != MU_NONE && process == b->registry.agents[other].process;
}

bool authorize_line(struct broker *b, const struct mail *m, uint32_t agent, const char *receiver)
{
    struct trust_agent who = who_asks(b, m->sender);
    bool allowed = false;
    if (agent == MU_NONE) {
        allowed = trust_allows_some(&b->trust, &who);
    } else if (is_housemate(b, m->sender, agent)) {
        return true;
    } else {
        struct trust_agent whom = {receiver, b->registry.agents[agent].is.kind};
        allowed = trust_allows(&b->trust, &who, &whom);
    }
    audit_receiver(record_begin(b, m, allowed), receiver);
    b->directed += allowed;
    b->unspoken += !allowed;
    return allowed;
}

/* The directive that follows a refusal is what is refused, counted and audited. */
bool authorize_probe(struct broker *b, uint32_t asker, uint32_t agent, const char *line)
{
    const struct agent *at = &b->registry.agents[agent];
    struct trust_agent who = who_asks(b, asker), whom = {at->name, at->is.kind};
    if (!trust_allows(&b->trust, &who, &whom)) {
        return false;
    }
    audit_receiver(record_of(b, asker, "glance", line, true), at->name);
    return true;
}

uint32_t authorize_mail(struct broker *b, const struct mail *m, uint32_t *agents, uint32_t *count)
{
    struct trust_agent who = who_asks(b, m->sender);
    struct audit_record *records[2] = {NULL, NULL};
    uint32_t numbers[2] = {0, 0};
    if (*count == 0) {
        numbers[false] = sift_nobody(b, m, &who);
    }
    for (uint32_t i = 0; i < *count; i++) {
        const struct agent *a = &b->registry.agents[agents[i]];
        struct trust_agent whom = {a->name, a->is.kind};
        bool allowed = trust_allows(&b->trust, &who, &whom);
        if (numbers[allowed]++ == 0) {
            records[allowed] = record_begin(b, m, allowed);
        }
        audit_receiver(records[allowed], a->name);
        if (allowed) {
            agents[numbers[true] - 1] = agents[i];
        }
    }
    *count = numbers[true];
    b->directed += numbers[true];
    b->counters.refused += numbers[false];
    return numbers[false];
}

/* An agent has the role R while it is shown with a service that has the attribute role=R. */
static bool has_role(const struct broker *b, const char *role, const char *agent, bool inside)
{
    const struct lines *s = &b->pages.services;
    char text[sizeof "* role=" + MU_NAME_MAX];
    struct mu_query query;
    struct mu_text t = mu_text_in(text, sizeof text);
    mu_text_format(&t, "* role=%s", role);
    if (mu_attributes_query(&query, text) != MU_OK) {
        return false;
    }
    uint32_t place = mu_pairs_start(&s->by_agent, agent), turned;
    while ((turned = mu_pairs_of(&s->by_agent, place++, agent)) != MU_NONE) {
        uint32_t line = s->line_of[turned];
        if (view_shows(b, line, inside) &&
            mu_attributes_match(&query, mu_pairs_first(&s->pairs, line),
                                s->offers[line].attributes)) {
            return true;
        }
    }
    return false;
}

/* A member of a run is seen as other members see it, and so are all agents by it. */
static bool party_has(void *self, const struct trust_party *party, const char *name)
{
    const struct broker *b = self;
    uint32_t agent = registry_find(&b->registry, name);
    if (agent == MU_NONE) {
        return false;
    }
    bool inside = b->pages.asked_inside || view_inside(b, agent);
    return party->kind == TRUST_GROUP ? groups_has(&b->pages.groups, party->name, name, inside)
                                      : has_role(b, party->name, name, inside);
}

void authorize_attach(struct broker *b)
{
    b->trust.pages = (struct trust_pages){.self = b, .has = party_has};
}
