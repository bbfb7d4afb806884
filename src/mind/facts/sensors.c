/* SPDX-License-Identifier: Apache-2.0 */
/* Which sensors the rules look at, and what sensors read as fields. */
#include "mind/engine/value.h"
#include "mind/facts/facts.h"

#include <stdio.h>
#include <string.h>

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

void sensors_note(struct mind *m, const char *word)
{
    for (size_t i = 0; i < sizeof sense_words / sizeof sense_words[0]; i++) {
        if (strcmp(word, sense_words[i].word) == 0) {
            m->senses_named |= sense_words[i].sense;
        }
    }
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

void sensors_set_blob(struct mind *m, const struct mu_blob *b, struct multifield *fields, size_t at)
{
    char bytes[8];
    clips_value_set_symbol(m->env, fields, at, sensors_color(b->rgb, bytes));
    clips_value_set_float(m->env, fields, at + 1, b->bearing_rad * VALUE_DEG);
    clips_value_set_float(m->env, fields, at + 2, b->width_rad * VALUE_DEG);
    clips_value_set_float(m->env, fields, at + 3, b->range_m * 1000);
}

void sensors_set_fiducial(struct mind *m, const struct mu_fiducial *f, struct multifield *fields,
                          size_t at)
{
    fields->theFields[at].type = INTEGER;
    fields->theFields[at].value = EnvAddLong(m->env, f->number);
    clips_value_set_float(m->env, fields, at + 1, f->bearing_rad * VALUE_DEG);
    clips_value_set_float(m->env, fields, at + 2, f->range_m * 1000);
    clips_value_set_float(m->env, fields, at + 3, value_norm_deg(f->heading_rad * VALUE_DEG));
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
