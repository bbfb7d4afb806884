/* SPDX-License-Identifier: Apache-2.0 */
/* Lines that a person types on a console, or another agent sends by (you-do). */
#include "core/probe.h"
#include "mind/mind.h"
#include "mind/snapshot/snapshot.h"

#include <ctype.h>
#include <string.h>

enum { LINE_FORM_MAX = 4 * ENVIRONMENT_LINE_MAX };

/* Checks a line before any of it runs.  @return NULL, or the mistake in the form f */
static const char *line_check(const char *line, struct syntax_form *f)
{
    int number = 1;
    for (size_t forms = 0;; forms++) {
        struct syntax_form before = *f;
        *f = syntax_read_form(&line, &number);
        bool junk = f->kind == SYNTAX_FORM_ATOM && forms > 0;
        if (f->kind == SYNTAX_FORM_BAD) {
            return f->what;
        }
        if (junk || (f->kind == SYNTAX_FORM_LIST && forms > 0 && before.kind == SYNTAX_FORM_ATOM)) {
            return "expected nothing more, or one more form in parentheses";
        }
        if (f->kind == SYNTAX_FORM_END) {
            return NULL;
        }
    }
}

/* (break RULE): in CLIPS break leaves a loop, has no arguments, and is of no use on a line.
 * @return the bytes of "(break", or 0: it is something else */
static size_t line_sets_break(struct syntax_form f)
{
    const char *at = f.at + 1, *end = f.at + f.len;
    while (at < end && strchr(" \t\n", *at)) {
        at++;
    }
    bool is_break = end - at > 6 && memcmp(at, "break", 5) == 0 && strchr(" \t\n", at[5]);
    return f.kind == SYNTAX_FORM_LIST && is_break ? (size_t)(at + 5 - f.at) : 0;
}

/* @return whether CLIPS did it */
static bool line_run(struct mind *m, struct syntax_form f)
{
    static char bytes[LINE_FORM_MAX]; /* RouteCommand reads it before it evaluates */
    struct mu_text form = mu_text_in(bytes, sizeof bytes);
    size_t begun = line_sets_break(f);
    mu_text_add(&form, begun ? "(set-break" : "");
    syntax_rewrite(&form, f.at + begun, f.len - begun);
    bool done = RouteCommand(m->env, form.at, TRUE);
    source_lines_note(m, form.at, NULL, 0);
    bool failed = GetEvaluationError(m->env) || GetHaltExecution(m->env);
    FlushPPBuffer(m->env);
    SetPPBufferStatus(m->env, OFF);
    CleanCurrentGarbageFrame(m->env, NULL);
    CallPeriodicTasks(m->env);
    return done && !failed && !GetHaltExecution(m->env);
}

mu_result mind_line(struct mind *m, const char *line, struct mu_text *out)
{
    struct syntax_form f = {.kind = SYNTAX_FORM_END};
    size_t start = out->len;
    int number = 1;
    if (strlen(line) > ENVIRONMENT_LINE_MAX) {
        mu_text_add(out, "a line has at most 16384 bytes\n");
        return MU_MALFORMED;
    }
    const char *wrong = line_check(line, &f);
    if (wrong) {
        mu_text_format(out, "%s: %.*s\n", wrong, (int)(f.len < 40 ? f.len : 40), f.at);
        return MU_MALFORMED;
    }
    if (!MIND_ENTER(m, STATE_LINE)) {
        m->out = NULL;
        mu_text_format(out, CLIPS_BROKEN_TEXT "\n", m->lost);
        return MU_MALFORMED;
    }
    m->out = out;
    m->shown_count = 0;
    bool done = true;
    while (done && (f = syntax_read_form(&line, &number)).kind != SYNTAX_FORM_END) {
        environment_begin(m);
        percept_show(m);
        trace_line(m, f);
        done = line_run(m, f);
        (void)environment_end(m);
    }
    (void)mind_leave(m);
    if (m->stopped) {
        mu_text_format(out, "stopped: the guard for %s\n", m->stopped);
    }
    m->out = NULL;
    syntax_as_written(out->at + start);
    out->len = start + strlen(out->at + start);
    return done ? MU_OK : MU_MALFORMED;
}

/* --- lines that only look --------------------------------------------------------------------- */

/*
 * They are answered between two steps.  A look must not change the run: all that it touches is put
 * back.
 */

/* State that a call into CLIPS changes by itself. */
struct probe_before {
    uint64_t units, worked;
    uint32_t allocations, trace_lost;
    const char *stopped;
    long memory_max;
    bool ring_unseen;
    struct mu_text trace;
    long long next_fact;
    unsigned long long time_tag;
};

static struct probe_before probe_begin(struct mind *m)
{
    struct probe_before before = {.units = m->cost.units,
                                  .worked = m->worked,
                                  .allocations = m->allocations,
                                  .stopped = m->stopped,
                                  .memory_max = m->memory_max,
                                  .ring_unseen = inputs_of(m)->ring_unseen,
                                  .trace = m->trace,
                                  .trace_lost = m->trace_lost,
                                  .next_fact = FactData(m->env)->NextFactIndex,
                                  .time_tag = DefruleData(m->env)->CurrentEntityTimeTag};
    (void)mind_enter(m, STATE_LOOK);
    m->memory_max = LONG_MAX;
    percept_show(m);
    return before;
}

