/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What stops rules that do not end by themselves.  Everything is counted, nothing is timed, so that
 * a run that meets a guard is still the same run when it is done again.
 */
#include "mind/clips_mind.h"

/* So many turns of loops, or pieces of memory, may pass without a look at the clock. */
enum { GUARD_WORK_UNITS = 256 * CLIPS_UNITS_A_TICK, GUARD_WORK_ALLOCATIONS = 1024 };

static void guard_work(struct mind *m)
{
    if (m->options.ports.work) {
        m->options.ports.work(m->options.ports.self);
    }
}

static void guard_stop(struct mind *m, const char *why)
{
    if (!m->stopped) {
        m->stopped = why;
    }
    SetHaltExecution(m->env, TRUE);
}

/*
 * One expression can want any amount of memory, and one fact can complete any number of matches,
 * before CLIPS comes to a tick.  There is no way back out of the middle of that but this one.
 */
void clips_guard_break(struct mind *m, const char *guard)
{
    MU_ASSERT(m->sheltered); /* else the machine has no memory, and nobody can go on without */
    clips_heap_drop(m);
    m->sheltered = false;
    m->stopped = m->broken = guard;
    m->firing = false;
    m->mode = CLIPS_MODE_QUIET;
    m->stack = NULL;
    m->meter = NULL;
    longjmp(m->shelter, 1);
}

/* The rule whose patterns are being matched; NULL: none are. */
static const char *guard_matched(void *env)
{
    const struct engineData *engine = EngineData(env);
    const struct joinNode *join = engine->JoinOperationInProgress ? engine->GlobalJoin : NULL;
    while (join && !join->ruleToActivate) {
        join = join->nextLinks ? join->nextLinks->join : NULL;
    }
    return join ? ValueToString(join->ruleToActivate->header.name) : NULL;
}

void clips_guard_say(struct mind *m)
{
    struct mu_text t;
    const struct expr *call = EvaluationData(m->env)->CurrentExpression;
    const char *matched = guard_matched(m->env);
    mu_text_init(&t, m->lost, sizeof m->lost);
    if (m->firing && m->rule) {
        mu_text_format(&t, "rule %.64s", m->rule);
    } else {
        mu_text_add(&t, m->mode == CLIPS_MODE_LINE ? "a line" : "what it was told");
    }
    mu_text_add(&t, " has not come back");
    if (matched) {
        mu_text_format(&t, " from matching the patterns of rule %.64s", matched);
    } else if (call && call->type == FCALL) {
        mu_text_format(&t, " from (%.32s)", ValueToString(ExpressionFunctionCallName(call)));
    }
}

void clips_guard_leave(struct mind *m, const char *guard)
{
    clips_guard_say(m);
    if (m->mode != CLIPS_MODE_LINE && m->options.ports.print) {
        m->options.ports.print(m->options.ports.self, m->lost);
        m->options.ports.print(m->options.ports.self, "\n");
    }
    clips_guard_break(m, guard);
}

void clips_guard_burst(struct mind *m)
{
    (void)mu_text_copy(m->lost, sizeof m->lost, "they wanted more memory than there is for them");
    clips_guard_break(m, "memory");
}

void clips_guard_allocated(struct mind *m)
{
    if (m->sheltered && ++m->allocations % GUARD_WORK_ALLOCATIONS == 0) {
        guard_work(m);
    }
}

/* @return false: there were not so many left; none of them is counted, as nothing is done for them
 */
static bool guard_count(struct mind *m, uint64_t units)
{
    if (m->units > CLIPS_UNITS_MAX || units > CLIPS_UNITS_MAX - m->units) {
        m->units = m->units > CLIPS_UNITS_MAX ? m->units : CLIPS_UNITS_MAX + 1;
        guard_stop(m, "ticks");
        return false;
    }
    m->units += units;
    if (m->units - m->worked >= GUARD_WORK_UNITS) {
        m->worked = m->units;
        guard_work(m);
    }
    return true;
}

