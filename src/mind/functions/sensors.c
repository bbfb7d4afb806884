/* SPDX-License-Identifier: Apache-2.0 */
/* Sensors and gripper as functions. */
#include "mind/functions/table.h"

#include <math.h>
#include <string.h>

bool sensors_have_body(void *env, const char *function)
{
    bool none = inputs_of(environment_mind(env))->body == PERCEPT_NO_BODY;
    if (none) {
        value_refuse(env, function, "a body, and this agent has none");
    }
    return !none;
}

/* @return whether there is a percept to give; else the result is () */
static bool sensors_sensed(void *env, const char *function, DATA_OBJECT *out)
{
    EnvSetMultifieldErrorValue(env, out);
    return sensors_have_body(env, function) &&
           inputs_of(environment_mind(env))->body == PERCEPT_BODY;
}

void sensors_position(void *env, DATA_OBJECT *out)
{
    const struct mind *m = environment_mind(env);
    double values[6];
    if (!sensors_sensed(env, "position", out)) {
        return;
    }
    sensors_set_position(&inputs_of(m)->percept, values);
    struct multifield *fields = EnvCreateMultifield(env, 7);
    for (size_t i = 0; i < 6; i++) {
        value_set_float(env, fields, i, values[i]);
    }
    value_set_symbol(env, fields, 6, inputs_of(m)->percept.stalled ? "TRUE" : "FALSE");
    value_multifield(out, fields);
}

void sensors_stalled(void *env, DATA_OBJECT *out)
{
    bool held_up =
        sensors_have_body(env, "stalled") && inputs_of(environment_mind(env))->percept.stalled;
    value_bool(env, out, held_up);
}

void sensors_sonar(void *env, DATA_OBJECT *out)
{
    const struct mind *m = environment_mind(env);
    size_t count = inputs_of(m)->percept.sonar_count;
    double ranges_mm[MU_SONARS_MAX];
    long long index;
    value_bool(env, out, false);
    if (!sensors_have_body(env, "sonar")) {
        return;
    }
    if (EnvRtnArgCount(env) == 0) {
        for (size_t i = 0; i < count; i++) {
            ranges_mm[i] = (double)inputs_of(m)->percept.sonar_m[i] * 1000;
        }
        value_floats(env, out, count, ranges_mm);
        return;
    }
    if (!value_whole(env, "sonar", 1, &index)) {
        return;
    }
    if ((index < 0 || (size_t)index >= count) && EnvRtnArgCount(env) == 2) {
        (void)value_any(env, 2, out);
        return;
    }
    if (index < 0 || (size_t)index >= count) {
        value_refuse(env, "sonar", "the index of a sonar that the body has, from 0");
        return;
    }
    value_float(env, out, (double)inputs_of(m)->percept.sonar_m[index] * 1000);
}

/* Takes the least of an argument, a number or several.  @return false: it holds something else */
static bool physical_least(const DATA_OBJECT *value, double *least)
{
    if (value->type != MULTIFIELD) {
        *least = fmin(*least, value_of(value->type, value->value));
        return value->type == FLOAT || value->type == INTEGER;
    }
    for (long i = value->begin; i <= value->end; i++) {
        const struct field *f = &((struct multifield *)value->value)->theFields[i];
        if (f->type != FLOAT && f->type != INTEGER) {
            return false;
        }
        *least = fmin(*least, value_of(f->type, f->value));
    }
    return true;
}

void sensors_sonar_data(void *env, DATA_OBJECT *out)
{
    double least = INFINITY;
    int count = EnvRtnArgCount(env);
    value_float(env, out, 0);
    for (int i = 1; i <= count; i++) {
        DATA_OBJECT value;
        if (!value_any(env, i, &value)) {
            return;
        }
        if (!physical_least(&value, &least)) {
            value_refuse(env, "sonar-data", "ranges in mm");
            return;
        }
    }
    const struct mind *m = environment_mind(env);
    double clip = environment_global(m, ENVIRONMENT_SONAR_CLIP);
    double clear = least - environment_global(m, ENVIRONMENT_SONAR_MARGIN);
    value_float(env, out, fmax(0, fmin(clear, clip)));
}

