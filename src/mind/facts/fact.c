/* SPDX-License-Identifier: Apache-2.0 */
/* Facts that C code asserts and holds until it retracts them. */
#include "mind/facts/facts.h"

void fact_retract(struct mind *m, struct fact **fact)
{
    if (!*fact) {
        return;
    }
    if (EnvFactExistp(m->env, *fact)) {
        EnvRetract(m->env, *fact);
    }
    EnvDecrementFactCount(m->env, *fact);
    *fact = NULL;
}

struct fact *fact_assert(struct mind *m, struct deftemplate *template, struct multifield *fields)
{
    struct fact *f = EnvCreateFact(m->env, template);
    ReturnMultifield(m->env, f->theProposition.theFields[0].value);
    f->theProposition.theFields[0].value = fields;
    f = EnvAssert(m->env, f);
    if (f) {
        EnvIncrementFactCount(m->env, f);
    }
    return f;
}

/* busyCount is the uses in constructs, plus the facts, plus one use that C code holds. */
bool fact_is_used(const struct deftemplate *template)
{
    long facts = 0;
    for (const struct fact *f = template->factList; f; f = f->nextTemplateFact) {
        facts++;
    }
    return template->patternNetwork || template->watch || template->busyCount - 1 > facts;
}
