/* SPDX-License-Identifier: Apache-2.0 */
/* What a trust policy asks of groups and services. */
#include "broker/control/parts.h"
#include "core/text.h"

/* Whoever is in a lock step is seen as those inside see it, and so is everybody by them. */
static bool is_asked_inside(const struct broker *b, uint32_t agent)
{
    return b->pages.asked_inside || pages_inside(b, agent);
}

static bool in_group(void *self, const char *group, const char *name)
{
    const struct broker *b = self;
    uint32_t agent = registry_find(&b->registry, name);
    return agent != MU_NONE && groups_has(&b->pages.groups, group, name, is_asked_inside(b, agent));
}

/* An agent has the role R while it is shown with a service that has the attribute role=R. */
static bool has_role(void *self, const char *role, const char *name)
{
    const struct broker *b = self;
    const struct services *s = &b->pages.services;
    char text[sizeof "* role=" + MU_NAME_MAX];
    struct mu_text t;
    struct mu_query query;
    uint32_t agent = registry_find(&b->registry, name);
    mu_text_init(&t, text, sizeof text);
    mu_text_format(&t, "* role=%s", role);
    if (agent == MU_NONE || mu_attributes_query(&query, text) != MU_OK) {
        return false;
    }
    bool inside = is_asked_inside(b, agent);
    uint32_t place = mu_pairs_start(&s->by_agent, name), turned;
    while ((turned = mu_pairs_of(&s->by_agent, place++, name)) != MU_NONE) {
        uint32_t line = s->line_of[turned];
        if (pages_shows(b, line, inside) &&
            mu_attributes_match(&query, mu_pairs_first(&s->pairs, line),
                                s->lines[line].attributes)) {
            return true;
        }
    }
    return false;
}

void pages_trust_attach(struct broker *b)
{
    b->trust.pages = (struct trust_pages){.self = b, .in_group = in_group, .has_role = has_role};
}