/* Reads the index of an element.  @return false, after a CLIPS error */
static bool list_index(void *env, const struct mu_channel *c, int argument, size_t count,
                       long long *index)
{
    if (!value_whole(env, c->fact, argument, index)) {
        return false;
    }
    if (*index < 0 || (size_t)*index >= count) {
        value_refuse(env, c->fact, "the index of a beam that was read, from 0");
        return false;
    }
    return true;
}

void sensors_list(void *env, DATA_OBJECT *out)
{
    struct mind *m = environment_mind(env);
    const struct mu_channel *c = GetEnvironmentFunctionContext(env);
    size_t count;
    const char *elements = mu_channel_list(c, &inputs_of(m)->percept, &count);
    int arguments = EnvRtnArgCount(env);
    long long from = 0, to = (long long)count - 1;
    value_bool(env, out, false);
    if (!sensors_have_body(env, c->fact)) {
        return;
    }
    if (arguments > 0 && (!list_index(env, c, 1, count, &from) ||
                          (arguments == 2 && !list_index(env, c, 2, count, &to)))) {
        return;
    }
    to = arguments == 1 ? from : to;
    size_t length = to >= from ? (size_t)(to - from + 1) : 0;
    struct multifield *fields = EnvCreateMultifield(env, (long)length);
    sensors_set(m, c, elements + (size_t)from * c->bytes, length, fields, 0);
    value_multifield(out, fields);
    if (arguments == 1) {
        out->type = fields->theFields[0].type;
        out->value = fields->theFields[0].value;
    }
}

/* Gives the records that are picked, each in its fields; picked NULL: all. */
static void records_give(void *env, size_t number, const bool *picked, DATA_OBJECT *out)
{
    struct mind *m = environment_mind(env);
    const struct mu_channel *c = &mu_channels[number];
    size_t count, wanted = 0, at = 0;
    const char *record = mu_channel_list(c, &inputs_of(m)->percept, &count);
    for (size_t i = 0; i < count; i++) {
        wanted += !picked || picked[i];
    }
    struct multifield *fields = EnvCreateMultifield(env, (long)(wanted * c->field_count));
    for (size_t i = 0; i < count; i++, record += c->bytes) {
        if (!picked || picked[i]) {
            sensors_set(m, c, record, 1, fields, at);
            at += c->field_count;
        }
    }
    value_multifield(out, fields);
}

void sensors_camera(void *env, DATA_OBJECT *out)
{
    const struct mu_percept *p = &inputs_of(environment_mind(env))->percept;
    const char *color = NULL;
    bool picked[MU_BLOBS_MAX];
    EnvSetMultifieldErrorValue(env, out);
    if (!sensors_have_body(env, "camera") ||
        (EnvRtnArgCount(env) == 1 && !value_word(env, "camera", 1, &color))) {
        return;
    }
    for (size_t i = 0; i < p->blob_count; i++) {
        char bytes[8];
        picked[i] = !color || strcmp(sensors_color(p->blobs[i].rgb, bytes), color) == 0;
    }
    records_give(env, MU_CHANNEL_BLOBS, picked, out);
}

void sensors_fiducials(void *env, DATA_OBJECT *out)
{
    EnvSetMultifieldErrorValue(env, out);
    if (sensors_have_body(env, "fiducials")) {
        records_give(env, MU_CHANNEL_FIDUCIALS, NULL, out);
    }
}

void sensors_gps(void *env, DATA_OBJECT *out)
{
    const struct mind *m = environment_mind(env);
    const struct mu_percept *p = &inputs_of(m)->percept;
    if (!sensors_sensed(env, "gps", out)) {
        return;
    }
    double compass_deg = value_norm_deg(p->compass_rad * VALUE_DEG);
    value_floats(env, out, 3, (double[]){p->gps_x_m * 1000, p->gps_y_m * 1000, compass_deg});
}

