/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Robots and things at random places: `distribute ( model puck count 20 region [x0 y0 x1 y1] )`.
 *
 * Each gets a place and a heading where it overlaps nothing that stops, with a gap around it.
 * The places come of the world's seed and of the order of the file alone.
 */
#include "core/random.h"
#include "world/read/builder.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { DISTRIBUTE_TRIES = 1000 }; /* for each */

struct distribute {
    struct builder *builder;
    const struct worldfile_entity *entity; /* the `distribute` itself */
    const struct worldfile_entity *model;  /* the definition of the body */
    bool is_robot;
    uint32_t count;
    double region_m[4]; /* x0 y0 x1 y1 */
    double gap_m;
    struct mu_random random;
};

/* A shape with the gap around it. */
static struct world_shape distribute_widen(struct world_shape shape, double gap_m)
{
    shape.half_x_m += gap_m;
    shape.half_y_m += gap_m;
    shape.radius_m += gap_m;
    return shape;
}

static struct world_pose distribute_draw(struct distribute *d)
{
    const double *r = d->region_m;
    double x = mu_random_unit(&d->random);
    double y = mu_random_unit(&d->random);
    double turn = mu_random_unit(&d->random);
    return (struct world_pose){r[0] + x * (r[2] - r[0]), r[1] + y * (r[3] - r[1]),
                               remainder(turn * 2 * M_PI, 2 * M_PI)};
}

/* Whether all of a shape lies in the region at any heading. */
static bool distribute_is_inside(const struct distribute *d, const struct world_shape *shape)
{
    double c = fabs(cos(shape->pose.heading_rad));
    double s = fabs(sin(shape->pose.heading_rad));
    bool disc = shape->kind == WORLD_DISC;
    double x = disc ? shape->radius_m : c * shape->half_x_m + s * shape->half_y_m;
    double y = disc ? shape->radius_m : s * shape->half_x_m + c * shape->half_y_m;
    const double *r = d->region_m;
    return shape->pose.x_m - x >= r[0] && shape->pose.x_m + x <= r[2] &&
           shape->pose.y_m - y >= r[1] && shape->pose.y_m + y <= r[3];
}

/*
 * Finds a place for a shape that is given about a pose of zero.
 *
 * @return whether there was one among so many tries
 */
static bool distribute_find(struct distribute *d, const struct world_shape *about,
                            struct world_pose *pose)
{
    struct world_shape wide = distribute_widen(*about, d->gap_m);
    for (int tries = 0; tries < DISTRIBUTE_TRIES; tries++) {
        *pose = distribute_draw(d);
        wide.pose = world_pose_in(*pose, about->pose);
        if (distribute_is_inside(d, &wide) &&
            placement_is_free(d->builder->world, &wide, PLACEMENT_NOBODY)) {
            return true;
        }
    }
    return false;
}

static mu_result distribute_no_room(struct distribute *d, uint32_t placed)
{
    return builder_fault(d->builder, &d->entity->at,
                         "expected room for %u of '%.40s', found it for %u in %d tries each",
                         d->count, d->model->defines, placed, DISTRIBUTE_TRIES);
}

static mu_result distribute_robots(struct distribute *d)
{
    struct builder *b = d->builder;
    struct world *world = b->world;
    struct world_robot robot;
    MU_TRY(body_read(b, d->model, (struct world_pose){0}, &robot));
    robot.pose = (struct world_pose){0};
    robot.name[0] = '\0';
    struct world_shape about = placement_room(&robot);
    for (uint32_t i = 0; i < d->count; i++) {
        if (world->robot_count == MU_ROBOTS_MAX) {
            return builder_full(b, &d->entity->at, "more than %d robots", MU_ROBOTS_MAX);
        }
        if (!distribute_find(d, &about, &robot.pose)) {
            return distribute_no_room(d, i);
        }
        MU_TRY(body_read_start(b, d->model, &robot));
        world->origins[world->robot_count] = (struct world_origin){
            .at = d->entity->at, .type = d->model->defines, .entity = d->model};
        world->robots[world->robot_count++] = robot;
    }
    return MU_OK;
}

