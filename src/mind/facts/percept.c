/* SPDX-License-Identifier: Apache-2.0 */
/* Percepts as facts, in the units of the paper: millimetres, mm/s, degrees. */
#include "mind/engine/value.h"
#include "mind/facts/facts.h"

#include <math.h>

static struct fact *percept_position(struct mind *m)
{
    double values[6];
    sensors_set_position(&m->percept, values);
    struct multifield *fields = CreateMultifield2(m->env, 7);
    for (size_t i = 0; i < 6; i++) {
        clips_value_set_float(m->env, fields, i, values[i]);
    }
    fields->theFields[6].type = SYMBOL;
    fields->theFields[6].value =
        m->percept.stalled ? EnvTrueSymbol(m->env) : EnvFalseSymbol(m->env);
    return fact_assert(m, m->position, fields);
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
    return fact_assert(m, m->ring, fields);
}

static struct fact *percept_laser(struct mind *m)
{
    size_t count = m->percept.laser_count;
    if (count == 0 || !(fact_is_used(m->laser) || m->senses_named & MU_SENSE_LASER)) {
        return NULL;
    }
    struct multifield *fields = CreateMultifield2(m->env, (long)count + 1);
    clips_value_set_float(m->env, fields, 0, (double)m->percept.time_ns * 1e-9);
    for (size_t i = 0; i < count; i++) {
        clips_value_set_float(m->env, fields, i + 1, (double)m->laser_m[i] * 1000);
    }
    return fact_assert(m, m->laser, fields);
}

/* What is seen becomes facts for those who have a pattern of them. */
static void percept_sights(struct mind *m)
{
    double time_s = (double)m->percept.time_ns * 1e-9;
    bool blobs = fact_is_used(m->blob);
    bool fiducials = fact_is_used(m->fiducial);
    for (size_t i = 0; blobs && i < m->percept.blob_count; i++) {
        struct multifield *fields = CreateMultifield2(m->env, 5);
        clips_value_set_float(m->env, fields, 0, time_s);
        sensors_set_blob(m, &m->blobs[i], fields, 1);
        m->blob_facts[i] = fact_assert(m, m->blob, fields);
    }
    for (size_t i = 0; fiducials && i < m->percept.fiducial_count; i++) {
        struct multifield *fields = CreateMultifield2(m->env, 5);
        clips_value_set_float(m->env, fields, 0, time_s);
        sensors_set_fiducial(m, &m->fiducials[i], fields, 1);
        m->fiducial_facts[i] = fact_assert(m, m->fiducial, fields);
    }
}

void percept_show(struct mind *m)
{
    if (m->ring_unseen) {
        long long next = FactData(m->env)->NextFactIndex;
        m->ring_unseen = false;
        EnvIncrementGCLocks(m->env);
        FactData(m->env)->NextFactIndex = m->ring_number;
        m->diary_fact = CLIPS_DIARY_SHOWN;
        m->ring_fact = percept_sonar(m);
        m->diary_fact = CLIPS_DIARY_CAUSED;
        FactData(m->env)->NextFactIndex = next;
        EnvDecrementGCLocks(m->env);
    }
}

/* A fact that is left out keeps its number, so that who looks changes nothing but what he sees. */
static void percept_ring(struct mind *m)
{
    m->ring_unseen = m->percept.sonar_count > 0 && !fact_is_used(m->ring);
    if (m->ring_unseen) {
        m->ring_number = FactData(m->env)->NextFactIndex++;
    } else {
        m->ring_fact = percept_sonar(m);
    }
}

/* What the last percept was. */
static void percept_retract_all(struct mind *m)
{
    fact_retract(m, &m->position_fact);
    fact_retract(m, &m->ring_fact);
    fact_retract(m, &m->laser_fact);
    for (size_t i = 0; i < m->percept.blob_count; i++) {
        fact_retract(m, &m->blob_facts[i]);
    }
    for (size_t i = 0; i < m->percept.fiducial_count; i++) {
        fact_retract(m, &m->fiducial_facts[i]);
    }
}

