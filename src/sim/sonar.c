/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/sonar.h"

#include "muster/memory.h"

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
    ring->count = robot->sonar_count;
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
        }
        sonar_aim(ring->rays + first, from);
        first += sonar_rays(from);
    }
}

/* Sound that comes in too flat goes on instead of coming back. */
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

static double sonar_cast(const struct sonar *sonar, const struct grid *grid, int32_t self,
                         const double from[2], const double along[2])
{
    if (sonar->least_cos <= 0) {
        return grid_ray(grid, self, from, along, sonar->range.max_m);
    }
    const struct solid *hit;
    struct grid_eye eye = {self, SOLID_ECHOES};
    double range = grid_find(grid, eye, from, along, sonar->range.max_m, &hit);
    return sonar_is_lost(sonar, hit, from, along, range) ? sonar->range.max_m : range;
}

static double sonar_hear(const struct sonar_ring *ring, size_t i, const struct grid *grid,
                         const struct sonar_place *place)
{
    const struct sonar *sonar = &ring->sonars[i];
    const struct frame *robot = &place->robot;
    const double from[2] = {robot->x + robot->c * sonar->x - robot->s * sonar->y,
                            robot->y + robot->s * sonar->x + robot->c * sonar->y};
    double nearest = sonar->range.max_m;
    for (uint32_t k = sonar->first_ray; k < sonar->first_ray + sonar->ray_count; k++) {
        const struct sonar_ray *ray = &ring->rays[k];
        double along[2] = {robot->c * ray->x - robot->s * ray->y,
                           robot->s * ray->x + robot->c * ray->y};
        if (sonar->noise.angle_rad > 0) { /* the whole cone is turned */
            noise_turn(&sonar->noise, along, draw_bits(place->key, i + MU_SONARS_MAX));
        }
        double range = sonar_cast(sonar, grid, place->self, from, along);
        nearest = range < nearest ? range : nearest;
    }
    return nearest;
}

void sonar_read(const struct sonar_ring *ring, const struct grid *grid,
                const struct sonar_place *place, float range_m[])
{
    for (size_t i = 0; i < ring->count; i++) {
        const struct sonar *sonar = &ring->sonars[i];
        double range = sonar_hear(ring, i, grid, place);
        if (!noise_is_exact(&sonar->noise)) {
            range = noise_range(&sonar->noise, &sonar->range, range, draw_bits(place->key, i));
        }
        range_m[i] = (float)noise_clip(&sonar->range, range);
    }
}
