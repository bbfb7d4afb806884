/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Fixed matter: boxes, blocks, floor plans and boundaries.
 *
 * Stage extrudes any polygon; here solid matter is convex and simple.  A block that is a rectangle
 * becomes that box.  One whose corners lie on a circle becomes a disc.  Any other one becomes the
 * smallest box around it that shares a direction with one of its sides.
 */
#include "world/parse/parser.h"
#include "world/read/builder.h"

#include <math.h>
#include <string.h>

enum { SOLID_POINTS_MAX = 256, SOLID_DISC_POINTS_MIN = 8 };

#define SOLID_DISC_TOLERANCE 0.02 /* of the radius */
#define SOLID_BOUNDARY_M     0.2  /* walls stand outside the model's size, this thick */

struct solid_polygon {
    double x[SOLID_POINTS_MAX], y[SOLID_POINTS_MAX];
    size_t count;
};

struct solid_reader {
    struct builder *builder;
    const struct worldfile_entity *owner;
    struct world_pose pose; /* of the model's middle, in the world */
    struct world_look look;
    double size_m[2];
    double min[2], max[2]; /* around all blocks, in the file's units */
    size_t block_count;
    bool placing; /* second visit: the bounds are known */
};

static mu_result solid_add_box(struct solid_reader *reader, struct world_pose in, double half_x_m,
                               double half_y_m)
{
    struct world_shape shape = {.kind = WORLD_BOX,
                                .pose = world_pose_in(reader->pose, in),
                                .half_x_m = half_x_m,
                                .half_y_m = half_y_m,
                                .look = reader->look};
    return builder_add_shape(reader->builder, &shape, &reader->owner->at);
}

static const struct worldfile_property *solid_point(const struct worldfile_entity *entity,
                                                    int index)
{
    for (const struct worldfile_entity *e = entity; e; e = e->base) {
        for (const struct worldfile_property *p = e->properties; p; p = p->next) {
            if (p->index == index && strcmp(p->key, "point") == 0) {
                return p;
            }
        }
    }
    return NULL;
}

static mu_result solid_read_polygon(struct builder *b, const struct worldfile_entity *entity,
                                    struct solid_polygon *polygon)
{
    double count = 0;
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"points", &count, 1, 1, NULL}));
    struct mu_fault_place at = builder_place(entity, "points");
    if (!(count >= 3 && count <= SOLID_POINTS_MAX && count == floor(count))) {
        return builder_fault(b, &at, "expected 3 to %d points of a block, found %g",
                             SOLID_POINTS_MAX, count);
    }
    polygon->count = (size_t)count;
    for (size_t i = 0; i < polygon->count; i++) {
        const struct worldfile_property *p = solid_point(entity, (int)i);
        if (!p) {
            return builder_fault(b, &at, "expected point[%zu] of a block of %zu points", i,
                                 polygon->count);
        }
        if (p->value_count < 2 || p->values[0].text || p->values[1].text) {
            return builder_fault(b, &p->at, "expected point[%zu] [x y]", i);
        }
        polygon->x[i] = p->values[0].number;
        polygon->y[i] = p->values[1].number;
        if (fabs(polygon->x[i]) > 1e9 || fabs(polygon->y[i]) > 1e9) {
            return builder_fault(b, &p->at, "expected a point within 1e9 of the middle");
        }
    }
    return MU_OK;
}

/* A disc: many corners, all as far from the middle, and none far from the next. */
static bool solid_as_disc(const struct solid_polygon *p, struct world_shape *shape)
{
    double x = 0;
    double y = 0;
    for (size_t i = 0; i < p->count; i++) {
        x += p->x[i] / (double)p->count;
        y += p->y[i] / (double)p->count;
    }
    double least = INFINITY;
    double most = 0;
    double side = 0;
    for (size_t i = 0; i < p->count; i++) {
        size_t next = (i + 1) % p->count;
        double radius = hypot(p->x[i] - x, p->y[i] - y);
        least = fmin(least, radius);
        most = fmax(most, radius);
        side = fmax(side, hypot(p->x[next] - p->x[i], p->y[next] - p->y[i]));
    }
    *shape = (struct world_shape){.kind = WORLD_DISC, .pose = {x, y, 0}, .radius_m = most};
    return p->count >= SOLID_DISC_POINTS_MIN && least >= (1 - SOLID_DISC_TOLERANCE) * most &&
           side <= most;
}