/* CLIPS calls this at each turn of a loop, at each return of a function and after each rule. */
static void guard_tick(void *env)
{
    struct mind *m = environment_mind(env);
    if (!guard_count(m, CLIPS_UNITS_A_TICK)) {
        return;
    }
    if (EnvMemUsed(env) > m->memory_max) {
        EnvReleaseMem(env, -1);
        if (EnvMemUsed(env) > m->memory_max) {
            guard_stop(m, "memory");
        }
    }
}

bool clips_guard_charge(struct mind *m, uint64_t units)
{
    return !m->sheltered || guard_count(m, units);
}

void clips_guard_install(struct mind *m)
{
    EnvAddPeriodicFunction(m->env, "mu-guard", guard_tick, 0);
}

void clips_guard_start(struct mind *m, long memory_spare)
{
    m->units = m->worked = 0;
    m->stopped = NULL;
    m->memory_max = CLIPS_MEMORY_MAX;
    if (memory_spare > 0 && EnvMemUsed(m->env) + memory_spare > m->memory_max) {
        m->memory_max = EnvMemUsed(m->env) + memory_spare;
    }
}

/*
 * (modify) and (duplicate) give a fact back with multifields that they have not filled yet, when a
 * slot is not there; CLIPS 6.30 follows them.
 */
void __real_ReturnFact(void *env, struct fact *fact);
void __wrap_ReturnFact(void *env, struct fact *fact);

void __wrap_ReturnFact(void *env, struct fact *fact)
{
    for (long i = 0; i < fact->theProposition.multifieldLength; i++) {
        struct field *f = &fact->theProposition.theFields[i];
        if (f->type == MULTIFIELD && !f->value) {
            f->type = RVOID;
        }
    }
    __real_ReturnFact(env, fact);
}

/*
 * Every body of a rule, function, method and message-handler runs through EvaluateProcActions, and
 * its callers are in other objects of libclips.a than itself: the linker's --wrap catches them all.
 */
void __real_EvaluateProcActions(void *env, struct defmodule *module, struct expr *actions,
                                int variables, DATA_OBJECT *result, void (*end)(void *));
void __wrap_EvaluateProcActions(void *env, struct defmodule *module, struct expr *actions,
                                int variables, DATA_OBJECT *result, void (*end)(void *));

static void guard_note_rule(struct mind *m, const struct expr *actions)
{
    const struct defrule *rule = EngineData(m->env)->ExecutingRule;
    if (!m->firing || !rule || rule->actions != actions) {
        return;
    }
    m->rule = ValueToString(rule->header.name);
    if (m->fired.len > 0) {
        mu_text_add(&m->fired, " ");
    }
    mu_text_add(&m->fired, m->rule);
    clips_diary_rule(m);
}

void __wrap_EvaluateProcActions(void *env, struct defmodule *module, struct expr *actions,
                                int variables, DATA_OBJECT *result, void (*end)(void *))
{
    const char *here = __builtin_frame_address(0);
    struct mind *m = environment_mind(env);
    if (!m) { /* CLIPS makes its own first instances before the mind is tied to it */
        __real_EvaluateProcActions(env, module, actions, variables, result, end);
        return;
    }
    guard_note_rule(m, actions);
    bool deep = EvaluationData(env)->CurrentEvaluationDepth > CLIPS_DEPTH_MAX ||
                (m->stack && m->stack - here > CLIPS_STACK_MAX);
    if (!deep) {
        __real_EvaluateProcActions(env, module, actions, variables, result, end);
        return;
    }
    if (!m->stopped) {
        EnvPrintRouter(env, WERROR, "[MUSTER2] Functions call each other too deeply\n");
    }
    guard_stop(m, "depth");
    SetEvaluationError(env, TRUE);
    result->type = SYMBOL;
    result->value = EnvFalseSymbol(env);
}
