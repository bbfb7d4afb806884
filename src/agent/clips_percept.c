/* SPDX-License-Identifier: Apache-2.0 */
/* Percepts as facts, in the units of the paper: millimetres, mm/s, degrees. */
#include "agent/clips_physical.h"
#include "agent/clips_value.h"

#include <math.h>

void clips_percept_retract(struct mind *m, struct fact **fact)
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

struct fact *clips_percept_assert(struct mind *m, struct deftemplate *template,
                                  struct multifield *fields)
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

static struct fact *percept_position(struct mind *m)
{
    double values[6];
    clips_physical_position(&m->percept, values);
    struct multifield *fields = CreateMultifield2(m->env, 7);
    for (size_t i = 0; i < 6; i++) {
        clips_value_set_float(m->env, fields, i, values[i]);
    }
    fields->theFields[6].type = SYMBOL;
    fields->theFields[6].value =
        m->percept.stalled ? EnvTrueSymbol(m->env) : EnvFalseSymbol(m->env);
    return clips_percept_assert(m, m->position, fields);
}

static struct fact *percept_sonar(struct mind *m)
{
    size_t count = m->percept.sonar_count;
    if (count == 0) {
        return NULL;
    }
    struct multifield *fields = CreateMultifield2(m->env, (long)count + 1);
    clips_value_set_float(m->env, fields, 0, (double)m->percept.time_ns * 1e-9);
    for (size_t i = 0; i < count; i++) {
        clips_value_set_float(m->env, fields, i + 1, (double)m->sonar[i] * 1000);
    }
    return clips_percept_assert(m, m->ring, fields);
}

/*
 * Whether rules could miss the fact of the ring: one has a pattern of it, or a query over facts, or
 * it is watched.  CLIPS counts such uses together with the facts that there are, and C holds one.
 */
static bool percept_ring_is_used(const struct mind *m)
{
    long facts = 0;
    for (const struct fact *f = m->ring->factList; f; f = f->nextTemplateFact) {
        facts++;
    }
    return m->ring->patternNetwork || m->ring->watch || m->ring->busyCount - 1 > facts;
}

void clips_percept_show(struct mind *m)
{
    if (m->ring_unseen) {
        long long next = FactData(m->env)->NextFactIndex;
        m->ring_unseen = false;
        EnvIncrementGCLocks(m->env);
        FactData(m->env)->NextFactIndex = m->ring_number;
        m->ring_fact = percept_sonar(m);
        FactData(m->env)->NextFactIndex = next;
        EnvDecrementGCLocks(m->env);
    }
}

/* A fact that is left out keeps its number, so that who looks changes nothing but what he sees. */
static void percept_ring(struct mind *m)
{
    m->ring_unseen = m->percept.sonar_count > 0 && !percept_ring_is_used(m);
    if (m->ring_unseen) {
        m->ring_number = FactData(m->env)->NextFactIndex++;
    } else {
        m->ring_fact = percept_sonar(m);
    }
}

/* Numbers that are no numbers would only poison what rules compute: 0 stands for them. */
static double percept_finite(double x)
{
    return isfinite(x) ? x : 0;
}

static void percept_copy(struct mind *m, const struct mind_percept *p)
{
    m->percept = *p;
    m->percept.x_m = percept_finite(p->x_m);
    m->percept.y_m = percept_finite(p->y_m);
    m->percept.heading_rad = percept_finite(p->heading_rad);
    m->percept.forward_m_s = percept_finite(p->forward_m_s);
    m->percept.turn_rad_s = percept_finite(p->turn_rad_s);
    if (m->percept.sonar_count > MU_SONARS_MAX) {
        m->percept.sonar_count = MU_SONARS_MAX;
    }
    for (size_t i = 0; i < m->percept.sonar_count; i++) {
        m->sonar[i] = isfinite(p->sonar_m[i]) ? p->sonar_m[i] : 0;
    }
    m->percept.sonar_m = m->sonar;
    m->sensed = true;
}

void mind_percept(struct mind *m, const struct mind_percept *percept)
{
    m->step++;
    percept_copy(m, percept);
    clips_env_enter(m, CLIPS_MODE_QUIET);
    clips_guard_start(m, 0);
    EnvIncrementGCLocks(m->env); /* nothing built here may go before it stands in a fact */
    clips_percept_retract(m, &m->position_fact);
    clips_percept_retract(m, &m->ring_fact);
    m->position_fact = percept_position(m);
    percept_ring(m);
    clips_event_assert(m);
    clips_message_age(m);
    EnvDecrementGCLocks(m->env);
    clips_env_leave(m);
}
