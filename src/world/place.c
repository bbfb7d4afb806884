/* SPDX-License-Identifier: Apache-2.0 */
/* Whether robots stand where they can: the only file of muster that sees libccd. */
#include "world/builder.h"

#include <ccd/ccd.h>
#include <ccd/vec3.h>
#include <math.h>

/* libccd works in space: flat things become slabs of this half height. */
#define PLACE_HALF_HEIGHT_M 0.5

static double place_radius(const struct world_shape *s)
{
    return s->kind == WORLD_DISC ? s->radius_m : hypot(s->half_x_m, s->half_y_m);
}

/* The farthest point of a shape in a direction. */
static void place_support(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *point)
{
    const struct world_shape *s = object;
    double dx = direction->v[0];
    double dy = direction->v[1];
    double x = s->pose.x_m;
    double y = s->pose.y_m;
    if (s->kind == WORLD_BOX) {
        double c = cos(s->pose.heading_rad);
        double sine = sin(s->pose.heading_rad);
        double along = c * dx + sine * dy < 0 ? -s->half_x_m : s->half_x_m;
        double across = c * dy - sine * dx < 0 ? -s->half_y_m : s->half_y_m;
        x += c * along - sine * across;
        y += sine * along + c * across;
    } else {
        double len = hypot(dx, dy);
        if (len > 1e-12) {
            x += s->radius_m * dx / len;
            y += s->radius_m * dy / len;
        }
    }
    ccdVec3Set(point, x, y, direction->v[2] < 0 ? -PLACE_HALF_HEIGHT_M : PLACE_HALF_HEIGHT_M);
}

static void place_center(const void *object, ccd_vec3_t *center)
{
    const struct world_shape *s = object;
    ccdVec3Set(center, s->pose.x_m, s->pose.y_m, 0);
}

static bool place_overlaps(const struct world_shape *a, const struct world_shape *b)
{
    if (hypot(a->pose.x_m - b->pose.x_m, a->pose.y_m - b->pose.y_m) >
        place_radius(a) + place_radius(b)) {
        return false;
    }
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = place_support;
    ccd.support2 = place_support;
    ccd.center1 = place_center;
    ccd.center2 = place_center;
    ccd.max_iterations = 100;
    return ccdGJKIntersect(a, b, &ccd) != 0;
}

static struct world_shape place_outline(const struct world_robot *robot)
{
    struct world_pose middle = {robot->origin_x_m, robot->origin_y_m, 0};
    return (struct world_shape){.kind = WORLD_BOX,
                                .pose = world_pose_in(robot->pose, middle),
                                .half_x_m = robot->length_m / 2,
                                .half_y_m = robot->width_m / 2};
}

/* Around what stands: robots do not widen it. */
struct place_bounds {
    double min[2], max[2];
};

static struct place_bounds place_measure(const struct world *world)
{
    struct place_bounds b = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    for (size_t i = 0; i < world->shape_count; i++) {
        const struct world_shape *s = &world->shapes[i];
        bool disc = s->kind == WORLD_DISC;
        double c = fabs(cos(s->pose.heading_rad));
        double sine = fabs(sin(s->pose.heading_rad));
        double x = disc ? s->radius_m : c * s->half_x_m + sine * s->half_y_m;
        double y = disc ? s->radius_m : sine * s->half_x_m + c * s->half_y_m;
        b.min[0] = fmin(b.min[0], s->pose.x_m - x);
        b.max[0] = fmax(b.max[0], s->pose.x_m + x);
        b.min[1] = fmin(b.min[1], s->pose.y_m - y);
        b.max[1] = fmax(b.max[1], s->pose.y_m + y);
    }
    return b;
}

static mu_result place_check_robot(const struct world *world, size_t index,
                                   const struct place_bounds *bounds, struct mu_fault *fault)
{
    const struct world_robot *robot = &world->robots[index];
    const struct worldfile_place *at = &world->source->origins[index].at;
    struct world_shape outline = place_outline(robot);
    if (world->shape_count > 0 &&
        (robot->pose.x_m < bounds->min[0] || robot->pose.x_m > bounds->max[0] ||
         robot->pose.y_m < bounds->min[1] || robot->pose.y_m > bounds->max[1])) {
        return mu_fault_at(fault, at->file, at->line, at->column,
                           "robot '%s' stands outside the world, at %.3f %.3f", robot->name,
                           robot->pose.x_m, robot->pose.y_m);
    }
    for (size_t i = 0; i < world->shape_count; i++) {
        if (place_overlaps(&outline, &world->shapes[i])) {
            return mu_fault_at(fault, at->file, at->line, at->column,
                               "robot '%s' at %.3f %.3f overlaps an obstacle at %.3f %.3f",
                               robot->name, robot->pose.x_m, robot->pose.y_m,
                               world->shapes[i].pose.x_m, world->shapes[i].pose.y_m);
        }
    }
    for (size_t i = 0; i < index; i++) {
        struct world_shape other = place_outline(&world->robots[i]);
        if (place_overlaps(&outline, &other)) {
            return mu_fault_at(fault, at->file, at->line, at->column,
                               "robot '%s' at %.3f %.3f overlaps robot '%s'", robot->name,
                               robot->pose.x_m, robot->pose.y_m, world->robots[i].name);
        }
    }
    return MU_OK;
}

mu_result place_check(const struct world *world, struct mu_fault *fault)
{
    struct place_bounds bounds = place_measure(world);
    for (size_t i = 0; i < world->robot_count; i++) {
        MU_TRY(place_check_robot(world, i, &bounds, fault));
    }
    return MU_OK;
}

static bool place_hits_shape(const struct world *world, const struct world_shape *outline)
{
    for (size_t i = 0; i < world->shape_count; i++) {
        if (place_overlaps(outline, &world->shapes[i])) {
            return true;
        }
    }
    return false;
}

bool place_fits(const struct world *world, size_t robot, double clear_m)
{
    struct place_bounds bounds = place_measure(world);
    struct world_shape outline = place_outline(&world->robots[robot]);
    struct world_pose pose = world->robots[robot].pose;
    outline.half_x_m += clear_m;
    outline.half_y_m += clear_m;
    if (pose.x_m < bounds.min[0] || pose.x_m > bounds.max[0] || pose.y_m < bounds.min[1] ||
        pose.y_m > bounds.max[1] || place_hits_shape(world, &outline)) {
        return false;
    }
    for (size_t i = 0; i < world->robot_count; i++) {
        struct world_shape other = place_outline(&world->robots[i]);
        if (i != robot && place_overlaps(&outline, &other)) {
            return false;
        }
    }
    return true;
}
