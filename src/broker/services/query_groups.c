/* SPDX-License-Identifier: Apache-2.0 */
/* Questions to the groups, and changes of them. */
#include "broker/services/services.h"

#include "broker/control/parts.h"
#include "core/fields.h"

#include <string.h>

/* --- changes ---------------------------------------------------------------------------------- */

void query_group_create(struct broker *b, const struct mail *question)
{
    query_name group;
    if (query_read_name(b, question, group)) {
        struct said said = view_said(b);
        const char *refusal = groups_create(&b->pages.groups, group, &said);
        notify_tell(b);
        query_changed(b, question, refusal, group);
    }
}

static const char *member_join(struct broker *b, const char *group, const char *agent,
                               const struct said *said)
{
    return groups_join(&b->pages.groups, group, agent, said);
}

void query_group_join(struct broker *b, const struct mail *question)
{
    query_make_change(b, question, member_join);
}

static const char *member_leave(struct broker *b, const char *group, const char *agent,
                                const struct said *said)
{
    return groups_leave(&b->pages.groups, group, agent, said);
}

void query_group_leave(struct broker *b, const struct mail *question)
{
    query_make_change(b, question, member_leave);
}

/* --- questions -------------------------------------------------------------------------------- */

void query_groups(struct broker *b, const struct mail *question)
{
    struct query_list list;
    bool inside = view_inside(b, question->sender);
    uint32_t place = 0;
    query_list_begin(b, &list, question, "groups", "");
    for (const char *name; (name = groups_name(&b->pages.groups, inside, &place));) {
        query_list_add(b, &list, name);
    }
    query_list_end(b, &list);
}

static void group_unknown(struct broker *b, const struct mail *question, const char *group)
{
    struct mu_text t;
    answer_begin(b, &t, "unknown-group");
    mu_fields_add(&t, group);
    answer_send(b, question, "failure");
}

void query_members(struct broker *b, const struct mail *question)
{
    query_name group;
    struct query_list list;
    bool inside = view_inside(b, question->sender);
    uint32_t place = 0;
    if (!query_read_name(b, question, group)) {
        return;
    }
    if (strlen(group) > MU_NAME_MAX || !groups_exists(&b->pages.groups, group, inside)) {
        group_unknown(b, question, group);
        return;
    }
    query_list_begin(b, &list, question, "members-of", group);
    for (const char *name; (name = groups_member(&b->pages.groups, group, inside, &place));) {
        query_list_add(b, &list, name);
    }
    query_list_end(b, &list);
}
