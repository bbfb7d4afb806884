/* SPDX-License-Identifier: Apache-2.0 */
/* Questions to the groups, and changes of them. */
#include "broker/services/services.h"

#include "broker/control/parts.h"
#include "core/fields.h"

#include <string.h>

/* --- changes ---------------------------------------------------------------------------------- */

void request_group_create(struct broker *b, const struct mail *question)
{
    request_name group;
    if (request_read_name(b, question, group)) {
        struct said said = view_said(b);
        request_changed(b, question, groups_create(&b->pages.groups, group, &said), group);
    }
}

/* --- questions -------------------------------------------------------------------------------- */

void request_groups(struct broker *b, const struct mail *question)
{
    struct request_list list;
    bool inside = view_inside(b, question->sender);
    uint32_t place = 0;
    request_list_begin(b, &list, question, "groups", "");
    for (const char *name; (name = groups_name(&b->pages.groups, inside, &place));) {
        request_list_add(b, &list, name);
    }
    request_list_end(b, &list);
}

void request_members(struct broker *b, const struct mail *question)
{
    request_name group;
    struct request_list list;
    bool inside = view_inside(b, question->sender);
    uint32_t place = 0;
    if (!request_read_name(b, question, group)) {
        return;
    }
    if (strlen(group) > MU_NAME_MAX || !groups_exists(&b->pages.groups, group, inside)) {
        answer_word(b, question, "failure", "unknown-group", group);
        return;
    }
    request_list_begin(b, &list, question, "members-of", group);
    for (const char *name; (name = groups_member(&b->pages.groups, group, inside, &place));) {
        request_list_add(b, &list, name);
    }
    request_list_end(b, &list);
}
