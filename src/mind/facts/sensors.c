/* SPDX-License-Identifier: Apache-2.0 */
/* Sensors and gripper as functions, and which sensors the rules look at. */
#include "mind/facts/sensors.h"

#include "mind/engine/value.h"
#include "mind/functions/motion.h"
#include "mind/functions/table.h"

#include <stdio.h>
#include <string.h>

/* Four fields tell of a blob, and of a fiducial. */
enum { SENSE_FIELDS = 4 };

static const double sense_deg = 180 / 3.14159265358979323846;

/* --- which sensors are wanted ----------------------------------------------------------------- */

/* Who calls such a function, or has a pattern of such a fact, looks at that sensor. */
static const struct {
    const char *word;
    uint32_t sense;
} sense_words[] = {
    {"sonar", MU_SENSE_SONAR},        {"clear-way", MU_SENSE_SONAR},
    {"laser", MU_SENSE_LASER},        {"camera", MU_SENSE_CAMERA},
    {"blob", MU_SENSE_CAMERA},        {"fiducials", MU_SENSE_FIDUCIALS},
    {"fiducial", MU_SENSE_FIDUCIALS},
};

void clips_sense_note(struct mind *m, const char *word)
{
    for (size_t i = 0; i < sizeof sense_words / sizeof sense_words[0]; i++) {
        if (strcmp(word, sense_words[i].word) == 0) {
            m->senses_named |= sense_words[i].sense;
        }
    }
}

static struct expr *sense_parse(void *env, struct expr *top, const char *source)
{
    const struct FunctionDefinition *f = top->value;
    top = clips_functions_parse(env, top, source);
    if (top) {
        clips_sense_note(clips_env_mind(env), ValueToString(f->callFunctionName));
    }
    return top;
}

void clips_sense_install(struct mind *m)
{
    static const char *const functions[] = {"sonar", "clear-way", "laser", "camera", "fiducials"};
    for (size_t i = 0; i < sizeof functions / sizeof functions[0]; i++) {
        clips_functions_note(m, functions[i], sense_parse);
    }
}

/* CLIPS counts uses in constructs together with the facts that there are, and C holds one. */
bool clips_sense_is_used(const struct deftemplate *template)
{
    long facts = 0;
    for (const struct fact *f = template->factList; f; f = f->nextTemplateFact) {
        facts++;
    }
    return template->patternNetwork || template->watch || template->busyCount - 1 > facts;
}

uint32_t mind_senses(const struct mind *m)
{
    if (!m->env) {
        return m->senses_named;
    }
    uint32_t used = (clips_sense_is_used(m->ring) ? MU_SENSE_SONAR : 0u) |
                    (clips_sense_is_used(m->laser) ? MU_SENSE_LASER : 0u) |
                    (clips_sense_is_used(m->blob) ? MU_SENSE_CAMERA : 0u) |
                    (clips_sense_is_used(m->fiducial) ? MU_SENSE_FIDUCIALS : 0u);
    return used | m->senses_named;
}

/* --- what they read --------------------------------------------------------------------------- */

/* The index of a beam as an argument.  @return false: it is none, and a CLIPS error */
static bool sense_beam(void *env, int argument, size_t count, long long *index)
{
    if (!clips_value_whole(env, "laser", argument, index)) {
        return false;
    }
    if (*index < 0 || (size_t)*index >= count) {
        clips_value_refuse(env, "laser", "the index of a beam that was read, from 0");
        return false;
    }
    return true;
}

void clips_sense_laser(void *env, DATA_OBJECT *out)
{
    const struct mind *m = clips_env_mind(env);
    int arguments = EnvRtnArgCount(env);
    size_t count = m->percept.laser_count;
    long long from = 0, to = (long long)count - 1;
    clips_value_bool(env, out, false);
    if (arguments > 0 && (!sense_beam(env, 1, count, &from) ||
                          (arguments == 2 && !sense_beam(env, 2, count, &to)))) {
        return;
    }
    if (arguments == 1) {
        clips_value_float(env, out, (double)m->laser_m[from] * 1000);
        return;
    }
    long length = to >= from ? (long)(to - from + 1) : 0;
    struct multifield *fields = EnvCreateMultifield(env, length);
    for (long i = 0; i < length; i++) {
        clips_value_set_float(env, fields, (size_t)i, (double)m->laser_m[from + i] * 1000);
    }
    clips_value_multifield(out, fields);
}

