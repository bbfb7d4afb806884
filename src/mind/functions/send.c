/* SPDX-License-Identifier: Apache-2.0 */
/* Mail that rules send. */
#include "mind/functions/table.h"

#include "core/name.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const struct mind_letter send_blank = {.dst = "",
                                       .performative = "",
                                       .language = "clips",
                                       .ontology = "",
                                       .reply_with = "",
                                       .in_reply_to = "",
                                       .conversation = "",
                                       .content = ""};

bool send_field(struct mu_text *out, unsigned short type, const void *value)
{
    const struct symbolHashNode *text = value;
    switch (type) {
    case SYMBOL: syntax_add_symbol(out, text->contents); return true;
    case STRING: syntax_add_quoted(out, text->contents); return true;
    case INSTANCE_NAME: mu_text_format(out, "[%s]", text->contents); return true;
    case INTEGER:
        mu_text_add_number(out, ((const struct integerHashNode *)value)->contents);
        return true;
    case FLOAT:
        syntax_add_float(out, value_of(type, value));
        return isfinite(value_of(type, value));
    default: return false;
    }
}

static bool send_value(struct mu_text *out, const DATA_OBJECT *value)
{
    bool single = value->type != MULTIFIELD;
    long begin = single ? 0 : value->begin;
    long end = single ? 0 : value->end;
    for (long i = begin; i <= end; i++) {
        const struct field *f = single ? NULL : &((struct multifield *)value->value)->theFields[i];
        if (out->len > 0 && out->at[out->len - 1] != '(') {
            mu_text_add(out, " ");
        }
        bool mailable = single ? send_field(out, value->type, value->value)
                               : send_field(out, f->type, f->value);
        if (!mailable) {
            return false;
        }
    }
    return true;
}

bool send_fields(void *env, const char *function, int first, DATA_OBJECT *fields)
{
    struct expr *arguments = EvaluationData(env)->CurrentExpression->argList;
    for (int i = 1; i < first && arguments; i++) {
        arguments = arguments->nextArg;
    }
    StoreInMultifield(env, fields, arguments, TRUE);
    if (fields->type != MULTIFIELD && !GetEvaluationError(env)) {
        value_refuse(env, function, "fields");
    }
    return !GetEvaluationError(env) && !GetHaltExecution(env);
}

bool send_content(void *env, const char *function, const DATA_OBJECT *fields, struct mu_text *out)
{
    if (!send_value(out, fields)) {
        value_refuse(env, function, "fields that can be mailed: symbols, strings, finite numbers");
        return false;
    }
    if (out->cut) {
        value_refuse(env, function, "a content of at most 16384 bytes");
        return false;
    }
    return true;
}

/* @return whether it is an address such as group:scouts, role:digger or near:2.5 */
static bool who_is_address(const char *who)
{
    char scheme[MU_NAME_MAX + 1];
    size_t len = strcspn(who, ":");
    if (len >= sizeof scheme || who[len] != ':' || who[len + 1] == '\0') {
        return false;
    }
    memcpy(scheme, who, len);
    scheme[len] = '\0';
    for (const char *c = who; *c; c++) {
        if ((unsigned char)*c <= ' ' || *c == 127) {
            return false;
        }
    }
    return mu_name_valid(scheme);
}

static bool who_is_word(unsigned short type)
{
    return type == SYMBOL || type == STRING;
}

/* Several names, joined by commas. */
static bool who_add_names(struct mu_text *to, const DATA_OBJECT *who)
{
    for (long i = who->begin; i <= who->end; i++) {
        const struct field *f = &((struct multifield *)who->value)->theFields[i];
        if (!who_is_word(f->type) || !mu_name_valid(ValueToString(f->value))) {
            return false;
        }
        mu_text_add(to, to->len > 0 ? "," : "");
        mu_text_add(to, ValueToString(f->value));
    }
    return to->len > 0;
}

