/* SPDX-License-Identifier: Apache-2.0 */
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

static char *text_of(char *text)
{
    return text ? text : sample_text("");
}

void answer_post(struct broker *b, uint32_t own, uint32_t receiver, muster_Mail *letter)
{
    bool inside = view_inside(b, receiver);
    letter->src = b->registry.agents[own].name;
    letter->dst = b->registry.agents[receiver].name;
    letter->layer = 2;
    letter->language = sample_text("");
    letter->ontology = text_of(letter->ontology);
    letter->reply_with = text_of(letter->reply_with);
    letter->in_reply_to = text_of(letter->in_reply_to);
    letter->conversation = text_of(letter->conversation);
    letter->content = b->text;
    letter->due_ns = -1;
    letter->seq = (inside ? 0 : outside_answers(b)) + ++b->answers[inside ? 0 : 1];
    deliver_send(b, receiver, letter);
}

void answer_reply(struct broker *b, uint32_t own, const struct mail *question,
                  const char *performative)
{
    muster_Mail answer = {.performative = sample_text(performative),
                          .ontology = question->letter.ontology,
                          .in_reply_to = question->letter.reply_with,
                          .conversation = question->letter.conversation};
    answer_post(b, own, question->sender, &answer);
}

void answer_word(struct broker *b, const struct mail *question, const char *performative,
                 const char *word, const char *field)
{
    struct mu_text t = answer_begin(b, word);
    mu_fields_add(&t, field);
    answer_reply(b, REGISTRY_BROKER, question, performative);
}
