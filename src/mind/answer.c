/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Answers of a mind: to a question of one word by a deffunction, as (ask-one red status) calls
 * (answer-status); its goal; its facts; mail of a layer by the handlers of that layer; and the
 * agents for which an address stands.
 */
#include "core/name.h"
#include "core/performatives.h"
#include "mind/mind.h"
#include "mind/snapshot/snapshot.h"

#include <string.h>

/* @return the function that answers a word without an argument, or NULL */
static struct deffunctionStruct *answer_function(const struct mind *m, const char *word)
{
    char name[MU_FIELD_MAX + 8];
    if (word[0] == '\0' || strlen(word) > MU_FIELD_MAX || strpbrk(word, " \t\n()\"")) {
        return NULL;
    }
    snprintf(name, sizeof name, "answer-%s", word);
    struct deffunctionStruct *f = EnvFindDeffunction(m->env, name);
    return f && f->minNumberOfParameters <= 0 ? f : NULL;
}

/* FALSE is no answer. */
static bool answer_write(struct mind *m, DATA_OBJECT *value, struct mu_text *out)
{
    if (value->type == MULTIFIELD) {
        return send_content(m->env, "answer", value, out);
    }
    bool passes = value->type == SYMBOL && value->value == EnvFalseSymbol(m->env);
    return !passes && send_field(out, value->type, value->value);
}

bool mind_answer(struct mind *m, const struct mind_mail *mail, struct mu_text *out)
{
    struct deffunctionStruct *f = state_has_rules(m) ? answer_function(m, mail->content) : NULL;
    if (!f || !MIND_ENTER(m, STATE_HANDLE)) {
        return false;
    }
    struct expr call = {.type = PCALL, .value = f};
    DATA_OBJECT result;
    trace_mail(m, mail);
    bool good = !EvaluateExpression(m->env, &call, &result) && answer_write(m, &result, out);
    bool failed = mind_leave(m);
    if (failed || m->said.len > 0) {
        complaint_show(m, "function", EnvGetDeffunctionName(m->env, f));
    }
    return good && !failed;
}

static void field_add(struct mu_text *out, const struct field *f)
{
    switch (f->type) {
    case FLOAT: syntax_add_float(out, ValueToDouble(f->value)); break;
    case INTEGER: mu_text_format(out, "%lld", ValueToLong(f->value)); break;
    case STRING:
    case SYMBOL:
    case INSTANCE_NAME: mu_text_add(out, ValueToString(f->value)); break;
    default: mu_text_add(out, "?"); break;
    }
}

void mind_goal(struct mind *m, char goal[MU_FIELD_MAX + 1])
{
    struct mu_text out = mu_text_in(goal, MU_FIELD_MAX + 1);
    const struct deftemplate *t = state_has_rules(m) ? EnvFindDeftemplate(m->env, "goal") : NULL;
    if (!t || !t->implied || !t->lastFact) {
        return;
    }
    const struct multifield *words = t->lastFact->theProposition.theFields[0].value;
    for (long i = 0; i < words->multifieldLength; i++) {
        mu_text_add(&out, i > 0 ? " " : "");
        field_add(&out, &words->theFields[i]);
    }
}

/* --- handlers of layers ----------------------------------------------------------------------- */

static uint32_t layer_of(const struct mind_mail *mail)
{
    return mail->layer ? mail->layer : MU_LAYER_SPEECH;
}

bool mind_has_layer(const struct mind *m, uint32_t layer)
{
    for (size_t i = 0; i < output_of(m)->handler_count; i++) {
        if (output_of(m)->handlers[i].layer == layer) {
            return true;
        }
    }
    return false;
}

