/* SPDX-License-Identifier: Apache-2.0 */
/* Questions of one word that deffunctions answer: (ask-one red status) calls (answer-status). */
#include "mind/engine/value.h"
#include "mind/functions/send.h"

#include <string.h>

/* @return the function that answers a word without an argument, or NULL */
static struct deffunctionStruct *answer_function(const struct mind *m, const char *word)
{
    char name[MU_FIELD_MAX + 8];
    if (word[0] == '\0' || strlen(word) > MU_FIELD_MAX || strpbrk(word, " \t\n()\"")) {
        return NULL;
    }
    snprintf(name, sizeof name, "answer-%s", word);
    struct deffunctionStruct *f = EnvFindDeffunction(m->env, name);
    return f && f->minNumberOfParameters <= 0 ? f : NULL;
}

/* FALSE is no answer. */
static bool answer_write(struct mind *m, DATA_OBJECT *value, struct mu_text *out)
{
    if (value->type == MULTIFIELD) {
        return clips_post_content(m->env, "answer", value, out);
    }
    bool passes = value->type == SYMBOL && value->value == EnvFalseSymbol(m->env);
    return !passes && clips_post_field(out, value->type, value->value);
}

bool mind_answer(struct mind *m, const struct mind_mail *mail, struct mu_text *out)
{
    if (CLIPS_BROKEN(m)) {
        return false;
    }
    struct deffunctionStruct *f = answer_function(m, mail->content);
    if (!f) {
        return false;
    }
    struct expr call = {.type = PCALL, .value = f};
    DATA_OBJECT result;
    clips_env_enter(m, CLIPS_MODE_FIRE);
    clips_guard_start(m, 0);
    clips_diary_mail(m, mail);
    bool good = !EvaluateExpression(m->env, &call, &result) && answer_write(m, &result, out);
    bool failed = clips_env_leave(m);
    if (failed || m->said.len > 0) {
        clips_fire_complain(m, "function", EnvGetDeffunctionName(m->env, f));
    }
    return good && !failed;
}
