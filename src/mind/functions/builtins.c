/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Functions of CLIPS that muster wraps.  (send) takes names besides instances.  Functions that
 * parse a text check its depth first: a deep nesting would exhaust the stack in the parser.
 */
#include "mind/functions/table.h"

#include <stdio.h>
#include <string.h>

/* The environment data of miscfun.c, which has the number of (gensym). */
enum { BUILTIN_GENSYM_DATA = 9 };

enum builtin { BUILTIN_EVAL, BUILTIN_BUILD, BUILTIN_ASSERT, BUILTIN_CHECK, BUILTIN_COUNT };

static const char *const builtin_names[BUILTIN_COUNT] = {"eval", "build", "assert-string",
                                                         "check-syntax"};

/* CLIPS's own functions, the same in every environment. */
static void (*builtin_send)(void *env, DATA_OBJECT *out);
static int (*builtin_calls[BUILTIN_COUNT])(void *env);
static char builtin_returns[BUILTIN_COUNT];
static void (*builtin_print_facts)(void *env);
static void (*builtin_list_facts)(void *env, DATA_OBJECT *out);

/* @return the current call with this value as its first argument */
static struct expr builtin_enter(void *env, struct expr *first, const DATA_OBJECT *value)
{
    struct expr call = *EvaluationData(env)->CurrentExpression;
    *first =
        (struct expr){.type = value->type, .value = value->value, .nextArg = call.argList->nextArg};
    call.argList = first;
    return call;
}

void builtins_send(void *env, DATA_OBJECT *out)
{
    DATA_OBJECT first;
    value_bool(env, out, false);
    if (!value_any(env, 1, &first)) {
        return;
    }
    if (first.type == RVOID) { /* the value of a function without one */
        value_refuse(env, "send", "an agent to send to");
        return;
    }
    bool instance = first.type == INSTANCE_NAME || first.type == INSTANCE_ADDRESS;
    if (instance && EnvRtnArgCount(env) < 2) {
        value_refuse(env, "send", "a message for the instance");
        return;
    }
    struct expr value;
    struct expr *before = EvaluationData(env)->CurrentExpression;
    struct expr call = builtin_enter(env, &value, &first);
    if (first.type == MULTIFIELD) { /* a multifield constant points to a data object */
        value.value = &first;
    }
    EvaluationData(env)->CurrentExpression = &call;
    (instance ? builtin_send : send_agent)(env, out);
    EvaluationData(env)->CurrentExpression = before;
}

/* Calls a function of CLIPS and stores its result, by its return code. */
static void builtin_result(void *env, enum builtin which, DATA_OBJECT *out)
{
    int (*call)(void *) = builtin_calls[which];
    if (builtin_returns[which] == 'b') {
        value_bool(env, out, call(env));
    } else {
        void (*fill)(void *, DATA_OBJECT *) = (void (*)(void *, DATA_OBJECT *))(void (*)(void))call;
        fill(env, out);
    }
}

static void builtin_parse(void *env, enum builtin which, DATA_OBJECT *out)
{
    percept_show(environment_mind(env));         /* the text may build a pattern of it */
    static char bytes[2 * ENVIRONMENT_LINE_MAX]; /* CLIPS copies the text into a symbol at once */
    const char *text;
    value_bool(env, out, false);
    if (!value_word(env, builtin_names[which], 1, &text)) {
        return;
    }
    const char *wrong =
        strlen(text) > ENVIRONMENT_LINE_MAX ? "at most 16384 bytes" : syntax_check(text);
    if (wrong) {
        char wanted[128];
        struct mu_text t = mu_text_in(wanted, sizeof wanted);
        mu_text_format(&t, "a text that can be parsed, not one with %s", wrong);
        value_refuse(env, builtin_names[which], wanted);
        return;
    }
    source_lines_note(environment_mind(env), text, NULL, 0);
    struct mu_text rewritten = mu_text_in(bytes, sizeof bytes);
    syntax_rewrite(&rewritten, text, strlen(text));
    DATA_OBJECT given = {.type = STRING, .value = EnvAddSymbol(env, bytes)};
    struct expr value;
    struct expr *before = EvaluationData(env)->CurrentExpression;
    struct expr call = builtin_enter(env, &value, &given);
    EvaluationData(env)->CurrentExpression = &call;
    builtin_result(env, which, out);
    EvaluationData(env)->CurrentExpression = before;
}

static void builtin_eval(void *env, DATA_OBJECT *out)
{
    builtin_parse(env, BUILTIN_EVAL, out);
}

static void builtin_build(void *env, DATA_OBJECT *out)
{
    builtin_parse(env, BUILTIN_BUILD, out);
}

static void builtin_assert(void *env, DATA_OBJECT *out)
{
    builtin_parse(env, BUILTIN_ASSERT, out);
}

static void builtin_check(void *env, DATA_OBJECT *out)
{
    builtin_parse(env, BUILTIN_CHECK, out);
}

