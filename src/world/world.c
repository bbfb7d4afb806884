/* SPDX-License-Identifier: Apache-2.0 */
#include "world/world.h"

#include "core/name.h"
#include "core/text.h"
#include "muster/memory.h"
#include "world/builder.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct world_walk {
    struct builder *builder;
    struct world_pose frame;
    int depth;
};

static mu_result world_visit(void *context, const struct worldfile_entity *entity);

struct world_pose world_pose_in(struct world_pose frame, struct world_pose pose)
{
    double c = cos(frame.heading_rad);
    double s = sin(frame.heading_rad);
    double heading = remainder(frame.heading_rad + pose.heading_rad, 2 * M_PI);
    return (struct world_pose){.x_m = frame.x_m + c * pose.x_m - s * pose.y_m,
                               .y_m = frame.y_m + s * pose.x_m + c * pose.y_m,
                               .heading_rad = heading <= -M_PI ? M_PI : heading};
}

static struct world_robot *world_find_robot(const struct world *world, const char *name)
{
    for (size_t i = 0; i < world->robot_count; i++) {
        if (strcmp(world->robots[i].name, name) == 0) {
            return &world->robots[i];
        }
    }
    return NULL;
}

static mu_result world_visit_robot(struct world_walk *walk, const struct worldfile_entity *entity)
{
    struct builder *b = walk->builder;
    struct world *world = b->world;
    if (world->robot_count == MU_ROBOTS_MAX) {
        return builder_fault(b, &entity->at, "more than %d robots", MU_ROBOTS_MAX);
    }
    struct world_robot *robot = &world->robots[world->robot_count];
    MU_TRY(body_read(b, entity, walk->frame, robot));
    if (robot->name[0] != '\0' && world_find_robot(world, robot->name)) {
        struct worldfile_place at = builder_place(entity, "name");
        return builder_fault(b, &at, "expected another name: there is a robot '%s' already",
                             robot->name);
    }
    world->source->origins[world->robot_count++] =
        (struct worldfile_origin){.at = entity->at, .type = entity->type};
    return MU_OK;
}

static mu_result world_visit_solid(struct world_walk *walk, const struct worldfile_entity *entity)
{
    struct builder *b = walk->builder;
    struct world_walk inside = {.builder = b, .depth = walk->depth + 1};
    builder_warn_unknown(b, entity, BUILDER_SOLID);
    MU_TRY(builder_pose(b, entity, walk->frame, &inside.frame));
    MU_TRY(solid_build(b, entity, inside.frame));
    return builder_children(entity, world_visit, &inside);
}

static mu_result world_visit_nothing(struct world_walk *walk, const struct worldfile_entity *entity)
{
    (void)walk;
    (void)entity;
    return MU_OK;
}

static mu_result world_visit(void *context, const struct worldfile_entity *entity)
{
    static const struct {
        const char *kind;
        mu_result (*visit)(struct world_walk *walk, const struct worldfile_entity *entity);
    } kinds[] = {
        {"model", world_visit_solid},
        {"position", world_visit_robot},
        {"block", world_visit_nothing}, /* its model has seen to it */
        {"window", world_visit_nothing},
    };
    struct world_walk *walk = context;
    struct builder *b = walk->builder;
    if (b->model_count++ == BUILDER_MODELS_MAX) {
        return builder_fault(b, &entity->at, "more than %d models", BUILDER_MODELS_MAX);
    }
    if (walk->depth > BUILDER_NESTING_MAX) {
        return builder_fault(b, &entity->at, "models nest deeper than %d", BUILDER_NESTING_MAX);
    }
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (strcmp(kinds[i].kind, worldfile_kind(entity)) == 0) {
            return kinds[i].visit(walk, entity);
        }
    }
    return builder_skip_model(b, entity);
}

/* Robots without a name get their type's and a number, as in Stage (which writes type:0). */
static void world_name_robots(struct world *world)
{
    for (size_t i = 0; i < world->robot_count; i++) {
        const char *type = world->source->origins[i].type;
        if (world->robots[i].name[0] != '\0') {
            continue;
        }
        char name[MU_NAME_MAX + 1];
        snprintf(name, sizeof name, "%.20s_0", type);
        const char *stem = mu_name_valid(name) ? type : "robot";
        size_t number = 0;
        do {
            snprintf(name, sizeof name, "%.20s_%zu", stem, number++);
        } while (world_find_robot(world, name));
        mu_text_copy(world->robots[i].name, sizeof world->robots[i].name, name);
    }
}