static mu_result distribute_objects(struct distribute *d)
{
    struct builder *b = d->builder;
    struct world *world = b->world;
    for (uint32_t i = 0; i < d->count; i++) {
        if (world->object_count == MU_OBJECTS_MAX) {
            return builder_full(b, &d->entity->at, "more than %d things that can be moved",
                                MU_OBJECTS_MAX);
        }
        struct world_object *object = &world->objects[world->object_count];
        MU_TRY(object_build(b, d->model, (struct world_pose){0}));
        struct world_shape about = object->shape;
        struct world_pose pose;
        world->object_count--; /* it is not in its own way */
        if (!distribute_find(d, &about, &pose)) {
            return distribute_no_room(d, i);
        }
        object->shape.pose = world_pose_in(pose, about.pose);
        object->name[0] = '\0';
        struct world_origin *origin = &world->object_origins[world->object_count++];
        origin->at = d->entity->at;
        origin->type = d->model->defines;
    }
    return MU_OK;
}

static mu_result distribute_read_model(struct distribute *d)
{
    struct builder *b = d->builder;
    const char *name = NULL;
    MU_TRY(builder_text(b, d->entity, "model", &name));
    struct mu_fault_place at = builder_place(d->entity, "model");
    if (!name) {
        return builder_fault(b, &at, "expected 'model' with what is to be distributed");
    }
    d->model = worldfile_definition(b->world->source, name);
    d->is_robot = d->model && strcmp(worldfile_kind(d->model), "position") == 0;
    if (!d->model || (!d->is_robot &&
                      (strcmp(worldfile_kind(d->model), "model") != 0 || !object_is(d->model)))) {
        return builder_fault(
            b, &at, "expected a defined robot, or a model that can be moved, found '%.40s'", name);
    }
    return MU_OK;
}

static mu_result distribute_read_region(struct distribute *d)
{
    struct builder *b = d->builder;
    double *r = d->region_m;
    memcpy(r, b->world->fixed_m, sizeof d->region_m);
    MU_TRY(builder_numbers(b, d->entity, (struct builder_numbers){"region", r, 4, 4, "llll"}));
    if (!(r[0] < r[2] && r[1] < r[3] && fabs(r[0]) <= BUILDER_POSE_MAX_M &&
          fabs(r[1]) <= BUILDER_POSE_MAX_M && fabs(r[2]) <= BUILDER_POSE_MAX_M &&
          fabs(r[3]) <= BUILDER_POSE_MAX_M)) {
        struct mu_fault_place at = builder_place(d->entity, "region");
        return builder_fault(b, &at, "expected a region [x0 y0 x1 y1] with x0 < x1 and y0 < y1%s",
                             worldfile_property(d->entity, "region") ? "" : ": nothing stands yet");
    }
    return MU_OK;
}

static mu_result distribute_one(struct builder *b, const struct worldfile_entity *entity,
                                unsigned index)
{
    struct distribute d = {.builder = b, .entity = entity, .count = 1, .gap_m = 0.05};
    char stream[32];
    builder_warn_unknown(b, entity, PROPERTY_DISTRIBUTE);
    MU_TRY(distribute_read_model(&d));
    MU_TRY(builder_count(b, entity, "count", 1e6, &d.count));
    MU_TRY(builder_number(b, entity, (struct builder_numbers){"gap", &d.gap_m, 1, 1, "l"}, 0,
                          BUILDER_POSE_MAX_M));
    MU_TRY(distribute_read_region(&d));
    snprintf(stream, sizeof stream, "distribute %u", index);
    mu_random_seed(&d.random, b->seed, stream);
    return d.is_robot ? distribute_robots(&d) : distribute_objects(&d);
}

mu_result distribute_all(struct builder *b)
{
    const struct worldfile_entity *e = b->world->source->root.children;
    unsigned index = 0;
    for (; e; e = e->next) {
        if (strcmp(worldfile_kind(e), "distribute") == 0) {
            MU_TRY(builder_go_on(b, distribute_one(b, e, index++)));
        }
    }
    return MU_OK;
}
