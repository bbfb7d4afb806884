/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/services/query.h"

#include "broker/base/sample.h"
#include "broker/control/parts.h"
#include "broker/directory/guard.h"
#include "broker/membership/presence.h"
#include "broker/services/router.h"
#include "core/fields.h"
#include "core/name.h"

#include <string.h>

/* Answers to others than members of the lock step count from here, so that a question from
 * outside does not shift the numbers inside a run. */
static const uint64_t OUTSIDE_ANSWERS = 1ull << 62;

/* All brokers answer as `broker`, and some answers cross: each of several has so many numbers of
 * its own. */
static const uint64_t ANSWERS_EACH = 1ull << 40;

static uint64_t outside_answers(const struct broker *b)
{
    return OUTSIDE_ANSWERS + (b->liaison.peers_count > 0 ? liaison_lane(b) * ANSWERS_EACH : 0);
}

/* --- answers ---------------------------------------------------------------------------------- */

void query_begin(struct broker *b, struct mu_text *t, const char *word)
{
    mu_text_init(t, b->text, sizeof b->text);
    mu_text_add(t, word);
}

static void answer_post(struct broker *b, uint32_t own, uint32_t receiver, muster_Mail *m)
{
    bool inside = presence_in_lockstep(b, receiver);
    m->src = b->registry.agents[own].name;
    m->dst = b->registry.agents[receiver].name;
    m->layer = 2;
    m->language = sample_text("");
    m->due_ns = -1;
    m->seq = (inside ? 0 : outside_answers(b)) + ++b->answers[inside ? 0 : 1];
    router_post(b, receiver, m);
}

void query_reply(struct broker *b, uint32_t own, const struct mail *question,
                 const char *performative, char *content)
{
    muster_Mail m = {.performative = sample_text(performative),
                     .ontology = question->letter.ontology,
                     .reply_with = sample_text(""),
                     .in_reply_to = question->letter.reply_with,
                     .conversation = question->letter.conversation,
                     .content = content};
    answer_post(b, own, question->sender, &m);
}

void query_send(struct broker *b, const struct mail *question, const char *performative)
{
    query_reply(b, REGISTRY_BROKER, question, performative, b->text);
}

void query_inform(struct broker *b, uint32_t receiver, const char *in_reply_to,
                  const char *conversation)
{
    muster_Mail m = {.performative = sample_text("inform"),
                     .ontology = sample_text(""),
                     .reply_with = sample_text(""),
                     .in_reply_to = sample_text(in_reply_to),
                     .conversation = sample_text(conversation),
                     .content = b->text};
    answer_post(b, REGISTRY_BROKER, receiver, &m);
}

void query_ask(struct broker *b, uint32_t receiver, const char *performative,
               const char *reply_with)
{
    muster_Mail m = {.performative = sample_text(performative),
                     .ontology = sample_text(""),
                     .reply_with = sample_text(reply_with),
                     .in_reply_to = sample_text(""),
                     .conversation = sample_text(""),
                     .content = b->text};
    answer_post(b, REGISTRY_BROKER, receiver, &m);
}

bool query_field(const char *content, struct mu_text *out)
{
    return mu_fields_next(&content, out) && out->len > 0 && mu_fields_end(content);
}

bool query_field_optional(const char **content, char *to, size_t size)
{
    struct mu_text read;
    mu_text_init(&read, to, size);
    return mu_fields_end(*content) || mu_fields_next(content, &read);
}

bool query_read_name(struct broker *b, const struct mail *question, query_name name)
{
    struct mu_text read;
    mu_text_init(&read, name, sizeof(query_name));
    if (query_field(question->letter.content, &read)) {
        return true;
    }
    query_not_understood(b, question);
    return false;
}

void query_not_understood(struct broker *b, const struct mail *question)
{
    struct mu_text t;
    b->counters.malformed++;
    query_begin(b, &t, question->letter.performative);
    query_send(b, question, "not-understood");
}

void query_changed(struct broker *b, const struct mail *question, const char *refusal,
                   const char *name)
{
    struct mu_text t;
    b->counters.malformed +=
        refusal && (strcmp(refusal, "not-a-name") == 0 || strcmp(refusal, "not-attributes") == 0);
    if (question->letter.reply_with[0] == '\0') {
        return;
    }
    query_begin(b, &t, refusal ? refusal : question->letter.performative);
    mu_fields_add(&t, name);
    query_send(b, question, refusal ? "failure" : "inform");
}

const char *query_actor(struct broker *b, const struct mail *question, const char *named)
{
    const char *own = b->registry.agents[question->sender].name, *refusal = NULL;
    if (named[0] == '\0' || strcmp(named, own) == 0) {
        return own;
    }
    bool valid = mu_name_valid(named);
    uint32_t agent = valid ? registry_find(&b->registry, named) : MU_NONE;
    bool inside = pages_inside(b, question->sender);
    if (agent != MU_NONE && (registry_is_own(agent) || (inside && !pages_inside(b, agent)))) {
        agent = MU_NONE;
    }
    if (!valid) {
        refusal = "not-a-name";
    } else if (!guard_speaks(b, question, agent, named)) {
        refusal = "refused";
    } else if (agent == MU_NONE) {
        refusal = "unknown-name";
    }
    if (refusal) {
        query_changed(b, question, refusal, named);
        return NULL;
    }
    return b->registry.agents[agent].name;
}