/* Widens the world's bounds around a box; a disc is covered by an upright one. */
static void world_cover(struct world *world, struct world_pose middle, double half_x_m,
                        double half_y_m)
{
    double c = fabs(cos(middle.heading_rad));
    double s = fabs(sin(middle.heading_rad));
    double x = c * half_x_m + s * half_y_m;
    double y = s * half_x_m + c * half_y_m;
    world->min_x_m = fmin(world->min_x_m, middle.x_m - x);
    world->min_y_m = fmin(world->min_y_m, middle.y_m - y);
    world->max_x_m = fmax(world->max_x_m, middle.x_m + x);
    world->max_y_m = fmax(world->max_y_m, middle.y_m + y);
}

static void world_measure(struct world *world)
{
    if (world->shape_count + world->robot_count == 0) {
        world->min_x_m = world->min_y_m = world->max_x_m = world->max_y_m = 0;
        return;
    }
    world->min_x_m = world->min_y_m = INFINITY;
    world->max_x_m = world->max_y_m = -INFINITY;
    for (size_t i = 0; i < world->shape_count; i++) {
        const struct world_shape *s = &world->shapes[i];
        bool disc = s->kind == WORLD_DISC;
        struct world_pose middle = {s->pose.x_m, s->pose.y_m, disc ? 0 : s->pose.heading_rad};
        world_cover(world, middle, disc ? s->radius_m : s->half_x_m,
                    disc ? s->radius_m : s->half_y_m);
    }
    for (size_t i = 0; i < world->robot_count; i++) {
        const struct world_robot *r = &world->robots[i];
        struct world_pose outline = {r->origin_x_m, r->origin_y_m, 0};
        world_cover(world, world_pose_in(r->pose, outline), r->length_m / 2, r->width_m / 2);
    }
}

mu_result world_load(struct world *world, const char *path, bool quiet, struct mu_fault *fault)
{
    *world = (struct world){0};
    if (!mu_text_copy(world->file, sizeof world->file, path)) {
        return mu_fault_at(fault, path, 0, 0, "expected a shorter path");
    }
    world->source = mu_startup_alloc(sizeof *world->source);
    world->shapes = mu_startup_array(BUILDER_SHAPES_MAX, sizeof *world->shapes);
    world->robots = mu_startup_array(MU_ROBOTS_MAX, sizeof *world->robots);
    world->objects = mu_startup_array(MU_OBJECTS_MAX, sizeof *world->objects);
    world->seed = -1;
    worldfile_init(world->source);
    MU_TRY(worldfile_parse(world->source, path, fault));
    world->source->origins =
        worldfile_take(world->source, MU_ROBOTS_MAX * sizeof *world->source->origins);
    if (!world->source->origins) {
        return mu_fault_at(fault, path, 0, 0, "the world is too large");
    }
    struct builder b = {.world = world, .fault = fault, .quiet = quiet};
    builder_warn_unknown(&b, &world->source->root, BUILDER_WORLD);
    struct world_walk walk = {.builder = &b};
    MU_TRY(builder_children(&world->source->root, world_visit, &walk));
    world_name_robots(world);
    world_measure(world);
    return MU_OK;
}

/* Whether a name belongs to a model of the file that is no robot. */
static bool world_names_thing(const struct world *world, const char *name)
{
    for (const struct worldfile_entity *e = world->source->root.children; e; e = e->next) {
        const struct worldfile_property *p = worldfile_property(e, "name");
        if (p && p->value_count == 1 && p->values[0].text && strcmp(p->values[0].text, name) == 0 &&
            strcmp(worldfile_kind(e), "position") != 0) {
            return true;
        }
    }
    return false;
}

