/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "core/fields.h"
#include "core/name.h"

/* --- answers ---------------------------------------------------------------------------------- */

bool request_field(const char *content, struct mu_text *out)
{
    return mu_fields_next(&content, out) && out->len > 0 && mu_fields_end(content);
}

bool request_field_optional(const char **content, char *to, size_t size)
{
    struct mu_text read = mu_text_in(to, size);
    return mu_fields_end(*content) || mu_fields_next(content, &read);
}

void request_not_understood(struct broker *b, const struct mail *question)
{
    b->counters.malformed++;
    (void)answer_begin(b, question->letter.performative);
    answer_reply(b, REGISTRY_BROKER, question, "not-understood");
}

void request_changed(struct broker *b, const struct mail *question, const char *refusal,
                     const char *name)
{
    notify_tell(b);
    b->counters.malformed +=
        refusal && (strcmp(refusal, "not-a-name") == 0 || strcmp(refusal, "not-attributes") == 0);
    if (question->letter.reply_with[0] == '\0') {
        return;
    }
    answer_word(b, question, refusal ? "failure" : "inform",
                refusal ? refusal : question->letter.performative, name);
}

const char *request_actor(struct broker *b, const struct mail *question, const char *named)
{
    const char *own = b->registry.agents[question->sender].name, *refusal = NULL;
    if (named[0] == '\0' || strcmp(named, own) == 0) {
        return own;
    }
    bool valid = mu_name_valid(named);
    uint32_t agent = valid ? registry_find(&b->registry, named) : MU_NONE;
    bool inside = view_inside(b, question->sender);
    if (agent != MU_NONE && (registry_is_own(agent) || (inside && !view_inside(b, agent)))) {
        agent = MU_NONE;
    }
    if (!valid) {
        refusal = "not-a-name";
    } else if (!authorize_line(b, question, agent, named)) {
        refusal = "refused";
    } else if (agent == MU_NONE) {
        refusal = "unknown-name";
    }
    if (refusal) {
        request_changed(b, question, refusal, named);
        return NULL;
    }
    return b->registry.agents[agent].name;
}

/* --- lists ------------------------------------------------------------------------------------ */

void request_list_begin(struct broker *b, struct request_list *l, const struct mail *question,
                        const char *word, const char *of)
{
    *l = (struct request_list){.question = question, .text = answer_begin(b, word)};
    if (of[0]) {
        mu_fields_add(&l->text, of);
    }
    l->head = l->text.len;
}

void request_list_room(struct broker *b, struct request_list *l, size_t bytes)
{
    if (l->text.len + bytes > MU_CONTENT_MAX) {
        request_list_end(b, l);
        l->text.len = l->head;
        l->text.at[l->head] = '\0';
    }
}

void request_list_end(struct broker *b, const struct request_list *l)
{
    answer_reply(b, REGISTRY_BROKER, l->question, "inform");
}
