/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include "core/sensors.h"
#include "core/text.h"
#include "muster/limits.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct order {
    const char *const *words; /* behind the verb */
    size_t count;
    double push_s;
    muster_RunCommand *c;
    char *wrong; /* WORLD_WORDS_WRONG bytes */
};

/* Says what was expected instead of a word.  @return false */
static bool refuse(const struct order *o, size_t word, const char *expected)
{
    char shown[MU_TEXT_SHOWN];
    snprintf(o->wrong, WORLD_WORDS_WRONG, "'%s': %s", mu_text_show(shown, o->words[word]),
             expected);
    return false;
}

static bool number_read(const struct order *o, size_t word, double *out)
{
    char *end;
    *out = strtod(o->words[word], &end);
    bool good = end != o->words[word] && *end == '\0' && isfinite(*out);
    return good || refuse(o, word, "expected a number");
}

static bool numbers_read(const struct order *o, size_t first, double *const *to, size_t count)
{
    for (size_t i = 0; i < count && first + i < o->count; i++) {
        if (!number_read(o, first + i, to[i])) {
            return false;
        }
    }
    return true;
}

static bool name_read(const struct order *o)
{
    if (strlen(o->words[0]) > MU_NAME_MAX) {
        return refuse(o, 0, "no name is that long");
    }
    o->c->name = (char *)(uintptr_t)o->words[0]; /* there is no writer */
    return true;
}

static bool place_read(const struct order *o)
{
    double deg = 0;
    double *const numbers[] = {&o->c->x_m, &o->c->y_m, &deg};
    bool good = name_read(o) && numbers_read(o, 1, numbers, 3);
    o->c->keeps_heading = o->count < 4;
    o->c->heading_rad = remainder(deg, 360) * M_PI / 180;
    return good;
}

static bool push_read(const struct order *o)
{
    double *const numbers[] = {&o->c->force_x_n, &o->c->force_y_n, &o->c->torque_nm};
    o->c->time_s = o->push_s;
    return name_read(o) && numbers_read(o, 1, numbers, 3);
}

static bool reset_read(const struct order *o)
{
    return o->count == 0 || name_read(o);
}

static bool sensor_read(const struct order *o)
{
    o->c->senses = mu_sensor_bits(o->words[1]);
    o->c->on = strcmp(o->words[2], "on") == 0;
    if (o->c->senses == 0 || (!o->c->on && strcmp(o->words[2], "off") != 0)) {
        snprintf(o->wrong, WORLD_WORDS_WRONG, "expected NAME, then %s or all, then on or off",
                 MU_SENSOR_WORDS);
        return false;
    }
    return name_read(o);
}

static bool pace_read(const struct order *o)
{
    if (!number_read(o, 0, &o->c->rate)) {
        return false;
    }
    return o->c->rate >= 0 || refuse(o, 0, "expected times real time, or 0: as fast as it goes");
}

static bool save_read(const struct order *o)
{
    o->c->file = (char *)(uintptr_t)o->words[0];
    return true;
}

static const struct {
    const char *verb;
    size_t min, max; /* words behind it */
    muster_RunOrder order;
    bool (*read)(const struct order *o);
    const char *usage;
} verbs[] = {
    {"place", 3, 4, muster_RUN_PLACE, place_read, "place NAME X Y [DEG]"},
    {"push", 3, 4, muster_RUN_PUSH, push_read, "push NAME FX FY [TORQUE]"},
    {"reset", 0, 1, muster_RUN_RESET, reset_read, "reset [NAME]"},
    {"sensor", 3, 3, muster_RUN_SENSOR, sensor_read, "sensor NAME SENSOR on|off"},
    {"pace", 1, 1, muster_RUN_PACE, pace_read, "pace R"},
    {"save", 1, 1, muster_RUN_SAVE, save_read, "save FILE"},
};

enum { VERBS = sizeof verbs / sizeof verbs[0] };

/* @return its row; VERBS: there is none */
static size_t verb_find(const char *verb)
{
    size_t i = 0;
    while (i < VERBS && strcmp(verb, verbs[i].verb) != 0) {
        i++;
    }
    return i;
}

bool world_words_know(const char *verb)
{
    return verb_find(verb) < VERBS;
}

mu_result world_words_read(const char *const *words, size_t count, double push_s,
                           muster_RunCommand *c, char wrong[WORLD_WORDS_WRONG])
{
    static char none[1];
    size_t verb = count > 0 ? verb_find(words[0]) : VERBS;
    *c = (muster_RunCommand){.simulator = none, .source = none, .name = none, .file = none};
    c->when = none;
    if (verb == VERBS) {
        snprintf(wrong, WORLD_WORDS_WRONG, "expected place, push, reset, sensor, pace or save");
        return MU_FAULT_USAGE;
    }
    struct order o = {words + 1, count - 1, push_s, c, wrong};
    if (o.count < verbs[verb].min || o.count > verbs[verb].max) {
        snprintf(wrong, WORLD_WORDS_WRONG, "expected %s", verbs[verb].usage);
        return MU_FAULT_USAGE;
    }
    c->order = verbs[verb].order;
    return verbs[verb].read(&o) ? MU_OK : MU_FAULT_USAGE;
}