/* The colours that have a name: X11's, which world files use. */
static const struct {
    uint32_t rgb;
    const char *name;
} sense_colors[] = {
    {0x000000, "black"},  {0xffffff, "white"},  {0xff0000, "red"},   {0x00ff00, "green"},
    {0x0000ff, "blue"},   {0xffff00, "yellow"}, {0x00ffff, "cyan"},  {0xff00ff, "magenta"},
    {0xffa500, "orange"}, {0xa020f0, "purple"}, {0xa52a2a, "brown"}, {0xffc0cb, "pink"},
    {0xbebebe, "gray"},   {0xee82ee, "violet"}, {0xffd700, "gold"},  {0x40e0d0, "turquoise"},
};

/* @return its name, or #rrggbb in bytes */
static const char *sense_color(uint32_t rgb, char bytes[8])
{
    for (size_t i = 0; i < sizeof sense_colors / sizeof sense_colors[0]; i++) {
        if (sense_colors[i].rgb == rgb) {
            return sense_colors[i].name;
        }
    }
    snprintf(bytes, 8, "#%06x", (unsigned)(rgb & 0xffffff));
    return bytes;
}

void clips_sense_blob(struct mind *m, const struct mu_blob *b, struct multifield *fields, size_t at)
{
    char bytes[8];
    clips_value_set_symbol(m->env, fields, at, sense_color(b->rgb, bytes));
    clips_value_set_float(m->env, fields, at + 1, b->bearing_rad * sense_deg);
    clips_value_set_float(m->env, fields, at + 2, b->width_rad * sense_deg);
    clips_value_set_float(m->env, fields, at + 3, b->range_m * 1000);
}

void clips_sense_fiducial(struct mind *m, const struct mu_fiducial *f, struct multifield *fields,
                          size_t at)
{
    fields->theFields[at].type = INTEGER;
    fields->theFields[at].value = EnvAddLong(m->env, f->number);
    clips_value_set_float(m->env, fields, at + 1, f->bearing_rad * sense_deg);
    clips_value_set_float(m->env, fields, at + 2, f->range_m * 1000);
    clips_value_set_float(m->env, fields, at + 3, clips_physical_norm(f->heading_rad * sense_deg));
}

/* Marks the blobs of that colour.  @return how many there are */
static size_t sense_pick(const struct mind *m, const char *color, bool picked[MU_BLOBS_MAX])
{
    size_t count = 0;
    for (size_t i = 0; i < m->percept.blob_count; i++) {
        char bytes[8];
        picked[i] = !color || strcmp(sense_color(m->blobs[i].rgb, bytes), color) == 0;
        count += picked[i];
    }
    return count;
}

void clips_sense_camera(void *env, DATA_OBJECT *out)
{
    struct mind *m = clips_env_mind(env);
    const char *color = NULL;
    bool picked[MU_BLOBS_MAX];
    EnvSetMultifieldErrorValue(env, out);
    if (EnvRtnArgCount(env) == 1 && !clips_value_word(env, "camera", 1, &color)) {
        return;
    }
    size_t count = sense_pick(m, color, picked);
    struct multifield *fields = EnvCreateMultifield(env, (long)(count * SENSE_FIELDS));
    size_t at = 0;
    for (size_t i = 0; i < m->percept.blob_count; i++) {
        if (picked[i]) {
            clips_sense_blob(m, &m->blobs[i], fields, at);
            at += SENSE_FIELDS;
        }
    }
    clips_value_multifield(out, fields);
}

void clips_sense_fiducials(void *env, DATA_OBJECT *out)
{
    struct mind *m = clips_env_mind(env);
    size_t count = m->percept.fiducial_count;
    struct multifield *fields = EnvCreateMultifield(env, (long)(count * SENSE_FIELDS));
    for (size_t i = 0; i < count; i++) {
        clips_sense_fiducial(m, &m->fiducials[i], fields, i * SENSE_FIELDS);
    }
    clips_value_multifield(out, fields);
}

