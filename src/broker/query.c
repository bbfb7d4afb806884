/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/query.h"

#include "broker/parts.h"
#include "broker/presence.h"
#include "broker/router.h"
#include "core/text.h"

#include <string.h>

/* Answers to others than members of the lock step count from here, so that a question from
 * outside does not shift the numbers inside a run. */
static const uint64_t OUTSIDE_ANSWERS = 1ull << 62;

/* Symbols of CLIPS: printable, without delimiters, not like a variable or a number. */
static bool is_symbol(const char *s)
{
    if (s[0] == '\0' || strchr("?$<+-.0123456789", s[0])) {
        return false;
    }
    for (const char *c = s; *c; c++) {
        if ((unsigned char)*c <= ' ' || *c == 127 || strchr("\"();&|~<", *c)) {
            return false;
        }
    }
    return true;
}

/* Adds a space and a field; what is no symbol becomes a string. */
static void field_add(struct mu_text *t, const char *s)
{
    mu_text_add(t, " ");
    if (is_symbol(s)) {
        mu_text_add(t, s);
        return;
    }
    mu_text_add(t, "\"");
    for (const char *c = s; *c; c++) {
        if (*c == '"' || *c == '\\') {
            mu_text_add(t, "\\");
        }
        mu_text_add_bytes(t, c, 1);
    }
    mu_text_add(t, "\"");
}

/* Reads content that is one field, a symbol or a string.  @return false if it is not */
static bool field_read(const char *content, struct mu_text *out)
{
    const char *c = content + strspn(content, " \t\r\n");
    if (*c == '"') {
        for (c++; *c && *c != '"'; c++) {
            c += *c == '\\' && c[1];
            mu_text_add_bytes(out, c, 1);
        }
        if (*c++ != '"') {
            return false;
        }
    } else {
        size_t len = strcspn(c, " \t\r\n\"()");
        mu_text_add_bytes(out, c, len);
        c += len;
    }
    c += strspn(c, " \t\r\n");
    return *c == '\0' && out->len > 0 && !out->cut;
}

/* --- answers ---------------------------------------------------------------------------------- */

void query_reply(struct broker *b, uint32_t own, const struct mail *question,
                 const char *performative, char *content)
{
    static char words[][16] = {"inform", "failure", "not-understood"};
    static char nothing[1];
    bool inside = presence_in_lockstep(b, question->sender);
    muster_Mail m = {.src = b->registry.agents[own].name,
                     .dst = b->registry.agents[question->sender].name,
                     .layer = 2,
                     .performative = words[0],
                     .language = nothing,
                     .ontology = question->letter.ontology,
                     .reply_with = nothing,
                     .in_reply_to = question->letter.reply_with,
                     .conversation = question->letter.conversation,
                     .due_ns = -1,
                     .content = content};
    while (strcmp(m.performative, performative) != 0) {
        m.performative += sizeof words[0];
    }
    m.seq = (inside ? 0 : OUTSIDE_ANSWERS) + ++b->answers[inside ? 0 : 1];
    router_post(b, question->sender, &m);
}

static void reply(struct broker *b, const struct mail *question, const char *performative,
                  char *content)
{
    query_reply(b, REGISTRY_BROKER, question, performative, content);
}

/* Who asks in lock step is told of its members, and of nothing that another run would have
 * otherwise. */
static bool is_shown(const struct broker *b, const struct mail *question, uint32_t agent)
{
    return !presence_in_lockstep(b, question->sender) || agent == REGISTRY_BROKER ||
           presence_in_lockstep(b, agent);
}

static void answer_lookup(struct broker *b, const struct mail *question)
{
    char name[MU_FIELD_MAX + 1];
    struct mu_text read, t;
    mu_text_init(&read, name, sizeof name);
    mu_text_init(&t, b->text, sizeof b->text);
    if (!field_read(question->letter.content, &read)) {
        mu_text_add(&t, "lookup");
        reply(b, question, "not-understood", b->text);
        return;
    }
    uint32_t agent = registry_find(&b->registry, name);
    if (agent == MU_NONE || !is_shown(b, question, agent)) {
        mu_text_add(&t, "unknown-name");
        field_add(&t, name);
        reply(b, question, "failure", b->text);
        return;
    }
    const struct agent *a = &b->registry.agents[agent];
    mu_text_add(&t, "member");
    field_add(&t, a->name);
    field_add(&t, registry_kind_word(a->is.kind));
    field_add(&t, registry_state_word(a->is.state));
    field_add(&t, b->name);
    bool inside = presence_in_lockstep(b, question->sender);
    field_add(&t, inside ? "nil" : a->is.host);
    mu_text_format(&t, " %lu", inside ? 0ul : (unsigned long)a->is.pid);
    reply(b, question, "inform", b->text);
}

static void answer_listing(struct broker *b, const struct mail *question)
{
    struct mu_text t;
    mu_text_init(&t, b->text, sizeof b->text);
    mu_text_add(&t, "members");
    for (uint32_t i = 0; i < b->registry.count; i++) {
        const char *name = b->registry.agents[b->registry.order[i]].name;
        if (!is_shown(b, question, b->registry.order[i])) {
            continue;
        }
        if (t.len + 1 + strlen(name) > MU_CONTENT_MAX) {
            reply(b, question, "inform", b->text);
            mu_text_clear(&t);
            mu_text_add(&t, "members");
        }
        field_add(&t, name);
    }
    reply(b, question, "inform", b->text);
}

void query_refuse(struct broker *b, uint32_t own, const struct mail *question)
{
    struct mu_text t;
    mu_text_init(&t, b->text, sizeof b->text);
    mu_text_add(&t, "performative");
    field_add(&t, question->letter.performative);
    query_reply(b, own, question, "not-understood", b->text);
}

void query_answer(struct broker *b, const struct mail *question)
{
    static const struct {
        const char *performative;
        void (*answer)(struct broker *b, const struct mail *question);
    } queries[] = {
        {"lookup", answer_lookup},
        {"listing", answer_listing},
    };
    for (size_t i = 0; i < sizeof queries / sizeof queries[0]; i++) {
        if (question->letter.layer == 2 &&
            strcmp(question->letter.performative, queries[i].performative) == 0) {
            queries[i].answer(b, question);
            return;
        }
    }
    query_refuse(b, REGISTRY_BROKER, question);
}