const char *send_address(void *env, const char *function, int index, const char *wanted)
{
    static char names[MU_DST_MAX + 1]; /* one thread uses it, and the port copies it */
    DATA_OBJECT who;
    bool good = false;
    if (!value_any(env, index, &who)) {
        return NULL;
    }
    struct mu_text to = mu_text_in(names, sizeof names);
    if (who.type == MULTIFIELD) {
        good = who_add_names(&to, &who);
    } else if (who_is_word(who.type)) {
        mu_text_add(&to, ValueToString(who.value));
        good = mu_name_valid(names) || who_is_address(names);
    }
    if (!good || to.cut) {
        value_refuse(env, function, wanted);
        return NULL;
    }
    return names;
}

bool send_seconds(void *env, const char *function, int index, const char *key, uint64_t *ns)
{
    char wanted[64];
    double seconds;
    if (!value_number(env, function, index, &seconds)) {
        return false;
    }
    if (!(seconds > 0 && seconds < 1e9)) {
        snprintf(wanted, sizeof wanted, "a number of seconds above 0 behind %s", key);
        value_refuse(env, function, wanted);
        return false;
    }
    *ns = (uint64_t)(seconds * 1e9);
    return true;
}

bool send_performative(void *env, const char *function, int index, struct mind_letter *letter)
{
    if (!value_word(env, function, index, &letter->performative)) {
        return false;
    }
    if (strlen(letter->performative) > MU_FIELD_MAX) {
        value_refuse(env, function, "a performative of at most 63 bytes");
        return false;
    }
    return true;
}

void send_hand(void *env, const struct mind_letter *letter, DATA_OBJECT *out)
{
    struct mind *m = environment_mind(env);
    const struct mind_ports *ports = &m->options.ports;
    bool taken = ports->send && ports->send(ports->self, letter) == MU_OK;
    if (taken) {
        trace_told(m, letter);
    }
    if (taken && letter->reply_with[0]) {
        value_symbol(env, out, letter->reply_with);
    } else {
        value_bool(env, out, taken);
    }
}

/* Nothing is evaluated from here on, so that the text stays whole. */
static void send_letter(void *env, const char *function, struct mind_letter *letter,
                        const DATA_OBJECT *fields, DATA_OBJECT *out)
{
    struct mu_text content =
        mu_text_in(inputs_of(environment_mind(env))->scratch, MU_CONTENT_MAX + 1);
    if (send_content(env, function, fields, &content)) {
        letter->content = content.at;
        send_hand(env, letter, out);
    }
}

const char *send_question(void *env, char *to, size_t size)
{
    struct mind *m = environment_mind(env);
    snprintf(to, size, "%s-%llu", m->options.name, (unsigned long long)++output_of(m)->asked);
    return to;
}

/* (FUNCTION WHO field...) */
static void send_to(void *env, const char *function, const char *performative, bool asks,
                    DATA_OBJECT *out)
{
    struct mind_letter letter = send_blank;
    char question[MU_FIELD_MAX + 1];
    DATA_OBJECT fields;
    letter.performative = performative;
    value_bool(env, out, false);
    if (!send_fields(env, function, 2, &fields)) {
        return;
    }
    letter.dst = send_address(env, function, 1, "the name of an agent, or several");
    if (!letter.dst) {
        return;
    }
    if (asks) {
        letter.reply_with = send_question(env, question, sizeof question);
    }
    send_letter(env, function, &letter, &fields, out);
}

void send_agent(void *env, DATA_OBJECT *out)
{
    send_to(env, "send", "", false, out);
}

void send_tell(void *env, DATA_OBJECT *out)
{
    send_to(env, "tell", "tell", false, out);
}

void send_ask_one(void *env, DATA_OBJECT *out)
{
    send_to(env, "ask-one", "ask-one", true, out);
}

void send_ask_all(void *env, DATA_OBJECT *out)
{
    send_to(env, "ask-all", "ask-all", true, out);
}

