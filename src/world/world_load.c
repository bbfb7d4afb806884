/* SPDX-License-Identifier: Apache-2.0 */
#include "world/world_load.h"

#include "core/name.h"
#include "core/text.h"
#include "muster/memory.h"
#include "world/read/builder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct world_walk {
    struct builder *builder;
    struct world_pose frame;
    int depth;
};

static mu_result world_visit(void *context, const struct worldfile_entity *entity);

static mu_result world_visit_robot(struct world_walk *walk, const struct worldfile_entity *entity)
{
    struct builder *b = walk->builder;
    struct world *world = b->world;
    if (world->robot_count == MU_ROBOTS_MAX) {
        return builder_full(b, &entity->at, "more than %d robots", MU_ROBOTS_MAX);
    }
    struct world_robot *robot = &world->robots[world->robot_count];
    MU_TRY(body_read(b, entity, walk->frame, robot));
    if (robot->name[0] != '\0' && world_name_taken(world, robot->name)) {
        struct mu_fault_place at = builder_place(entity, "name");
        return builder_fault(b, &at, "expected another name: there is a robot '%s' already",
                             robot->name);
    }
    world->origins[world->robot_count++] = (struct world_origin){
        .at = entity->at, .type = entity->type, .entity = entity, .misplaced = b->misplaced};
    return MU_OK;
}

static mu_result world_visit_solid(struct world_walk *walk, const struct worldfile_entity *entity)
{
    struct builder *b = walk->builder;
    struct world_walk inside = {.builder = b, .depth = walk->depth + 1};
    builder_warn_unknown(b, entity, PROPERTY_SOLID);
    MU_TRY(builder_pose(b, entity, walk->frame, &inside.frame));
    if (walk->depth == 0 && object_is(entity)) {
        return object_build(b, entity, inside.frame);
    }
    MU_TRY(builder_go_on(b, solid_build(b, entity, inside.frame)));
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
        {"model", world_visit_solid},        {"position", world_visit_robot},
        {"block", world_visit_nothing},      /* its model has seen to it */
        {"distribute", world_visit_nothing}, /* comes when all else stands */
        {"window", world_visit_nothing},
    };
    struct world_walk *walk = context;
    struct builder *b = walk->builder;
    MU_TRY(builder_count_model(b, entity, walk->depth));
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (strcmp(kinds[i].kind, worldfile_kind(entity)) == 0) {
            return builder_go_on(b, kinds[i].visit(walk, entity));
        }
    }
    return builder_go_on(b, builder_skip_model(b, entity));
}

/* The stem of a name, where the last one of the same type ended. */
struct world_namer {
    const char *type;
    size_t number;
};

/* A nameless body gets its type's name and a number, as in Stage (which writes type:0). */
static void world_give_name(const struct world *world, struct world_namer *namer, const char *type,
                            char name[MU_NAME_MAX + 1])
{
    if (name[0] != '\0') {
        return;
    }
    char wanted[MU_NAME_MAX + 1];
    snprintf(wanted, sizeof wanted, "%.20s_0", type);
    const char *stem = mu_name_valid(wanted) ? type : "robot";
    if (!namer->type || strcmp(namer->type, type) != 0) {
        *namer = (struct world_namer){.type = type};
    }
    do {
        snprintf(wanted, sizeof wanted, "%.20s_%zu", stem, namer->number++);
    } while (world_name_taken(world, wanted));
    mu_text_copy(name, MU_NAME_MAX + 1, wanted);
}