/* (set-strategy random) would draw from numbers that all environments of a process share. */
static void builtin_strategy(void *env, DATA_OBJECT *out)
{
    static const struct {
        const char *name;
        int value;
    } strategies[] = {{"depth", DEPTH_STRATEGY},
                      {"breadth", BREADTH_STRATEGY},
                      {"lex", LEX_STRATEGY},
                      {"mea", MEA_STRATEGY},
                      {"complexity", COMPLEXITY_STRATEGY},
                      {"simplicity", SIMPLICITY_STRATEGY}};
    enum { COUNT = sizeof strategies / sizeof strategies[0] };
    const char *name;
    value_bool(env, out, false);
    if (!value_word(env, "set-strategy", 1, &name)) {
        return;
    }
    const char *old = "depth";
    for (size_t i = 0; i < COUNT; i++) {
        old = strategies[i].value == EnvGetStrategy(env) ? strategies[i].name : old;
    }
    for (size_t i = 0; i < COUNT; i++) {
        if (strcmp(strategies[i].name, name) == 0) {
            EnvSetStrategy(env, strategies[i].value);
            value_symbol(env, out, old);
            return;
        }
    }
    value_refuse(env, "set-strategy", "depth, breadth, lex, mea, complexity or simplicity");
}

/* CLIPS compares anew at each place: 4 MB in 8 MB took it hours. */
static void builtin_index(void *env, DATA_OBJECT *out)
{
    DATA_OBJECT word, text;
    value_bool(env, out, false);
    if (!EnvArgTypeCheck(env, "str-index", 1, SYMBOL_OR_STRING, &word) ||
        !EnvArgTypeCheck(env, "str-index", 2, SYMBOL_OR_STRING, &text)) {
        return;
    }
    const char *in = ValueToString(text.value), *what = ValueToString(word.value);
    const char *at = strstr(in, what);
    if (what[0] == '\0') {
        value_integer(env, out, (long long)UTF8Length(in) + 1);
    } else if (at) {
        value_integer(env, out, (long long)UTF8CharNum(in, (size_t)(at - in) + 1));
    }
}

/* Makes the next new word; rules may have made a hundred thousand of the words before. */
static void *builtin_gensym(void *env)
{
    char word[32];
    long long *number = GetEnvironmentData(env, BUILTIN_GENSYM_DATA);
    do {
        snprintf(word, sizeof word, "gen%lld", (*number)++);
    } while (budget_charge(environment_mind(env), BUDGET_UNITS_A_TICK) && FindSymbolHN(env, word));
    return EnvAddSymbol(env, word);
}

/* (facts) and (get-fact-list) look at all facts, so the ones left out are asserted first. */
static void builtin_facts(void *env)
{
    percept_show(environment_mind(env));
    builtin_print_facts(env);
}

static void builtin_list(void *env, DATA_OBJECT *out)
{
    percept_show(environment_mind(env));
    builtin_list_facts(env, out);
}

/* Puts another function in the place of one of CLIPS.  @return the latter */
static void (*builtin_replace(void *env, const char *name, void (*call)(void)))(void)
{
    struct FunctionDefinition *f = FindFunction(env, name);
    MU_ASSERT(f);
    void (*old)(void) = (void (*)(void))f->functionPointer;
    f->functionPointer = (int (*)(void))call;
    return old;
}

static void builtin_define(void *env, const char *name, void (*call)(void *, DATA_OBJECT *),
                           const char *arguments)
{
    EnvDefineFunction2(env, name, 'u', (int (*)(void *))(void (*)(void))call, name, arguments);
}

void builtins_install(struct mind *m)
{
    static void (*const calls[BUILTIN_COUNT])(void *, DATA_OBJECT *) = {
        builtin_eval, builtin_build, builtin_assert, builtin_check};
    const struct FunctionDefinition *f = FindFunction(m->env, "send");
    MU_ASSERT(f);
    builtin_send = (void (*)(void *, DATA_OBJECT *))(void (*)(void))f->functionPointer;
    for (size_t i = 0; i < BUILTIN_COUNT; i++) {
        f = FindFunction(m->env, builtin_names[i]);
        MU_ASSERT(f);
        builtin_calls[i] = (int (*)(void *))(void (*)(void))f->functionPointer;
        builtin_returns[i] = f->returnValueType;
        builtin_define(m->env, builtin_names[i], calls[i], "11k");
    }
    builtin_print_facts =
        (void (*)(void *))builtin_replace(m->env, "facts", (void (*)(void))builtin_facts);
    builtin_list_facts = (void (*)(void *, DATA_OBJECT *))builtin_replace(
        m->env, "get-fact-list", (void (*)(void))builtin_list);
    builtin_define(m->env, "str-assert", builtin_assert, "11k");
    builtin_define(m->env, "str-index", builtin_index, "22j");
    (void)builtin_replace(m->env, "gensym*", (void (*)(void))builtin_gensym);
    builtin_define(m->env, "set-strategy", builtin_strategy, "11w");
}
