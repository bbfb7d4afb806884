/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/services/services.h"

#include "broker/control/parts.h"
#include "core/fields.h"
#include "core/name.h"

#include <string.h>

void desk_take(struct broker *b, uint32_t own, struct mail *m)
{
    bool asks_state = m->letter.layer == 2 && strcmp(m->letter.performative, "state") == 0;
    if (m->letter.layer == 0) {
        directive_take(b, own, m);
    } else if (asks_state) {
        counters_answer(b, own, m);
    } else if (own == REGISTRY_BROKER) {
        desk_answer(b, m);
    } else {
        query_refuse(b, own, m);
    }
}

/* Who asks in lock step is told of its members, and of nothing that another run would have
 * otherwise. */
static bool is_shown(const struct broker *b, const struct mail *question, uint32_t agent)
{
    return !names_in_lockstep(b, question->sender) || agent == REGISTRY_BROKER ||
           names_in_lockstep(b, agent);
}

static void query_lookup(struct broker *b, const struct mail *question)
{
    query_name name;
    struct mu_text t;
    if (!query_read_name(b, question, name)) {
        return;
    }
    uint32_t agent = registry_find(&b->registry, name);
    if (agent == MU_NONE || !is_shown(b, question, agent)) {
        answer_begin(b, &t, "unknown-name");
        mu_fields_add(&t, name);
        answer_send(b, question, "failure");
        return;
    }
    muster_Member m;
    registry_line(&b->registry, agent, b->name, &m);
    answer_begin(b, &t, "member");
    mu_fields_add(&t, m.name);
    mu_fields_add(&t, border_kind_word(m.kind));
    mu_fields_add(&t, border_state_word(m.state));
    mu_fields_add(&t, m.broker);
    bool inside = names_in_lockstep(b, question->sender);
    mu_fields_add(&t, m.host);
    mu_text_format(&t, " %lu", inside ? 0ul : (unsigned long)m.pid);
    answer_send(b, question, "inform");
}

static void query_listing(struct broker *b, const struct mail *question)
{
    struct query_list list;
    query_list_begin(b, &list, question, "members", "");
    for (uint32_t i = 0; i < b->registry.count; i++) {
        uint32_t agent = b->registry.order[i];
        if (is_shown(b, question, agent)) {
            query_list_add(b, &list, b->registry.agents[agent].name);
        }
    }
    query_list_end(b, &list);
}

static void (*const answers[QUERY_VERBS])(struct broker *b, const struct mail *question) = {
    [QUERY_LOOKUP] = query_lookup,
    [QUERY_LISTING] = query_listing,
    [QUERY_GROUPS] = query_groups,
    [QUERY_MEMBERS] = query_members,
    [QUERY_GROUP_CREATE] = query_group_create,
    [QUERY_GROUP_JOIN] = query_group_join,
    [QUERY_GROUP_LEAVE] = query_group_leave,
    [QUERY_ADVERTISE] = query_advertise,
    [QUERY_WITHDRAW] = query_withdraw,
    [QUERY_FIND_SERVICE] = query_find_service,
    [QUERY_SUBSCRIBE] = query_subscribe,
    [QUERY_UNSUBSCRIBE] = query_unsubscribe,
};

void desk_answer(struct broker *b, const struct mail *question)
{
    enum audience_verb verb = audience_verb(question);
    if (verb < QUERY_VERBS) {
        answers[verb](b, question);
    } else {
        query_refuse(b, REGISTRY_BROKER, question);
    }
}
