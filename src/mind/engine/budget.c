/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The budget of rules: ticks, depth and memory.  It counts work and never reads a clock, so that a
 * run that exceeds its budget does so again at the same place.
 */
#include "mind/engine/engine.h"

#include <prccode.h>

/* The port hears of work at least this often. */
enum { BUDGET_WORK_UNITS = 256 * BUDGET_UNITS_A_TICK };

enum { BUDGET_NEAR = 8 }; /* arguments that cost nothing to find */

static void budget_stop(struct mind *m, const char *why)
{
    if (!m->stopped) {
        m->stopped = why;
    }
    SetHaltExecution(m->env, TRUE);
}

/*
 * One expression can ask for any amount of memory, and one fact can complete any number of matches,
 * before CLIPS calls a tick.  Only a jump leads out of the middle of that.
 */
static _Noreturn void budget_break(struct mind *m, const char *why)
{
    (void)state_on(m, STATE_FAIL); /* outside of a limited state the machine itself has no memory */
    heap_drop(m);
    m->stopped = m->failed_by = why;
    m->stack = NULL;
    m->cost.meter = NULL;
    longjmp(m->shelter, 1);
}

/* The rule whose patterns CLIPS is matching, or NULL. */
static const char *budget_matched(void *env)
{
    const struct engineData *engine = EngineData(env);
    const struct joinNode *join = engine->JoinOperationInProgress ? engine->GlobalJoin : NULL;
    while (join && !join->ruleToActivate) {
        join = join->nextLinks ? join->nextLinks->join : NULL;
    }
    return join ? ValueToString(join->ruleToActivate->header.name) : NULL;
}

void budget_say(struct mind *m)
{
    const struct expr *call = EvaluationData(m->env)->CurrentExpression;
    const char *matched = budget_matched(m->env);
    struct mu_text t = mu_text_in(m->lost, sizeof m->lost);
    if (m->state == MIND_FIRING && m->rule) {
        mu_text_format(&t, "rule %.64s", m->rule);
    } else {
        mu_text_add(&t, state_mode(m) == STATE_MODE_LINE ? "a line" : "what it was told");
    }
    mu_text_add(&t, " has not come back");
    if (matched) {
        mu_text_format(&t, " from matching the patterns of rule %.64s", matched);
    } else if (call && call->type == FCALL) {
        mu_text_format(&t, " from (%.32s)", ValueToString(ExpressionFunctionCallName(call)));
    }
}

void budget_leave(struct mind *m, const char *why)
{
    budget_say(m);
    if (state_mode(m) != STATE_MODE_LINE && m->options.ports.print) {
        m->options.ports.print(m->options.ports.self, m->lost);
        m->options.ports.print(m->options.ports.self, "\n");
    }
    budget_break(m, why);
}

/* CLIPS calls this when heap_take has no memory for it. */
static int budget_burst(void *env, size_t bytes)
{
    struct mind *m = environment_mind(env);
    (void)bytes;
    (void)mu_text_copy(m->lost, sizeof m->lost, "they wanted more memory than there is for them");
    budget_break(m, "memory");
}

/* @return false: fewer were left; nothing is done for them, so none is counted */
static bool budget_count(struct mind *m, uint64_t units)
{
    if (m->cost.units > BUDGET_UNITS_MAX || units > BUDGET_UNITS_MAX - m->cost.units) {
        m->cost.units = m->cost.units > BUDGET_UNITS_MAX ? m->cost.units : BUDGET_UNITS_MAX + 1;
        budget_stop(m, "ticks");
        return false;
    }
    m->cost.units += units;
    if (m->cost.units - m->worked >= BUDGET_WORK_UNITS) {
        m->worked = m->cost.units;
        engine_work(m);
    }
    return true;
}

/* CLIPS calls this at each turn of a loop, at each return of a function and after each rule. */
static void budget_tick(void *env)
{
    struct mind *m = environment_mind(env);
    if (!budget_count(m, BUDGET_UNITS_A_TICK)) {
        return;
    }
    if (EnvMemUsed(env) > m->memory_max) {
        EnvReleaseMem(env, -1);
        if (EnvMemUsed(env) > m->memory_max) {
            budget_stop(m, "memory");
        }
    }
}

bool budget_charge(struct mind *m, uint64_t units)
{
    return !state_is_limited(m) || budget_count(m, units);
}

/* CLIPS walks the list of arguments to each of them: that costs something from the ninth on. */
int budget_argument(void *env, int position)
{
    struct mind *m = environment_mind(env);
    return position <= BUDGET_NEAR || !m || budget_charge(m, (uint64_t)position);
}

void budget_install(struct mind *m)
{
    EnvAddPeriodicFunction(m->env, "mu-budget", budget_tick, 0);
    EnvSetOutOfMemoryFunction(m->env, budget_burst);
}

void budget_start(struct mind *m, long memory_spare)
{
    m->cost.units = m->worked = 0;
    m->stopped = NULL;
    m->memory_max = BUDGET_MEMORY_MAX;
    if (memory_spare > 0 && EnvMemUsed(m->env) + memory_spare > m->memory_max) {
        m->memory_max = EnvMemUsed(m->env) + memory_spare;
    }
}

static void budget_note_rule(struct mind *m, const struct expr *actions)
{
    const struct defrule *rule = EngineData(m->env)->ExecutingRule;
    if (m->state != MIND_FIRING || !rule || rule->actions != actions) {
        return;
    }
    m->rule = ValueToString(rule->header.name);
    if (m->fired.len > 0) {
        mu_text_add(&m->fired, " ");
    }
    mu_text_add(&m->fired, m->rule);
    trace_rule(m);
}

/* Stands before EvaluateProcActions, through which every body of a rule, function, method and
 * message-handler runs: port.h renames it for its callers. */
__typeof__(EvaluateProcActions) budget_evaluate_actions;

void budget_evaluate_actions(void *env, struct defmodule *module, struct expr *actions,
                             int variables, DATA_OBJECT *result, void (*end)(void *))
{
    const char *here = __builtin_frame_address(0);
    struct mind *m = environment_mind(env);
    if (!m) { /* CLIPS makes its first instances before the environment has a context */
        EvaluateProcActions(env, module, actions, variables, result, end);
        return;
    }
    budget_note_rule(m, actions);
    bool deep = EvaluationData(env)->CurrentEvaluationDepth > BUDGET_DEPTH_MAX ||
                (m->stack && m->stack - here > BUDGET_STACK_MAX);
    if (!deep) {
        EvaluateProcActions(env, module, actions, variables, result, end);
        return;
    }
    if (!m->stopped) {
        EnvPrintRouter(env, WERROR, "[MUSTER2] Functions call each other too deeply\n");
    }
    budget_stop(m, "depth");
    SetEvaluationError(env, TRUE);
    result->type = SYMBOL;
    result->value = EnvFalseSymbol(env);
}
