/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "core/fields.h"

static bool is_shown(const struct broker *b, const struct mail *question, uint32_t agent)
{
    return scope_sees(b->registry.agents[question->sender].scope, b->registry.agents[agent].scope);
}

/* Reads a question that is one field.  @return false: answered, and counted */
static bool name_read(struct broker *b, const struct mail *question, request_name name)
{
    struct mu_text read = mu_text_in(name, sizeof(request_name));
    if (request_field(question->letter.content, &read)) {
        return true;
    }
    request_not_understood(b, question);
    return false;
}

static void list_add(struct broker *b, struct request_list *l, const char *name)
{
    request_list_room(b, l, 1 + strlen(name));
    mu_fields_add(&l->text, name);
}

/* Makes a change that NAME or NAME AGENT asks for, and answers it. */
static void change_make(struct broker *b, const struct mail *question, struct lines *table,
                        request_change *change)
{
    request_name name, named;
    const char *content = question->letter.content;
    if (!request_field_optional(&content, name, sizeof name) || name[0] == '\0' ||
        !request_field_optional(&content, named, sizeof named) || !mu_fields_end(content)) {
        request_not_understood(b, question);
        return;
    }
    const char *agent = request_actor(b, question, named);
    if (agent) {
        struct said said = view_said(b);
        request_changed(b, question, change(table, name, agent, &said), name);
    }
}

static void request_lookup(struct broker *b, const struct mail *question)
{
    request_name name;
    if (!name_read(b, question, name)) {
        return;
    }
    uint32_t agent = registry_find(&b->registry, name);
    if (agent == MU_NONE || !is_shown(b, question, agent)) {
        answer_word(b, question, "failure", "unknown-name", name);
        return;
    }
    muster_Member m;
    registry_line(&b->registry, agent, b->name, &m);
    struct mu_text t = answer_begin(b, "member");
    mu_fields_add(&t, m.name);
    mu_fields_add(&t, validate_kind_word(m.kind));
    mu_fields_add(&t, validate_state_word(m.state));
    mu_fields_add(&t, m.broker);
    bool inside = view_inside(b, question->sender);
    mu_fields_add(&t, m.host);
    mu_text_format(&t, " %lu", inside ? 0ul : (unsigned long)m.pid);
    answer_reply(b, REGISTRY_BROKER, question, "inform");
}

static void request_listing(struct broker *b, const struct mail *question)
{
    struct request_list list;
    request_list_begin(b, &list, question, "members", "");
    for (uint32_t i = 0; i < b->registry.live; i++) {
        uint32_t agent = b->registry.order[i];
        if (is_shown(b, question, agent)) {
            list_add(b, &list, b->registry.agents[agent].name);
        }
    }
    request_list_end(b, &list);
}

static void request_groups(struct broker *b, const struct mail *question)
{
    struct request_list list;
    bool inside = view_inside(b, question->sender);
    uint32_t place = 0;
    request_list_begin(b, &list, question, "groups", "");
    for (const char *name; (name = groups_name(&b->pages.groups, inside, &place));) {
        list_add(b, &list, name);
    }
    request_list_end(b, &list);
}

static void request_members(struct broker *b, const struct mail *question)
{
    request_name group;
    struct request_list list;
    bool inside = view_inside(b, question->sender);
    uint32_t place = 0;
    if (!name_read(b, question, group)) {
        return;
    }
    if (strlen(group) > MU_NAME_MAX || !groups_exists(&b->pages.groups, group, inside)) {
        answer_word(b, question, "failure", "unknown-group", group);
        return;
    }
    request_list_begin(b, &list, question, "members-of", group);
    for (const char *name; (name = groups_member(&b->pages.groups, group, inside, &place));) {
        list_add(b, &list, name);
    }
    request_list_end(b, &list);
}

static void request_group_create(struct broker *b, const struct mail *question)
{
    request_name group;
    if (name_read(b, question, group)) {
        struct said said = view_said(b);
        request_changed(b, question, groups_create(&b->pages.groups, group, &said), group);
    }
}

/* A question is answered; a change of groups or services is made in the name of an agent. */
static const struct {
    const char *performative;
    void (*answer)(struct broker *b, const struct mail *question);
    request_change *change;
    enum lines_kind table;
} verbs[] = {
    {"lookup", .answer = request_lookup},
    {"listing", .answer = request_listing},
    {"groups", .answer = request_groups},
    {"members", .answer = request_members},
    {"group-create", .answer = request_group_create},
    {"group-join", .change = groups_join, .table = LINES_GROUPS},
    {"group-leave", .change = groups_leave, .table = LINES_GROUPS},
    {"advertise", .answer = request_advertise},
    {"withdraw", .change = services_withdraw, .table = LINES_SERVICES},
    {"find-service", .answer = request_find_service},
    {"subscribe", .answer = request_subscribe},
    {"unsubscribe", .answer = request_unsubscribe},
};

enum { VERBS = sizeof verbs / sizeof verbs[0] };

/* Answers that this is not understood. */
static void request_refuse(struct broker *b, uint32_t own, const struct mail *question)
{
    struct mu_text t = answer_begin(b, "performative");
    mu_fields_add(&t, question->letter.performative);
    answer_reply(b, own, question, "not-understood");
}

static void handler_answer(struct broker *b, const struct mail *question)
{
    size_t i = 0;
    while (i < VERBS && strcmp(question->letter.performative, verbs[i].performative) != 0) {
        i++;
    }
    if (i == VERBS || question->letter.layer != 2) {
        request_refuse(b, REGISTRY_BROKER, question);
    } else if (verbs[i].change) {
        change_make(b, question, journal_table(b, verbs[i].table), verbs[i].change);
    } else {
        verbs[i].answer(b, question);
    }
}

void handlers_take(struct broker *b, uint32_t own, struct mail *m)
{
    bool asks_state = m->letter.layer == 2 && strcmp(m->letter.performative, "state") == 0;
    if (m->letter.layer == 0) {
        directive_take(b, own, m);
    } else if (asks_state) {
        metrics_answer(b, own, m);
    } else if (own == REGISTRY_BROKER) {
        handler_answer(b, m);
    } else {
        request_refuse(b, own, m);
    }
}
