/* SPDX-License-Identifier: Apache-2.0 */
/* A mind as text: the head of a snapshot, its rules and its switches. */
#include "mind/snapshot/fields.h"

#include "core/hash.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const char SNAPSHOT_WORD[] = "muster-capsule";
enum { SNAPSHOT_VERSION = 3, SNAPSHOT_HEAD_MAX = 96 };

/* A checksum against pieces that are lost or mixed up, not against attackers. */
static uint64_t snapshot_sum(const char *body, size_t len)
{
    return mu_hash_bytes(MU_HASH_EMPTY, body, len);
}

/* --- switches --------------------------------------------------------------------------------- */

/* Settings of (set-strategy) and the like, in the order of a snapshot. */
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

static mu_result switches_load(struct snapshot *c)
{
    uint64_t values[SWITCHES];
    bool good = snapshot_line(c, "switches");
    for (size_t i = 0; i < SWITCHES && good; i++) {
        good = snapshot_count(c, &values[i]) && values[i] <= (uint64_t)switches[i].most;
    }
    if (!good || !snapshot_end(c)) {
        return snapshot_wrong(c, "the switches");
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
    return strcmp(name, "mu-snapshot") == 0;
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
            save(m->env, module, "mu-snapshot");
        }
    }
}

static void constructs_save(struct mind *m, struct mu_text *out)
{
    struct mu_text *before = m->out;
    size_t start = out->len;
    m->out = out;
    EnvAddRouter(m->env, "mu-snapshot", 40, route_query, route_print, NULL, NULL, NULL);
    constructs_print(m);
    EnvDeleteRouter(m->env, "mu-snapshot");
    m->out = before;
    mu_text_format(out, "\nconstructs-end %zu\n", out->len - start);
}

/*
 * @return whether a form defines the mail template, which every mind has and which cannot be
 * redefined
 */
static bool form_is_ours(struct syntax_form f)
{
    static const char mail[] = "(deftemplate MAIN::mail";
    return f.len > sizeof mail && strncmp(f.at, mail, sizeof mail - 1) == 0 &&
           strchr(" \t\r\n", f.at[sizeof mail - 1]);
}

static mu_result constructs_load(struct snapshot *c)
{
    size_t len = 0;
    while (true) {
        struct syntax_form f = syntax_read_form(&c->at, &c->line);
        bool is_list = f.kind == SYNTAX_FORM_LIST;
        if (f.kind == SYNTAX_FORM_ATOM && strncmp(f.at, "constructs-end", f.len) == 0) {
            break;
        }
        if (!is_list) {
            return snapshot_wrong(c, "a construct");
        }
        if (!form_is_ours(f)) {
            MU_TRY(load_construct(c->mind, "capsule", f, c->fault));
        }
    }
    bool good = sscanf(c->at, " %zu", &len) == 1;
    c->at += strspn(c->at, " 0123456789");
    return good && snapshot_end(c) ? MU_OK : snapshot_wrong(c, "the end of the rules");
}

/* Loads the rules without the checks that they passed in the mind that wrote them. */
static mu_result rules_load(struct snapshot *c)
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