/* Numbers that are no numbers would only poison what rules compute: 0 stands for them. */
static double percept_finite(double x)
{
    return isfinite(x) ? x : 0;
}

static size_t percept_ranges(float *to, const float *from_m, size_t count, size_t most)
{
    count = count < most ? count : most;
    for (size_t i = 0; i < count; i++) {
        to[i] = isfinite(from_m[i]) ? from_m[i] : 0;
    }
    return count;
}

void percept_reals(struct mu_percept *p, double *reals[PERCEPT_REALS])
{
    double *const all[PERCEPT_REALS] = {&p->x_m,
                                        &p->y_m,
                                        &p->heading_rad,
                                        &p->forward_m_s,
                                        &p->turn_rad_s,
                                        &p->gps_x_m,
                                        &p->gps_y_m,
                                        &p->compass_rad,
                                        &p->odometer_x_m,
                                        &p->odometer_y_m,
                                        &p->odometer_heading_rad,
                                        &p->battery_share};
    memcpy(reals, all, sizeof all);
}

static void percept_copy_body(struct mu_percept *p)
{
    double *reals[PERCEPT_REALS];
    percept_reals(p, reals);
    for (size_t i = 0; i < PERCEPT_REALS; i++) {
        *reals[i] = percept_finite(*reals[i]);
    }
}

static void percept_copy_sights(struct mind *m, const struct mu_percept *p)
{
    size_t blobs = p->blob_count < MU_BLOBS_MAX ? p->blob_count : MU_BLOBS_MAX;
    size_t fiducials = p->fiducial_count < MU_FIDUCIALS_MAX ? p->fiducial_count : MU_FIDUCIALS_MAX;
    for (size_t i = 0; i < blobs; i++) {
        const struct mu_blob *b = &p->blobs[i];
        m->blobs[i] = (struct mu_blob){b->rgb, percept_finite(b->bearing_rad),
                                       percept_finite(b->width_rad), percept_finite(b->range_m)};
    }
    for (size_t i = 0; i < fiducials; i++) {
        const struct mu_fiducial *f = &p->fiducials[i];
        m->fiducials[i] =
            (struct mu_fiducial){f->number, percept_finite(f->bearing_rad),
                                 percept_finite(f->range_m), percept_finite(f->heading_rad)};
    }
    m->percept.blob_count = blobs;
    m->percept.fiducial_count = fiducials;
    m->percept.blobs = m->blobs;
    m->percept.fiducials = m->fiducials;
}

static void percept_copy(struct mind *m, const struct mu_percept *p)
{
    m->percept = *p;
    percept_copy_body(&m->percept);
    percept_copy_sights(m, p);
    m->percept.sonar_count = percept_ranges(m->sonar, p->sonar_m, p->sonar_count, MU_SONARS_MAX);
    m->percept.laser_count = percept_ranges(m->laser_m, p->laser_m, p->laser_count, MU_BEAMS_MAX);
    m->percept.sonar_m = m->sonar;
    m->percept.laser_m = m->laser_m;
    m->sensed = true;
}

void percept_take(struct mind *m, const struct mu_percept *p)
{
    m->diary_fact = CLIPS_DIARY_SENSED;
    percept_retract_all(m);
    percept_copy(m, p);
    m->position_fact = percept_position(m);
    percept_ring(m);
    m->laser_fact = percept_laser(m);
    percept_sights(m);
    m->diary_fact = CLIPS_DIARY_CAUSED;
}

void percept_lose(struct mind *m, uint64_t time_ns)
{
    const struct mu_percept nothing = {.time_ns = time_ns, .battery_share = -1};
    percept_retract_all(m);
    percept_copy(m, &nothing);
    m->sensed = m->ring_unseen = false;
}

/* (reset) takes it with the other facts. */
static void percept_reset(void *env)
{
    environment_mind(env)->ring_unseen = false;
}

void percept_install(struct mind *m)
{
    EnvAddResetFunction(m->env, "mu-percept", percept_reset, 100);
}
