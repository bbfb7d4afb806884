/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/sensors/models.h"

#include "muster/memory.h"

#define SONAR_SLACK_M 1e-6 /* rounding must not exclude a solid that is just within reach */

static uint32_t sonar_rays(const struct world_sonar *sonar)
{
    return sonar->rays > 1 ? sonar->rays : 1;
}

static void sonar_aim(struct sonar_ray *rays, const struct world_sonar *from)
{
    uint32_t count = sonar_rays(from);
    for (uint32_t k = 0; k < count; k++) {
        double off = count > 1 ? from->fov_rad * ((double)k / (count - 1) - 0.5) : 0;
        double heading = from->pose.heading_rad + off;
        rays[k] = (struct sonar_ray){cos(heading), sin(heading)};
    }
}

void sonar_init(struct sonar_ring *ring, const struct world_robot *robot)
{
    uint32_t rays = 0;
    for (size_t i = 0; i < robot->sonar_count; i++) {
        rays += sonar_rays(&robot->sonars[i]);
    }
    *ring = (struct sonar_ring){.count = robot->sonar_count, .ray_count = rays};
    ring->sonars = mu_startup_array(ring->count, sizeof *ring->sonars);
    ring->rays = mu_startup_array(rays, sizeof *ring->rays);
    uint32_t first = 0;
    for (size_t i = 0; i < ring->count; i++) {
        const struct world_sonar *from = &robot->sonars[i];
        ring->sonars[i] = (struct sonar){.x = from->pose.x_m,
                                         .y = from->pose.y_m,
                                         .range = {from->range_min_m, from->range_max_m},
                                         .noise = from->noise,
                                         .first_ray = first,
                                         .ray_count = sonar_rays(from)};
        if (from->specular_rad > 0) {
            ring->sonars[i].least_cos = cos(from->specular_rad);
            ring->mirrors = ring->mirrors || ring->sonars[i].least_cos > 0;
        }
        ring->reach_m =
            fmax(ring->reach_m, from->range_max_m + hypot(from->pose.x_m, from->pose.y_m));
        sonar_aim(ring->rays + first, from);
        first += sonar_rays(from);
    }
}

/* An echo does not return if the angle of incidence is too large. */
static bool sonar_is_lost(const struct sonar *sonar, const struct solid *hit, const double from[2],
                          const double along[2], double range)
{
    if (!hit || range <= 0) {
        return false;
    }
    const double at[2] = {from[0] + range * along[0], from[1] + range * along[1]};
    double normal[2];
    solid_normal(hit, at, normal);
    return -(along[0] * normal[0] + along[1] * normal[1]) < sonar->least_cos;
}

static double sonar_cast(const struct sonar *sonar, const struct sensing *at, const double from[2],
                         const double along[2])
{
    if (sonar->least_cos <= 0) {
        return grid_ray(at->grid, at->self, from, along, sonar->range.max_m);
    }
    const struct solid *hit;
    struct grid_eye eye = {at->self, SOLID_ECHOES};
    double range = grid_find(at->grid, eye, from, along, sonar->range.max_m, &hit);
    return sonar_is_lost(sonar, hit, from, along, range) ? sonar->range.max_m : range;
}

/* Casts the rays of a ring one by one, through the grid. */
static void sonar_cast_each(const struct sonar_ring *ring, struct sensing *at)
{
    struct fan_rays *rays = &at->rays;
    for (size_t i = 0; i < ring->count; i++) {
        const struct sonar *sonar = &ring->sonars[i];
        for (uint32_t k = sonar->first_ray; k < sonar->first_ray + sonar->ray_count; k++) {
            const double from[2] = {rays->from_x[k], rays->from_y[k]};
            const double along[2] = {rays->along_x[k], rays->along_y[k]};
            rays->range_m[k] = sonar_cast(sonar, at, from, along);
        }
    }
}

static void sonar_along(const struct sonar_ring *ring, size_t i, const struct sensing *at,
                        uint32_t k, double along[2])
{
    const struct sonar *sonar = &ring->sonars[i];
    const struct sonar_ray *ray = &ring->rays[k];
    const struct frame *robot = &at->robot;
    along[0] = robot->c * ray->x - robot->s * ray->y;
    along[1] = robot->s * ray->x + robot->c * ray->y;
    if (sonar->noise.angle_rad > 0) { /* the noise turns the whole cone */
        noise_turn(&sonar->noise, along, draw_bits(at->key, i + MU_SONARS_MAX));
    }
}

static void sonar_put_ray(struct fan_rays *rays, size_t k, const double from[2],
                          const double along[2], double range_m)
{
    rays->from_x[k] = from[0];
    rays->from_y[k] = from[1];
    rays->along_x[k] = along[0];
    rays->along_y[k] = along[1];
    rays->range_m[k] = range_m;
}

/* Places the rays of a ring in the world. */
static void sonar_put_rays(const struct sonar_ring *ring, struct sensing *at)
{
    const struct frame *robot = &at->robot;
    double from[2] = {0, 0};
    double along[2] = {1, 0};
    for (size_t i = 0; i < ring->count; i++) {
        const struct sonar *sonar = &ring->sonars[i];
        from[0] = robot->x + robot->c * sonar->x - robot->s * sonar->y;
        from[1] = robot->y + robot->s * sonar->x + robot->c * sonar->y;
        for (uint32_t k = sonar->first_ray; k < sonar->first_ray + sonar->ray_count; k++) {
            sonar_along(ring, i, at, k, along);
            sonar_put_ray(&at->rays, k, from, along, sonar->range.max_m);
        }
    }
    for (size_t k = ring->ray_count; k % FAN_PAD != 0; k++) {
        sonar_put_ray(&at->rays, k, from, along, 0);
    }
    at->rays.count = ring->ray_count;
    at->rays.returns = SOLID_ECHOES;
}

/* Computes the reading of a sonar from its nearest echo. */
static float sonar_tell(const struct sonar *sonar, size_t i, const struct sensing *at)
{
    const double *range_m = at->rays.range_m;
    double nearest = sonar->range.max_m;
    for (uint32_t k = sonar->first_ray; k < sonar->first_ray + sonar->ray_count; k++) {
        nearest = range_m[k] < nearest ? range_m[k] : nearest;
    }
    if (!noise_is_exact(&sonar->noise)) {
        nearest = noise_range(&sonar->noise, &sonar->range, nearest, draw_bits(at->key, i));
    }
    return (float)noise_clip(&sonar->range, nearest);
}

void sonar_read(const struct sonar_ring *ring, struct sensing *at, float range_m[])
{
    struct gather_circle circle = {at->robot.x, at->robot.y, ring->reach_m + SONAR_SLACK_M};
    at->key = sensing_key(at, DRAW_SONAR);
    sonar_put_rays(ring, at);
    if (ring->mirrors || !gather_cast(at->gather, &circle, at->self, &at->rays, at->near.found)) {
        sonar_cast_each(ring, at);
    }
    for (size_t i = 0; i < ring->count; i++) {
        range_m[i] = sonar_tell(&ring->sonars[i], i, at);
    }
}
