/* SPDX-License-Identifier: Apache-2.0 */
/* Incoming mail: its content as fields, the queue of mail facts, (getmsg). */
#include "mind/facts/facts.h"

#include <string.h>

enum { MAIL_ID = 0, MAIL_FROM = 1, MAIL_CONTENT = 9, MAIL_LAYER = 10, MAIL_FIELDS_FEW = 16 };

void mailbox_install(struct mind *m)
{
    messages_install(m);
    mail_ring_install(m);
}

static void field_set(struct mind *m, struct field *to, struct syntax_field f)
{
    switch (f.kind) {
    case SYNTAX_FIELD_INTEGER:
        to->type = INTEGER;
        to->value = EnvAddLong(m->env, f.integer);
        break;
    case SYNTAX_FIELD_FLOAT:
        to->type = FLOAT;
        to->value = EnvAddDouble(m->env, f.real);
        break;
    case SYNTAX_FIELD_STRING:
        syntax_unescape(inputs_of(m)->scratch, f.at, f.len);
        to->type = STRING;
        to->value = EnvAddSymbol(m->env, inputs_of(m)->scratch);
        break;
    case SYNTAX_FIELD_INSTANCE:
    case SYNTAX_FIELD_SYMBOL:
        memcpy(inputs_of(m)->scratch, f.at, f.len);
        inputs_of(m)->scratch[f.len] = '\0';
        to->type = f.kind == SYNTAX_FIELD_SYMBOL ? SYMBOL : INSTANCE_NAME;
        to->value = EnvAddSymbol(m->env, inputs_of(m)->scratch);
        break;
    case SYNTAX_FIELD_END:
    case SYNTAX_FIELD_BAD: break;
    }
}

/* @return the content's fields, typed; NULL: it is no list of fields */
static struct multifield *mail_fields(struct mind *m, const char *content)
{
    struct syntax_field few[MAIL_FIELDS_FEW]; /* of most mails all, read once */
    long count = 0;
    struct syntax_field f;
    if (strnlen(content, MU_CONTENT_MAX + 1) > MU_CONTENT_MAX) {
        return NULL;
    }
    const char *behind = content;
    for (const char *at = content; (f = syntax_read_field(&at)).kind != SYNTAX_FIELD_END; count++) {
        if (f.kind == SYNTAX_FIELD_BAD) {
            return NULL;
        }
        if (count < MAIL_FIELDS_FEW) {
            few[count] = f;
            behind = at;
        }
    }
    struct multifield *fields = CreateMultifield2(m->env, count);
    for (long i = 0; i < count; i++) {
        field_set(m, &fields->theFields[i],
                  i < MAIL_FIELDS_FEW ? few[i] : syntax_read_field(&behind));
    }
    return fields;
}

static struct multifield *mail_raw(struct mind *m, const char *content)
{
    struct multifield *fields = CreateMultifield2(m->env, 1);
    fields->theFields[0].type = STRING;
    fields->theFields[0].value = EnvAddSymbol(m->env, content);
    return fields;
}

/*
 * @return whether functions or right-hand sides look at mail facts: (findall (mail)), fact queries.
 * CLIPS counts such uses, the facts themselves, and one use that C code holds.
 */
static bool mail_is_looked_at(const struct mind *m)
{
    long others = inputs_of(m)->mail->busyCount - 1;
    for (const struct fact *f = inputs_of(m)->mail->factList; f && others > 0;
         f = f->nextTemplateFact) {
        others--;
    }
    return others > 0;
}

/* Drops the facts that rules have taken, once the list is full.  @return whether there is room */
static bool mail_make_room(struct mind *m)
{
    if (inputs_of(m)->mail_count < MAILBOX_MAX) {
        return true;
    }
    inputs_of(m)->mail_count = 0;
    for (size_t i = 0; i < MAILBOX_MAX; i++) {
        if (EnvFactExistp(m->env, inputs_of(m)->mails[i])) {
            inputs_of(m)->mails[inputs_of(m)->mail_count++] = inputs_of(m)->mails[i];
        } else {
            EnvDecrementFactCount(m->env, inputs_of(m)->mails[i]);
        }
    }
    return inputs_of(m)->mail_count < MAILBOX_MAX;
}

static struct fact *mail_assert(struct mind *m, const struct mind_mail *mail,
                                struct multifield *content)
{
    const char *const words[MAIL_CONTENT] = {
        NULL,           mail->src,        m->options.name,   mail->performative, mail->language,
        mail->ontology, mail->reply_with, mail->in_reply_to, mail->conversation};
    struct fact *f = EnvCreateFact(m->env, inputs_of(m)->mail);
    struct field *slots = f->theProposition.theFields;
    slots[MAIL_ID].type = INTEGER;
    slots[MAIL_ID].value = EnvAddLong(m->env, (long long)mail->id);
    for (size_t i = MAIL_FROM; i < MAIL_CONTENT; i++) {
        slots[i].type = SYMBOL;
        slots[i].value = EnvAddSymbol(m->env, words[i][0] ? words[i] : "nil");
    }
    slots[MAIL_CONTENT].type = MULTIFIELD;
    slots[MAIL_CONTENT].value = content;
    slots[MAIL_LAYER].type = INTEGER;
    slots[MAIL_LAYER].value = EnvAddLong(m->env, mail->layer ? mail->layer : MU_LAYER_SPEECH);
    return EnvAssert(m->env, f);
}

