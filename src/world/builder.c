/* SPDX-License-Identifier: Apache-2.0 */
#include "world/builder.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define SILENT 0xff /* of no concern to a simulator without a window */
#define MODELS (BUILDER_SOLID | BUILDER_ROBOT | BUILDER_RANGER | BUILDER_SENSOR)

/* The properties that are read, and those that are passed over without a word. */
static const struct {
    const char *key;
    int kinds;
} builder_known[] = {
    {"name", MODELS},
    {"pose", MODELS},
    {"size", MODELS},
    {"color", MODELS},
    {"origin", BUILDER_SOLID | BUILDER_ROBOT},
    {"obstacle_return", BUILDER_SOLID | BUILDER_ROBOT},
    {"ranger_return", MODELS},
    {"bitmap", BUILDER_SOLID},
    {"boundary", BUILDER_SOLID},
    {"mass", BUILDER_ROBOT},
    {"velocity_bounds", BUILDER_ROBOT},
    {"acceleration_bounds", BUILDER_ROBOT},
    {"drive", BUILDER_ROBOT},
    {"localization", BUILDER_ROBOT},
    {"range", BUILDER_SENSOR},
    {"fov", BUILDER_SENSOR},
    {"samples", BUILDER_SENSOR},
    {"view", BUILDER_SENSOR},
    {"points", BUILDER_BLOCK},
    {"point", BUILDER_BLOCK},
    {"z", BUILDER_BLOCK},
    {"alwayson", SILENT},
    {"color_rgba", SILENT},
    {"paused", SILENT},
    {"speedup", SILENT},
    {"trail_length", SILENT},
};

static bool builder_knows(const char *key, enum builder_kind kind)
{
    if (strncmp(key, "gui_", 4) == 0 || strncmp(key, "show_", 5) == 0) {
        return true;
    }
    for (size_t i = 0; i < sizeof builder_known / sizeof builder_known[0]; i++) {
        if ((builder_known[i].kinds & (int)kind) && strcmp(builder_known[i].key, key) == 0) {
            return true;
        }
    }
    return false;
}

void builder_warn(struct builder *b, const struct worldfile_place *at, const char *word,
                  const char *what)
{
    if (b->quiet || b->warned_count == BUILDER_WARNINGS_MAX) {
        return;
    }
    for (size_t i = 0; i < b->warned_count; i++) {
        if (strcmp(b->warned[i], word) == 0) {
            return;
        }
    }
    b->warned[b->warned_count++] = word;
    fprintf(stderr, "%s:%d:%d: warning: '%.64s' %s\n", at->file, at->line, at->column, word, what);
}

void builder_warn_unknown(struct builder *b, const struct worldfile_entity *entity,
                          enum builder_kind kind)
{
    for (const struct worldfile_entity *e = entity; e; e = e->base) {
        for (const struct worldfile_property *p = e->properties; p; p = p->next) {
            if (!builder_knows(p->key, kind)) {
                builder_warn(b, &p->at, p->key, "is not supported and has no effect");
            }
        }
    }
}

mu_result builder_fault(struct builder *b, const struct worldfile_place *at, const char *format,
                        ...)
{
    char text[MU_FAULT_TEXT_MAX + 1];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return mu_fault_at(b->fault, at->file, at->line, at->column, "%s", text);
}

mu_result builder_skip_model(struct builder *b, const struct worldfile_entity *entity)
{
    static const char *const models[] = {
        "actuator", "blinkenlight", "blobfinder", "block",          "bumper", "camera",
        "fiducial", "gripper",      "indicator",  "lightindicator", "laser",  "model",
        "position", "ranger",       "sensor",     "speech",         "wifi",
    };
    const char *kind = worldfile_kind(entity);
    for (size_t i = 0; i < sizeof models / sizeof models[0]; i++) {
        if (strcmp(models[i], kind) == 0) {
            builder_warn(b, &entity->at, kind, "is not supported here and is left out");
            return MU_OK;
        }
    }
    return builder_fault(b, &entity->at,
                         "expected a model that Stage has or that is defined before, found '%.40s'",
                         kind);
}

