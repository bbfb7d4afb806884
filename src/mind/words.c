/* SPDX-License-Identifier: Apache-2.0 */
/* The words of a mind, for whoever completes what a person types. */
#include "mind/clips_mind.h"

#include <ctype.h>
#include <string.h>

/* What CLIPS parses by itself. */
static const char *const words_constructs[] = {
    "defrule",   "deffacts", "deftemplate", "deffunction", "defglobal",
    "defmodule", "defclass", "defgeneric",  "defmethod",   "definstances"};

/* Names that CLIPS gave to its own parts, (query-...) and others, nobody types. */
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
    if (!m->env) {
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
