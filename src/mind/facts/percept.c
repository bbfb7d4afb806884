/* SPDX-License-Identifier: Apache-2.0 */
/* Percepts as facts, in the units of the paper: millimetres, mm/s, degrees. */
#include "mind/facts/facts.h"

#include <math.h>

static struct fact *percept_position(struct mind *m)
{
    double values[6];
    sensors_set_position(&m->inputs->percept, values);
    struct multifield *fields = CreateMultifield2(m->env, 7);
    for (size_t i = 0; i < 6; i++) {
        value_set_float(m->env, fields, i, values[i]);
    }
    fields->theFields[6].type = SYMBOL;
    fields->theFields[6].value =
        m->inputs->percept.stalled ? EnvTrueSymbol(m->env) : EnvFalseSymbol(m->env);
    return fact_assert(m, m->inputs->position, fields);
}

/* The time and some elements; NULL: there are none. */
static struct multifield *percept_fields(struct mind *m, const struct mu_channel *c,
                                         const void *element, size_t count)
{
    struct multifield *fields = CreateMultifield2(m->env, (long)(count * c->field_count) + 1);
    value_set_float(m->env, fields, 0, (double)m->inputs->percept.time_ns * 1e-9);
    sensors_set(m, c, element, count, fields, 1);
    return fields;
}

static void percept_list_assert(struct mind *m, size_t number)
{
    const struct mu_channel *c = &mu_channels[number];
    struct percept_list *list = &m->inputs->lists[number];
    size_t count;
    const char *element = mu_channel_list(c, &m->inputs->percept, &count);
    if (c->plain && count > 0) {
        list->facts[0] = fact_assert(m, list->relation, percept_fields(m, c, element, count));
    }
    for (size_t i = 0; i < count && !c->plain; i++, element += c->bytes) {
        list->facts[i] = fact_assert(m, list->relation, percept_fields(m, c, element, 1));
    }
}

void percept_show(struct mind *m)
{
    if (m->inputs->ring_unseen) {
        long long next = FactData(m->env)->NextFactIndex;
        m->inputs->ring_unseen = false;
        EnvIncrementGCLocks(m->env);
        FactData(m->env)->NextFactIndex = m->inputs->ring_number;
        m->trace_fact = TRACE_SHOWN;
        percept_list_assert(m, MU_CHANNEL_SONAR);
        m->trace_fact = TRACE_CAUSED;
        FactData(m->env)->NextFactIndex = next;
        EnvDecrementGCLocks(m->env);
    }
}

/* A fact that is left out keeps its number, so that who looks changes nothing but what he sees. */
static void percept_ring(struct mind *m)
{
    m->inputs->ring_unseen = m->inputs->percept.sonar_count > 0 &&
                             !fact_is_used(m->inputs->lists[MU_CHANNEL_SONAR].relation);
    if (m->inputs->ring_unseen) {
        m->inputs->ring_number = FactData(m->env)->NextFactIndex++;
    } else {
        percept_list_assert(m, MU_CHANNEL_SONAR);
    }
}

/* A plain list becomes a fact when its sensor is looked at in any way, a record only for those who
 * have a pattern of it. */
static void percept_lists(struct mind *m)
{
    uint32_t senses = sensors_wanted(m);
    percept_ring(m);
    for (size_t i = MU_CHANNEL_SONAR + 1; i < MU_CHANNEL_COUNT; i++) {
        const struct mu_channel *c = &mu_channels[i];
        if (c->plain ? (senses & c->senses) == c->senses
                     : fact_is_used(m->inputs->lists[i].relation)) {
            percept_list_assert(m, i);
        }
    }
}

/* What the last percept was. */
static void percept_retract_all(struct mind *m)
{
    fact_retract(m, &m->inputs->position_fact);
    for (size_t i = 0; i < MU_CHANNEL_COUNT; i++) {
        size_t count = percept_fact_count(m, i);
        for (size_t k = 0; k < count; k++) {
            fact_retract(m, &m->inputs->lists[i].facts[k]);
        }
    }
}

size_t percept_fact_count(const struct mind *m, size_t number)
{
    size_t count;
    (void)mu_channel_list(&mu_channels[number], &m->inputs->percept, &count);
    return mu_channels[number].plain ? 1 : count;
}

/* Numbers that are no numbers would only poison what rules compute: 0 stands for them. */
static void percept_make_finite(const struct mu_field *f, char *element)
{
    double real;
    float range;
    if (f->type == MU_FIELD_double) {
        memcpy(&real, element + f->at, sizeof real);
        real = isfinite(real) ? real : 0;
        memcpy(element + f->at, &real, sizeof real);
    } else if (f->type == MU_FIELD_float) {
        memcpy(&range, element + f->at, sizeof range);
        range = isfinite(range) ? range : 0;
        memcpy(element + f->at, &range, sizeof range);
    }
}

static void percept_copy_list(struct mind *m, size_t number, const struct mu_percept *from)
{
    const struct mu_channel *c = &mu_channels[number];
    char *element = m->inputs->lists[number].elements;
    size_t count;
    const void *list = mu_channel_list(c, from, &count);
    count = count < c->most ? count : c->most;
    mu_channel_set(c, &m->inputs->percept, element, count);
    if (count > 0) {
        memcpy(element, list, count * c->bytes);
    }
    for (size_t i = 0; i < count; i++, element += c->bytes) {
        for (size_t k = 0; k < c->field_count; k++) {
            percept_make_finite(&c->fields[k], element);
        }
    }
}

static void percept_copy(struct mind *m, const struct mu_percept *p)
{
    m->inputs->percept = *p;
    m->inputs->percept.robot = NULL; /* the caller's */
    for (size_t i = 0; i < MU_READING_COUNT; i++) {
        percept_make_finite(&mu_readings[i], (char *)&m->inputs->percept);
    }
    for (size_t i = 0; i < MU_CHANNEL_COUNT; i++) {
        percept_copy_list(m, i, p);
    }
    m->inputs->sensed = true;
}

void percept_take(struct mind *m, const struct mu_percept *p)
{
    m->trace_fact = TRACE_SENSED;
    percept_retract_all(m);
    percept_copy(m, p);
    m->inputs->position_fact = percept_position(m);
    percept_lists(m);
    m->trace_fact = TRACE_CAUSED;
}

void percept_lose(struct mind *m, uint64_t time_ns)
{
    const struct mu_percept nothing = {.time_ns = time_ns, .battery_share = -1};
    percept_retract_all(m);
    percept_copy(m, &nothing);
    m->inputs->sensed = m->inputs->ring_unseen = false;
}

/* (reset) takes it with the other facts. */
static void percept_reset(void *env)
{
    environment_mind(env)->inputs->ring_unseen = false;
}

void percept_install(struct mind *m)
{
#define LIST(id, senses, type, list, ...)                      \
    m->inputs->lists[MU_CHANNEL_##id] = (struct percept_list){ \
        .elements = m->inputs->elements.list, .facts = m->inputs->list_facts.list};
    MU_CHANNELS(LIST)
#undef LIST
    EnvAddResetFunction(m->env, "mu-percept", percept_reset, 100);
}
