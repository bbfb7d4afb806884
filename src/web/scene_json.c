/* SPDX-License-Identifier: Apache-2.0 */
#include "web/json.h"

#include "core/json.h"
#include "core/palette.h"
#include "muster/limits.h"
#include "muster/result.h"
#include "muster/sensors.h"

#include <math.h>
#include <stdio.h>

/* A tenth of a millimetre is more than the eye sees. */
static void number_write(struct mu_json *j, const char *key, double value)
{
    mu_json_real(j, key, round(value * 1e4) / 1e4);
}

static void color_write(struct mu_json *j, uint32_t rgb)
{
    char color[8];
    snprintf(color, sizeof color, "#%06x", (unsigned)(rgb & 0xffffffu));
    mu_json_string(j, "rgb", color);
}

static void outline_write(struct mu_json *j, const char *key, const muster_Outline *o)
{
    mu_json_object(j, key);
    color_write(j, o->rgb);
    if (o->radius_m > 0) {
        number_write(j, "radius", o->radius_m);
    }
    if (o->flat) {
        mu_json_bool(j, "flat", true);
    }
    mu_json_list(j, "corners");
    for (uint32_t i = 0; i < o->corners_m._length; i++) {
        number_write(j, NULL, (double)o->corners_m._buffer[i]);
    }
    mu_json_end(j);
    mu_json_end(j);
}

/* x, y, heading, field of view, range, beams */
static void mount_write(struct mu_json *j, const muster_Mount *m)
{
    mu_json_list(j, NULL);
    number_write(j, NULL, m->x_m);
    number_write(j, NULL, m->y_m);
    number_write(j, NULL, m->heading_rad);
    number_write(j, NULL, m->fov_rad);
    number_write(j, NULL, m->range_m);
    mu_json_uint(j, NULL, m->beams);
    mu_json_end(j);
}

static void mounts_write(struct mu_json *j, const char *key,
                         const dds_sequence_muster_Mount *mounts)
{
    mu_json_list(j, key);
    for (uint32_t i = 0; i < mounts->_length; i++) {
        mount_write(j, &mounts->_buffer[i]);
    }
    mu_json_end(j);
}

/* By which the page tells it apart; NULL: it is a thing. */
static void identity_write(struct mu_json *j, const struct palette_color *color)
{
    if (color) {
        mu_json_object(j, "identity");
        mu_json_string(j, "light", color->light);
        mu_json_string(j, "dark", color->dark);
        mu_json_uint(j, "pattern", color->pattern);
        mu_json_end(j);
    }
}

static void figure_write(struct mu_json *j, const muster_Figure *f,
                         const struct palette_color *color)
{
    mu_json_object(j, NULL);
    mu_json_string(j, "name", f->name);
    mu_json_string(j, "color", f->color);
    identity_write(j, color);
    outline_write(j, "shape", &f->shape);
    mu_json_list(j, "start");
    number_write(j, NULL, f->x_m);
    number_write(j, NULL, f->y_m);
    number_write(j, NULL, f->heading_rad);
    mu_json_end(j);
    mu_json_bool(j, "controlled", f->controlled);
    mounts_write(j, "sonars", &f->sonars);
    mounts_write(j, "lasers", &f->lasers);
    mu_json_end(j);
}

static void figures_write(struct mu_json *j, const char *key,
                          const dds_sequence_muster_Figure *figures,
                          const struct palette_color *colors)
{
    mu_json_list(j, key);
    for (uint32_t i = 0; i < figures->_length; i++) {
        figure_write(j, &figures->_buffer[i], colors ? &colors[i] : NULL);
    }
    mu_json_end(j);
}

static const struct palette_color *colors_choose(const dds_sequence_muster_Figure *robots)
{
    static struct palette_color colors[MU_ROBOTS_MAX];
    static struct palette_robot wishes[MU_ROBOTS_MAX];
    MU_ASSERT(robots->_length <= MU_ROBOTS_MAX);
    for (uint32_t i = 0; i < robots->_length; i++) {
        const muster_Figure *f = &robots->_buffer[i];
        wishes[i] = (struct palette_robot){f->name, f->shape.rgb, !f->controlled};
    }
    palette_choose(colors, wishes, robots->_length);
    return colors;
}

static void sensors_write(struct mu_json *j)
{
    mu_json_list(j, "sensors");
#define X(id, word, ...) mu_json_string(j, NULL, word);
    MU_SENSORS(X)
#undef X
    mu_json_end(j);
}

void scene_json_write(struct mu_text *text, const muster_Scene *scene)
{
    mu_text_clear(text);
    struct mu_json j;
    mu_json_to_text(&j, text, MU_JSON_LINE);
    mu_json_object(&j, NULL);
    mu_json_string(&j, "world", scene->world);
    mu_json_uint(&j, "seed", scene->seed);
    mu_json_real(&j, "step_ms", (double)scene->step_ns / 1e6);
    sensors_write(&j);
    mu_json_list(&j, "bounds");
    number_write(&j, NULL, scene->min_x_m);
    number_write(&j, NULL, scene->min_y_m);
    number_write(&j, NULL, scene->max_x_m);
    number_write(&j, NULL, scene->max_y_m);
    mu_json_end(&j);
    mu_json_list(&j, "walls");
    for (uint32_t i = 0; i < scene->walls._length; i++) {
        outline_write(&j, NULL, &scene->walls._buffer[i]);
    }
    mu_json_end(&j);
    figures_write(&j, "robots", &scene->robots, colors_choose(&scene->robots));
    figures_write(&j, "objects", &scene->objects, NULL);
    mu_json_end(&j);
}
