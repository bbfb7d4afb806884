/* SPDX-License-Identifier: Apache-2.0 */
/* Percepts as facts, in the units of the paper: millimetres, mm/s, degrees. */
#include "mind/facts/facts.h"

#include <math.h>

/* No run's time comes so far, about 31 years, and the wall's has. */
static const uint64_t PERCEPT_WALL_NS = 1000000000u * UINT64_C(1000000000);

/* The time of the step as a fact, if rules look at such ones. */
static struct fact *percept_time(struct mind *m, struct deftemplate *relation)
{
    if (!fact_is_used(relation)) {
        return NULL;
    }
    struct multifield *fields = CreateMultifield2(m->env, 1);
    value_set_float(m->env, fields, 0, (double)inputs_of(m)->percept.time_ns * 1e-9);
    return fact_assert(m, relation, fields);
}

static struct fact *percept_position(struct mind *m)
{
    double values[6];
    sensors_set_position(&inputs_of(m)->percept, values);
    struct multifield *fields = CreateMultifield2(m->env, 7);
    for (size_t i = 0; i < 6; i++) {
        value_set_float(m->env, fields, i, values[i]);
    }
    fields->theFields[6].type = SYMBOL;
    fields->theFields[6].value =
        inputs_of(m)->percept.stalled ? EnvTrueSymbol(m->env) : EnvFalseSymbol(m->env);
    return fact_assert(m, inputs_of(m)->position, fields);
}

/* The time and some elements; NULL: there are none. */
static struct multifield *percept_fields(struct mind *m, const struct mu_channel *c,
                                         const void *element, size_t count)
{
    struct multifield *fields = CreateMultifield2(m->env, (long)(count * c->field_count) + 1);
    value_set_float(m->env, fields, 0, (double)inputs_of(m)->percept.time_ns * 1e-9);
    sensors_set(m, c, element, count, fields, 1);
    return fields;
}

static void percept_list_assert(struct mind *m, size_t number)
{
    const struct mu_channel *c = &mu_channels[number];
    struct percept_list *list = &inputs_of(m)->lists[number];
    size_t count;
    const char *element = mu_channel_list(c, &inputs_of(m)->percept, &count);
    if (c->plain && count > 0) {
        list->facts[0] = fact_assert(m, list->relation, percept_fields(m, c, element, count));
    }
    for (size_t i = 0; i < count && !c->plain; i++, element += c->bytes) {
        list->facts[i] = fact_assert(m, list->relation, percept_fields(m, c, element, 1));
    }
}

void percept_show(struct mind *m)
{
    if (inputs_of(m)->ring_unseen) {
        long long next = FactData(m->env)->NextFactIndex;
        inputs_of(m)->ring_unseen = false;
        EnvIncrementGCLocks(m->env);
        FactData(m->env)->NextFactIndex = inputs_of(m)->ring_number;
        m->trace_fact = TRACE_SHOWN;
        percept_list_assert(m, MU_CHANNEL_SONAR);
        m->trace_fact = TRACE_CAUSED;
        FactData(m->env)->NextFactIndex = next;
        EnvDecrementGCLocks(m->env);
    }
}

/* A fact that is left out keeps its number, so that a look at the facts changes no other number. */
static void percept_ring(struct mind *m)
{
    inputs_of(m)->ring_unseen = inputs_of(m)->percept.sonar_count > 0 &&
                                !fact_is_used(inputs_of(m)->lists[MU_CHANNEL_SONAR].relation);
    if (inputs_of(m)->ring_unseen) {
        inputs_of(m)->ring_number = FactData(m->env)->NextFactIndex++;
    } else {
        percept_list_assert(m, MU_CHANNEL_SONAR);
    }
}

/*
 * A plain list becomes a fact when rules use its sensor in any way, a record only when a pattern or
 * query uses its facts.
 */
static void percept_lists(struct mind *m)
{
    uint32_t senses = sensors_wanted(m);
    percept_ring(m);
    for (size_t i = MU_CHANNEL_SONAR + 1; i < MU_CHANNEL_COUNT; i++) {
        const struct mu_channel *c = &mu_channels[i];
        if (c->plain ? (senses & c->senses) == c->senses
                     : fact_is_used(inputs_of(m)->lists[i].relation)) {
            percept_list_assert(m, i);
        }
    }
}

