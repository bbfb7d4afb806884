/* SPDX-License-Identifier: Apache-2.0 */
/* Things that can be moved: pucks, crates on wheels. */
#include "core/name.h"
#include "core/text.h"
#include "world/read/builder.h"

#include <string.h>

static bool object_flag(const struct worldfile_entity *entity, const char *key)
{
    const struct worldfile_property *p = worldfile_property(entity, key);
    return p && p->value_count == 1 && !p->values[0].text && p->values[0].number != 0;
}

bool object_is(const struct worldfile_entity *entity)
{
    return object_flag(entity, "movable") || object_flag(entity, "gripper_return");
}

/* Stage's names may be anything; one that is no name here is left to be given. */
static mu_result object_read_name(struct builder *b, const struct worldfile_entity *entity,
                                  struct world_object *object)
{
    const char *name = "";
    MU_TRY(builder_text(b, entity, "name", &name));
    if (name[0] == '\0' || (mu_name_valid(name) && !mu_name_reserved(name))) {
        mu_text_copy(object->name, sizeof object->name, name);
        return MU_OK;
    }
    struct mu_fault_place at = builder_place(entity, "name");
    builder_warn(b, &at, name, "is no name for a thing that can be moved: it gets another");
    return MU_OK;
}

/* Blocks that are more than one piece become the box around the model. */
static mu_result object_read_shape(struct builder *b, const struct worldfile_entity *entity,
                                   struct world_pose pose, struct world_shape *shape)
{
    struct world *world = b->world;
    size_t first = world->shape_count;
    mu_result built = solid_build(b, entity, pose);
    size_t count = world->shape_count - first;
    if (count > 0) {
        *shape = world->shapes[first];
    }
    world->shape_count = first;
    MU_TRY(built);
    if (count == 1) {
        return MU_OK;
    }
    builder_warn(b, &entity->at, entity->type,
                 "can be moved and has several pieces: it is the box of its size");
    double size_m[2];
    MU_TRY(builder_size(b, entity, size_m));
    *shape = (struct world_shape){
        .kind = WORLD_BOX, .pose = pose, .half_x_m = size_m[0] / 2, .half_y_m = size_m[1] / 2};
    return look_read(b, entity, &shape->look);
}

/* Its own children, and those of its definitions. */
static mu_result object_visit_child(void *context, const struct worldfile_entity *child)
{
    struct builder *b = context;
    if (strcmp(worldfile_kind(child), "block") != 0) {
        builder_warn(b, &child->at, child->type,
                     "is left out: what it is in can be moved, and is one piece");
    }
    return MU_OK;
}

static mu_result object_read(struct builder *b, const struct worldfile_entity *entity,
                             struct world_pose pose, struct world_object *object)
{
    *object = (struct world_object){.mass_kg = 10, .friction = 0.5};
    MU_TRY(object_read_name(b, entity, object));
    MU_TRY(builder_number(b, entity, (struct builder_numbers){"mass", &object->mass_kg, 1, 1, NULL},
                          1e-3, 1e6));
    MU_TRY(builder_number(
        b, entity, (struct builder_numbers){"friction", &object->friction, 1, 1, NULL}, 0, 10));
    MU_TRY(builder_children(entity, object_visit_child, b));
    struct world_shape *shape = &object->shape;
    MU_TRY(object_read_shape(b, entity, pose, shape));
    return shape->kind == WORLD_DISC
               ? builder_check_body(b, entity, 2 * shape->radius_m, 2 * shape->radius_m)
               : builder_check_body(b, entity, 2 * shape->half_x_m, 2 * shape->half_y_m);
}

mu_result object_build(struct builder *b, const struct worldfile_entity *entity,
                       struct world_pose pose)
{
    struct world *world = b->world;
    if (world->object_count == MU_OBJECTS_MAX) {
        return builder_full(b, &entity->at, "more than %d things that can be moved",
                            MU_OBJECTS_MAX);
    }
    struct world_object *object = &world->objects[world->object_count];
    MU_TRY(object_read(b, entity, pose, object));
    if (object->name[0] != '\0' && world_name_taken(world, object->name)) {
        struct mu_fault_place at = builder_place(entity, "name");
        return builder_fault(b, &at, "expected another name: there is a '%s' already",
                             object->name);
    }
    world->object_origins[world->object_count++] =
        (struct world_origin){.at = entity->at, .type = entity->type, .entity = entity};
    return MU_OK;
}
