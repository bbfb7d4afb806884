/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What a line, or a rule, says of the agent's own life: run, step, suspend, and stopping before a
 * rule.  Nothing changes here; the robot asks what was wished when the line or the step is over.
 */
#include "mind/engine/value.h"
#include "mind/functions/table.h"

#include <string.h>

static void control_wish(struct mind *m, enum mind_wish wish, uint32_t rules)
{
    m->wish = wish;
    m->wish_rules = rules;
}

/* @return the number of rules that are asked for, or 0: it was none, and that is said */
static uint32_t control_count(void *env, const char *function)
{
    long long rules;
    if (!clips_value_whole(env, function, 1, &rules)) {
        return 0;
    }
    if (rules < 1 || rules > UINT32_MAX) {
        clips_value_refuse(env, function, "a number of rules, from 1 on");
        return 0;
    }
    return (uint32_t)rules;
}

static void control_step(void *env, DATA_OBJECT *out, const char *function)
{
    struct mind *m = clips_env_mind(env);
    uint32_t rules = EnvRtnArgCount(env) > 0 ? control_count(env, function) : 1;
    clips_value_bool(env, out, rules > 0);
    if (rules > 0 && m->mode == CLIPS_MODE_LINE) {
        control_wish(m, MIND_WISH_STEP, rules);
    }
}

/* (run) on a line asks the life cycle to go on: rules fire in steps only. */
void clips_control_run(void *env, DATA_OBJECT *out)
{
    struct mind *m = clips_env_mind(env);
    if (EnvRtnArgCount(env) > 0) {
        control_step(env, out, "run");
        return;
    }
    clips_value_bool(env, out, true);
    if (m->mode == CLIPS_MODE_LINE) {
        control_wish(m, MIND_WISH_RUN, 0);
    }
}

void clips_control_step(void *env, DATA_OBJECT *out)
{
    control_step(env, out, "step");
}

void clips_control_suspend(void *env, DATA_OBJECT *out)
{
    clips_value_bool(env, out, true);
    control_wish(clips_env_mind(env), MIND_WISH_SUSPEND, 0);
}

enum mind_wish mind_wish(struct mind *m, uint32_t *rules)
{
    enum mind_wish wish = m->wish;
    *rules = m->wish_rules;
    m->wish = MIND_WISH_NOTHING;
    return wish;
}

/* --- stopping before a rule ------------------------------------------------------------------- */

/* The module whose rules fire next: the first in the focus with any, else MAIN. */
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

bool clips_control_breaks(struct mind *m)
{
    struct activation *next = control_next(m);
    return next && next->theRule->afterBreakpoint;
}

bool clips_control_stops(struct mind *m)
{
    if (!clips_control_breaks(m)) {
        return false;
    }
    const char *rule = ValueToString(control_next(m)->theRule->header.name);
    if (m->passes && strcmp(m->stands, rule) == 0) {
        m->passes = false;
        m->stands[0] = '\0';
        return false;
    }
    mu_text_copy(m->stands, sizeof m->stands, rule);
    m->passes = false;
    return true;
}

void mind_go_on(struct mind *m)
{
    m->passes = m->stands[0] != '\0';
}