/* Gives a name to each robot and thing that has none: its type and a number. */
static void world_name_all(struct world *world)
{
    struct world_namer namer = {0};
    for (size_t i = 0; i < world->robot_count; i++) {
        world_give_name(world, &namer, world->origins[i].type, world->robots[i].name);
    }
    for (size_t i = 0; i < world->object_count; i++) {
        world_give_name(world, &namer, world->object_origins[i].type, world->objects[i].name);
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

static void world_cover_shape(struct world *world, const struct world_shape *s)
{
    bool disc = s->kind == WORLD_DISC;
    struct world_pose middle = {s->pose.x_m, s->pose.y_m, disc ? 0 : s->pose.heading_rad};
    world_cover(world, middle, disc ? s->radius_m : s->half_x_m, disc ? s->radius_m : s->half_y_m);
}

static void world_measure_fixed(struct world *world)
{
    world->min_x_m = world->min_y_m = INFINITY;
    world->max_x_m = world->max_y_m = -INFINITY;
    for (size_t i = 0; i < world->shape_count; i++) {
        world_cover_shape(world, &world->shapes[i]);
    }
    for (size_t i = 0; i < world->object_count; i++) {
        world_cover_shape(world, &world->objects[i].shape);
    }
    double *box = world->fixed_m;
    box[0] = world->min_x_m;
    box[1] = world->min_y_m;
    box[2] = world->max_x_m;
    box[3] = world->max_y_m;
}

/* Robots come and go after the file has been read: the box around all else stays. */
static void world_measure(struct world *world)
{
    const double *box = world->fixed_m;
    world->min_x_m = box[0];
    world->min_y_m = box[1];
    world->max_x_m = box[2];
    world->max_y_m = box[3];
    for (size_t i = 0; i < world->robot_count; i++) {
        const struct world_robot *r = &world->robots[i];
        struct world_pose outline = {r->origin_x_m, r->origin_y_m, 0};
        world_cover(world, world_pose_in(r->pose, outline), r->length_m / 2, r->width_m / 2);
    }
    if (!(world->min_x_m <= world->max_x_m)) {
        world->min_x_m = world->min_y_m = world->max_x_m = world->max_y_m = 0;
    }
}

/* Reads the properties outside all models: units, step, seed. */
static mu_result world_read_units(struct builder *b, const struct worldfile_entity *root)
{
    static const struct {
        const char *name;
        double length_m, angle_deg; /* 0: it is none */
    } units[] = {
        {"m", 1, 0},
        {"cm", 0.01, 0},
        {"mm", 0.001, 0},
        {"degrees", 0, 1},
        {"radians", 0, 180 / M_PI},
    };
    const char *length = "m";
    const char *angle = "degrees";
    MU_TRY(builder_text(b, root, "unit_length", &length));
    MU_TRY(builder_text(b, root, "unit_angle", &angle));
    b->unit_length_m = b->unit_angle_deg = 0;
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
        b->unit_length_m += strcmp(length, units[i].name) == 0 ? units[i].length_m : 0;
        b->unit_angle_deg += strcmp(angle, units[i].name) == 0 ? units[i].angle_deg : 0;
    }
    if (!(b->unit_length_m > 0)) {
        struct mu_fault_place at = builder_place(root, "unit_length");
        return builder_fault(b, &at, "expected m, cm or mm, found '%.40s'", length);
    }
    if (!(b->unit_angle_deg > 0)) {
        struct mu_fault_place at = builder_place(root, "unit_angle");
        return builder_fault(b, &at, "expected degrees or radians, found '%.40s'", angle);
    }
    return MU_OK;
}

/* The physics takes 20 ms at a time. */
static void world_round_step(struct builder *b, const struct worldfile_entity *root, double step_ms)
{
    double whole_ms = ceil(step_ms / 20) * 20;
    if (whole_ms != step_ms) {
        struct mu_fault_place at = builder_place(root, "interval_sim");
        builder_warn(b, &at, "interval_sim", "is no multiple of 20 ms and is rounded up");
    }
    b->world->step_ns = (uint64_t)llround(whole_ms * 1e6);
}

static mu_result world_read_settings(struct builder *b, const struct worldfile_entity *root)
{
    double step_ms = 0;
    double seed = -1;
    MU_TRY(builder_number(b, root, (struct builder_numbers){"interval_sim", &step_ms, 1, 1, NULL},
                          1, 10000));
    MU_TRY(builder_number(b, root, (struct builder_numbers){"seed", &seed, 1, 1, NULL}, 0, 0x1p53));
    world_round_step(b, root, step_ms);
    b->world->seed = (int64_t)seed;
    if (seed >= 0) {
        b->seed = (uint64_t)seed;
    }
    return MU_OK;
}

static mu_result world_build(struct builder *b)
{
    struct world *world = b->world;
    const struct worldfile_entity *root = &world->source->root;
    struct world_walk walk = {.builder = b};
    builder_warn_unknown(b, root, PROPERTY_WORLD);
    mu_result units = builder_go_on(b, world_read_units(b, root));
    if (units != MU_OK || !(b->unit_length_m > 0 && b->unit_angle_deg > 0)) {
        b->unit_length_m = b->unit_angle_deg = 1;
        MU_TRY(units);
    }
    MU_TRY(builder_go_on(b, world_read_settings(b, root)));
    MU_TRY(builder_children(root, world_visit, &walk));
    world_measure_fixed(world);
    MU_TRY(distribute_all(b));
    world_name_all(world);
    world_measure_fixed(world);
    world_measure(world);
    return b->mistake_count > 0 ? MU_FAULT_FILE : MU_OK;
}

mu_result world_read(struct world *world, const char *path, const struct world_options *options,
                     struct mu_fault *fault)
{
    struct world_file *source = world->source;
    world->shape_count = world->object_count = world->robot_count = 0;
    world->rings = NULL;
    world->step_ns = 0;
    world->seed = -1;
    if (!mu_text_copy(world->file, sizeof world->file, path)) {
        return mu_fault_at(fault, path, 0, 0, "expected a shorter path");
    }
    source->listener = options->listener;
    MU_TRY(strcmp(path, WORLD_NONE) == 0 ? worldfile_parse_text(source, path, "", 0, fault)
                                         : worldfile_parse(source, path, fault));
    struct builder b = {.world = world,
                        .fault = fault,
                        .listener = options->listener,
                        .quiet = options->quiet,
                        .seed = options->seed,
                        .unit_length_m = 1,
                        .unit_angle_deg = 1};
    mu_result built = world_build(&b);
    builder_tell_end(&b);
    MU_TRY(built);
    return source->mistake_count > 0 ? MU_FAULT_FILE : MU_OK;
}

mu_result world_open(struct world *world, const char *path, const struct world_options *options,
                     struct mu_fault *fault)
{
    *world = (struct world){0};
    world->source = mu_startup_alloc(sizeof *world->source);
    world->shapes = mu_startup_array(BUILDER_SHAPES_MAX, sizeof *world->shapes);
    world->robots = mu_startup_array(MU_ROBOTS_MAX, sizeof *world->robots);
    world->objects = mu_startup_array(MU_OBJECTS_MAX, sizeof *world->objects);
    world->origins = mu_startup_array(MU_ROBOTS_MAX, sizeof *world->origins);
    world->object_origins = mu_startup_array(MU_OBJECTS_MAX, sizeof *world->object_origins);
    worldfile_init(world->source);
    return world_read(world, path, options, fault);
}

mu_result world_load(struct world *world, const char *path, bool quiet, struct mu_fault *fault)
{
    return world_open(world, path, &(struct world_options){.quiet = quiet, .seed = 1}, fault);
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
    struct mu_text text = mu_text_in(known, sizeof known);
    for (const struct worldfile_entity *e = world->source->definitions; e; e = e->next) {
        if (strcmp(worldfile_kind(e), "position") == 0) {
            mu_text_format(&text, "%s%s", text.len ? " " : "", e->defines);
        }
    }
    return mu_fault_at(fault, world->file, 0, 0,
                       "expected a body that the world defines (%s), found '%.40s'", known, body);
}

/* A builder for robots added after the file; its units are checked already. */
static struct builder world_later_builder(struct world *world, struct mu_fault *fault)
{
    struct builder b = {
        .world = world, .fault = fault, .quiet = true, .unit_length_m = 1, .unit_angle_deg = 1};
    mu_result units = world_read_units(&b, &world->source->root);
    MU_ASSERT(units == MU_OK);
    return b;
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
    struct builder b = world_later_builder(world, fault);
    MU_TRY(body_read(&b, definition, (struct world_pose){0}, robot));
    if (old) {
        robot->pose = old->pose;
        robot->look.rgb = old->look.rgb;
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
    if (world_names_thing(world, name) || world_has_object(world, name)) {
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

/* Takes a robot into the world, in the place of the old one if there was one. */
static mu_result world_put_robot(struct world *world, struct world_robot *old,
                                 const struct world_robot *robot, const char *body,
                                 struct mu_fault *fault)
{
    size_t index = old ? (size_t)(old - world->robots) : world->robot_count++;
    struct world_origin *origin = &world->origins[index];
    if (!old) {
        *origin = (struct world_origin){.at = {.file = world->file}, .type = body};
    }
    if (body) {
        origin->entity = worldfile_definition(world->source, body);
    }
    world->robots[index] = *robot;
    struct builder b = world_later_builder(world, fault);
    MU_TRY(body_read_start(&b, origin->entity, &world->robots[index]));
    world_measure(world);
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
    if (color) {
        (void)look_color(color, &robot.look.rgb);
    }
    return world_put_robot(world, old, &robot, body, fault);
}

mu_result world_add_placed(struct world *world, const char *text, struct mu_fault *fault)
{
    char name[64], body[64], color[64];
    char number[3][32];
    if (sscanf(text, "%63s %63s %31s %31s %31s %63s", name, body, number[0], number[1], number[2],
               color) != 6) {
        return mu_fault_at(fault, "--place", 0, 0, "'%s': expected NAME BODY X Y DEG COLOR", text);
    }
    double values[3];
    bool has_pose = strcmp(number[0], "-") != 0;
    for (size_t i = 0; has_pose && i < 3; i++) {
        char *end;
        values[i] = strtod(number[i], &end);
        if (*end || !isfinite(values[i])) {
            return mu_fault_at(fault, "--place", 0, 0, "'%s': expected a number", number[i]);
        }
    }
    struct world_pose pose = {0};
    if (has_pose) {
        pose = (struct world_pose){values[0], values[1], values[2] * M_PI / 180.0};
    }
    return world_add_robot(world, name, strcmp(body, "-") == 0 ? NULL : body,
                           has_pose ? &pose : NULL, strcmp(color, "-") == 0 ? NULL : color, fault);
}