/* --- lists ------------------------------------------------------------------------------------ */

static void list_open(struct broker *b, struct query_list *l)
{
    query_begin(b, &l->text, l->word);
    if (l->of[0]) {
        mu_fields_add(&l->text, l->of);
    }
}

void query_list_begin(struct broker *b, struct query_list *l, const struct mail *question,
                      const char *word, const char *of)
{
    *l = (struct query_list){.question = question, .word = word, .of = of};
    list_open(b, l);
}

void query_list_room(struct broker *b, struct query_list *l, size_t bytes)
{
    if (l->text.len + bytes > MU_CONTENT_MAX) {
        query_list_end(b, l);
        list_open(b, l);
    }
}

void query_list_add(struct broker *b, struct query_list *l, const char *name)
{
    query_list_room(b, l, 1 + strlen(name));
    mu_fields_add(&l->text, name);
}

void query_list_end(struct broker *b, const struct query_list *l)
{
    query_send(b, l->question, "inform");
}

/* --- changes ---------------------------------------------------------------------------------- */

void query_make_change(struct broker *b, const struct mail *question, query_change *change)
{
    query_name name, named;
    const char *content = question->letter.content;
    if (!query_field_optional(&content, name, sizeof name) || name[0] == '\0' ||
        !query_field_optional(&content, named, sizeof named) || !mu_fields_end(content)) {
        query_not_understood(b, question);
        return;
    }
    const char *agent = query_actor(b, question, named);
    if (agent) {
        struct said said = pages_said(b);
        const char *refusal = change(b, name, agent, &said);
        pages_tell(b);
        query_changed(b, question, refusal, name);
    }
}

/* --- the white pages -------------------------------------------------------------------------- */

/* Who asks in lock step is told of its members, and of nothing that another run would have
 * otherwise. */
static bool is_shown(const struct broker *b, const struct mail *question, uint32_t agent)
{
    return !presence_in_lockstep(b, question->sender) || agent == REGISTRY_BROKER ||
           presence_in_lockstep(b, agent);
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
        query_begin(b, &t, "unknown-name");
        mu_fields_add(&t, name);
        query_send(b, question, "failure");
        return;
    }
    muster_Member m;
    registry_line(&b->registry, agent, b->name, &m);
    query_begin(b, &t, "member");
    mu_fields_add(&t, m.name);
    mu_fields_add(&t, registry_kind_word(m.kind));
    mu_fields_add(&t, registry_state_word(m.state));
    mu_fields_add(&t, m.broker);
    bool inside = presence_in_lockstep(b, question->sender);
    mu_fields_add(&t, m.host);
    mu_text_format(&t, " %lu", inside ? 0ul : (unsigned long)m.pid);
    query_send(b, question, "inform");
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

void query_refuse(struct broker *b, uint32_t own, const struct mail *question)
{
    struct mu_text t;
    query_begin(b, &t, "performative");
    mu_fields_add(&t, question->letter.performative);
    query_reply(b, own, question, "not-understood", b->text);
}

/* The verbs of questions and changes. */
static const struct {
    const char *performative;
    unsigned names; /* which of its fields, from 1, names an agent whom it changes; 0: none */
} verbs[QUERY_VERBS] = {
    [QUERY_LOOKUP] = {"lookup", 0},
    [QUERY_LISTING] = {"listing", 0},
    [QUERY_GROUPS] = {"groups", 0},
    [QUERY_MEMBERS] = {"members", 0},
    [QUERY_GROUP_CREATE] = {"group-create", 0},
    [QUERY_GROUP_JOIN] = {"group-join", 2},
    [QUERY_GROUP_LEAVE] = {"group-leave", 2},
    [QUERY_ADVERTISE] = {"advertise", 4},
    [QUERY_WITHDRAW] = {"withdraw", 2},
    [QUERY_FIND_SERVICE] = {"find-service", 0},
    [QUERY_SUBSCRIBE] = {"subscribe", 0},
    [QUERY_UNSUBSCRIBE] = {"unsubscribe", 0},
};

enum query_verb query_verb(const struct mail *question)
{
    enum query_verb verb = 0;
    while (verb < QUERY_VERBS &&
           (question->letter.layer != 2 ||
            strcmp(question->letter.performative, verbs[verb].performative) != 0)) {
        verb++;
    }
    return verb;
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

void query_answer(struct broker *b, const struct mail *question)
{
    enum query_verb verb = query_verb(question);
    if (verb < QUERY_VERBS) {
        answers[verb](b, question);
    } else {
        query_refuse(b, REGISTRY_BROKER, question);
    }
}

uint32_t query_named(const struct broker *b, const struct mail *question)
{
    enum query_verb verb = query_verb(question);
    unsigned names = verb < QUERY_VERBS ? verbs[verb].names : 0;
    const char *content = question->letter.content;
    char name[MU_NAME_MAX + 1];
    struct mu_text read;
    bool whole = false;
    mu_text_init(&read, name, sizeof name);
    for (unsigned i = 0; i < names; i++) {
        whole = mu_fields_next(&content, &read);
        if (!whole && !read.cut) {
            return MU_NONE;
        }
    }
    return whole ? registry_find(&b->registry, name) : MU_NONE;
}

bool query_changes_member(const struct broker *b, const struct mail *question)
{
    uint32_t agent = query_named(b, question);
    return agent != MU_NONE && pages_inside(b, agent);
}
