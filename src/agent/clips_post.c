/* SPDX-License-Identifier: Apache-2.0 */
/* Mail that rules send. */
#include "agent/clips_post.h"

#include "agent/clips_functions.h"
#include "agent/clips_value.h"
#include "core/name.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct mind_letter post_blank = {.dst = "",
                                              .performative = "",
                                              .language = "clips",
                                              .ontology = "",
                                              .reply_with = "",
                                              .in_reply_to = "",
                                              .conversation = "",
                                              .content = ""};

bool clips_post_field(struct mu_text *out, unsigned short type, const void *value)
{
    const struct symbolHashNode *text = value;
    switch (type) {
    case SYMBOL: clips_text_add_symbol(out, text->contents); return true;
    case STRING: clips_text_add_quoted(out, text->contents); return true;
    case INSTANCE_NAME: mu_text_format(out, "[%s]", text->contents); return true;
    case INTEGER:
        mu_text_format(out, "%lld", ((const struct integerHashNode *)value)->contents);
        return true;
    case FLOAT:
        clips_text_add_float(out, clips_value_of(type, value));
        return isfinite(clips_value_of(type, value));
    default: return false;
    }
}

static bool post_value(struct mu_text *out, const DATA_OBJECT *value)
{
    bool single = value->type != MULTIFIELD;
    long begin = single ? 0 : value->begin;
    long end = single ? 0 : value->end;
    for (long i = begin; i <= end; i++) {
        const struct field *f = single ? NULL : &((struct multifield *)value->value)->theFields[i];
        if (out->len > 0 && out->at[out->len - 1] != '(') {
            mu_text_add(out, " ");
        }
        bool mailable = single ? clips_post_field(out, value->type, value->value)
                               : clips_post_field(out, f->type, f->value);
        if (!mailable) {
            return false;
        }
    }
    return true;
}

/* Adds the arguments from first on.  @return false, after a CLIPS error: they cannot be mailed */
static bool post_arguments(void *env, const char *function, int first, struct mu_text *out)
{
    int count = EnvRtnArgCount(env);
    for (int i = first; i <= count; i++) {
        DATA_OBJECT value;
        if (!clips_value_any(env, i, &value)) {
            return false;
        }
        if (!post_value(out, &value)) {
            clips_value_refuse(env, function,
                               "fields that can be mailed: symbols, strings, finite numbers");
            return false;
        }
    }
    if (out->cut) {
        clips_value_refuse(env, function, "a content of at most 16384 bytes");
        return false;
    }
    return true;
}

static bool post_name(void *env, const char *function, int index, const char **out)
{
    if (!clips_value_word(env, function, index, out)) {
        return false;
    }
    const char *colon = strchr(*out, ':'); /* of an address, which the broker takes apart */
    if (!mu_name_valid(*out) && (!colon || colon == *out)) {
        clips_value_refuse(env, function, "the name of an agent");
        return false;
    }
    return true;
}

/* Hands a letter over: FALSE when there is no room, else TRUE or the word that the answer bears. */
static void post_hand(void *env, const struct mind_letter *letter, DATA_OBJECT *out)
{
    const struct mind_ports *ports = &clips_env_mind(env)->options.ports;
    bool taken = ports->send && ports->send(ports->self, letter) == MU_OK;
    if (taken && letter->reply_with[0]) {
        clips_value_symbol(env, out, letter->reply_with);
    } else {
        clips_value_bool(env, out, taken);
    }
}

/* The arguments from first on are the content of the letter. */
static void post_letter(void *env, const char *function, struct mind_letter *letter, int first,
                        DATA_OBJECT *out)
{
    struct mind *m = clips_env_mind(env);
    struct mu_text content;
    mu_text_init(&content, m->scratch, MU_CONTENT_MAX + 1);
    clips_value_bool(env, out, false);
    if (post_arguments(env, function, first, &content)) {
        letter->content = content.at;
        post_hand(env, letter, out);
    }
}

