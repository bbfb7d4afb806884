/* SPDX-License-Identifier: Apache-2.0 */
/* A mind as text: what a capsule begins with, its rules and its switches. */
#include "mind/snapshot/snapshot.h"

#include "core/hash.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const char CAPSULE_WORD[] = "muster-capsule";
enum { CAPSULE_VERSION = 3, CAPSULE_HEAD_MAX = 96 };

/* Against pieces that are lost or mixed up, not against attackers. */
static uint64_t capsule_sum(const char *body, size_t len)
{
    return mu_hash_bytes(MU_HASH_EMPTY, body, len);
}

/* --- switches --------------------------------------------------------------------------------- */

/* What (set-strategy) and the like have changed, in the order of a capsule. */
static const struct {
    int (*get)(void *env);
    int (*set)(void *env, int value);
    int most;
} switches[] = {
    {EnvGetStrategy, EnvSetStrategy, RANDOM_STRATEGY},
    {EnvGetSalienceEvaluation, EnvSetSalienceEvaluation, EVERY_CYCLE},
    {EnvGetFactDuplication, EnvSetFactDuplication, 1},
    {EnvGetResetGlobals, EnvSetResetGlobals, 1},
    {EnvGetSequenceOperatorRecognition, EnvSetSequenceOperatorRecognition, 1},
    {EnvGetIncrementalReset, EnvSetIncrementalReset, 1}, /* before there are rules */
    {EnvGetAutoFloatDividend, EnvSetAutoFloatDividend, 1},
    {EnvGetDynamicConstraintChecking, EnvSetDynamicConstraintChecking, 1},
    {EnvGetStaticConstraintChecking, EnvSetStaticConstraintChecking, 1},
};

enum { SWITCHES = sizeof switches / sizeof switches[0] };

static void switches_save(struct mind *m, struct mu_text *out)
{
    mu_text_add(out, "switches");
    for (size_t i = 0; i < SWITCHES; i++) {
        mu_text_format(out, " %d", switches[i].get(m->env));
    }
    mu_text_add(out, "\n");
}

static mu_result switches_load(struct capsule *c)
{
    uint64_t values[SWITCHES];
    bool good = clips_capsule_line(c, "switches");
    for (size_t i = 0; i < SWITCHES && good; i++) {
        good = clips_capsule_count(c, &values[i]) && values[i] <= (uint64_t)switches[i].most;
    }
    if (!good || !clips_capsule_end(c)) {
        return clips_capsule_wrong(c, "the switches");
    }
    for (size_t i = 0; i < SWITCHES; i++) {
        (void)switches[i].set(c->mind->env, (int)values[i]);
    }
    return MU_OK;
}

/* --- rules ------------------------------------------------------------------------------------ */

static int route_query(void *env, const char *name)
{
    (void)env;
    return strcmp(name, "mu-capsule") == 0;
}

static int route_print(void *env, const char *name, const char *text)
{
    (void)name;
    mu_text_add(environment_mind(env)->out, text);
    return TRUE;
}

/* CLIPS prints them as (save) would, headers of functions first. */
static void constructs_print(struct mind *m)
{
    for (struct defmodule *module = EnvGetNextDefmodule(m->env, NULL); module;
         module = EnvGetNextDefmodule(m->env, module)) {
        for (const struct callFunctionItem *f = ConstructData(m->env)->ListOfSaveFunctions; f;
             f = f->next) {
            void (*save)(void *, void *, const char *) =
                (void (*)(void *, void *, const char *))(void (*)(void))f->func;
            save(m->env, module, "mu-capsule");
        }
    }
}

static void constructs_save(struct mind *m, struct mu_text *out)
{
    struct mu_text *before = m->out;
    size_t start = out->len;
    m->out = out;
    EnvAddRouter(m->env, "mu-capsule", 40, route_query, route_print, NULL, NULL, NULL);
    constructs_print(m);
    EnvDeleteRouter(m->env, "mu-capsule");
    m->out = before;
    mu_text_format(out, "\nconstructs-end %zu\n", out->len - start);
}

