/* SPDX-License-Identifier: Apache-2.0 */
/* What a mind wants just now, in words: its youngest fact (goal ...). */
#include "mind/clips_mind.h"
#include "mind/engine/syntax.h"

static void field_add(struct mu_text *out, const struct field *f)
{
    switch (f->type) {
    case FLOAT: clips_text_add_float(out, ValueToDouble(f->value)); break;
    case INTEGER: mu_text_format(out, "%lld", ValueToLong(f->value)); break;
    case STRING:
    case SYMBOL:
    case INSTANCE_NAME: mu_text_add(out, ValueToString(f->value)); break;
    default: mu_text_add(out, "?"); break;
    }
}

void mind_goal(struct mind *m, char goal[MU_FIELD_MAX + 1])
{
    struct mu_text out;
    mu_text_init(&out, goal, MU_FIELD_MAX + 1);
    const struct deftemplate *t = m->env ? EnvFindDeftemplate(m->env, "goal") : NULL;
    if (!t || !t->implied || !t->lastFact) {
        return;
    }
    const struct multifield *words = t->lastFact->theProposition.theFields[0].value;
    for (long i = 0; i < words->multifieldLength; i++) {
        mu_text_add(&out, i > 0 ? " " : "");
        field_add(&out, &words->theFields[i]);
    }
}
