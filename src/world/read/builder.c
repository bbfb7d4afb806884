/* SPDX-License-Identifier: Apache-2.0 */
#include "world/read/builder.h"

#include "core/hash.h"
#include "core/spell.h"
#include "world/parse/parser.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* A mistake in a definition comes again with each model that derives from it: it is told once. */
static void builder_tell_mistake(struct builder *b)
{
    struct builder_mistake m = {b->fault->line, b->fault->column, mu_hash_string(b->fault->text)};
    for (size_t i = 0; i < b->mistake_count; i++) {
        const struct builder_mistake *old = &b->mistakes[i];
        if (old->line == m.line && old->column == m.column && old->text == m.text) {
            return;
        }
    }
    if (b->mistake_count < MU_FAULT_MISTAKES_MAX) {
        b->mistakes[b->mistake_count++] = m;
        b->listener->tell(b->listener->self, b->fault, true);
    }
}

mu_result builder_go_on(struct builder *b, mu_result result)
{
    if (!b->listener || result != MU_FAULT_FILE || b->ended) {
        return result;
    }
    builder_tell_mistake(b);
    return MU_OK;
}

static bool builder_warned(struct builder *b, const char *word)
{
    for (size_t i = 0; i < b->warned_count; i++) {
        if (strcmp(b->warned[i], word) == 0) {
            return true;
        }
    }
    if (b->warned_count == BUILDER_WARNINGS_MAX) {
        return true;
    }
    b->warned[b->warned_count++] = word;
    return false;
}

void builder_warn(struct builder *b, const struct mu_fault_place *at, const char *word,
                  const char *what)
{
    if (b->quiet || builder_warned(b, word)) {
        return;
    }
    if (b->listener) {
        struct mu_fault warning;
        mu_fault_at(&warning, at->file, at->line, at->column, "'%.64s' %s", word, what);
        b->listener->tell(b->listener->self, &warning, false);
        return;
    }
    fprintf(stderr, "%s:%d:%d: warning: '%.64s' %s\n", at->file, at->line, at->column, word, what);
}

static void builder_warn_property(struct builder *b, const struct worldfile_property *p,
                                  enum property_kind kind)
{
    const char *meant = properties_near(p->key, kind);
    if (!meant) {
        builder_warn(b, &p->at, p->key, "is not supported and has no effect");
    } else if (b->listener) {
        builder_fault(b, &p->at, "expected a property, found '%.40s': did you mean '%s'?", p->key,
                      meant);
        builder_tell_mistake(b);
    } else {
        char what[128];
        snprintf(what, sizeof what, "is not a property: did you mean '%s'?", meant);
        builder_warn(b, &p->at, p->key, what);
    }
}

void builder_warn_unknown(struct builder *b, const struct worldfile_entity *entity,
                          enum property_kind kind)
{
    for (const struct worldfile_entity *e = entity; e; e = e->base) {
        for (const struct worldfile_property *p = e->properties; p; p = p->next) {
            if (!properties_known(p->key, kind)) {
                builder_warn_property(b, p, kind);
            }
        }
    }
}

static mu_result builder_fault_list(struct builder *b, const struct mu_fault_place *at,
                                    const char *format, va_list args)
{
    char text[MU_FAULT_TEXT_MAX + 1];
    vsnprintf(text, sizeof text, format, args);
    return mu_fault_at(b->fault, at->file, at->line, at->column, "%s", text);
}

mu_result builder_fault(struct builder *b, const struct mu_fault_place *at, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    mu_result result = builder_fault_list(b, at, format, args);
    va_end(args);
    return result;
}

mu_result builder_full(struct builder *b, const struct mu_fault_place *at, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    mu_result result = builder_fault_list(b, at, format, args);
    va_end(args);
    b->ended = true;
    return result;
}

void builder_tell_end(struct builder *b)
{
    if (b->listener && b->ended) {
        builder_tell_mistake(b);
    }
}

mu_result builder_count_model(struct builder *b, const struct worldfile_entity *entity, int depth)
{
    if (b->model_count++ >= BUILDER_MODELS_MAX) {
        return builder_full(b, &entity->at, "more than %d models", BUILDER_MODELS_MAX);
    }
    if (depth > BUILDER_NESTING_MAX) {
        return builder_full(b, &entity->at, "models nest deeper than %d", BUILDER_NESTING_MAX);
    }
    return MU_OK;
}

mu_result builder_skip_model(struct builder *b, const struct worldfile_entity *entity)
{
    static const char *const models[] = {
        "actuator", "blinkenlight", "blobfinder", "block",          "bumper", "camera",
        "fiducial", "gripper",      "indicator",  "lightindicator", "laser",  "model",
        "position", "ranger",       "sensor",     "sonar",          "speech", "wifi",
    };
    const char *kind = worldfile_kind(entity);
    struct mu_spell spell;
    mu_spell_init(&spell, kind);
    for (size_t i = 0; i < sizeof models / sizeof models[0]; i++) {
        if (strcmp(models[i], kind) == 0) {
            builder_warn(b, &entity->at, kind, "is not supported here and is left out");
            return MU_OK;
        }
        mu_spell_offer(&spell, models[i]);
    }
    const struct worldfile_entity *e = b->world->source->definitions;
    for (; e; e = e->next) {
        mu_spell_offer(&spell, e->defines);
    }
    return builder_fault(b, &entity->at,
                         "expected a model that Stage has or that is defined before, found '%.40s'"
                         "%s%.40s%s",
                         kind, spell.nearest ? ": did you mean '" : "",
                         spell.nearest ? spell.nearest : "", spell.nearest ? "'?" : "");
}

