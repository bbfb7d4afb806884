/* SPDX-License-Identifier: Apache-2.0 */
/* The sensors that rules use, and readings as fields. */
#include "mind/facts/facts.h"

#include <stdio.h>
#include <string.h>

/* A call of a sensor's function or a pattern of its facts is a use of that sensor. */
void sensors_note(struct mind *m, const char *word)
{
    for (size_t i = 0; i < MU_CHANNEL_COUNT; i++) {
        if (strcmp(word, mu_channels[i].fact) == 0) {
            inputs_of(m)->senses_named |= mu_channels[i].senses;
        }
    }
    if (strcmp(word, "all") != 0) {
        inputs_of(m)->senses_named |= mu_sensor_bits(word);
    }
    if (strcmp(word, "clear-way") == 0) {
        inputs_of(m)->senses_named |= MU_SENSE_SONAR;
    }
}

uint32_t sensors_wanted(const struct mind *m)
{
    uint32_t senses = inputs_of(m)->senses_named;
    for (size_t i = 0; i < MU_CHANNEL_COUNT && m->env; i++) {
        senses |= fact_is_used(inputs_of(m)->lists[i].relation) ? mu_channels[i].senses : 0;
    }
    return senses;
}

/* Names of colours: X11's, which world files use. */
static const struct {
    uint32_t rgb;
    const char *name;
} sense_colors[] = {
    {0x000000, "black"},  {0xffffff, "white"},  {0xff0000, "red"},   {0x00ff00, "green"},
    {0x0000ff, "blue"},   {0xffff00, "yellow"}, {0x00ffff, "cyan"},  {0xff00ff, "magenta"},
    {0xffa500, "orange"}, {0xa020f0, "purple"}, {0xa52a2a, "brown"}, {0xffc0cb, "pink"},
    {0xbebebe, "gray"},   {0xee82ee, "violet"}, {0xffd700, "gold"},  {0x40e0d0, "turquoise"},
};

const char *sensors_color(uint32_t rgb, char bytes[8])
{
    for (size_t i = 0; i < sizeof sense_colors / sizeof sense_colors[0]; i++) {
        if (sense_colors[i].rgb == rgb) {
            return sense_colors[i].name;
        }
    }
    snprintf(bytes, 8, "#%06x", (unsigned)(rgb & 0xffffff));
    return bytes;
}

/* A field of a record, in the unit that the table names; the next one follows it. */
static void set_MM(struct mind *m, struct multifield *fields, size_t at, double x)
{
    value_set_float(m->env, fields, at, x * 1000);
}

static void set_DEG(struct mind *m, struct multifield *fields, size_t at, double x)
{
    value_set_float(m->env, fields, at, x * VALUE_DEG);
}

static void set_HEADING(struct mind *m, struct multifield *fields, size_t at, double x)
{
    value_set_float(m->env, fields, at, value_norm_deg(x * VALUE_DEG));
}

static void set_COLOR(struct mind *m, struct multifield *fields, size_t at, uint32_t rgb)
{
    char bytes[8];
    value_set_symbol(m->env, fields, at, sensors_color(rgb, bytes));
}

static void set_AS_IS(struct mind *m, struct multifield *fields, size_t at, long long x)
{
    fields->theFields[at].type = INTEGER;
    fields->theFields[at].value = EnvAddLong(m->env, x);
}

#define FIELD(type, member, unit, ...) set_##unit(m, fields, at++, from->member);

static void sensors_set_blob(struct mind *m, const struct mu_blob *from, struct multifield *fields,
                             size_t at)
{
    MU_BLOB(FIELD)
}

static void sensors_set_fiducial(struct mind *m, const struct mu_fiducial *from,
                                 struct multifield *fields, size_t at)
{
    MU_FIDUCIAL(FIELD)
}

void sensors_set(struct mind *m, const struct mu_channel *c, const void *elements, size_t count,
                 struct multifield *fields, size_t at)
{
    double scale = c->fields[0].unit == MU_UNIT_MM ? 1000 : 1;
    for (size_t i = 0; i < count; i++, at += c->field_count) {
        if (c->plain) {
            value_set_float(m->env, fields, at, (double)((const float *)elements)[i] * scale);
        } else if (c == &mu_channels[MU_CHANNEL_BLOBS]) {
            sensors_set_blob(m, (const struct mu_blob *)elements + i, fields, at);
        } else {
            sensors_set_fiducial(m, (const struct mu_fiducial *)elements + i, fields, at);
        }
    }
}

void sensors_set_position(const struct mu_percept *p, double out[6])
{
    out[0] = (double)p->time_ns * 1e-9;
    out[1] = p->x_m * 1000;
    out[2] = p->y_m * 1000;
    out[3] = p->forward_m_s * 1000;
    out[4] = p->turn_rad_s * VALUE_DEG;
    out[5] = value_norm_deg(p->heading_rad * VALUE_DEG);
}