/* @return whether the handler took the mail; one that ends in an error did not */
static bool layer_call(struct mind *m, const struct mind_mail *mail, const char *function,
                       DATA_OBJECT *content)
{
    const char *performative = mail->performative[0] ? mail->performative : "nil";
    struct deffunctionStruct *f = layers_function(m, function);
    if (!f) {
        return false;
    }
    struct expr arguments[LAYERS_ARGUMENTS] = {
        {.type = INTEGER, .value = EnvAddLong(m->env, (long long)mail->id)},
        {.type = SYMBOL, .value = EnvAddSymbol(m->env, mail->src)},
        {.type = SYMBOL, .value = EnvAddSymbol(m->env, performative)},
        {.type = MULTIFIELD, .value = content}};
    for (size_t i = 0; i + 1 < LAYERS_ARGUMENTS; i++) {
        arguments[i].nextArg = &arguments[i + 1];
        AtomInstall(m->env, arguments[i].type, arguments[i].value);
    }
    struct expr call = {.type = PCALL, .value = f, .argList = arguments};
    DATA_OBJECT result;
    environment_begin(m);
    output_of(m)->handled = mail;
    EvaluateExpression(m->env, &call, &result);
    output_of(m)->handled = NULL;
    bool passes = result.type == SYMBOL && result.value == EnvFalseSymbol(m->env);
    bool failed = environment_end(m);
    for (size_t i = 0; i + 1 < LAYERS_ARGUMENTS; i++) {
        AtomDeinstall(m->env, arguments[i].type, arguments[i].value);
    }
    if (failed || m->said.len > 0) {
        complaint_show(m, "function", function);
    }
    return !passes && !failed;
}

bool mind_handle(struct mind *m, const struct mind_mail *mail)
{
    struct layers_handler chain[LAYERS_HANDLERS_MAX]; /* a handler may add others */
    size_t count = output_of(m)->handler_count;
    bool list, taken = false;
    if (!mind_has_layer(m, layer_of(mail)) || !MIND_ENTER(m, STATE_HANDLE)) {
        return false;
    }
    memcpy(chain, output_of(m)->handlers, count * sizeof chain[0]);
    trace_mail(m, mail);
    struct multifield *fields = mailbox_content(m, mail, &list);
    MultifieldInstall(m->env, fields);
    DATA_OBJECT content = {
        .type = MULTIFIELD, .value = fields, .begin = 0, .end = fields->multifieldLength - 1};
    while (count-- > 0 && !taken) {
        if (chain[count].layer == layer_of(mail)) {
            taken = layer_call(m, mail, ValueToString(chain[count].function), &content);
        }
    }
    MultifieldDeinstall(m->env, fields);
    AddToMultifieldList(m->env, fields); /* values that the handlers left may still point to it */
    CleanCurrentGarbageFrame(m->env, NULL);
    CallPeriodicTasks(m->env);
    (void)mind_leave(m);
    return taken;
}

bool mind_understands(const struct mind *m, const struct mind_mail *mail)
{
    const char *word = mail->performative;
    if (word[0] == '\0' && layer_of(mail) == MU_LAYER_SPEECH) {
        return true; /* most mail */
    }
    if (mail->in_reply_to[0] || mu_performative_answers(word)) {
        return true;
    }
    if (layer_of(mail) == MU_LAYER_SPEECH) {
        return mu_performative_known(word);
    }
    return layer_of(mail) > MU_LAYER_SPEECH && mind_has_layer(m, layer_of(mail));
}

/* --- addresses -------------------------------------------------------------------------------- */

const char *mind_scheme(const struct mind *m)
{
    return output_of(m)->scheme;
}

/* @return false: the value is no name */
static bool resolve_add(struct mu_text *names, unsigned short type, const void *value)
{
    const char *name = type == SYMBOL || type == STRING ? ValueToString(value) : "";
    mu_text_add(names, names->len > 0 ? "," : "");
    mu_text_add(names, name);
    return mu_name_valid(name);
}

/* @return whether the resolver's value is FALSE, or names, which are written */
static bool resolve_write(const struct mind *m, const DATA_OBJECT *value, bool *known,
                          struct mu_text *names)
{
    *known = !(value->type == SYMBOL && value->value == EnvFalseSymbol(m->env));
    if (value->type != MULTIFIELD) {
        return !*known || resolve_add(names, value->type, value->value);
    }
    bool good = true;
    for (long i = value->begin; good && i <= value->end; i++) {
        const struct field *f = &((struct multifield *)value->value)->theFields[i];
        good = resolve_add(names, f->type, f->value);
    }
    return good;
}

/* What stands behind the colon: a number if it is nothing else. */
static struct expr rest_argument(const struct mind *m, const char *rest)
{
    const char *behind = rest;
    struct syntax_field f = syntax_read_field(&behind);
    bool whole = *behind == '\0' && f.at == rest;
    if (whole && f.kind == SYNTAX_FIELD_INTEGER) {
        return (struct expr){.type = INTEGER, .value = EnvAddLong(m->env, f.integer)};
    }
    if (whole && f.kind == SYNTAX_FIELD_FLOAT) {
        return (struct expr){.type = FLOAT, .value = EnvAddDouble(m->env, f.real)};
    }
    return (struct expr){.type = SYMBOL, .value = EnvAddSymbol(m->env, rest)};
}