void send_achieve(void *env, DATA_OBJECT *out)
{
    send_to(env, "achieve", "achieve", true, out);
}

void send_broadcast(void *env, DATA_OBJECT *out)
{
    struct mind_letter letter = send_blank;
    DATA_OBJECT fields;
    value_bool(env, out, false);
    letter.dst = "all";
    if (send_fields(env, "broadcast", 1, &fields)) {
        send_letter(env, "broadcast", &letter, &fields, out);
    }
}

/* (FUNCTION NAME field...): to SCHEME:NAME */
static void send_scheme(void *env, const char *function, const char *scheme, const char *wanted,
                        DATA_OBJECT *out)
{
    char to[MU_FIELD_MAX + 1];
    struct mind_letter letter = send_blank;
    const char *name;
    DATA_OBJECT fields;
    value_bool(env, out, false);
    if (!send_fields(env, function, 2, &fields) || !value_word(env, function, 1, &name)) {
        return;
    }
    if (!mu_name_valid(name)) {
        value_refuse(env, function, wanted);
        return;
    }
    snprintf(to, sizeof to, "%s:%s", scheme, name);
    letter.dst = to;
    send_letter(env, function, &letter, &fields, out);
}

void send_group(void *env, DATA_OBJECT *out)
{
    send_scheme(env, "group-send", "group", "the name of a group", out);
}

void send_role(void *env, DATA_OBJECT *out)
{
    send_scheme(env, "send-role", "role", "the name of a role", out);
}

void send_task(void *env, DATA_OBJECT *out)
{
    send_scheme(env, "send-task", "task", "the name of a task", out);
}

/* Rules have millimetres, addresses metres. */
void send_near(void *env, DATA_OBJECT *out)
{
    char to[MU_FIELD_MAX + 1];
    struct mind_letter letter = send_blank;
    double distance_mm;
    DATA_OBJECT fields;
    value_bool(env, out, false);
    if (!send_fields(env, "send-near", 2, &fields) ||
        !value_number(env, "send-near", 1, &distance_mm)) {
        return;
    }
    if (!isfinite(distance_mm) || distance_mm < 0) {
        value_refuse(env, "send-near", "a distance in mm, 0 or more");
        return;
    }
    snprintf(to, sizeof to, "near:%.15g", distance_mm / 1000);
    letter.dst = to;
    send_letter(env, "send-near", &letter, &fields, out);
}

/* --- answers ---------------------------------------------------------------------------------- */

/* Slots of a mail fact. */
enum {
    SLOT_FROM = 1,
    SLOT_ONTOLOGY = 5,
    SLOT_REPLY_WITH = 6,
    SLOT_CONVERSATION = 8,
    SLOT_LAYER = 10
};

/* The text of a mail fact's slot, "" for nil. */
static const char *send_slot(const struct fact *f, size_t index)
{
    const struct field *slot = &f->theProposition.theFields[index];
    bool word = slot->type == SYMBOL || slot->type == STRING;
    const char *text = word ? ((const struct symbolHashNode *)slot->value)->contents : "";
    return strcmp(text, "nil") == 0 ? "" : text;
}

/* @return the mail fact that a value is, or NULL */
static const struct fact *mail_fact(const struct mind *m, const DATA_OBJECT *mail)
{
    const struct fact *f = mail->type == FACT_ADDRESS ? mail->value : NULL;
    return f && f->whichDeftemplate == inputs_of(m)->mail ? f : NULL;
}

/* @return the mail of the handler that runs, if the value is its number: it is no fact yet */
static const struct mind_mail *mail_handled(const struct mind *m, const DATA_OBJECT *mail)
{
    const struct mind_mail *handled = output_of(m)->handled;
    bool is_it = handled && mail->type == INTEGER &&
                 (uint64_t)((const struct integerHashNode *)mail->value)->contents == handled->id;
    return is_it ? handled : NULL;
}

