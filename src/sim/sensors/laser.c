/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/sensors/models.h"

/* A narrower fan counts as one direction: its steps would be too small for a double. */
#define LASER_FOV_MIN_RAD 1e-9

void laser_init(struct laser *laser, const struct world_laser *from)
{
    *laser = (struct laser){.place = frame_of(from->pose),
                            .range = {from->range_min_m, from->range_max_m},
                            .noise = from->noise};
    double fov = from->fov_rad < 2 * M_PI ? from->fov_rad : 2 * M_PI;
    if (from->samples > 1 && fov > LASER_FOV_MIN_RAD) {
        fan_table_init(&laser->table, -fov / 2, fov / (from->samples - 1), from->samples);
    } else if (from->samples > 0) { /* all beams point ahead, so that any step will do */
        fan_table_init(&laser->table, 0, LASER_FOV_MIN_RAD, from->samples);
    }
}

double laser_reach(const struct laser *laser)
{
    return laser->table.count ? laser->range.max_m + hypot(laser->place.x, laser->place.y) : 0;
}

/* Stage's: the ranger_return of what a beam meets. */
static float laser_intensity(const struct solid *hit)
{
    return hit ? (float)hit->look.reflectance : 0;
}

static void laser_sweep(const struct laser *laser, const struct sensing *at)
{
    struct frame eye = frame_join(&at->robot, &laser->place);
    struct fan_eye fan = {eye.x, eye.y, eye.c, eye.s, laser->range.max_m, SOLID_ECHOES};
    bool deep = at->due & MU_SENSE_LASER_INTENSITY;
    fan_kernel()->sweep(&laser->table, &fan, &at->near.solids, at->range_m, deep ? at->hit : NULL);
    for (uint32_t k = 0; k < laser->table.count && deep; k++) {
        int64_t hit = at->hit[k];
        at->lists->laser_intensity[k] =
            laser_intensity(hit == FAN_NOTHING ? NULL : gather_solid(at->gather, hit));
    }
}

/* Beams with an angular error are no fan: each is cast as a ray of its own. */
static void laser_scatter(const struct laser *laser, const struct sensing *at)
{
    struct frame eye = frame_join(&at->robot, &laser->place);
    const double from[2] = {eye.x, eye.y};
    uint64_t key = sensing_key(at, DRAW_LASER_ANGLE);
    for (uint32_t k = 0; k < laser->table.count; k++) {
        double x = laser->table.along_x[k];
        double y = laser->table.along_y[k];
        double along[2] = {eye.c * x - eye.s * y, eye.s * x + eye.c * y};
        noise_turn(&laser->noise, along, draw_bits(key, k));
        const struct solid *hit;
        at->range_m[k] = grid_find(at->grid, (struct grid_eye){at->self, SOLID_ECHOES}, from, along,
                                   laser->range.max_m, &hit);
        if (at->due & MU_SENSE_LASER_INTENSITY) {
            at->lists->laser_intensity[k] = laser_intensity(hit);
        }
    }
}

static void laser_blur(const struct laser *laser, const struct sensing *at)
{
    uint64_t key = sensing_key(at, DRAW_LASER);
    for (uint32_t k = 0; k < laser->table.count; k++) {
        uint64_t bits = draw_bits(key, k);
        at->range_m[k] = noise_range(&laser->noise, &laser->range, at->range_m[k], bits);
    }
}

void laser_read(const struct laser *laser, const struct sensing *at)
{
    if (laser->noise.angle_rad > 0) {
        laser_scatter(laser, at);
    } else {
        laser_sweep(laser, at);
    }
    if (!(at->due & MU_SENSE_LASER)) {
        return;
    }
    if (!noise_is_exact(&laser->noise)) {
        laser_blur(laser, at);
    }
    const struct noise_limits limits = laser->range;
    for (uint32_t k = 0; k < laser->table.count; k++) {
        at->lists->laser_m[k] = (float)noise_clip(&limits, at->range_m[k]);
    }
}