static mu_result world_unknown_body(const struct world *world, const char *body,
                                    struct mu_fault *fault)
{
    char known[160];
    struct mu_text text;
    mu_text_init(&text, known, sizeof known);
    for (const struct worldfile_entity *e = world->source->definitions; e; e = e->next) {
        if (strcmp(worldfile_kind(e), "position") == 0) {
            mu_text_format(&text, "%s%s", text.len ? " " : "", e->defines);
        }
    }
    return mu_fault_at(fault, world->file, 0, 0,
                       "expected a body that the world defines (%s), found '%.40s'", known, body);
}

/* Reads the robot anew, or takes the one that is there. */
static mu_result world_take_body(struct world *world, const struct world_robot *old,
                                 const char *body, struct world_robot *robot,
                                 struct mu_fault *fault)
{
    if (!body) {
        *robot = *old;
        return MU_OK;
    }
    const struct worldfile_entity *definition = worldfile_definition(world->source, body);
    if (!definition || strcmp(worldfile_kind(definition), "position") != 0) {
        return world_unknown_body(world, body, fault);
    }
    struct builder b = {.world = world, .fault = fault, .quiet = true};
    MU_TRY(body_read(&b, definition, (struct world_pose){0}, robot));
    if (old) {
        robot->pose = old->pose;
        memcpy(robot->color, old->color, sizeof robot->color);
    }
    return MU_OK;
}

static mu_result world_check_added(const struct world *world, const char *name, const char *body,
                                   const struct world_pose *pose, struct mu_fault *fault)
{
    const char *file = world->file;
    if (!mu_name_valid(name) || mu_name_reserved(name)) {
        return mu_fault_at(fault, file, 0, 0, "expected a robot's name, found '%.40s'", name);
    }
    if (world_names_thing(world, name)) {
        return mu_fault_at(fault, file, 0, 0, "'%s' is not a robot in this world", name);
    }
    if (pose && !(fabs(pose->x_m) <= BUILDER_POSE_MAX_M && fabs(pose->y_m) <= BUILDER_POSE_MAX_M &&
                  isfinite(pose->heading_rad))) {
        return mu_fault_at(fault, file, 0, 0, "robot '%s': expected a place within %g m", name,
                           BUILDER_POSE_MAX_M);
    }
    if (world_find_robot(world, name)) {
        return MU_OK;
    }
    if (!body) {
        return mu_fault_at(fault, file, 0, 0,
                           "robot '%s' does not stand in this world, and no body is given", name);
    }
    if (world->robot_count == MU_ROBOTS_MAX) {
        return mu_fault_at(fault, file, 0, 0, "more than %d robots", MU_ROBOTS_MAX);
    }
    const struct worldfile_entity *definition = worldfile_definition(world->source, body);
    if (!pose && definition && !worldfile_property(definition, "pose")) {
        return mu_fault_at(fault, file, 0, 0, "robot '%s': expected a pose", name);
    }
    return MU_OK;
}

mu_result world_add_robot(struct world *world, const char *name, const char *body,
                          const struct world_pose *pose, const char *color, struct mu_fault *fault)
{
    MU_TRY(world_check_added(world, name, body, pose, fault));
    struct world_robot *old = world_find_robot(world, name);
    struct world_robot robot;
    MU_TRY(world_take_body(world, old, body, &robot, fault));
    mu_text_copy(robot.name, sizeof robot.name, name);
    if (pose) {
        robot.pose = world_pose_in((struct world_pose){0}, *pose);
    }
    if (color && !mu_text_copy(robot.color, sizeof robot.color, color)) {
        return mu_fault_at(fault, world->file, 0, 0, "robot '%s': expected a shorter colour", name);
    }
    if (!old) {
        world->source->origins[world->robot_count] =
            (struct worldfile_origin){.at = {.file = world->file}, .type = body};
        old = &world->robots[world->robot_count++];
    }
    *old = robot;
    world_measure(world);
    return MU_OK;
}

bool world_robot_fits(const struct world *world, const char *name, double clear_m)
{
    const struct world_robot *robot = world_find_robot(world, name);
    return robot && place_fits(world, (size_t)(robot - world->robots), clear_m);
}

mu_result world_check_places(const struct world *world, struct mu_fault *fault)
{
    return place_check(world, fault);
}