struct worldfile_place builder_place(const struct worldfile_entity *entity, const char *key)
{
    const struct worldfile_property *property = worldfile_property(entity, key);
    return property ? property->at : entity->at;
}

mu_result builder_numbers(struct builder *b, const struct worldfile_entity *entity,
                          struct builder_numbers wanted)
{
    const struct worldfile_property *p = worldfile_property(entity, wanted.key);
    if (!p) {
        return MU_OK;
    }
    if (p->value_count < wanted.min || p->value_count > wanted.max) {
        return wanted.min == wanted.max
                   ? builder_fault(b, &p->at, "expected %zu number%s for '%s', found %zu",
                                   wanted.min, wanted.min == 1 ? "" : "s", wanted.key,
                                   p->value_count)
                   : builder_fault(b, &p->at, "expected %zu to %zu numbers for '%s', found %zu",
                                   wanted.min, wanted.max, wanted.key, p->value_count);
    }
    for (size_t i = 0; i < p->value_count; i++) {
        if (p->values[i].text) {
            return builder_fault(b, &p->at, "expected a number for '%s', found '%.40s'", wanted.key,
                                 p->values[i].text);
        }
        wanted.to[i] = p->values[i].number;
    }
    return MU_OK;
}

mu_result builder_text(struct builder *b, const struct worldfile_entity *entity, const char *key,
                       const char **text)
{
    const struct worldfile_property *p = worldfile_property(entity, key);
    if (!p) {
        return MU_OK;
    }
    if (p->value_count != 1 || !p->values[0].text) {
        return builder_fault(b, &p->at, "expected a text for '%s'", key);
    }
    *text = p->values[0].text;
    return MU_OK;
}

mu_result builder_pose(struct builder *b, const struct worldfile_entity *entity,
                       struct world_pose frame, struct world_pose *pose)
{
    double v[4] = {0, 0, 0, 0}; /* x y z heading_deg */
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"pose", v, 2, 4}));
    struct world_pose own = {v[0], v[1], remainder(v[3], 360) * M_PI / 180};
    *pose = world_pose_in(frame, own);
    if (fabs(pose->x_m) > BUILDER_POSE_MAX_M || fabs(pose->y_m) > BUILDER_POSE_MAX_M) {
        struct worldfile_place at = builder_place(entity, "pose");
        return builder_fault(b, &at, "expected a place within %g m of the middle",
                             BUILDER_POSE_MAX_M);
    }
    return MU_OK;
}

mu_result builder_size(struct builder *b, const struct worldfile_entity *entity, double size_m[2])
{
    double v[3] = {0.1, 0.1, 0.1}; /* what Stage gives to a model without a size */
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"size", v, 2, 3}));
    struct worldfile_place at = builder_place(entity, "size");
    for (size_t i = 0; i < 2; i++) {
        if (!(v[i] > 0) || v[i] > BUILDER_POSE_MAX_M) {
            return builder_fault(b, &at, "expected a size above 0 and up to %g m, found %g",
                                 BUILDER_POSE_MAX_M, v[i]);
        }
        size_m[i] = v[i];
    }
    return MU_OK;
}

mu_result builder_children(const struct worldfile_entity *entity,
                           mu_result (*visit)(void *context, const struct worldfile_entity *child),
                           void *context)
{
    if (entity->base) { /* WORLDFILE_DERIVATION_MAX deep at most */
        MU_TRY(builder_children(entity->base, visit, context));
    }
    for (const struct worldfile_entity *child = entity->children; child; child = child->next) {
        MU_TRY(visit(context, child));
    }
    return MU_OK;
}

mu_result builder_add_shape(struct builder *b, const struct world_shape *shape,
                            const struct worldfile_place *at)
{
    if (b->world->shape_count == BUILDER_SHAPES_MAX) {
        return builder_fault(b, at, "more than %d obstacles", BUILDER_SHAPES_MAX);
    }
    struct world_shape *added = &b->world->shapes[b->world->shape_count++];
    *added = *shape;
    added->look = (struct world_look){.stops = true, .echoes = true, .shows = true};
    return MU_OK;
}