struct mu_fault_place builder_place(const struct worldfile_entity *entity, const char *key)
{
    const struct worldfile_property *property = worldfile_property(entity, key);
    return property ? property->at : entity->at;
}

static mu_result builder_count_fault(struct builder *b, const struct worldfile_property *p,
                                     const struct builder_numbers *wanted)
{
    if (wanted->min == wanted->max) {
        return builder_fault(b, &p->at, "expected %zu number%s for '%s', found %zu", wanted->min,
                             wanted->min == 1 ? "" : "s", wanted->key, p->value_count);
    }
    return builder_fault(b, &p->at, "expected %zu to %zu numbers for '%s', found %zu", wanted->min,
                         wanted->max, wanted->key, p->value_count);
}

mu_result builder_numbers(struct builder *b, const struct worldfile_entity *entity,
                          struct builder_numbers wanted)
{
    const struct worldfile_property *p = worldfile_property(entity, wanted.key);
    if (!p) {
        return MU_OK;
    }
    if (p->value_count < wanted.min || p->value_count > wanted.max) {
        return builder_count_fault(b, p, &wanted);
    }
    for (size_t i = 0; i < p->value_count; i++) {
        if (p->values[i].text) {
            return builder_fault(b, &p->at, "expected a number for '%s', found '%.40s'", wanted.key,
                                 p->values[i].text);
        }
        char unit = wanted.units && i < strlen(wanted.units) ? wanted.units[i] : ' ';
        double in = unit == 'l' ? b->unit_length_m : unit == 'a' ? b->unit_angle_deg : 1;
        wanted.to[i] = p->values[i].number * in;
        if (!isfinite(wanted.to[i])) {
            return builder_fault(b, &p->at, "expected a smaller number for '%s', found %g",
                                 wanted.key, p->values[i].number);
        }
    }
    return MU_OK;
}

mu_result builder_number(struct builder *b, const struct worldfile_entity *entity,
                         struct builder_numbers wanted, double min, double max)
{
    double *to = wanted.to;
    double value = *to;
    wanted.to = &value;
    MU_TRY(builder_numbers(b, entity, wanted));
    if (worldfile_property(entity, wanted.key) && !(value >= min && value <= max)) {
        struct mu_fault_place at = builder_place(entity, wanted.key);
        return builder_fault(b, &at, "expected '%s' of %g to %g, found %g", wanted.key, min, max,
                             value);
    }
    *to = value;
    return MU_OK;
}

mu_result builder_count(struct builder *b, const struct worldfile_entity *entity, const char *key,
                        double max, uint32_t *to)
{
    double value = *to;
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){key, &value, 1, 1, NULL}));
    if (!(value >= 0 && value <= max && value == floor(value))) {
        struct mu_fault_place at = builder_place(entity, key);
        return builder_fault(b, &at, "expected '%s' to be a whole number from 0 to %g, found %g",
                             key, max, value);
    }
    *to = (uint32_t)value;
    return MU_OK;
}

mu_result builder_flag(struct builder *b, const struct worldfile_entity *entity, const char *key,
                       bool *to)
{
    double value = *to;
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){key, &value, 1, 1, NULL}));
    *to = value != 0;
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
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"pose", v, 2, 4, "llla"}));
    struct world_pose own = {v[0], v[1], remainder(v[3], 360) * M_PI / 180};
    *pose = world_pose_in(frame, own);
    if (fabs(pose->x_m) > BUILDER_POSE_MAX_M || fabs(pose->y_m) > BUILDER_POSE_MAX_M) {
        struct mu_fault_place at = builder_place(entity, "pose");
        return builder_fault(b, &at, "expected a place within %g m of the middle",
                             BUILDER_POSE_MAX_M);
    }
    return MU_OK;
}

mu_result builder_size(struct builder *b, const struct worldfile_entity *entity, double size_m[2])
{
    double v[3] = {0.1, 0.1, 0.1}; /* Stage's size of a model without one */
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"size", v, 2, 3, "lll"}));
    struct mu_fault_place at = builder_place(entity, "size");
    for (size_t i = 0; i < 2; i++) {
        if (!(v[i] > 0) || v[i] > BUILDER_POSE_MAX_M) {
            return builder_fault(b, &at, "expected a size above 0 and up to %g m, found %g",
                                 BUILDER_POSE_MAX_M, v[i]);
        }
        size_m[i] = v[i];
    }
    return MU_OK;
}

mu_result builder_check_body(struct builder *b, const struct worldfile_entity *entity,
                             double length_m, double width_m)
{
    if (fmin(length_m, width_m) >= BUILDER_BODY_MIN_M &&
        fmax(length_m, width_m) <= BUILDER_BODY_MAX_M) {
        return MU_OK;
    }
    struct mu_fault_place at = builder_place(entity, "size");
    return builder_fault(b, &at, "expected a body of %g to %g m, found %g x %g", BUILDER_BODY_MIN_M,
                         BUILDER_BODY_MAX_M, length_m, width_m);
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
                            const struct mu_fault_place *at)
{
    if (b->world->shape_count == BUILDER_SHAPES_MAX) {
        return builder_full(b, at, "more than %d obstacles", BUILDER_SHAPES_MAX);
    }
    b->world->shapes[b->world->shape_count++] = *shape;
    return MU_OK;
}