/* --- what every percept has ------------------------------------------------------------------- */

void clips_sense_gps(void *env, DATA_OBJECT *out)
{
    const struct mind *m = clips_env_mind(env);
    const struct mind_percept *p = &m->percept;
    if (!m->sensed) {
        EnvSetMultifieldErrorValue(env, out);
        return;
    }
    double compass_deg = clips_physical_norm(p->compass_rad * sense_deg);
    clips_value_floats(env, out, 3, (double[]){p->gps_x_m * 1000, p->gps_y_m * 1000, compass_deg});
}

void clips_sense_odometer(void *env, DATA_OBJECT *out)
{
    const struct mind *m = clips_env_mind(env);
    const struct mind_percept *p = &m->percept;
    if (!m->sensed) {
        EnvSetMultifieldErrorValue(env, out);
        return;
    }
    double heading_deg = clips_physical_norm(p->odometer_heading_rad * sense_deg);
    clips_value_floats(env, out, 3,
                       (double[]){p->odometer_x_m * 1000, p->odometer_y_m * 1000, heading_deg});
}

void clips_sense_bumpers(void *env, DATA_OBJECT *out)
{
    uint32_t touched = clips_env_mind(env)->percept.bumpers;
    double directions_deg[32];
    size_t count = 0;
    for (unsigned k = 0; k < 8; k++) {
        if (touched & 1u << k) {
            directions_deg[count++] = clips_physical_norm(45.0 * k);
        }
    }
    clips_value_floats(env, out, count, directions_deg);
}

void clips_sense_battery(void *env, DATA_OBJECT *out)
{
    const struct mind *m = clips_env_mind(env);
    clips_value_bool(env, out, false);
    if (m->sensed && m->percept.battery_share >= 0) {
        clips_value_float(env, out, m->percept.battery_share);
    }
}

/* --- the gripper ------------------------------------------------------------------------------ */

static void gripper_state(void *env, uint32_t gripper, DATA_OBJECT *out)
{
    static const uint32_t flags[] = {MU_GRIPPER_OUTER_BEAM, MU_GRIPPER_INNER_BEAM,
                                     MU_GRIPPER_HOLDS};
    if (!(gripper & MU_GRIPPER_THERE)) {
        EnvSetMultifieldErrorValue(env, out);
        return;
    }
    struct multifield *fields = EnvCreateMultifield(env, 5);
    clips_value_set_symbol(env, fields, 0, gripper & MU_GRIPPER_CLOSED ? "closed" : "open");
    clips_value_set_symbol(env, fields, 1, gripper & MU_GRIPPER_LIFTED ? "up" : "down");
    for (size_t i = 0; i < 3; i++) {
        clips_value_set_symbol(env, fields, 2 + i, gripper & flags[i] ? "TRUE" : "FALSE");
    }
    clips_value_multifield(out, fields);
}

void clips_sense_gripper(void *env, DATA_OBJECT *out)
{
    static const struct {
        const char *word;
        enum mu_paddles paddles;
        enum mu_lift lift;
    } orders[] = {{"open", MU_PADDLES_OPEN, MU_LIFT_KEEP},
                  {"close", MU_PADDLES_CLOSE, MU_LIFT_KEEP},
                  {"lift", MU_PADDLES_KEEP, MU_LIFT_UP},
                  {"lower", MU_PADDLES_KEEP, MU_LIFT_DOWN}};
    struct mind *m = clips_env_mind(env);
    const char *word;
    if (EnvRtnArgCount(env) == 0) {
        gripper_state(env, m->percept.gripper, out);
        return;
    }
    clips_value_bool(env, out, false);
    if (!clips_value_word(env, "gripper", 1, &word)) {
        return;
    }
    for (size_t i = 0; i < sizeof orders / sizeof orders[0]; i++) {
        if (strcmp(word, orders[i].word) == 0) {
            m->act.paddles = orders[i].paddles ? orders[i].paddles : m->act.paddles;
            m->act.lift = orders[i].lift ? orders[i].lift : m->act.lift;
            clips_value_bool(env, out, m->percept.gripper & MU_GRIPPER_THERE);
            return;
        }
    }
    clips_value_refuse(env, "gripper", "open, close, lift or lower");
}