/*
 * Queues a mail as a fact, if a rule's pattern fits it or a function looks at mail facts.  Any
 * other fact would stay for ever and fill the queue.
 *
 * @return MU_OK; MU_ABSENT: no rule can take it; MU_FULL: refused
 */
static mu_result mail_queue(struct mind *m, const struct mind_mail *mail,
                            struct multifield *content)
{
    bool looked_at = mail_is_looked_at(m);
    if (!looked_at && !inputs_of(m)->mail->patternNetwork) {
        return MU_ABSENT;
    }
    struct fact *f = mail_assert(m, mail, CopyMultifield(m->env, content));
    if (!f) {
        return MU_ABSENT;
    }
    mu_result r = looked_at || f->list ? MU_OK : MU_ABSENT;
    if (r == MU_OK && !mail_make_room(m)) {
        r = MU_FULL;
    }
    if (r != MU_OK) {
        EnvRetract(m->env, f);
        return r;
    }
    EnvIncrementFactCount(m->env, f);
    inputs_of(m)->mails[inputs_of(m)->mail_count++] = f;
    return MU_OK;
}

static bool mail_is_clips(const struct mind_mail *mail)
{
    return mail->language[0] == '\0' || strcmp(mail->language, "clips") == 0;
}

struct multifield *mailbox_content(struct mind *m, const struct mind_mail *mail, bool *list)
{
    struct multifield *fields = mail_is_clips(mail) ? mail_fields(m, mail->content) : NULL;
    *list = fields != NULL;
    return fields ? fields : mail_raw(m, mail->content);
}

mu_result mailbox_take(struct mind *m, const struct mind_mail *mail)
{
    struct mind_mail letter = *mail;
    bool list;
    letter.language = mail_is_clips(mail) ? "clips" : mail->language;
    EnvIncrementGCLocks(m->env);
    struct multifield *fields = mailbox_content(m, mail, &list);
    mu_result r = mail_queue(m, &letter, fields);
    if (r == MU_ABSENT) {
        r = mail_ring_put(m, &letter, list);
    }
    if (list) {
        messages_add(m, mail->id, EnvAddSymbol(m->env, mail->src), fields);
    } else {
        ReturnMultifield(m->env, fields);
    }
    EnvDecrementGCLocks(m->env);
    return r;
}

/* Notes that a construct calls (getmsg). */
struct expr *mailbox_parse_getmsg(void *env, struct expr *top, const char *source)
{
    struct mind *m = environment_mind(env);
    inputs_of(m)->rules_getmsg = inputs_of(m)->rules_getmsg || ConstructData(env)->ParsingConstruct;
    top = CollectArguments(env, top, source);
    if (top && top->argList) {
        ExpectedCountError(env, "getmsg", EXACTLY, 0);
        ReturnExpression(env, top);
        return NULL;
    }
    return top;
}

static void getmsg_answer(void *env, const struct field *from, const struct multifield *content,
                          DATA_OBJECT *out)
{
    long count = content->multifieldLength;
    struct multifield *fields = EnvCreateMultifield(env, count + 1);
    fields->theFields[0] = *from;
    memcpy(&fields->theFields[1], content->theFields, (size_t)count * sizeof content->theFields[0]);
    value_multifield(out, fields);
}

/* @return the number of a mail fact, or 0: rules may have put anything in its slot */
static uint64_t mail_number(const struct fact *f)
{
    const struct field *id = &f->theProposition.theFields[MAIL_ID];
    return id->type == INTEGER ? (uint64_t)((const struct integerHashNode *)id->value)->contents
                               : 0;
}

static void getmsg_fact(struct mind *m, struct fact *f, DATA_OBJECT *out)
{
    const struct field *slots = f->theProposition.theFields;
    getmsg_answer(m->env, &slots[MAIL_FROM], slots[MAIL_CONTENT].value, out);
    messages_forget(m, mail_number(f));
    EnvRetract(m->env, f);
}

static void getmsg_ring(struct mind *m, const struct mail_ring_entry *mail, const char *content,
                        DATA_OBJECT *out)
{
    struct field from = {.type = SYMBOL, .value = mail->from};
    struct multifield *fields = mail->clips ? mail_fields(m, content) : mail_raw(m, content);
    getmsg_answer(m->env, &from, fields, out);
    ReturnMultifield(m->env, fields);
    messages_forget(m, mail->id);
    mail_ring_drop(m);
}

void mailbox_getmsg(void *env, DATA_OBJECT *out)
{
    struct mind *m = environment_mind(env);
    const char *content;
    struct fact *f = EnvGetNextFactInTemplate(env, inputs_of(m)->mail, NULL);
    const struct mail_ring_entry *queued = mail_ring_first(m, &content);
    bool fact_first = f && (!queued || mail_number(f) < queued->id);
    EnvSetMultifieldErrorValue(env, out);
    if (fact_first) {
        getmsg_fact(m, f, out);
    } else if (queued) {
        getmsg_ring(m, queued, content, out);
    }
}