static bool reply_to_fact(const struct mind *m, const DATA_OBJECT *mail, struct mind_letter *letter)
{
    const struct fact *f = mail_fact(m, mail);
    if (!f || !mu_name_valid(send_slot(f, SLOT_FROM))) {
        return false;
    }
    const struct field *layer = &f->theProposition.theFields[SLOT_LAYER];
    double number = value_of(layer->type, layer->value);
    letter->dst = send_slot(f, SLOT_FROM);
    letter->ontology = send_slot(f, SLOT_ONTOLOGY);
    letter->in_reply_to = send_slot(f, SLOT_REPLY_WITH);
    letter->conversation = send_slot(f, SLOT_CONVERSATION);
    letter->layer = number >= 1 && number <= UINT32_MAX ? (uint32_t)number : 0;
    return true;
}

static bool reply_to_handled(const struct mind *m, const DATA_OBJECT *mail,
                             struct mind_letter *letter)
{
    const struct mind_mail *handled = mail_handled(m, mail);
    if (!handled) {
        return false;
    }
    letter->dst = handled->src;
    letter->ontology = handled->ontology;
    letter->in_reply_to = handled->reply_with;
    letter->conversation = handled->conversation;
    letter->layer = handled->layer;
    return true;
}

/* Answers the mail of the first argument with the fields from argument `first` on. */
static void reply_send(void *env, const char *function, int first, struct mind_letter *letter,
                       DATA_OBJECT *out)
{
    const struct mind *m = environment_mind(env);
    DATA_OBJECT mail, fields;
    if (!send_fields(env, function, first, &fields) || !value_any(env, 1, &mail)) {
        return;
    }
    if (!reply_to_fact(m, &mail, letter) && !reply_to_handled(m, &mail, letter)) {
        value_refuse(env, function, "a mail fact, or in a handler the number of its mail");
        return;
    }
    send_letter(env, function, letter, &fields, out);
}

void send_reply(void *env, DATA_OBJECT *out)
{
    struct mind_letter letter = send_blank;
    value_bool(env, out, false);
    letter.performative = "tell";
    reply_send(env, "reply", 2, &letter, out);
}

void send_reply_as(void *env, DATA_OBJECT *out)
{
    struct mind_letter letter = send_blank;
    value_bool(env, out, false);
    if (send_performative(env, "reply-as", 2, &letter)) {
        reply_send(env, "reply-as", 3, &letter, out);
    }
}

/* The parameters of a mail, in the order of their slots in a mail fact. */
static const struct parameter {
    const char *key;
    size_t slot;   /* of a mail fact */
    size_t offset; /* of the word in a mail that a handler has */
} parameters[] = {
    {"from", SLOT_FROM, offsetof(struct mind_mail, src)},
    {"performative", 3, offsetof(struct mind_mail, performative)},
    {"language", 4, offsetof(struct mind_mail, language)},
    {"ontology", SLOT_ONTOLOGY, offsetof(struct mind_mail, ontology)},
    {"reply-with", SLOT_REPLY_WITH, offsetof(struct mind_mail, reply_with)},
    {"in-reply-to", 7, offsetof(struct mind_mail, in_reply_to)},
    {"conversation", SLOT_CONVERSATION, offsetof(struct mind_mail, conversation)},
};

static const struct parameter *parameter_find(const char *key)
{
    for (size_t i = 0; i < sizeof parameters / sizeof parameters[0]; i++) {
        if (strcmp(parameters[i].key, key) == 0) {
            return &parameters[i];
        }
    }
    return NULL;
}