/* @return whether a form defines what every mind has, and does not let be redefined */
static bool form_is_ours(struct clips_form f)
{
    static const char mail[] = "(deftemplate MAIN::mail";
    return f.len > sizeof mail && strncmp(f.at, mail, sizeof mail - 1) == 0 &&
           strchr(" \t\r\n", f.at[sizeof mail - 1]);
}

static mu_result constructs_load(struct capsule *c)
{
    size_t len = 0;
    while (true) {
        struct clips_form f = clips_text_form(&c->at, &c->line);
        bool is_list = f.kind == CLIPS_FORM_LIST;
        if (f.kind == CLIPS_FORM_ATOM && strncmp(f.at, "constructs-end", f.len) == 0) {
            break;
        }
        if (!is_list) {
            return clips_capsule_wrong(c, "a construct");
        }
        if (!form_is_ours(f)) {
            MU_TRY(clips_load_construct(c->mind, "capsule", f, c->fault));
        }
    }
    bool good = sscanf(c->at, " %zu", &len) == 1;
    c->at += strspn(c->at, " 0123456789");
    return good && clips_capsule_end(c) ? MU_OK : clips_capsule_wrong(c, "the end of the rules");
}

/* What was taken where it was written is taken here. */
static mu_result rules_load(struct capsule *c)
{
    void *env = c->mind->env;
    int sequence = EnvSetSequenceOperatorRecognition(env, FALSE);
    int checks = EnvSetStaticConstraintChecking(env, FALSE);
    mu_result r = constructs_load(c);
    (void)EnvSetSequenceOperatorRecognition(env, sequence);
    (void)EnvSetStaticConstraintChecking(env, checks);
    return r;
}

/* --- the number of (gensym) ------------------------------------------------------------------- */

static uint64_t gensym_next(struct mind *m)
{
    DATA_OBJECT out;
    unsigned long long number = 1;
    if (EnvFunctionCall(m->env, "gensym", NULL, &out) == FALSE && out.type == SYMBOL) {
        (void)sscanf(ValueToString(out.value), "gen%llu", &number);
    }
    return number;
}

static void gensym_set(struct mind *m, uint64_t number)
{
    DATA_OBJECT out;
    char digits[24];
    snprintf(digits, sizeof digits, "%" PRIu64, number);
    (void)EnvFunctionCall(m->env, "setgen", digits, &out);
}

static void gensym_save(struct mind *m, struct mu_text *out)
{
    uint64_t number = gensym_next(m);
    gensym_set(m, number);
    mu_text_format(out, "gensym %" PRIu64 "\n", number);
}

static mu_result gensym_load(struct capsule *c)
{
    uint64_t number;
    if (!clips_capsule_line(c, "gensym") || !clips_capsule_count(c, &number) ||
        !clips_capsule_end(c)) {
        return clips_capsule_wrong(c, "the number of (gensym)");
    }
    gensym_set(c->mind, number);
    return MU_OK;
}

/* --- saving ----------------------------------------------------------------------------------- */

/* Every mind has the instance of CLIPS itself. */
static bool has_instances(struct mind *m)
{
    for (INSTANCE_TYPE *i = EnvGetNextInstance(m->env, NULL); i;
         i = EnvGetNextInstance(m->env, i)) {
        if (strcmp(ValueToString(i->name), "initial-object") != 0) {
            return true;
        }
    }
    return false;
}

static bool body_save(struct mind *m, struct mu_text *out, const char **why)
{
    if (has_instances(m)) {
        *why = "it has instances of classes";
        return false;
    }
    mu_text_add(out, "agent");
    clips_capsule_add_word(out, m->options.name);
    mu_text_add(out, "\n");
    switches_save(m, out);
    constructs_save(m, out);
    gensym_save(m, out);
    if (!clips_capsule_save_globals(m, out, why) || !clips_capsule_save_facts(m, out, why)) {
        return false;
    }
    clips_capsule_save_agenda(m, out);
    clips_capsule_save_state(m, out);
    *why = out->cut ? "it is too large for a capsule" : NULL;
    return !out->cut;
}