void sensors_odometer(void *env, DATA_OBJECT *out)
{
    const struct mind *m = environment_mind(env);
    const struct mu_percept *p = &inputs_of(m)->percept;
    if (!sensors_sensed(env, "odometer", out)) {
        return;
    }
    double heading_deg = value_norm_deg(p->odometer_heading_rad * VALUE_DEG);
    value_floats(env, out, 3,
                 (double[]){p->odometer_x_m * 1000, p->odometer_y_m * 1000, heading_deg});
}

void sensors_bumpers(void *env, DATA_OBJECT *out)
{
    uint32_t touched = inputs_of(environment_mind(env))->percept.bumpers;
    double directions_deg[32];
    size_t count = 0;
    EnvSetMultifieldErrorValue(env, out);
    if (!sensors_have_body(env, "bumpers")) {
        return;
    }
    for (unsigned k = 0; k < 8; k++) {
        if (touched & 1u << k) {
            directions_deg[count++] = value_norm_deg(45.0 * k);
        }
    }
    value_floats(env, out, count, directions_deg);
}

void sensors_battery(void *env, DATA_OBJECT *out)
{
    const struct mind *m = environment_mind(env);
    value_bool(env, out, false);
    if (sensors_have_body(env, "battery") && inputs_of(m)->body == PERCEPT_BODY &&
        inputs_of(m)->percept.battery_share >= 0) {
        value_float(env, out, inputs_of(m)->percept.battery_share);
    }
}

static void gripper_state(void *env, uint32_t gripper, DATA_OBJECT *out)
{
    static const uint32_t flags[] = {MU_GRIPPER_OUTER_BEAM, MU_GRIPPER_INNER_BEAM,
                                     MU_GRIPPER_HOLDS};
    if (!(gripper & MU_GRIPPER_THERE)) {
        EnvSetMultifieldErrorValue(env, out);
        return;
    }
    struct multifield *fields = EnvCreateMultifield(env, 5);
    value_set_symbol(env, fields, 0, gripper & MU_GRIPPER_CLOSED ? "closed" : "open");
    value_set_symbol(env, fields, 1, gripper & MU_GRIPPER_LIFTED ? "up" : "down");
    for (size_t i = 0; i < 3; i++) {
        value_set_symbol(env, fields, 2 + i, gripper & flags[i] ? "TRUE" : "FALSE");
    }
    value_multifield(out, fields);
}

void sensors_gripper(void *env, DATA_OBJECT *out)
{
    static const struct {
        const char *word;
        enum mu_paddles paddles;
        enum mu_lift lift;
    } orders[] = {{"open", MU_PADDLES_OPEN, MU_LIFT_KEEP},
                  {"close", MU_PADDLES_CLOSE, MU_LIFT_KEEP},
                  {"lift", MU_PADDLES_KEEP, MU_LIFT_UP},
                  {"lower", MU_PADDLES_KEEP, MU_LIFT_DOWN}};
    struct mind *m = environment_mind(env);
    const char *word;
    EnvSetMultifieldErrorValue(env, out);
    if (!sensors_have_body(env, "gripper")) {
        return;
    }
    if (EnvRtnArgCount(env) == 0) {
        gripper_state(env, inputs_of(m)->percept.gripper, out);
        return;
    }
    value_bool(env, out, false);
    if (!value_word(env, "gripper", 1, &word)) {
        return;
    }
    for (size_t i = 0; i < sizeof orders / sizeof orders[0]; i++) {
        if (strcmp(word, orders[i].word) == 0) {
            output_of(m)->act.paddles =
                orders[i].paddles ? orders[i].paddles : output_of(m)->act.paddles;
            output_of(m)->act.lift = orders[i].lift ? orders[i].lift : output_of(m)->act.lift;
            value_bool(env, out, inputs_of(m)->percept.gripper & MU_GRIPPER_THERE);
            return;
        }
    }
    value_refuse(env, "gripper", "open, close, lift or lower");
}
