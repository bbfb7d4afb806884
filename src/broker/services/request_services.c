/* SPDX-License-Identifier: Apache-2.0 */
/* Questions to the yellow pages, and changes of them. */
#include "broker/control/parts.h"
#include "core/fields.h"

#include <stdlib.h>

/* What `advertise` says: as it came, checked by services.c. */
struct advert {
    char service[MU_FIELD_MAX + 1];
    char attributes[2 * MU_ATTRIBUTES_MAX + 1];
    char seconds[MU_FIELD_MAX + 1];
    char agent[MU_FIELD_MAX + 1];
};

static bool advert_read(const char *content, struct advert *a)
{
    return request_field_optional(&content, a->service, sizeof a->service) &&
           a->service[0] != '\0' &&
           request_field_optional(&content, a->attributes, sizeof a->attributes) &&
           request_field_optional(&content, a->seconds, sizeof a->seconds) &&
           request_field_optional(&content, a->agent, sizeof a->agent) && mu_fields_end(content);
}

/* @return whether it is a time from 0 to a hundred years, or nothing, which is 0 */
static bool lease_read(const char *seconds, uint64_t *lease_ns)
{
    char *end;
    double s = strtod(seconds, &end);
    if (*end != '\0' || !(s >= 0.0 && s <= 3.2e9) ||
        strspn(seconds, "0123456789+-.eE") != strlen(seconds)) {
        return false;
    }
    *lease_ns = (uint64_t)(s * 1e9 + 0.5);
    return true;
}

void request_advertise(struct broker *b, const struct mail *question)
{
    struct advert a;
    struct line_word word = {.key = a.service, .attributes = a.attributes};
    if (!advert_read(question->letter.content, &a) || !lease_read(a.seconds, &word.lease_ns)) {
        request_not_understood(b, question);
        return;
    }
    word.agent = request_actor(b, question, a.agent);
    if (!word.agent) {
        return;
    }
    struct said said = view_said(b);
    const char *refusal = services_advertise(&b->pages.services, &word, &said);
    request_changed(b, question, refusal, a.service);
}

/* --- queries ---------------------------------------------------------------------------------- */

/* Reads a query: one string, or all of the content as it stands.  @return false: answered */
static bool question_read(struct broker *b, const struct mail *question,
                          char text[MU_QUERY_MAX + 1], struct mu_query *query)
{
    const char *content = question->letter.content + strspn(question->letter.content, " ");
    struct mu_text read = mu_text_in(text, MU_QUERY_MAX + 1);
    bool good = content[0] == '"' ? request_field(content, &read)
                                  : mu_text_copy(text, MU_QUERY_MAX + 1, content);
    if (good && mu_attributes_query(query, text) == MU_OK) {
        return true;
    }
    request_not_understood(b, question);
    return false;
}

void request_find_service(struct broker *b, const struct mail *question)
{
    /* A service, an agent, and attributes of which each byte may need a backslash. */
    enum { LINE_MAX_BYTES = 2 * (MU_NAME_MAX + 3) + 2 * MU_ATTRIBUTES_MAX + 3 };
    char text[MU_QUERY_MAX + 1];
    struct mu_query query;
    struct request_list list;
    const struct lines *s = &b->pages.services;
    bool inside = view_inside(b, question->sender);
    if (!question_read(b, question, text, &query)) {
        return;
    }
    request_list_begin(b, &list, question, "services", "");
    for (uint32_t i = 0; i < s->pairs.count; i++) {
        uint32_t line = s->pairs.order[i];
        const char *service = mu_pairs_first(&s->pairs, line);
        if (!mu_attributes_match(&query, service, s->offers[line].attributes) ||
            !view_shows(b, line, inside)) {
            continue;
        }
        request_list_room(b, &list, LINE_MAX_BYTES);
        mu_fields_add(&list.text, service);
        mu_fields_add(&list.text, mu_pairs_second(&s->pairs, line));
        mu_fields_add_string(&list.text, s->offers[line].attributes);
    }
    request_list_end(b, &list);
}

/* A subscriber that is absent makes room, the oldest first. */
static void subscription_spare(struct broker *b)
{
    struct subscriptions *all = &b->pages.subscriptions;
    for (uint32_t i = 0; i < all->count; i++) {
        uint32_t agent = registry_find(&b->registry, subscriptions_at(all, i)->agent);
        if (agent == MU_NONE || b->registry.agents[agent].process == MU_NONE) {
            subscriptions_remove(all, i);
            return;
        }
    }
}

void request_subscribe(struct broker *b, const struct mail *question)
{
    char text[MU_QUERY_MAX + 1];
    struct mu_query query;
    struct subscriptions *all = &b->pages.subscriptions;
    const char *agent = b->registry.agents[question->sender].name;
    if (!question_read(b, question, text, &query)) {
        return;
    }
    uint32_t old = subscriptions_find(all, agent, text);
    if (old != MU_NONE) { /* it may have forgotten what it was told */
        subscriptions_remove(all, old);
    } else if (all->count == MU_SUBSCRIPTIONS_MAX) {
        subscription_spare(b);
    }
    struct subscription *s = subscriptions_add(all, agent, text);
    if (s) {
        s->query = query;
        mu_text_copy(s->in_reply_to, sizeof s->in_reply_to, question->letter.reply_with);
        mu_text_copy(s->conversation, sizeof s->conversation, question->letter.conversation);
    }
    request_changed(b, question, s ? NULL : "full", text);
    if (s) {
        notify_review(b, s, false); /* one that is there already has come, too */
    }
}

void request_unsubscribe(struct broker *b, const struct mail *question)
{
    char text[MU_QUERY_MAX + 1];
    struct mu_query query;
    struct subscriptions *all = &b->pages.subscriptions;
    if (!question_read(b, question, text, &query)) {
        return;
    }
    uint32_t old = subscriptions_find(all, b->registry.agents[question->sender].name, text);
    if (old != MU_NONE) {
        subscriptions_remove(all, old);
    }
    request_changed(b, question, old == MU_NONE ? "not-subscribed" : NULL, text);
}