/* (FUNCTION WHO field...) */
static void post_to(void *env, const char *function, const char *performative, bool asks,
                    DATA_OBJECT *out)
{
    struct mind *m = clips_env_mind(env);
    struct mind_letter letter = post_blank;
    char question[MU_FIELD_MAX + 1] = "";
    letter.performative = performative;
    clips_value_bool(env, out, false);
    if (!post_name(env, function, 1, &letter.dst)) {
        return;
    }
    if (asks) {
        snprintf(question, sizeof question, "%s-%llu", m->options.name,
                 (unsigned long long)++m->asked);
    }
    letter.reply_with = question;
    post_letter(env, function, &letter, 2, out);
}

void clips_post_send(void *env, DATA_OBJECT *out)
{
    post_to(env, "send", "", false, out);
}

void clips_post_tell(void *env, DATA_OBJECT *out)
{
    post_to(env, "tell", "tell", false, out);
}

void clips_post_ask_one(void *env, DATA_OBJECT *out)
{
    post_to(env, "ask-one", "ask-one", true, out);
}

void clips_post_ask_all(void *env, DATA_OBJECT *out)
{
    post_to(env, "ask-all", "ask-all", true, out);
}

void clips_post_achieve(void *env, DATA_OBJECT *out)
{
    post_to(env, "achieve", "achieve", true, out);
}

void clips_post_broadcast(void *env, DATA_OBJECT *out)
{
    struct mind_letter letter = post_blank;
    letter.dst = "all";
    post_letter(env, "broadcast", &letter, 1, out);
}

/* Where in a letter the value of each key of speak stands. */
static const struct {
    const char *key;
    size_t offset;
} post_keys[] = {
    {"language", offsetof(struct mind_letter, language)},
    {"ontology", offsetof(struct mind_letter, ontology)},
    {"reply-with", offsetof(struct mind_letter, reply_with)},
    {"in-reply-to", offsetof(struct mind_letter, in_reply_to)},
    {"conversation", offsetof(struct mind_letter, conversation)},
};

static const char **post_key(struct mind_letter *letter, const char *key)
{
    for (size_t i = 0; i < sizeof post_keys / sizeof post_keys[0]; i++) {
        if (strcmp(post_keys[i].key, key) == 0) {
            return (const char **)((char *)letter + post_keys[i].offset);
        }
    }
    return NULL;
}

/* reply-by SECONDS: how long the mail lives from now. */
static bool post_reply_by(void *env, int index, struct mind_letter *letter)
{
    double until_s;
    if (!clips_value_number(env, "speak", index, &until_s)) {
        return false;
    }
    double now_s = (double)clips_env_mind(env)->percept.time_ns * 1e-9;
    if (!(until_s > now_s && until_s < now_s + 1e9)) {
        clips_value_refuse(env, "speak", "a time in the future behind reply-by");
        return false;
    }
    letter->ttl_ns = (uint64_t)((until_s - now_s) * 1e9);
    return true;
}

static bool post_key_value(void *env, int index, struct mind_letter *letter)
{
    const char *key;
    if (!clips_value_word(env, "speak", index, &key)) {
        return false;
    }
    if (strcmp(key, "reply-by") == 0) {
        return post_reply_by(env, index + 1, letter);
    }
    const char **value = post_key(letter, key);
    if (!value) {
        clips_value_refuse(env, "speak",
                           "pairs of a value and one of these keys: language ontology reply-with "
                           "in-reply-to reply-by conversation");
        return false;
    }
    if (!clips_value_word(env, "speak", index + 1, value)) {
        return false;
    }
    if (strlen(*value) > MU_FIELD_MAX) {
        clips_value_refuse(env, "speak", "words of at most 63 bytes");
        return false;
    }
    return true;
}

