/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/mail/mail.h"

#include "broker/control/parts.h"
#include "core/fields.h"

/* Answers outside count from here, so that a question from there does not shift the numbers
 * inside. */
static const uint64_t OUTSIDE_ANSWERS = 1ull << 62;

/* All brokers answer as `broker`, and some answers cross: each of several has so many numbers of
 * its own. */
static const uint64_t ANSWERS_EACH = 1ull << 40;

static uint64_t outside_answers(const struct broker *b)
{
    return OUTSIDE_ANSWERS + (b->federation.peers_count > 0 ? remote_range(b) * ANSWERS_EACH : 0);
}

struct mu_text answer_begin(struct broker *b, const char *word)
{
    struct mu_text t = mu_text_in(b->text, sizeof b->text);
    mu_text_add(&t, word);
    return t;
}

static void answer_post(struct broker *b, uint32_t own, uint32_t receiver, muster_Mail *m)
{
    bool inside = scope_is_inside(b->registry.agents[receiver].scope);
    m->src = b->registry.agents[own].name;
    m->dst = b->registry.agents[receiver].name;
    m->layer = 2;
    m->language = sample_text("");
    m->due_ns = -1;
    m->seq = (inside ? 0 : outside_answers(b)) + ++b->answers[inside ? 0 : 1];
    deliver_send(b, receiver, m);
}

static muster_Mail letter_of(const char *performative, const char *reply_with,
                             const char *in_reply_to, char *content)
{
    return (muster_Mail){.performative = sample_text(performative),
                         .ontology = sample_text(""),
                         .reply_with = sample_text(reply_with),
                         .in_reply_to = sample_text(in_reply_to),
                         .conversation = sample_text(""),
                         .content = content};
}

void answer_reply(struct broker *b, uint32_t own, const struct mail *question,
                  const char *performative, char *content)
{
    muster_Mail m = letter_of(performative, "", question->letter.reply_with, content);
    m.ontology = question->letter.ontology;
    m.conversation = question->letter.conversation;
    answer_post(b, own, question->sender, &m);
}

void answer_send(struct broker *b, const struct mail *question, const char *performative)
{
    answer_reply(b, REGISTRY_BROKER, question, performative, b->text);
}

void answer_word(struct broker *b, const struct mail *question, const char *performative,
                 const char *word, const char *field)
{
    struct mu_text t = answer_begin(b, word);
    mu_fields_add(&t, field);
    answer_send(b, question, performative);
}

void answer_inform(struct broker *b, uint32_t receiver, const char *in_reply_to,
                   const char *conversation)
{
    muster_Mail m = letter_of("inform", "", in_reply_to, b->text);
    m.conversation = sample_text(conversation);
    answer_post(b, REGISTRY_BROKER, receiver, &m);
}

void answer_ask(struct broker *b, uint32_t receiver, const char *performative,
                const char *reply_with)
{
    muster_Mail m = letter_of(performative, reply_with, "", b->text);
    answer_post(b, REGISTRY_BROKER, receiver, &m);
}