/* The box around a polygon that lies along a direction. */
static struct world_shape solid_box_along(const struct solid_polygon *p, double ux, double uy)
{
    double min[2] = {INFINITY, INFINITY};
    double max[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < p->count; i++) {
        double along = p->x[i] * ux + p->y[i] * uy;
        double across = p->y[i] * ux - p->x[i] * uy;
        min[0] = fmin(min[0], along);
        max[0] = fmax(max[0], along);
        min[1] = fmin(min[1], across);
        max[1] = fmax(max[1], across);
    }
    double along = (min[0] + max[0]) / 2;
    double across = (min[1] + max[1]) / 2;
    return (struct world_shape){
        .kind = WORLD_BOX,
        .pose = {along * ux - across * uy, along * uy + across * ux, atan2(uy, ux)},
        .half_x_m = (max[0] - min[0]) / 2,
        .half_y_m = (max[1] - min[1]) / 2,
    };
}

static struct world_shape solid_as_box(const struct solid_polygon *p)
{
    struct world_shape best = solid_box_along(p, 1, 0);
    for (size_t i = 0; i < p->count; i++) {
        size_t next = (i + 1) % p->count;
        double dx = p->x[next] - p->x[i];
        double dy = p->y[next] - p->y[i];
        double side = hypot(dx, dy);
        if (side > 0) {
            struct world_shape box = solid_box_along(p, dx / side, dy / side);
            if (box.half_x_m * box.half_y_m < best.half_x_m * best.half_y_m * (1 - 1e-9)) {
                best = box;
            }
        }
    }
    return best;
}

/* Stage scales all blocks of a model together, so that they fill its size. */
static mu_result solid_place_block(struct solid_reader *reader, struct solid_polygon *polygon,
                                   const struct worldfile_entity *entity)
{
    double *axes[2] = {polygon->x, polygon->y};
    for (size_t k = 0; k < 2; k++) {
        double extent = reader->max[k] - reader->min[k];
        if (!(extent > 0)) {
            return builder_fault(reader->builder, &entity->at, "expected a block with an area");
        }
        for (size_t i = 0; i < polygon->count; i++) {
            axes[k][i] = ((axes[k][i] - reader->min[k]) / extent - 0.5) * reader->size_m[k];
        }
    }
    struct world_shape shape;
    if (!solid_as_disc(polygon, &shape)) {
        shape = solid_as_box(polygon);
        if (!(shape.half_x_m > 0 && shape.half_y_m > 0)) {
            return builder_fault(reader->builder, &entity->at, "expected a block with an area");
        }
    }
    shape.pose = world_pose_in(reader->pose, shape.pose);
    shape.look = reader->look;
    return builder_add_shape(reader->builder, &shape, &entity->at);
}

static mu_result solid_visit_block(void *context, const struct worldfile_entity *entity)
{
    struct solid_reader *reader = context;
    if (strcmp(worldfile_kind(entity), "block") != 0) {
        return MU_OK;
    }
    struct solid_polygon polygon;
    MU_TRY(solid_read_polygon(reader->builder, entity, &polygon));
    if (reader->placing) {
        return solid_place_block(reader, &polygon, entity);
    }
    builder_warn_unknown(reader->builder, entity, PROPERTY_BLOCK);
    reader->block_count++;
    for (size_t i = 0; i < polygon.count; i++) {
        reader->min[0] = fmin(reader->min[0], polygon.x[i]);
        reader->max[0] = fmax(reader->max[0], polygon.x[i]);
        reader->min[1] = fmin(reader->min[1], polygon.y[i]);
        reader->max[1] = fmax(reader->max[1], polygon.y[i]);
    }
    return MU_OK;
}

static mu_result solid_read_bitmap(struct builder *b, const struct worldfile_entity *owner,
                                   const char *name, struct bitmap *bitmap)
{
    struct mu_fault_place at = builder_place(owner, "bitmap");
    char path[MU_FAULT_FILE_MAX + 1];
    if (!worldfile_path(at.file, name, path, sizeof path)) {
        return builder_fault(b, &at, "expected a shorter path");
    }
    double threshold = BITMAP_THRESHOLD;
    MU_TRY(builder_number(
        b, owner, (struct builder_numbers){"bitmap_threshold", &threshold, 1, 1, NULL}, 0, 256));
    struct bitmap_rule rule = {.threshold = threshold};
    MU_TRY(builder_flag(b, owner, "bitmap_negate", &rule.negate));
    const char *problem = bitmap_read(bitmap, path, &rule, b->world->source);
    worldfile_note(b->world->source, path);
    return problem ? builder_fault(b, &at, "cannot read the bitmap '%.200s': %s", path, problem)
                   : MU_OK;
}

