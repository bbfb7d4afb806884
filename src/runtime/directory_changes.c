/* SPDX-License-Identifier: Apache-2.0 */
/* Changes of groups and services: mails to the broker, and its refusals. */
#include "core/fields.h"
#include "core/name.h"
#include "core/text.h"
#include "runtime/process.h"

#include <stdio.h>
#include <string.h>

/* Begins reply_with of a change, and so in_reply_to of its answer; behind it stands which change.
 */
static const char CHANGE_MARK[] = "muster change ";

/* A hundred years; a broker takes no longer lease. */
static const uint64_t LEASE_MAX_NS = 3200000000000000000u;

/* Sends a change.  Only an agent that hears refusals wants an answer. */
static mu_result change_send(mu_agent *a, const char *performative, const char *name,
                             const char *content)
{
    char reply_with[MU_FIELD_MAX + 1];
    if (!name || !mu_name_valid(name)) {
        return MU_MALFORMED;
    }
    snprintf(reply_with, sizeof reply_with, "%s%s %s", CHANGE_MARK, performative, name);
    return mu_agent_send(a,
                         &(struct mu_mail){.dst = "broker",
                                           .layer = MU_LAYER_QUERY,
                                           .performative = performative,
                                           .reply_with = a->handlers.on_refusal ? reply_with : "",
                                           .content = content},
                         NULL);
}

bool directory_take_answer(mu_agent *a, const muster_Mail *mail)
{
    size_t mark = sizeof CHANGE_MARK - 1;
    if (strncmp(mail->in_reply_to, CHANGE_MARK, mark) != 0 || strcmp(mail->src, "broker") != 0) {
        return false;
    }
    if (strcmp(mail->performative, "inform") != 0 && a->handlers.on_refusal) {
        char reason[MU_FIELD_MAX + 1];
        struct mu_text t;
        mu_text_init(&t, reason, sizeof reason);
        mu_text_add_bytes(&t, mail->content, strcspn(mail->content, " "));
        a->handlers.on_refusal(a->handlers.self, a, mail->in_reply_to + mark, reason);
    }
    return true;
}

/* --- groups ----------------------------------------------------------------------------------- */

mu_result mu_agent_group_create(mu_agent *a, const char *group)
{
    return change_send(a, "group-create", group, group);
}

mu_result mu_agent_group_join(mu_agent *a, const char *group)
{
    return change_send(a, "group-join", group, group);
}

mu_result mu_agent_group_leave(mu_agent *a, const char *group)
{
    return change_send(a, "group-leave", group, group);
}

mu_result mu_agent_group_send(mu_agent *a, const char *group, const char *content)
{
    char dst[MU_FIELD_MAX + 1];
    if (!group || !mu_name_valid(group)) {
        return MU_MALFORMED;
    }
    snprintf(dst, sizeof dst, "group:%s", group);
    return mu_agent_send(
        a, &(struct mu_mail){.dst = dst, .layer = MU_LAYER_SPEECH, .content = content}, NULL);
}

/* --- services --------------------------------------------------------------------------------- */

mu_result mu_agent_advertise(mu_agent *a, const char *service, const char *attributes,
                             uint64_t lease_ns)
{
    char content[MU_NAME_MAX + 2 * MU_ATTRIBUTES_MAX + 40];
    struct mu_text t;
    attributes = attributes ? attributes : "";
    if (!service || !mu_name_valid(service) || !mu_attributes_valid(attributes) ||
        lease_ns > LEASE_MAX_NS) {
        return MU_MALFORMED;
    }
    mu_text_init(&t, content, sizeof content);
    mu_text_add(&t, service);
    mu_fields_add_string(&t, attributes);
    mu_text_format(&t, " %llu.%09llu", (unsigned long long)(lease_ns / 1000000000u),
                   (unsigned long long)(lease_ns % 1000000000u));
    MU_ASSERT(!t.cut);
    return change_send(a, "advertise", service, content);
}

mu_result mu_agent_withdraw(mu_agent *a, const char *service)
{
    return change_send(a, "withdraw", service, service);
}

/* @return a place for one more standing query, or NULL: none is free */
static struct directory_watch *watch_place(struct directory *d)
{
    uint32_t i = 0;
    while (i < d->watches_count && d->watches[i].agent) {
        i++;
    }
    if (i == MU_WATCHES_MAX) {
        return NULL;
    }
    d->watches_count += i == d->watches_count;
    return &d->watches[i];
}

mu_result mu_agent_watch_service(mu_agent *a, const char *query)
{
    struct directory *d = &a->process->directory;
    struct mu_query read;
    if (!query || mu_attributes_query(&read, query) != MU_OK) {
        return MU_MALFORMED;
    }
    for (uint32_t i = 0; i < d->watches_count; i++) {
        if (d->watches[i].agent == a && strcmp(d->watches[i].text, query) == 0) {
            return MU_OK;
        }
    }
    if (a->state == MU_GONE) {
        return MU_REFUSED;
    }
    struct directory_watch *w = watch_place(d);
    if (!w) {
        return MU_FULL;
    }
    *w = (struct directory_watch){.agent = a, .query = read, .fresh = true};
    mu_text_copy(w->text, sizeof w->text, query);
    d->fresh = true;
    return MU_OK;
}