/* Reads a parameter of a handler's mail.  @return false: there is none of that name */
static bool parameter_of_handled(void *env, const struct mind_mail *mail, const char *key,
                                 DATA_OBJECT *out)
{
    const struct parameter *p = parameter_find(key);
    if (p) {
        const char *word = *(const char *const *)((const char *)mail + p->offset);
        bool is_clips = p->offset == offsetof(struct mind_mail, language) && !word[0];
        value_symbol(env, out, is_clips ? "clips" : word[0] ? word : "nil");
    } else if (strcmp(key, "layer") == 0) {
        value_integer(env, out, mail->layer ? mail->layer : MU_LAYER_SPEECH);
    } else if (strcmp(key, "reply-by") == 0 && mail->reply_by_ns) {
        value_float(env, out, (double)mail->reply_by_ns * 1e-9);
    } else if (strcmp(key, "reply-by") == 0) {
        value_symbol(env, out, "nil");
    } else {
        return false;
    }
    return true;
}

static bool parameter_of_fact(const struct fact *f, const char *key, DATA_OBJECT *out)
{
    const struct parameter *p = parameter_find(key);
    bool is_layer = strcmp(key, "layer") == 0;
    if (p || is_layer) {
        const struct field *slot =
            &f->theProposition.theFields[is_layer ? (size_t)SLOT_LAYER : p->slot];
        out->type = slot->type;
        out->value = slot->value;
    }
    return p || is_layer;
}

void send_mail_parameter(void *env, DATA_OBJECT *out)
{
    const struct mind *m = environment_mind(env);
    DATA_OBJECT mail;
    const char *key;
    value_bool(env, out, false);
    if (!value_any(env, 1, &mail) || !value_word(env, "mail-parameter", 2, &key)) {
        return;
    }
    const struct fact *f = mail_fact(m, &mail);
    const struct mind_mail *handled = mail_handled(m, &mail);
    if (!f && !handled) {
        value_refuse(env, "mail-parameter", "a mail fact, or in a handler the number of its mail");
    } else if (!(f ? parameter_of_fact(f, key, out)
                   : parameter_of_handled(env, handled, key, out))) {
        value_refuse(env, "mail-parameter",
                     "one of these parameters: from performative language ontology reply-with "
                     "in-reply-to conversation layer, and in a handler reply-by");
    }
}

/* --- directives ------------------------------------------------------------------------------- */

/* @return whether it is the name of a group, and of no agent */
static bool you_do_group(const struct mind *m, const char *name)
{
    const struct mind_ports *ports = &m->options.ports;
    struct mind_member member;
    const char *group;
    if (!mu_name_valid(name) || mu_name_reserved(name) || !ports->entry ||
        (ports->lookup && ports->lookup(ports->self, name, &member) == MU_OK)) {
        return false;
    }
    for (size_t i = 0; (group = ports->entry(ports->self, MIND_GROUPS, "", i)) != NULL; i++) {
        if (strcmp(group, name) == 0) {
            return true;
        }
    }
    return false;
}

void send_you_do(void *env, DATA_OBJECT *out)
{
    static const char wanted[] = "a name, a group or a multifield of names, a command, its fields";
    char group[MU_FIELD_MAX + 1];
    struct mind *m = environment_mind(env);
    struct mind_letter letter = send_blank;
    DATA_OBJECT fields;
    value_bool(env, out, false);
    if (!send_fields(env, "you-do", 2, &fields)) {
        return;
    }
    letter.dst = send_address(env, "you-do", 1, wanted);
    if (!letter.dst) {
        return;
    }
    if (fields.end < 0 || !who_is_word(((struct multifield *)fields.value)->theFields[0].type)) {
        value_refuse(env, "you-do", wanted);
        return;
    }
    if (you_do_group(m, letter.dst)) {
        snprintf(group, sizeof group, "group:%s", letter.dst);
        letter.dst = group;
    }
    struct mu_text line = mu_text_in(inputs_of(m)->scratch, MU_CONTENT_MAX);
    mu_text_add(&line, "(");
    if (!send_content(env, "you-do", &fields, &line)) {
        return;
    }
    mu_text_add(&line, ")");
    letter.directive = true;
    letter.performative = "do";
    letter.content = line.at;
    send_hand(env, &letter, out);
}
