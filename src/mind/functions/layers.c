/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Handlers of layers, written in rules: deffunctions that see a mail before it becomes a fact. They
 * are known by name, so that a deffunction may be defined anew, or go.
 */
#include "core/performatives.h"
#include "mind/engine/value.h"
#include "mind/facts/facts.h"
#include "mind/functions/table.h"

#include <string.h>

enum { HANDLER_ARGUMENTS = 4 }; /* id, from, performative, content */

static uint32_t layer_of(const struct mind_mail *mail)
{
    return mail->layer ? mail->layer : MU_LAYER_SPEECH;
}

/* @return the deffunction of that name if it can be called so, or NULL */
static struct deffunctionStruct *layer_function(const struct mind *m, const char *name)
{
    struct deffunctionStruct *f = EnvFindDeffunction(m->env, name);
    bool fits = f && f->minNumberOfParameters <= HANDLER_ARGUMENTS &&
                (f->maxNumberOfParameters < 0 || f->maxNumberOfParameters >= HANDLER_ARGUMENTS);
    return fits ? f : NULL;
}

mu_result clips_layer_add(struct mind *m, uint32_t layer, const char *function)
{
    size_t place = 0;
    if (!layer_function(m, function)) {
        return MU_ABSENT;
    }
    SYMBOL_HN *name = EnvAddSymbol(m->env, function);
    while (place < m->handler_count &&
           (m->handlers[place].layer != layer || m->handlers[place].function != name)) {
        place++;
    }
    if (place == CLIPS_HANDLERS_MAX) {
        return MU_FULL;
    }
    if (place < m->handler_count) { /* it is there already, and becomes the youngest */
        m->handler_count--;
        memmove(&m->handlers[place], &m->handlers[place + 1],
                (m->handler_count - place) * sizeof m->handlers[0]);
    } else {
        IncrementSymbolCount(name);
    }
    m->handlers[m->handler_count++] = (struct clips_handler){.layer = layer, .function = name};
    return MU_OK;
}

void clips_layer_on(void *env, DATA_OBJECT *out)
{
    long long layer;
    const char *function;
    clips_value_bool(env, out, false);
    if (!clips_value_whole(env, "on-layer", 1, &layer) ||
        !clips_value_word(env, "on-layer", 2, &function)) {
        return;
    }
    if (layer < 1 || layer > UINT32_MAX) {
        clips_value_refuse(env, "on-layer", "a layer: a whole number from 1 on");
        return;
    }
    mu_result r = clips_layer_add(clips_env_mind(env), (uint32_t)layer, function);
    if (r == MU_ABSENT) {
        clips_value_refuse(env, "on-layer",
                           "a deffunction that takes four arguments: id, from, performative, "
                           "content");
    } else if (r == MU_FULL) {
        clips_value_refuse(env, "on-layer", "at most 32 handlers");
    }
    clips_value_bool(env, out, r == MU_OK);
}

bool mind_has_layer(const struct mind *m, uint32_t layer)
{
    for (size_t i = 0; i < m->handler_count; i++) {
        if (m->handlers[i].layer == layer) {
            return true;
        }
    }
    return false;
}

/* @return whether the handler took the mail; one that ends in an error has not */
static bool layer_call(struct mind *m, const struct mind_mail *mail, const char *function,
                       DATA_OBJECT *content)
{
    const char *performative = mail->performative[0] ? mail->performative : "nil";
    struct deffunctionStruct *f = layer_function(m, function);
    if (!f) {
        return false;
    }
    struct expr arguments[HANDLER_ARGUMENTS] = {
        {.type = INTEGER, .value = EnvAddLong(m->env, (long long)mail->id)},
        {.type = SYMBOL, .value = EnvAddSymbol(m->env, mail->src)},
        {.type = SYMBOL, .value = EnvAddSymbol(m->env, performative)},
        {.type = MULTIFIELD, .value = content}};
    for (size_t i = 0; i + 1 < HANDLER_ARGUMENTS; i++) {
        arguments[i].nextArg = &arguments[i + 1];
        AtomInstall(m->env, arguments[i].type, arguments[i].value);
    }
    struct expr call = {.type = PCALL, .value = f, .argList = arguments};
    DATA_OBJECT result;
    clips_env_enter(m, CLIPS_MODE_FIRE);
    m->handled = mail;
    EvaluateExpression(m->env, &call, &result);
    m->handled = NULL;
    bool passes = result.type == SYMBOL && result.value == EnvFalseSymbol(m->env);
    bool failed = clips_env_leave(m);
    for (size_t i = 0; i + 1 < HANDLER_ARGUMENTS; i++) {
        AtomDeinstall(m->env, arguments[i].type, arguments[i].value);
    }
    if (failed || m->said.len > 0) {
        clips_fire_complain(m, "function", function);
    }
    return !passes && !failed;
}

