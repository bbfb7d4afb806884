/* SPDX-License-Identifier: Apache-2.0 */
/* What a person types on a console, or another agent has done by (you-do). */
#include "mind/engine/value.h"
#include "mind/facts/facts.h"

#include <string.h>

enum { LINE_FORM_MAX = 4 * CLIPS_LINE_MAX };

/* Looks at a line before any of it runs.  @return NULL, or what is wrong with the form f */
static const char *line_check(const char *line, struct clips_form *f)
{
    int number = 1;
    for (size_t forms = 0;; forms++) {
        struct clips_form before = *f;
        *f = clips_text_form(&line, &number);
        bool junk = f->kind == CLIPS_FORM_ATOM && forms > 0;
        if (f->kind == CLIPS_FORM_BAD) {
            return f->what;
        }
        if (junk || (f->kind == CLIPS_FORM_LIST && forms > 0 && before.kind == CLIPS_FORM_ATOM)) {
            return "expected nothing more, or one more form in parentheses";
        }
        if (f->kind == CLIPS_FORM_END) {
            return NULL;
        }
    }
}

/* (break RULE): in CLIPS break leaves a loop, has no arguments, and is of no use on a line.
 * @return the bytes of "(break", or 0: it is something else */
static size_t line_sets_break(struct clips_form f)
{
    const char *at = f.at + 1, *end = f.at + f.len;
    while (at < end && strchr(" \t\n", *at)) {
        at++;
    }
    bool is_break = end - at > 6 && memcmp(at, "break", 5) == 0 && strchr(" \t\n", at[5]);
    return f.kind == CLIPS_FORM_LIST && is_break ? (size_t)(at + 5 - f.at) : 0;
}

/* @return whether CLIPS did it */
static bool line_run(struct mind *m, struct clips_form f)
{
    static char bytes[LINE_FORM_MAX]; /* RouteCommand reads it before it evaluates */
    struct mu_text form;
    mu_text_init(&form, bytes, sizeof bytes);
    size_t begun = line_sets_break(f);
    mu_text_add(&form, begun ? "(set-break" : "");
    clips_text_rewrite(&form, f.at + begun, f.len - begun);
    bool done = RouteCommand(m->env, form.at, TRUE);
    clips_place_note(m, form.at, NULL, 0);
    bool failed = GetEvaluationError(m->env) || GetHaltExecution(m->env);
    FlushPPBuffer(m->env);
    SetPPBufferStatus(m->env, OFF);
    CleanCurrentGarbageFrame(m->env, NULL);
    CallPeriodicTasks(m->env);
    return done && !failed && !GetHaltExecution(m->env);
}

mu_result mind_line(struct mind *m, const char *line, struct mu_text *out)
{
    struct clips_form f = {.kind = CLIPS_FORM_END};
    size_t start = out->len;
    int number = 1;
    if (strlen(line) > CLIPS_LINE_MAX) {
        mu_text_add(out, "a line has at most 16384 bytes\n");
        return MU_MALFORMED;
    }
    const char *wrong = line_check(line, &f);
    if (wrong) {
        mu_text_format(out, "%s: %.*s\n", wrong, (int)(f.len < 40 ? f.len : 40), f.at);
        return MU_MALFORMED;
    }
    if (CLIPS_BROKEN(m)) {
        m->out = NULL;
        mu_text_format(out, CLIPS_BROKEN_TEXT "\n", m->lost);
        return MU_MALFORMED;
    }
    m->out = out;
    m->shown_count = 0;
    clips_guard_start(m, CLIPS_MEMORY_SPARE);
    bool done = true;
    while (done && (f = clips_text_form(&line, &number)).kind != CLIPS_FORM_END) {
        clips_env_enter(m, CLIPS_MODE_LINE);
        percept_show(m);
        clips_diary_line(m, f);
        done = line_run(m, f);
        clips_env_leave(m);
    }
    if (m->stopped) {
        mu_text_format(out, "stopped: the guard for %s\n", m->stopped);
    }
    m->out = NULL;
    clips_text_as_written(out->at + start);
    out->len = start + strlen(out->at + start);
    return done ? MU_OK : MU_MALFORMED;
}

/* The field as text that reads back; false: it is not exactly one field. */
static bool line_field(const char *field, struct mu_text *out)
{
    const char *rest = field;
    struct clips_field f = clips_text_field(&rest);
    struct clips_field more = clips_text_field(&rest);
    if (f.kind == CLIPS_FIELD_END || f.kind == CLIPS_FIELD_BAD || more.kind != CLIPS_FIELD_END) {
        return false;
    }
    if (f.kind == CLIPS_FIELD_SYMBOL) {
        char word[256];
        if (f.len >= sizeof word) {
            return false;
        }
        memcpy(word, f.at, f.len);
        word[f.len] = '\0';
        clips_text_add_symbol(out, word);
    } else {
        mu_text_add(out, field);
    }
    return !out->cut;
}

/* Redefines the global, so that the value is also what (reset) gives it. */
mu_result mind_set_global(struct mind *m, const char *name, const char *field)
{
    char bytes[512];
    struct mu_text build;
    DATA_OBJECT value;
    mu_text_init(&build, bytes, sizeof bytes);
    if (CLIPS_BROKEN(m)) {
        return MU_MALFORMED;
    }
    if (!EnvGetDefglobalValue(m->env, name, &value)) {
        return MU_ABSENT;
    }
    mu_text_format(&build, "(defglobal ?*%s* = ", name);
    if (!line_field(field, &build)) {
        return MU_MALFORMED;
    }
    mu_text_add(&build, ")");
    clips_env_enter(m, CLIPS_MODE_QUIET);
    clips_guard_start(m, 0);
    bool built = EnvBuild(m->env, build.at);
    return clips_env_leave(m) || !built || build.cut ? MU_MALFORMED : MU_OK;
}