mu_result snapshot_save(struct mind *m, struct mu_text *out, struct mu_fault *fault)
{
    char head[CAPSULE_HEAD_MAX + 1];
    const char *why = NULL;
    mu_text_clear(out);
    mu_text_format(out, "%*s", CAPSULE_HEAD_MAX, ""); /* its place: the sum comes last */
    if (!body_save(m, out, &why)) {
        (void)mu_fault_at(fault, "capsule", 0, 0, "%s", why);
        return out->cut ? MU_FULL : MU_REFUSED;
    }
    const char *body = out->at + CAPSULE_HEAD_MAX;
    size_t len = out->len - CAPSULE_HEAD_MAX;
    int used = snprintf(head, sizeof head, "%s %d %zu %016" PRIx64, CAPSULE_WORD, CAPSULE_VERSION,
                        len, capsule_sum(body, len));
    memcpy(out->at, head, (size_t)used);
    out->at[CAPSULE_HEAD_MAX - 1] = '\n';
    return MU_OK;
}

/* --- restoring -------------------------------------------------------------------------------- */

mu_result snapshot_check(const char *text, size_t len, struct mu_fault *fault)
{
    int version = 0;
    size_t bytes = 0;
    uint64_t sum = 0;
    size_t word = sizeof CAPSULE_WORD - 1;
    bool good = len > CAPSULE_HEAD_MAX && strncmp(text, CAPSULE_WORD, word) == 0 &&
                sscanf(text + word, " %d %zu %" SCNx64, &version, &bytes, &sum) == 3;
    if (!good) {
        return mu_fault_at(fault, "capsule", 1, 0, "this is no capsule");
    }
    if (version != CAPSULE_VERSION) {
        return mu_fault_at(fault, "capsule", 1, 0, "expected version %d, found %d", CAPSULE_VERSION,
                           version);
    }
    const char *body = text + CAPSULE_HEAD_MAX;
    if (bytes != len - CAPSULE_HEAD_MAX || body[bytes - 1] != '\n' || memchr(body, '\0', bytes) ||
        sum != capsule_sum(body, bytes)) {
        return mu_fault_at(fault, "capsule", 1, 0, "it is not whole: the checksum differs");
    }
    return MU_OK;
}

/* A fresh mind has facts of its own beginning; the capsule has all that there are to be. */
static void facts_clear(struct mind *m)
{
    EnvReset(m->env); /* for CLIPS's own instance */
    for (struct fact *f; (f = EnvGetNextFact(m->env, NULL));) {
        EnvRetract(m->env, f);
    }
}

static mu_result body_load(struct capsule *c, char name[MU_NAME_MAX + 1])
{
    struct mind *m = c->mind;
    if (!clips_capsule_line(c, "agent") || !clips_capsule_word(c) ||
        !mu_text_copy(name, MU_NAME_MAX + 1, c->word) || !clips_capsule_end(c)) {
        return clips_capsule_wrong(c, "whose mind it is");
    }
    facts_clear(m);
    MU_TRY(switches_load(c));
    MU_TRY(rules_load(c));
    environment_enter(m, CLIPS_MODE_QUIET);
    clips_guard_start(m, CLIPS_MEMORY_SPARE);
    EnvIncrementGCLocks(m->env); /* nothing read here may go before it stands somewhere */
    mu_result r = gensym_load(c);
    struct capsule globals = *c; /* patterns look at them, and they at facts */
    r = r == MU_OK ? clips_capsule_load_globals(c) : r;
    r = r == MU_OK ? clips_capsule_load_facts(c) : r;
    r = r == MU_OK ? clips_capsule_load_globals(&globals) : r;
    r = r == MU_OK ? clips_capsule_load_agenda(c) : r;
    r = r == MU_OK ? clips_capsule_load_state(c) : r;
    EnvSetCurrentModule(m->env, EnvFindDefmodule(m->env, "MAIN"));
    EnvDecrementGCLocks(m->env);
    environment_leave(m);
    return r;
}

mu_result snapshot_load(struct mind *m, const char *text, struct mu_fault *fault,
                        char name[MU_NAME_MAX + 1])
{
    struct capsule c = {.mind = m, .at = text + CAPSULE_HEAD_MAX, .line = 2, .fault = fault};
    return body_load(&c, name);
}