void clips_post_speak(void *env, DATA_OBJECT *out)
{
    struct mind_letter letter = post_blank;
    struct mu_text content;
    DATA_OBJECT fields;
    int count = EnvRtnArgCount(env);
    clips_value_bool(env, out, false);
    if (count % 2 == 0) {
        clips_value_refuse(env, "speak",
                           "a performative, a name, a content and pairs of key, value");
        return;
    }
    if (!clips_value_word(env, "speak", 1, &letter.performative) ||
        !post_name(env, "speak", 2, &letter.dst) || !clips_value_any(env, 3, &fields)) {
        return;
    }
    for (int i = 4; i < count; i += 2) {
        if (!post_key_value(env, i, &letter)) {
            return;
        }
    }
    mu_text_init(&content, clips_env_mind(env)->scratch, MU_CONTENT_MAX + 1);
    bool raw = strcmp(letter.language, "clips") != 0 && fields.type == STRING;
    if (raw) { /* a text in another language goes as it is */
        mu_text_add(&content, ValueToString(fields.value));
    }
    if (strlen(letter.performative) > MU_FIELD_MAX || (!raw && !post_value(&content, &fields)) ||
        content.cut) {
        clips_value_refuse(env, "speak", "a content of symbols, strings and finite numbers");
        return;
    }
    letter.content = content.at;
    post_hand(env, &letter, out);
}

/* The text of a mail fact's slot, "" for nil. */
static const char *post_slot(const struct fact *f, size_t index)
{
    const struct field *slot = &f->theProposition.theFields[index];
    bool word = slot->type == SYMBOL || slot->type == STRING;
    const char *text = word ? ((const struct symbolHashNode *)slot->value)->contents : "";
    return strcmp(text, "nil") == 0 ? "" : text;
}

void clips_post_reply(void *env, DATA_OBJECT *out)
{
    enum { FROM = 1, ONTOLOGY = 5, REPLY_WITH = 6, CONVERSATION = 8 };
    struct mind *m = clips_env_mind(env);
    struct mind_letter letter = post_blank;
    DATA_OBJECT mail;
    clips_value_bool(env, out, false);
    if (!clips_value_any(env, 1, &mail)) {
        return;
    }
    const struct fact *f = mail.type == FACT_ADDRESS ? mail.value : NULL;
    if (!f || f->whichDeftemplate != m->mail || !mu_name_valid(post_slot(f, FROM))) {
        clips_value_refuse(env, "reply", "a mail fact and fields");
        return;
    }
    letter.dst = post_slot(f, FROM);
    letter.performative = "tell";
    letter.ontology = post_slot(f, ONTOLOGY);
    letter.in_reply_to = post_slot(f, REPLY_WITH);
    letter.conversation = post_slot(f, CONVERSATION);
    post_letter(env, "reply", &letter, 2, out);
}

/* WHO: a name, or a multifield of names, joined by commas. */
static bool post_who(void *env, struct mu_text *to)
{
    DATA_OBJECT who;
    if (!clips_value_any(env, 1, &who)) {
        return false;
    }
    bool single = who.type != MULTIFIELD;
    bool good = single || who.begin <= who.end;
    for (long i = single ? 0 : who.begin; good && i <= (single ? 0 : who.end); i++) {
        struct field f = {.type = who.type, .value = who.value};
        if (!single) {
            f = ((struct multifield *)who.value)->theFields[i];
        }
        bool word = f.type == SYMBOL || f.type == STRING;
        good = word && mu_name_valid(ValueToString(f.value));
        if (good) {
            mu_text_add(to, to->len > 0 ? "," : "");
            mu_text_add(to, ValueToString(f.value));
        }
    }
    if (!good || to->cut) {
        clips_value_refuse(env, "you-do", "a name or a multifield of names, a command, its fields");
    }
    return good && !to->cut;
}

void clips_post_you_do(void *env, DATA_OBJECT *out)
{
    static char names[4096]; /* one thread, and the port copies it */
    struct mind_letter letter = post_blank;
    struct mu_text to;
    struct mu_text line;
    const char *command;
    clips_value_bool(env, out, false);
    mu_text_init(&to, names, sizeof names);
    mu_text_init(&line, clips_env_mind(env)->scratch, MU_CONTENT_MAX);
    if (!post_who(env, &to) || !clips_value_word(env, "you-do", 2, &command)) {
        return;
    }
    mu_text_add(&line, "(");
    if (!post_arguments(env, "you-do", 2, &line)) {
        return;
    }
    mu_text_add(&line, ")");
    letter.dst = to.at;
    letter.directive = true;
    letter.performative = "do";
    letter.content = line.at;
    post_hand(env, &letter, out);
}