/* @return whether there is such an address; a resolver that ends in an error says so */
static bool resolver_call(struct mind *m, struct deffunctionStruct *f, struct expr *arguments,
                          struct mu_text *names)
{
    static const char wrong[] = "a resolver returns a name, a multifield of names, or FALSE\n";
    struct expr call = {.type = PCALL, .value = f, .argList = arguments};
    DATA_OBJECT result;
    bool known = false;
    environment_begin(m);
    bool good = !EvaluateExpression(m->env, &call, &result);
    if (good && !resolve_write(m, &result, &known, names)) {
        EnvPrintRouter(m->env, WERROR, wrong);
        good = false;
    }
    bool failed = environment_end(m);
    if (failed || m->said.len > 0) {
        complaint_show(m, "function", EnvGetDeffunctionName(m->env, f));
    }
    return !failed && good && known;
}

bool mind_resolve(struct mind *m, const char *rest, const char *sender, struct mu_text *names)
{
    struct deffunctionStruct *f = state_has_rules(m) ? layers_resolver(m) : NULL;
    if (!f || !MIND_ENTER(m, STATE_HANDLE)) {
        return false;
    }
    struct expr arguments[RESOLVER_ARGUMENTS] = {
        rest_argument(m, rest), {.type = SYMBOL, .value = EnvAddSymbol(m->env, sender)}};
    arguments[0].nextArg = &arguments[1];
    for (size_t i = 0; i < RESOLVER_ARGUMENTS; i++) {
        AtomInstall(m->env, arguments[i].type, arguments[i].value);
    }
    bool good = resolver_call(m, f, arguments, names);
    for (size_t i = 0; i < RESOLVER_ARGUMENTS; i++) {
        AtomDeinstall(m->env, arguments[i].type, arguments[i].value);
    }
    CleanCurrentGarbageFrame(m->env, NULL);
    CallPeriodicTasks(m->env);
    (void)mind_leave(m);
    return good;
}

/* --- the question for facts ------------------------------------------------------------------- */

/* Ends a text that was cut with a whole character of UTF-8. */
static void facts_end_character(struct mu_text *out, size_t start)
{
    size_t lead = out->len;
    while (lead > start && ((unsigned char)out->at[lead - 1] & 0xc0) == 0x80) {
        lead--;
    }
    if (lead > start && (unsigned char)out->at[lead - 1] >= 0xc0) {
        out->len = lead - 1;
        out->at[out->len] = '\0';
    }
}

mu_result mind_facts(struct mind *m, const char *relation, struct mu_text *out)
{
    if (!state_has_rules(m)) {
        mu_text_format(out, CLIPS_BROKEN_TEXT "\n", m->lost);
        return MU_ABSENT;
    }
    struct deftemplate *t = relation[0] ? EnvFindDeftemplate(m->env, relation) : NULL;
    if (relation[0] && !t) {
        mu_text_format(out, "no facts %.63s\n", relation);
        return MU_ABSENT;
    }
    if (!MIND_ENTER(m, STATE_LINE)) {
        m->out = NULL;
        mu_text_format(out, CLIPS_BROKEN_TEXT "\n", m->lost);
        return MU_ABSENT;
    }
    size_t start = out->len;
    unsigned count = 0;
    m->out = out;
    percept_show(m);
    for (struct fact *f = EnvGetNextFact(m->env, NULL); f && !out->cut;
         f = EnvGetNextFact(m->env, f)) {
        if (!t || f->whichDeftemplate == t) {
            PrintFactWithIdentifier(m->env, WDISPLAY, f);
            EnvPrintRouter(m->env, WDISPLAY, "\n");
            count++;
        }
    }
    (void)mind_leave(m);
    m->out = NULL;
    bool whole = !out->cut;
    if (whole) {
        mu_text_format(out, "For a total of %u fact%s.\n", count, count == 1 ? "" : "s");
    }
    syntax_as_written(out->at + start);
    out->len = start + strlen(out->at + start);
    if (!whole) {
        facts_end_character(out, start);
    }
    return MU_OK;
}