static void probe_end(struct mind *m, const struct probe_before *before)
{
    if (before->ring_unseen) {
        fact_retract(m, inputs_of(m)->lists[MU_CHANNEL_SONAR].facts);
    }
    CleanCurrentGarbageFrame(m->env, NULL);
    FactData(m->env)->NextFactIndex = before->next_fact;
    DefruleData(m->env)->CurrentEntityTimeTag = before->time_tag;
    inputs_of(m)->ring_unseen = before->ring_unseen;
    m->trace = before->trace;
    m->trace.at[m->trace.len] = '\0';
    m->trace_lost = before->trace_lost;
    m->cost.units = before->units;
    m->worked = before->worked;
    m->allocations = before->allocations;
    m->stopped = before->stopped;
    m->memory_max = before->memory_max;
    (void)mind_leave(m);
}

/* @return whether the word is the engine's: rules may have given it another meaning */
static bool probe_is_plain(struct mind *m, const char *line)
{
    char name[MU_GLANCE_LINE_MAX + 1];
    const char *word = line;
    size_t len = mu_probe_word(line, &word);
    if (len == 0) {
        return true;
    }
    memcpy(name, word, len);
    name[len] = '\0';
    return FindFunction(m->env, name) && !LookupDefgenericInScope(m->env, name) &&
           !LookupDeffunctionInScope(m->env, name);
}

/* @return whether CLIPS did it */
static bool probe_run(struct mind *m, const char *line)
{
    bool done = RouteCommand(m->env, line, TRUE);
    bool failed = GetEvaluationError(m->env) || GetHaltExecution(m->env);
    FlushPPBuffer(m->env);
    SetPPBufferStatus(m->env, OFF);
    return done && !failed;
}

mu_result mind_probe(struct mind *m, const char *line, struct mu_text *out)
{
    char sink_bytes[1];
    size_t start = out->len;
    if (!state_has_rules(m) || !mu_probe_is(line) || !probe_is_plain(m, line)) {
        return MU_ABSENT;
    }
    struct mu_text sink = mu_text_in(sink_bytes, sizeof sink_bytes);
    m->out = &sink; /* a watch of facts must not show one asserted for this look */
    struct probe_before before = probe_begin(m);
    m->out = out;
    bool done = probe_run(m, line);
    m->out = &sink;
    probe_end(m, &before);
    m->out = NULL;
    syntax_as_written(out->at + start);
    out->len = start + strlen(out->at + start);
    return done ? MU_OK : MU_MALFORMED;
}

/* --- words, for completion of what a person types ----------------------------------------------
 */

/* Words of CLIPS that are no functions. */
static const char *const words_constructs[] = {
    "defrule",   "deffacts", "deftemplate", "deffunction", "defglobal",
    "defmodule", "defclass", "defgeneric",  "defmethod",   "definstances"};

/* Leaves out names that CLIPS gave to its own parts, as (query-...). */
static void words_add(struct mu_text *out, char kind, const char *name)
{
    if (isalpha((unsigned char)name[0]) && !strpbrk(name, "() \n")) {
        mu_text_format(out, "%c %s\n", kind, name);
    }
}

static void words_functions(struct mind *m, struct mu_text *out)
{
    for (size_t i = 0; i < sizeof words_constructs / sizeof words_constructs[0]; i++) {
        words_add(out, 'f', words_constructs[i]);
    }
    for (const struct FunctionDefinition *f = GetFunctionList(m->env); f; f = f->next) {
        words_add(out, 'f', ValueToString(f->callFunctionName));
    }
    for (void *f = EnvGetNextDeffunction(m->env, NULL); f; f = EnvGetNextDeffunction(m->env, f)) {
        words_add(out, 'f', EnvGetDeffunctionName(m->env, f));
    }
}

void mind_words(struct mind *m, struct mu_text *out)
{
    if (!state_has_rules(m)) {
        return;
    }
    words_functions(m, out);
    for (void *r = EnvGetNextDefrule(m->env, NULL); r; r = EnvGetNextDefrule(m->env, r)) {
        words_add(out, 'r', EnvGetDefruleName(m->env, r));
    }
    for (void *t = EnvGetNextDeftemplate(m->env, NULL); t; t = EnvGetNextDeftemplate(m->env, t)) {
        words_add(out, 't', EnvGetDeftemplateName(m->env, t));
    }
    for (void *g = EnvGetNextDefglobal(m->env, NULL); g; g = EnvGetNextDefglobal(m->env, g)) {
        mu_text_format(out, "g ?*%s*\n", EnvGetDefglobalName(m->env, g));
    }
}

void mind_functions(struct mu_text *out)
{
    functions_page(out);
}
