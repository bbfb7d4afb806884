/* SPDX-License-Identifier: Apache-2.0 */
/* One step's firing of rules. */
#include "core/hash.h"
#include "mind/facts/facts.h"

#include <stdio.h>
#include <string.h>

/* CLIPS calls this behind each rule: one that called (update-sensors) or (moveTo) is the last. */
static void fire_after_rule(void *env)
{
    const struct mind *m = clips_env_mind(env);
    if (m->sense_again || m->travel.kind != MIND_STAYS) {
        EnvHalt(env);
    }
}

void clips_fire_install(struct mind *m)
{
    EnvAddRunFunction(m->env, "mu-step", fire_after_rule, 0);
}

/* @return whether this complaint was shown before, be it of other numbers; remembers it */
static bool fire_was_shown(struct mind *m, const char *text)
{
    uint64_t hash = MU_HASH_EMPTY;
    for (const char *c = text; *c; c++) {
        bool number = (*c >= '0' && *c <= '9') || *c == '.' || *c == '-';
        hash = number ? hash : mu_hash_bytes(hash, c, 1);
    }
    for (size_t i = 0; i < m->shown_count; i++) {
        if (m->shown[i] == hash) {
            return true;
        }
    }
    if (m->shown_count == CLIPS_SHOWN_MAX) {
        return true;
    }
    m->shown[m->shown_count++] = hash;
    return false;
}

/* Leaves out of what was said that the actions of this very rule were halted. */
static void complaint_cut(char *said, const char *kind)
{
    static const char halt[] = "[PRCCODE4] Execution halted during the actions of def";
    char *halted = strstr(said, halt);
    while (halted && strncmp(halted + sizeof halt - 1, kind, strlen(kind)) != 0) {
        halted = strstr(halted + 1, halt);
    }
    if (halted) {
        *halted = '\0';
    }
}

/* Adds what was said, as one line. */
static void complaint_add(struct mu_text *line, const char *said)
{
    size_t start = line->len;
    for (const char *s = said; *s; s++) {
        bool blank = line->len == start || line->at[line->len - 1] == ' ';
        if (*s != '\n') {
            mu_text_add_bytes(line, s, 1);
        } else if (!blank) {
            mu_text_add(line, " ");
        }
    }
}

void clips_fire_complain(struct mind *m, const char *kind, const char *name)
{
    char bytes[CLIPS_SAID_MAX];
    struct mu_text line;
    mu_text_init(&line, bytes, sizeof bytes);
    mu_text_format(&line, "%s %s", kind, name);
    clips_place_add(m, name, &line);
    mu_text_add(&line, ": ");
    clips_text_as_written(m->said.at);
    complaint_cut(m->said.at, kind);
    size_t start = line.len;
    complaint_add(&line, m->said.at);
    if (line.len == start) {
        mu_text_format(&line, "stopped%s%s", m->stopped ? " by the guard for " : "",
                       m->stopped ? m->stopped : "");
    }
    if (!fire_was_shown(m, line.at) && m->options.ports.print) {
        m->options.ports.print(m->options.ports.self, line.at);
        m->options.ports.print(m->options.ports.self, "\n");
    }
    mu_text_clear(&m->said);
}

/* Fires rules until one errs, the step ends, or the budget is used. */
static uint32_t fire_some(struct mind *m, uint32_t budget, bool *failed)
{
    clips_env_enter(m, CLIPS_MODE_FIRE);
    m->firing = true;
    long long fired = EnvRun(m->env, budget);
    m->firing = false;
    bool halted = GetHaltExecution(m->env); /* EnvRun itself clears the other flag */
    clips_env_leave(m);
    *failed = halted;
    if (halted) {
        clips_failure_note(m);
    }
    if (m->said.len > 0 || halted) {
        clips_fire_complain(m, "rule", m->rule ? m->rule : "?");
    }
    return (uint32_t)fired;
}

static enum mind_end fire_loop(struct mind *m, uint32_t budget)
{
    while (m->act.firings < budget) {
        bool failed;
        if (clips_control_stops(m)) {
            m->act.why = m->stands;
            return MIND_BREAK;
        }
        uint32_t fired = fire_some(m, budget - m->act.firings, &failed);
        m->act.firings += fired;
        m->act.errors += failed;
        if (m->stopped) {
            m->act.why = m->stopped;
            return MIND_STOPPED;
        }
        if (m->sense_again || m->travel.kind != MIND_STAYS) {
            return MIND_SENSE_AGAIN;
        }
        bool idle = !failed && m->act.firings < budget && !clips_control_breaks(m);
        if (fired == 0 || idle) {
            return MIND_IDLE;
        }
    }
    return EnvGetNextActivation(m->env, NULL) ? MIND_BUDGET : MIND_IDLE;
}

void mind_fire(struct mind *m, struct mind_act *act)
{
    mind_fire_some(m, m->options.firings_max, act);
}

/* Nothing fires any more; the robot stands still. */
static void fire_nothing(struct mind *m, struct mind_act *act)
{
    snprintf(m->reason, sizeof m->reason, "its rules are gone: %s", m->broken);
    *act = (struct mind_act){.drives = true,
                             .errors = 1,
                             .rules = "",
                             .end = MIND_STOPPED,
                             .why = m->broken,
                             .enough = m->reason};
}

void mind_fire_some(struct mind *m, uint32_t most, struct mind_act *act)
{
    if (CLIPS_BROKEN(m)) {
        fire_nothing(m, act);
        return;
    }
    uint32_t budget = most < m->options.firings_max ? most : m->options.firings_max;
    clips_guard_start(m, 0);
    mu_text_clear(&m->fired);
    m->printed = 0;
    m->sense_again = false;
    m->rule = NULL;
    m->act.end = fire_loop(m, budget);
    m->act.rules = m->fired.at;
    clips_diary_agenda(m);
    *act = m->act;
    m->act = (struct mind_act){.drives = false};
}

void mind_percept(struct mind *m, const struct mu_percept *percept)
{
    m->step++;
    if (CLIPS_BROKEN(m)) {
        return;
    }
    clips_env_enter(m, CLIPS_MODE_QUIET);
    clips_guard_start(m, 0);
    EnvIncrementGCLocks(m->env); /* nothing built here may go before it stands in a fact */
    clips_diary_cause(m, 'S', "", "");
    percept_take(m, percept);
    clips_event_assert(m);
    clips_message_age(m);
    EnvDecrementGCLocks(m->env);
    clips_env_leave(m);
}

void mind_feel_nothing(struct mind *m, uint64_t time_ns)
{
    m->step++;
    if (CLIPS_BROKEN(m)) {
        return;
    }
    clips_env_enter(m, CLIPS_MODE_QUIET);
    clips_guard_start(m, 0);
    percept_lose(m, time_ns);
    clips_event_assert(m);
    clips_message_age(m);
    clips_env_leave(m);
}
