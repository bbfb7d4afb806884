/* SPDX-License-Identifier: Apache-2.0 */
/* Whether robots and things stand where they can: the only file of muster that sees libccd. */
#include "world/model/world.h"

#include <ccd/ccd.h>
#include <ccd/vec3.h>
#include <math.h>
#include <stdio.h>

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

/* Not less than the radius around a shape; most pairs are told apart by it. */
static double place_reach(const struct world_shape *s)
{
    return s->kind == WORLD_DISC ? s->radius_m : s->half_x_m + s->half_y_m;
}

/* @return whether two shapes overlap */
static bool place_overlaps(const struct world_shape *a, const struct world_shape *b)
{
    double reach = place_reach(a) + place_reach(b);
    if (fabs(a->pose.x_m - b->pose.x_m) > reach || fabs(a->pose.y_m - b->pose.y_m) > reach) {
        return false;
    }
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

/* @return the outline of a robot, as it stands */
static struct world_shape place_outline(const struct world_robot *robot)
{
    struct world_pose middle = {robot->origin_x_m, robot->origin_y_m, 0};
    return (struct world_shape){.kind = WORLD_BOX,
                                .pose = world_pose_in(robot->pose, middle),
                                .half_x_m = robot->length_m / 2,
                                .half_y_m = robot->width_m / 2};
}

/* The case of a gripper with its paddles open, in front of its robot. */
static struct world_shape place_gripper(const struct world_robot *robot)
{
    const struct world_gripper *g = &robot->gripper;
    struct world_pose middle = world_pose_in(robot->pose, g->pose);
    return (struct world_shape){
        .kind = WORLD_BOX,
        .pose = world_pose_in(middle, (struct world_pose){g->paddle_length_m / 2, 0, 0}),
        .half_x_m = (g->length_m + g->paddle_length_m) / 2,
        .half_y_m = g->width_m / 2};
}

/* Around all fixed shapes; robots do not widen it. */
struct place_bounds {
    double min[2], max[2];
};

static struct place_bounds place_bounds_of(const struct world_shape *s)
{
    bool disc = s->kind == WORLD_DISC;
    double c = fabs(cos(s->pose.heading_rad));
    double sine = fabs(sin(s->pose.heading_rad));
    double x = disc ? s->radius_m : c * s->half_x_m + sine * s->half_y_m;
    double y = disc ? s->radius_m : sine * s->half_x_m + c * s->half_y_m;
    return (struct place_bounds){{s->pose.x_m - x, s->pose.y_m - y},
                                 {s->pose.x_m + x, s->pose.y_m + y}};
}

static void place_cover(struct place_bounds *all, const struct place_bounds *one)
{
    for (size_t k = 0; k < 2; k++) {
        all->min[k] = fmin(all->min[k], one->min[k]);
        all->max[k] = fmax(all->max[k], one->max[k]);
    }
}

static struct place_bounds place_measure(const struct world *world)
{
    struct place_bounds b = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    for (size_t i = 0; i < world->shape_count; i++) {
        struct place_bounds one = place_bounds_of(&world->shapes[i]);
        place_cover(&b, &one);
    }
    return b;
}

struct world_shape placement_room(const struct world_robot *robot)
{
    if (!(robot->gripper.length_m > 0)) {
        return place_outline(robot);
    }
    struct world_robot here = *robot; /* in its own frame, boxes are covered by upright ones */
    here.pose = (struct world_pose){0};
    const struct world_shape parts[2] = {place_outline(&here), place_gripper(&here)};
    struct place_bounds all = place_bounds_of(&parts[0]);
    struct place_bounds gripper = place_bounds_of(&parts[1]);
    place_cover(&all, &gripper);
    struct world_pose middle = {(all.min[0] + all.max[0]) / 2, (all.min[1] + all.max[1]) / 2, 0};
    return (struct world_shape){.kind = WORLD_BOX,
                                .pose = world_pose_in(robot->pose, middle),
                                .half_x_m = (all.max[0] - all.min[0]) / 2,
                                .half_y_m = (all.max[1] - all.min[1]) / 2};
}

/* A thing being checked, and the words for it in a fault. */
struct place_thing {
    const struct world_shape *shape;
    const char *what, *name; /* "robot", "red" */
    const struct mu_fault_place *at;
};

static mu_result place_fault(const struct place_thing *thing, struct mu_fault *fault,
                             const char *text)
{
    return mu_fault_at(fault, thing->at->file, thing->at->line, thing->at->column,
                       "%s '%s' at %.3f %.3f %s", thing->what, thing->name, thing->shape->pose.x_m,
                       thing->shape->pose.y_m, text);
}

static mu_result place_check_bounds(const struct world *world, const struct place_bounds *bounds,
                                    const struct place_thing *thing, struct mu_fault *fault)
{
    const struct world_pose *pose = &thing->shape->pose;
    bool outside = pose->x_m < bounds->min[0] || pose->x_m > bounds->max[0] ||
                   pose->y_m < bounds->min[1] || pose->y_m > bounds->max[1];
    return world->shape_count > 0 && outside ? place_fault(thing, fault, "stands outside the world")
                                             : MU_OK;
}

static mu_result place_check_shapes(const struct world *world, const struct place_thing *thing,
                                    struct mu_fault *fault)
{
    char text[80];
    for (size_t i = 0; i < world->shape_count; i++) {
        const struct world_shape *shape = &world->shapes[i];
        if (shape->look.stops && place_overlaps(thing->shape, shape)) {
            snprintf(text, sizeof text, "overlaps an obstacle at %.3f %.3f", shape->pose.x_m,
                     shape->pose.y_m);
            return place_fault(thing, fault, text);
        }
    }
    return MU_OK;
}

/* Checks against the first robots, without one; robots that stop no bodies are passed over. */
static mu_result place_check_robots(const struct world *world, size_t count, size_t own,
                                    const struct place_thing *thing, struct mu_fault *fault)
{
    char text[64];
    for (size_t i = 0; i < count; i++) {
        struct world_shape other = place_outline(&world->robots[i]);
        if (i != own && world->robots[i].look.stops && place_overlaps(thing->shape, &other)) {
            snprintf(text, sizeof text, "overlaps robot '%s'", world->robots[i].name);
            return place_fault(thing, fault, text);
        }
    }
    return MU_OK;
}

static mu_result place_check_robot(const struct world *world, size_t index,
                                   const struct place_bounds *bounds, struct mu_fault *fault)
{
    const struct world_robot *robot = &world->robots[index];
    const struct mu_fault_place *at = &world->origins[index].at;
    struct world_shape outline = place_outline(robot);
    struct place_thing thing = {&outline, "robot", robot->name, at};
    if (!robot->look.stops) {
        return place_check_bounds(world, bounds, &thing, fault);
    }
    MU_TRY(place_check_bounds(world, bounds, &thing, fault));
    MU_TRY(place_check_shapes(world, &thing, fault));
    MU_TRY(place_check_robots(world, index, index, &thing, fault));
    if (robot->gripper.length_m > 0) {
        struct world_shape gripper = place_gripper(robot);
        struct place_thing zone = {&gripper, "the gripper of robot", robot->name, at};
        MU_TRY(place_check_shapes(world, &zone, fault));
        MU_TRY(place_check_robots(world, world->robot_count, index, &zone, fault));
    }
    return MU_OK;
}

static mu_result place_check_object(const struct world *world, size_t index,
                                    const struct place_bounds *bounds, struct mu_fault *fault)
{
    const struct world_object *object = &world->objects[index];
    struct place_thing thing = {&object->shape, "thing", object->name,
                                &world->object_origins[index].at};
    char text[64];
    MU_TRY(place_check_bounds(world, bounds, &thing, fault));
    MU_TRY(place_check_shapes(world, &thing, fault));
    MU_TRY(place_check_robots(world, world->robot_count, SIZE_MAX, &thing, fault));
    for (size_t i = 0; i < index; i++) {
        if (place_overlaps(&object->shape, &world->objects[i].shape)) {
            snprintf(text, sizeof text, "overlaps thing '%s'", world->objects[i].name);
            return place_fault(&thing, fault, text);
        }
    }
    return MU_OK;
}

/* Where a listener hears of all, the search goes on.  @return whether it ends here */
static bool place_ends(mu_result result, const struct mu_fault_listener *listener,
                       const struct mu_fault *fault, size_t *mistakes)
{
    if (result != MU_OK && listener) {
        listener->tell(listener->self, fault, true);
        return ++*mistakes == MU_FAULT_MISTAKES_MAX;
    }
    return result != MU_OK;
}

mu_result world_check_places(const struct world *world, const struct mu_fault_listener *listener,
                             struct mu_fault *fault)
{
    struct place_bounds bounds = place_measure(world);
    size_t mistakes = 0;
    for (size_t i = 0; i < world->robot_count; i++) {
        if (!world->origins[i].misplaced &&
            place_ends(place_check_robot(world, i, &bounds, fault), listener, fault, &mistakes)) {
            return MU_FAULT_FILE;
        }
    }
    for (size_t i = 0; i < world->object_count; i++) {
        if (place_ends(place_check_object(world, i, &bounds, fault), listener, fault, &mistakes)) {
            return MU_FAULT_FILE;
        }
    }
    return mistakes > 0 ? MU_FAULT_FILE : MU_OK;
}

bool placement_is_free(const struct world *world, const struct world_shape *shape, size_t robot)
{
    for (size_t i = 0; i < world->shape_count; i++) {
        if (world->shapes[i].look.stops && place_overlaps(shape, &world->shapes[i])) {
            return false;
        }
    }
    for (size_t i = 0; i < world->object_count; i++) {
        if (place_overlaps(shape, &world->objects[i].shape)) {
            return false;
        }
    }
    for (size_t i = 0; i < world->robot_count; i++) {
        struct world_shape room = placement_room(&world->robots[i]);
        if (i != robot && world->robots[i].look.stops && place_overlaps(shape, &room)) {
            return false;
        }
    }
    return true;
}

bool world_robot_fits(const struct world *world, const char *name, double clear_m)
{
    const struct world_robot *robot = world_find_robot(world, name);
    if (!robot) {
        return false;
    }
    struct place_bounds bounds = place_measure(world);
    struct world_shape outline = place_outline(robot);
    struct world_pose pose = robot->pose;
    outline.half_x_m += clear_m;
    outline.half_y_m += clear_m;
    bool inside = pose.x_m >= bounds.min[0] && pose.x_m <= bounds.max[0] &&
                  pose.y_m >= bounds.min[1] && pose.y_m <= bounds.max[1];
    return inside && placement_is_free(world, &outline, (size_t)(robot - world->robots));
}