/* The whole picture fills the model's size. */
static mu_result solid_place_bitmap(struct solid_reader *reader, const char *name)
{
    struct world_file *file = reader->builder->world->source;
    size_t mark = file->bytes_used; /* the pixels are not needed any longer than here */
    struct bitmap bitmap;
    MU_TRY(solid_read_bitmap(reader->builder, reader->owner, name, &bitmap));
    double pixel_x_m = reader->size_m[0] / bitmap.width;
    double pixel_y_m = reader->size_m[1] / bitmap.height;
    size_t from = 0;
    struct bitmap_rectangle r;
    while (bitmap_take_rectangle(&bitmap, &from, &r)) {
        struct world_pose in = {(r.x + r.width / 2.0) * pixel_x_m - reader->size_m[0] / 2,
                                reader->size_m[1] / 2 - (r.y + r.height / 2.0) * pixel_y_m, 0};
        MU_TRY(solid_add_box(reader, in, r.width * pixel_x_m / 2, r.height * pixel_y_m / 2));
    }
    file->bytes_used = mark;
    return MU_OK;
}

static mu_result solid_place_boundary(struct solid_reader *reader)
{
    double half_x = reader->size_m[0] / 2;
    double half_y = reader->size_m[1] / 2;
    double half_wall = SOLID_BOUNDARY_M / 2;
    for (int side = -1; side <= 1; side += 2) {
        struct world_pose beside = {side * (half_x + half_wall), 0, 0};
        struct world_pose ahead = {0, side * (half_y + half_wall), 0};
        MU_TRY(solid_add_box(reader, beside, half_wall, half_y));
        MU_TRY(solid_add_box(reader, ahead, half_x + SOLID_BOUNDARY_M, half_wall));
    }
    return MU_OK;
}

static mu_result solid_place_all(struct solid_reader *reader, bool boundary)
{
    struct builder *b = reader->builder;
    const char *bitmap = NULL;
    MU_TRY(builder_text(b, reader->owner, "bitmap", &bitmap));
    MU_TRY(builder_children(reader->owner, solid_visit_block, reader));
    if (bitmap) {
        MU_TRY(solid_place_bitmap(reader, bitmap));
    } else if (reader->block_count > 0) {
        reader->placing = true;
        MU_TRY(builder_children(reader->owner, solid_visit_block, reader));
    } else if (!boundary) {
        MU_TRY(solid_add_box(reader, (struct world_pose){0}, reader->size_m[0] / 2,
                             reader->size_m[1] / 2));
    }
    return boundary ? solid_place_boundary(reader) : MU_OK;
}

/* A model of many shapes is one fiducial: the shape that is nearest to its pose bears it. */
static void solid_mark_fiducial(struct world *world, size_t first, const struct world_pose *pose)
{
    size_t nearest = first;
    double least_m = INFINITY;
    for (size_t i = first; i < world->shape_count; i++) {
        const struct world_pose *at = &world->shapes[i].pose;
        double range_m = hypot(at->x_m - pose->x_m, at->y_m - pose->y_m);
        if (range_m < least_m) {
            least_m = range_m;
            nearest = i;
        }
    }
    for (size_t i = first; i < world->shape_count; i++) {
        if (i != nearest) {
            world->shapes[i].look.fiducial = 0;
        }
    }
}

/* A charger never runs dry. */
static void solid_warn_store(struct builder *b, const struct worldfile_entity *entity)
{
    static const char *const keys[] = {"joules", "kjoules"};
    for (size_t i = 0; i < 2; i++) {
        const struct worldfile_property *p = worldfile_property(entity, keys[i]);
        if (p && p->value_count == 1 && p->values[0].number >= 0) {
            builder_warn(b, &p->at, keys[i], "of what charges others has no end");
        }
    }
}

mu_result solid_build(struct builder *b, const struct worldfile_entity *entity,
                      struct world_pose pose)
{
    struct solid_reader reader = {
        .builder = b, .owner = entity, .min = {INFINITY, INFINITY}, .max = {-INFINITY, -INFINITY}};
    double origin[4] = {0, 0, 0, 0};
    bool boundary = false;
    MU_TRY(builder_size(b, entity, reader.size_m));
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"origin", origin, 2, 4, "llla"}));
    MU_TRY(look_read(b, entity, &reader.look));
    MU_TRY(builder_flag(b, entity, "boundary", &boundary));
    const struct world_look *look = &reader.look;
    if (!look->stops && !look->echoes && !look->shows && !look->fiducial && !(look->give_w > 0)) {
        return MU_OK;
    }
    if (fabs(origin[0]) > BUILDER_POSE_MAX_M || fabs(origin[1]) > BUILDER_POSE_MAX_M) {
        struct mu_fault_place at = builder_place(entity, "origin");
        return builder_fault(b, &at, "expected an origin within %g m", BUILDER_POSE_MAX_M);
    }
    struct world_pose middle = {origin[0], origin[1], remainder(origin[3], 360) * M_PI / 180};
    reader.pose = world_pose_in(pose, middle);
    if (look->give_w > 0) {
        solid_warn_store(b, entity);
    }
    size_t first = b->world->shape_count;
    MU_TRY(solid_place_all(&reader, boundary));
    if (look->fiducial) {
        solid_mark_fiducial(b->world, first, &reader.pose);
    }
    return MU_OK;
}
