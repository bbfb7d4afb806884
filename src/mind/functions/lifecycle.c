/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Wishes of a line or a rule about the agent's own life: run, step, suspend, move; and breakpoints.
 * The functions only note a wish; the robot asks for it after the line or the step.
 */
#include "core/name.h"
#include "mind/functions/table.h"

#include <string.h>

static void control_wish(struct mind *m, enum mind_wish wish, uint32_t rules)
{
    output_of(m)->wish = wish;
    output_of(m)->wish_rules = rules;
}

/* @return the number of rules that is asked for; 0, after a CLIPS error: the argument is none */
static uint32_t control_count(void *env, const char *function)
{
    long long rules;
    if (!value_whole(env, function, 1, &rules)) {
        return 0;
    }
    if (rules < 1 || rules > UINT32_MAX) {
        value_refuse(env, function, "a number of rules, from 1 on");
        return 0;
    }
    return (uint32_t)rules;
}

static void control_step(void *env, DATA_OBJECT *out, const char *function)
{
    struct mind *m = environment_mind(env);
    uint32_t rules = EnvRtnArgCount(env) > 0 ? control_count(env, function) : 1;
    value_bool(env, out, rules > 0);
    if (rules > 0 && state_mode(m) == STATE_MODE_LINE) {
        control_wish(m, MIND_WISH_STEP, rules);
    }
}

/* (run) on a line asks the life cycle to go on: rules fire in steps only. */
void lifecycle_run(void *env, DATA_OBJECT *out)
{
    struct mind *m = environment_mind(env);
    if (EnvRtnArgCount(env) > 0) {
        control_step(env, out, "run");
        return;
    }
    value_bool(env, out, true);
    if (state_mode(m) == STATE_MODE_LINE) {
        control_wish(m, MIND_WISH_RUN, 0);
    }
}

void lifecycle_step(void *env, DATA_OBJECT *out)
{
    control_step(env, out, "step");
}

void lifecycle_suspend(void *env, DATA_OBJECT *out)
{
    value_bool(env, out, true);
    control_wish(environment_mind(env), MIND_WISH_SUSPEND, 0);
}

/* --- stopping before a rule ------------------------------------------------------------------- */

/* @return the next activation: of the first module in the focus that has any, else of MAIN */
static struct activation *control_next(struct mind *m)
{
    const struct focus *f = EngineData(m->env)->CurrentFocus;
    for (; f; f = f->next) {
        if (f->theDefruleModule->agenda) {
            return f->theDefruleModule->agenda;
        }
    }
    if (EngineData(m->env)->CurrentFocus) {
        return NULL;
    }
    SaveCurrentModule(m->env);
    EnvSetCurrentModule(m->env, EnvFindDefmodule(m->env, "MAIN"));
    struct activation *next = EnvGetNextActivation(m->env, NULL);
    RestoreCurrentModule(m->env);
    return next;
}

bool lifecycle_breaks(struct mind *m)
{
    struct activation *next = control_next(m);
    return next && next->theRule->afterBreakpoint;
}

bool lifecycle_stops(struct mind *m)
{
    if (!lifecycle_breaks(m)) {
        return false;
    }
    const char *rule = ValueToString(control_next(m)->theRule->header.name);
    if (output_of(m)->passes && strcmp(output_of(m)->stands, rule) == 0) {
        output_of(m)->passes = false;
        output_of(m)->stands[0] = '\0';
        return false;
    }
    mu_text_copy(output_of(m)->stands, sizeof output_of(m)->stands, rule);
    output_of(m)->passes = false;
    return true;
}

/* --- (moveTo), (clone), (dispose): where a mind is to go when its step is over ------------------
 */

/* Reads an argument that is a name.  @return false, after a CLIPS error */
static bool name_take(void *env, const char *function, int index, char name[MU_NAME_MAX + 1])
{
    const char *word;
    if (!value_word(env, function, index, &word)) {
        return false;
    }
    if (!mu_name_valid(word) || mu_name_reserved(word)) {
        value_refuse(env, function, "a name");
        return false;
    }
    return mu_text_copy(name, MU_NAME_MAX + 1, word);
}

static void travel_set(void *env, struct mind_travel w, DATA_OBJECT *out)
{
    struct mind *m = environment_mind(env);
    bool first = output_of(m)->travel.kind == MIND_STAYS;
    if (first) {
        output_of(m)->travel = w;
    }
    value_bool(env, out, first);
}

void lifecycle_move(void *env, DATA_OBJECT *out)
{
    struct mind_travel w = {.kind = MIND_MOVES};
    value_bool(env, out, false);
    if (name_take(env, "moveTo", 1, w.host)) {
        travel_set(env, w, out);
    }
}

void lifecycle_clone(void *env, DATA_OBJECT *out)
{
    struct mind_travel w = {.kind = MIND_CLONES};
    value_bool(env, out, false);
    if (!name_take(env, "clone", 1, w.name)) {
        return;
    }
    if (EnvRtnArgCount(env) < 2 || name_take(env, "clone", 2, w.host)) {
        travel_set(env, w, out);
    }
}

void lifecycle_dispose(void *env, DATA_OBJECT *out)
{
    travel_set(env, (struct mind_travel){.kind = MIND_DISPOSES}, out);
}

void lifecycle_failures(void *env, DATA_OBJECT *out)
{
    const struct mind *m = environment_mind(env);
    struct multifield *fields = EnvCreateMultifield(env, (long)(2 * m->failing_count));
    for (size_t i = 0; i < m->failing_count; i++) {
        value_set_symbol(env, fields, 2 * i, m->failing[i].rule);
        fields->theFields[2 * i + 1].type = INTEGER;
        fields->theFields[2 * i + 1].value = EnvAddLong(env, m->failing[i].count);
    }
    value_multifield(out, fields);
}