bool mind_handle(struct mind *m, const struct mind_mail *mail)
{
    struct clips_handler chain[CLIPS_HANDLERS_MAX]; /* a handler may add others */
    size_t count = m->handler_count;
    bool list, taken = false;
    if (!mind_has_layer(m, layer_of(mail)) || CLIPS_BROKEN(m)) {
        return false;
    }
    memcpy(chain, m->handlers, count * sizeof chain[0]);
    clips_env_enter(m, CLIPS_MODE_QUIET);
    clips_guard_start(m, 0);
    clips_diary_mail(m, mail);
    struct multifield *fields = clips_mail_content(m, mail, &list);
    MultifieldInstall(m->env, fields);
    DATA_OBJECT content = {
        .type = MULTIFIELD, .value = fields, .begin = 0, .end = fields->multifieldLength - 1};
    while (count-- > 0 && !taken) {
        if (chain[count].layer == layer_of(mail)) {
            taken = layer_call(m, mail, ValueToString(chain[count].function), &content);
        }
    }
    MultifieldDeinstall(m->env, fields);
    AddToMultifieldList(m->env, fields); /* what the handlers left behind may still point to it */
    CleanCurrentGarbageFrame(m->env, NULL);
    CallPeriodicTasks(m->env);
    clips_env_leave(m);
    return taken;
}

bool mind_understands(const struct mind *m, const struct mind_mail *mail)
{
    const char *word = mail->performative;
    if (mail->in_reply_to[0] || mu_performative_answers(word)) {
        return true;
    }
    if (layer_of(mail) == MU_LAYER_SPEECH) {
        return word[0] == '\0' || mu_performative_known(word);
    }
    return layer_of(mail) > MU_LAYER_SPEECH && mind_has_layer(m, layer_of(mail));
}

/* --- the question for facts ------------------------------------------------------------------- */

/* What was cut ends with a whole character of UTF-8. */
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
    if (CLIPS_BROKEN(m)) {
        m->out = NULL;
        mu_text_format(out, CLIPS_BROKEN_TEXT "\n", m->lost);
        return MU_ABSENT;
    }
    struct deftemplate *t = relation[0] ? EnvFindDeftemplate(m->env, relation) : NULL;
    size_t start = out->len;
    unsigned count = 0;
    if (relation[0] && !t) {
        mu_text_format(out, "no facts %.63s\n", relation);
        return MU_ABSENT;
    }
    m->out = out;
    clips_env_enter(m, CLIPS_MODE_LINE);
    percept_show(m);
    clips_guard_start(m, 0);
    for (struct fact *f = EnvGetNextFact(m->env, NULL); f && !out->cut;
         f = EnvGetNextFact(m->env, f)) {
        if (!t || f->whichDeftemplate == t) {
            PrintFactWithIdentifier(m->env, WDISPLAY, f);
            EnvPrintRouter(m->env, WDISPLAY, "\n");
            count++;
        }
    }
    clips_env_leave(m);
    m->out = NULL;
    bool whole = !out->cut;
    if (whole) {
        mu_text_format(out, "For a total of %u fact%s.\n", count, count == 1 ? "" : "s");
    }
    clips_text_as_written(out->at + start);
    out->len = start + strlen(out->at + start);
    if (!whole) {
        facts_end_character(out, start);
    }
    return MU_OK;
}