/* Retracts the facts of the last percept. */
static void percept_retract_all(struct mind *m)
{
    fact_retract(m, &inputs_of(m)->time_fact);
    fact_retract(m, &inputs_of(m)->position_fact);
    for (size_t i = 0; i < MU_CHANNEL_COUNT; i++) {
        size_t count = percept_fact_count(m, i);
        for (size_t k = 0; k < count; k++) {
            fact_retract(m, &inputs_of(m)->lists[i].facts[k]);
        }
    }
}

size_t percept_fact_count(const struct mind *m, size_t number)
{
    size_t count;
    (void)mu_channel_list(&mu_channels[number], &inputs_of(m)->percept, &count);
    return mu_channels[number].plain ? 1 : count;
}

/* NaN and infinity become 0: they would spoil all that rules compute of them. */
static void finite_double(double *x)
{
    *x = isfinite(*x) ? *x : 0;
}

static void finite_float(float *x)
{
    *x = isfinite(*x) ? *x : 0;
}

static void finite_other(const void *x)
{
    (void)x; /* a whole number or a truth value */
}

/* clang-format off */
#define FINITE(type, member, ...) \
    _Generic(&to->member, double *: finite_double, float *: finite_float, \
             default: finite_other)(&to->member);
/* clang-format on */

static void percept_finite_blob(struct mu_blob *to)
{
    MU_BLOB(FINITE)
}

static void percept_finite_fiducial(struct mu_fiducial *to)
{
    MU_FIDUCIAL(FINITE)
}

/* Timers count what is left to them when the clock is another one: a run ends, and the wall's time
 * is behind it; or another run begins. */
static void percept_change_clock(struct mind *m, uint64_t time_ns)
{
    uint64_t before_ns = inputs_of(m)->percept.time_ns;
    bool of_wall = time_ns >= PERCEPT_WALL_NS;
    if (time_ns < before_ns || of_wall != (before_ns >= PERCEPT_WALL_NS)) {
        timers_move(m, ((double)time_ns - (double)before_ns) * 1e-9);
    }
}

static void percept_copy(struct mind *m, const struct mu_percept *from)
{
    percept_change_clock(m, from->time_ns);
    struct mu_percept *to = &inputs_of(m)->percept;
    struct percept_elements *own = &inputs_of(m)->elements;
    *to = *from;
    to->robot = NULL; /* the caller's */
    MU_READINGS(FINITE)
#define COPY(id, senses, type, list, counted, most, ...)           \
    to->counted = from->counted < (most) ? from->counted : (most); \
    to->list = own->list;                                          \
    for (size_t i = 0; i < to->counted; i++) {                     \
        own->list[i] = from->list[i];                              \
        _Generic(own->list, float *                              \
                 : finite_float, struct mu_blob *                \
                 : percept_finite_blob, struct mu_fiducial *     \
                 : percept_finite_fiducial)(&own->list[i]); \
    }
    MU_CHANNELS(COPY)
#undef COPY
    inputs_of(m)->body = PERCEPT_BODY;
}

void percept_take(struct mind *m, const struct mu_percept *p)
{
    m->trace_fact = TRACE_SENSED;
    percept_retract_all(m);
    percept_copy(m, p);
    inputs_of(m)->time_fact = percept_time(m, inputs_of(m)->time);
    inputs_of(m)->position_fact = percept_position(m);
    percept_lists(m);
    m->trace_fact = TRACE_CAUSED;
}

void percept_lose(struct mind *m, uint64_t time_ns)
{
    const struct mu_percept nothing = {.time_ns = time_ns, .battery_share = -1};
    m->trace_fact = TRACE_SENSED;
    percept_retract_all(m);
    percept_copy(m, &nothing);
    inputs_of(m)->body = PERCEPT_NO_BODY;
    inputs_of(m)->ring_unseen = false;
    inputs_of(m)->time_fact = percept_time(m, inputs_of(m)->time);
    inputs_of(m)->position_fact = percept_time(m, inputs_of(m)->tick);
    m->trace_fact = TRACE_CAUSED;
}

/* (reset) drops the ring's fact with all others. */
static void percept_reset(void *env)
{
    inputs_of(environment_mind(env))->ring_unseen = false;
}

void percept_install(struct mind *m)
{
#define LIST(id, senses, type, list, ...)                         \
    inputs_of(m)->lists[MU_CHANNEL_##id] = (struct percept_list){ \
        .elements = inputs_of(m)->elements.list, .facts = inputs_of(m)->list_facts.list};
    MU_CHANNELS(LIST)
#undef LIST
    EnvAddResetFunction(m->env, "mu-percept", percept_reset, 100);
}
