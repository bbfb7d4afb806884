/* SPDX-License-Identifier: Apache-2.0 */
/* Questions to the groups, and changes of them. */
#include "broker/parts.h"
#include "broker/query.h"
#include "core/fields.h"

#include <string.h>

/* Room for a name that is none, so that it can be told. */
typedef char name_read[MU_FIELD_MAX + 1];

static bool group_read(struct broker *b, const struct mail *question, name_read name)
{
    struct mu_text read;
    mu_text_init(&read, name, sizeof(name_read));
    if (query_field(question->letter.content, &read)) {
        return true;
    }
    b->counters.malformed++;
    query_not_understood(b, question);
    return false;
}

/* --- changes ---------------------------------------------------------------------------------- */

void query_group_create(struct broker *b, const struct mail *question)
{
    name_read group;
    if (group_read(b, question, group)) {
        struct said said = pages_said(b);
        const char *refusal = groups_create(&b->pages.groups, group, &said);
        pages_tell(b);
        query_changed(b, question, refusal, group);
    }
}

typedef const char *group_change(struct groups *g, const char *group, const char *agent,
                                 const struct said *said);

/* GROUP, and whom it is about, if that is not the sender. */
static void member_change(struct broker *b, const struct mail *question, group_change *change)
{
    name_read group, named;
    const char *content = question->letter.content;
    if (!query_field_optional(&content, group, sizeof group) || group[0] == '\0' ||
        !query_field_optional(&content, named, sizeof named) || !mu_fields_end(content)) {
        b->counters.malformed++;
        query_not_understood(b, question);
        return;
    }
    const char *agent = query_actor(b, question, named);
    if (agent) {
        struct said said = pages_said(b);
        const char *refusal = change(&b->pages.groups, group, agent, &said);
        pages_tell(b);
        query_changed(b, question, refusal, group);
    }
}

void query_group_join(struct broker *b, const struct mail *question)
{
    member_change(b, question, groups_join);
}

void query_group_leave(struct broker *b, const struct mail *question)
{
    member_change(b, question, groups_leave);
}

/* --- questions -------------------------------------------------------------------------------- */

void query_groups(struct broker *b, const struct mail *question)
{
    struct mu_text t;
    bool inside = pages_inside(b, question->sender);
    uint32_t place = 0;
    query_begin(b, &t, "groups");
    for (const char *name; (name = groups_name(&b->pages.groups, inside, &place));) {
        if (t.len + 1 + strlen(name) > MU_CONTENT_MAX) {
            query_send(b, question, "inform");
            query_begin(b, &t, "groups");
        }
        mu_fields_add(&t, name);
    }
    query_send(b, question, "inform");
}

static void members_begin(struct broker *b, struct mu_text *t, const char *group)
{
    query_begin(b, t, "members-of");
    mu_fields_add(t, group);
}

void query_members(struct broker *b, const struct mail *question)
{
    name_read group;
    struct mu_text t;
    bool inside = pages_inside(b, question->sender);
    if (!group_read(b, question, group)) {
        return;
    }
    if (strlen(group) > MU_NAME_MAX || !groups_exists(&b->pages.groups, group, inside)) {
        query_begin(b, &t, "unknown-group");
        mu_fields_add(&t, group);
        query_send(b, question, "failure");
        return;
    }
    uint32_t place = 0;
    members_begin(b, &t, group);
    for (const char *name; (name = groups_member(&b->pages.groups, group, inside, &place));) {
        if (t.len + 1 + strlen(name) > MU_CONTENT_MAX) {
            query_send(b, question, "inform");
            members_begin(b, &t, group);
        }
        mu_fields_add(&t, name);
    }
    query_send(b, question, "inform");
}
