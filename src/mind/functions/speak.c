/* SPDX-License-Identifier: Apache-2.0 */
/* Mail with its envelope: (speak), (send-layer). */
#include "core/performatives.h"
#include "mind/functions/table.h"

#include <string.h>

/* Reads the value of a key into a letter.  @return false, after a CLIPS error */
typedef bool (*speak_key)(void *env, int index, size_t offset, struct mind_letter *letter);

static bool speak_word(void *env, int index, size_t offset, struct mind_letter *letter)
{
    const char *word;
    if (!value_word(env, "speak", index, &word)) {
        return false;
    }
    if (strlen(word) > MU_FIELD_MAX) {
        value_refuse(env, "speak", "words of at most 63 bytes");
        return false;
    }
    *(const char **)((char *)letter + offset) = word;
    return true;
}

/* reply-by SECONDS: the time after which neither the answer nor the mail is of use. */
static bool speak_reply_by(void *env, int index, size_t offset, struct mind_letter *letter)
{
    (void)offset;
    double until_s;
    if (!value_number(env, "speak", index, &until_s)) {
        return false;
    }
    double now_s = (double)inputs_of(environment_mind(env))->percept.time_ns * 1e-9;
    if (!(until_s > now_s && until_s < now_s + 1e9)) {
        value_refuse(env, "speak", "a time in the future behind reply-by");
        return false;
    }
    letter->reply_by_ns = (uint64_t)(until_s * 1e9);
    if (letter->ttl_ns == 0) { /* ttl says something else, in either order */
        letter->ttl_ns = (uint64_t)((until_s - now_s) * 1e9);
    }
    return true;
}

/* ttl SECONDS: the mail is of no use when it is so old. */
static bool speak_ttl(void *env, int index, size_t offset, struct mind_letter *letter)
{
    (void)offset;
    return send_seconds(env, "speak", index, "ttl", &letter->ttl_ns);
}

static bool layer_read(void *env, const char *function, int index, uint32_t *layer)
{
    long long number;
    if (!value_whole(env, function, index, &number)) {
        return false;
    }
    if (number < 1 || number > UINT32_MAX) {
        value_refuse(env, function, "a layer: a whole number from 1 on");
        return false;
    }
    *layer = (uint32_t)number;
    return true;
}

static bool speak_layer(void *env, int index, size_t offset, struct mind_letter *letter)
{
    (void)offset;
    return layer_read(env, "speak", index, &letter->layer);
}

/* @return the place of a word among words; count: it is not there, after a CLIPS error */
static size_t speak_choice(void *env, int index, const char *const *words, size_t count,
                           const char *wanted)
{
    const char *word;
    if (!value_word(env, "speak", index, &word)) {
        return count;
    }
    for (size_t i = 0; i < count; i++) {
        if (strcmp(words[i], word) == 0) {
            return i;
        }
    }
    value_refuse(env, "speak", wanted);
    return count;
}

static bool speak_priority(void *env, int index, size_t offset, struct mind_letter *letter)
{
    (void)offset;
    static const char *const words[] = {"low", "normal", "high"};
    size_t found = speak_choice(env, index, words, 3, "low, normal or high behind priority");
    letter->priority = (enum mu_priority)((int)found + MU_PRIORITY_LOW);
    return found < 3;
}

static bool speak_level(void *env, int index, size_t offset, struct mind_letter *letter)
{
    (void)offset;
    static const char *const words[] = {"ram", "logged", "synced"};
    size_t found = speak_choice(env, index, words, 3, "ram, logged or synced behind level");
    letter->level = (enum mu_level)found;
    return found < 3;
}

static const struct {
    const char *key;
    speak_key read;
    size_t offset; /* of the word in a letter */
} speak_keys[] = {
    {"language", speak_word, offsetof(struct mind_letter, language)},
    {"ontology", speak_word, offsetof(struct mind_letter, ontology)},
    {"reply-with", speak_word, offsetof(struct mind_letter, reply_with)},
    {"in-reply-to", speak_word, offsetof(struct mind_letter, in_reply_to)},
    {"conversation", speak_word, offsetof(struct mind_letter, conversation)},
    {"reply-by", speak_reply_by, 0},
    {"ttl", speak_ttl, 0},
    {"layer", speak_layer, 0},
    {"priority", speak_priority, 0},
    {"level", speak_level, 0},
};

static bool speak_key_value(void *env, int index, struct mind_letter *letter)
{
    const char *key;
    if (!value_word(env, "speak", index, &key)) {
        return false;
    }
    for (size_t i = 0; i < sizeof speak_keys / sizeof speak_keys[0]; i++) {
        if (strcmp(speak_keys[i].key, key) == 0) {
            return speak_keys[i].read(env, index + 1, speak_keys[i].offset, letter);
        }
    }
    value_refuse(env, "speak",
                 "pairs of a value and one of these keys: language ontology reply-with "
                 "in-reply-to reply-by conversation ttl layer priority level");
    return false;
}

void speak_send(void *env, DATA_OBJECT *out)
{
    struct mind_letter letter = send_blank;
    struct mu_text content;
    DATA_OBJECT fields;
    int count = EnvRtnArgCount(env);
    value_bool(env, out, false);
    if (count % 2 == 0) {
        value_refuse(env, "speak", "a performative, a name, a content and pairs of key, value");
        return;
    }
    if (!send_performative(env, "speak", 1, &letter) || !value_any(env, 3, &fields)) {
        return;
    }
    for (int i = 4; i < count; i += 2) {
        if (!speak_key_value(env, i, &letter)) {
            return;
        }
    }
    letter.dst = send_address(env, "speak", 2, "the name of an agent, or several");
    if (!letter.dst) {
        return;
    }
    mu_text_init(&content, inputs_of(environment_mind(env))->scratch, MU_CONTENT_MAX + 1);
    bool raw = strcmp(letter.language, "clips") != 0 && fields.type == STRING;
    if (raw) { /* a text in another language goes as it is */
        mu_text_add(&content, ValueToString(fields.value));
    }
    if (content.cut) {
        value_refuse(env, "speak", "a content of at most 16384 bytes");
    } else if (raw || send_content(env, "speak", &fields, &content)) {
        letter.content = content.at;
        send_hand(env, &letter, out);
    }
}

void speak_send_layer(void *env, DATA_OBJECT *out)
{
    struct mind_letter letter = send_blank;
    char question[MU_FIELD_MAX + 1];
    DATA_OBJECT fields;
    value_bool(env, out, false);
    if (!send_fields(env, "send-layer", 4, &fields) ||
        !layer_read(env, "send-layer", 1, &letter.layer) ||
        !send_performative(env, "send-layer", 2, &letter)) {
        return;
    }
    letter.dst = send_address(env, "send-layer", 3, "the name of an agent, or several");
    if (!mu_performative_answers(letter.performative)) {
        letter.reply_with = send_question(env, question, sizeof question);
    }
    struct mu_text content =
        mu_text_in(inputs_of(environment_mind(env))->scratch, MU_CONTENT_MAX + 1);
    if (letter.dst && send_content(env, "send-layer", &fields, &content)) {
        letter.content = content.at;
        send_hand(env, &letter, out);
    }
}
