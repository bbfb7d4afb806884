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

static double sensors_real(enum mu_field_type type, const char *at)
{
    double real;
    float range;
    uint32_t bits;
    switch (type) {
    case MU_FIELD_double: memcpy(&real, at, sizeof real); return real;
    case MU_FIELD_float: memcpy(&range, at, sizeof range); return (double)range;
    case MU_FIELD_uint32_t: memcpy(&bits, at, sizeof bits); return (double)bits;
    case MU_FIELD_int32_t: memcpy(&bits, at, sizeof bits); return (double)(int32_t)bits;
    case MU_FIELD_bool: return *at;
    }
    return 0;
}

static void sensors_set_field(struct mind *m, const struct mu_field *f, const char *element,
                              struct multifield *fields, size_t at)
{
    double x = sensors_real(f->type, element + f->at);
    char bytes[8];
    switch (f->unit) {
    case MU_UNIT_MM: x *= 1000; break;
    case MU_UNIT_DEG: x *= VALUE_DEG; break;
    case MU_UNIT_HEADING: x = value_norm_deg(x * VALUE_DEG); break;
    case MU_UNIT_COLOR:
        value_set_symbol(m->env, fields, at, sensors_color((uint32_t)x, bytes));
        return;
    case MU_UNIT_AS_IS: break;
    }
    if (f->type == MU_FIELD_int32_t) {
        fields->theFields[at].type = INTEGER;
        fields->theFields[at].value = EnvAddLong(m->env, (long long)x);
    } else {
        value_set_float(m->env, fields, at, x);
    }
}

void sensors_set(struct mind *m, const struct mu_channel *c, const void *elements, size_t count,
                 struct multifield *fields, size_t at)
{
    const char *element = elements;
    for (size_t i = 0; i < count; i++, element += c->bytes) {
        for (size_t k = 0; k < c->field_count; k++) {
            sensors_set_field(m, &c->fields[k], element, fields, at++);
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