static mu_result gensym_load(struct snapshot *c)
{
    uint64_t number;
    if (!snapshot_line(c, "gensym") || !snapshot_count(c, &number) || !snapshot_end(c)) {
        return snapshot_wrong(c, "the number of (gensym)");
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
    snapshot_add_word(out, m->options.name);
    mu_text_add(out, "\n");
    switches_save(m, out);
    constructs_save(m, out);
    gensym_save(m, out);
    if (!snapshot_save_globals(m, out, why) || !snapshot_save_facts(m, out, why)) {
        return false;
    }
    snapshot_save_agenda(m, out);
    snapshot_save_state(m, out);
    *why = out->cut ? "it is too large for a capsule" : NULL;
    return !out->cut;
}

mu_result snapshot_save(struct mind *m, struct mu_text *out, struct mu_fault *fault)
{
    char head[SNAPSHOT_HEAD_MAX + 1];
    const char *why = NULL;
    mu_text_clear(out);
    mu_text_format(out, "%*s", SNAPSHOT_HEAD_MAX, ""); /* the checksum is known last */
    if (!body_save(m, out, &why)) {
        (void)mu_fault_at(fault, "capsule", 0, 0, "%s", why);
        return out->cut ? MU_FULL : MU_REFUSED;
    }
    const char *body = out->at + SNAPSHOT_HEAD_MAX;
    size_t len = out->len - SNAPSHOT_HEAD_MAX;
    int used = snprintf(head, sizeof head, "%s %d %zu %016" PRIx64, SNAPSHOT_WORD, SNAPSHOT_VERSION,
                        len, snapshot_sum(body, len));
    memcpy(out->at, head, (size_t)used);
    out->at[SNAPSHOT_HEAD_MAX - 1] = '\n';
    return MU_OK;
}

/* --- restoring -------------------------------------------------------------------------------- */

mu_result snapshot_check(const char *text, size_t len, struct mu_fault *fault)
{
    int version = 0;
    size_t bytes = 0;
    uint64_t sum = 0;
    size_t word = sizeof SNAPSHOT_WORD - 1;
    bool good = len > SNAPSHOT_HEAD_MAX && strncmp(text, SNAPSHOT_WORD, word) == 0 &&
                sscanf(text + word, " %d %zu %" SCNx64, &version, &bytes, &sum) == 3;
    if (!good) {
        return mu_fault_at(fault, "capsule", 1, 0, "this is no capsule");
    }
    if (version != SNAPSHOT_VERSION) {
        return mu_fault_at(fault, "capsule", 1, 0, "expected version %d, found %d",
                           SNAPSHOT_VERSION, version);
    }
    const char *body = text + SNAPSHOT_HEAD_MAX;
    if (bytes != len - SNAPSHOT_HEAD_MAX || body[bytes - 1] != '\n' || memchr(body, '\0', bytes) ||
        sum != snapshot_sum(body, bytes)) {
        return mu_fault_at(fault, "capsule", 1, 0, "it is not whole: the checksum differs");
    }
    return MU_OK;
}

/* Drops the initial facts of a fresh mind: the snapshot has all facts. */
static void facts_drop(struct mind *m)
{
    EnvReset(m->env); /* for CLIPS's own instance */
    for (struct fact *f; (f = EnvGetNextFact(m->env, NULL));) {
        EnvRetract(m->env, f);
    }
}

static mu_result body_load(struct snapshot *c, char name[MU_NAME_MAX + 1])
{
    struct mind *m = c->mind;
    if (!snapshot_line(c, "agent") || !snapshot_word(c) ||
        !mu_text_copy(name, MU_NAME_MAX + 1, c->word) || !snapshot_end(c)) {
        return snapshot_wrong(c, "whose mind it is");
    }
    facts_drop(m);
    MU_TRY(switches_load(c));
    MU_TRY(rules_load(c));
    environment_begin(m);
    budget_start(m, BUDGET_MEMORY_SPARE);
    EnvIncrementGCLocks(m->env); /* values are read before a fact holds them */
    mu_result r = gensym_load(c);
    struct snapshot globals = *c; /* read twice: patterns use them, and they may hold facts */
    r = r == MU_OK ? snapshot_load_globals(c) : r;
    r = r == MU_OK ? snapshot_load_facts(c) : r;
    r = r == MU_OK ? snapshot_load_globals(&globals) : r;
    r = r == MU_OK ? snapshot_load_agenda(c) : r;
    r = r == MU_OK ? snapshot_load_state(c) : r;
    EnvSetCurrentModule(m->env, EnvFindDefmodule(m->env, "MAIN"));
    EnvDecrementGCLocks(m->env);
    (void)environment_end(m);
    return r;
}

mu_result snapshot_load(struct mind *m, const char *text, struct mu_fault *fault,
                        char name[MU_NAME_MAX + 1])
{
    struct snapshot c = {.mind = m, .at = text + SNAPSHOT_HEAD_MAX, .line = 2, .fault = fault};
    return body_load(&c, name);
}
