/* SPDX-License-Identifier: Apache-2.0 */
/*
 * muster world import of a world of Stage: the same models, in one file.
 *
 * Kept are the definitions that some model needs, and the properties that count here.
 */
#include "core/json.h"
#include "muster/memory.h"
#include "world/parse/parser.h"
#include "world/world_load.h"
#include "worldtool/worldtool.h"

#include <limits.h>
#include <string.h>

struct stage {
    const struct world_files_options *options;
    const struct world_file *source;
    const struct worldfile_entity *needed[WORLDFILE_DEFINITIONS_MAX];
    size_t needed_count;
    FILE *to;
    struct mu_fault *fault;
};

/* @return what a model's properties belong to; 0: it is left out */
static int stage_kinds(const struct worldfile_entity *entity)
{
    static const struct {
        const char *kind;
        int kinds;
    } known[] = {
        {"model", PROPERTY_SOLID | PROPERTY_PART},
        {"position", PROPERTY_ROBOT},
        {"ranger", PROPERTY_RANGER},
        {"sensor", PROPERTY_SENSOR},
        {"laser", PROPERTY_SENSOR | PROPERTY_RANGER},
        {"sonar", PROPERTY_SENSOR | PROPERTY_RANGER},
        {"blobfinder", PROPERTY_CAMERA},
        {"fiducial", PROPERTY_FINDER},
        {"gripper", PROPERTY_GRIPPER},
        {"block", PROPERTY_BLOCK},
        {"distribute", PROPERTY_DISTRIBUTE},
        {"world", PROPERTY_WORLD},
    };
    const char *kind = worldfile_kind(entity);
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (strcmp(known[i].kind, kind) == 0) {
            return known[i].kinds;
        }
    }
    return 0;
}

static bool stage_needs(const struct stage *s, const struct worldfile_entity *definition)
{
    for (size_t i = 0; i < s->needed_count; i++) {
        if (s->needed[i] == definition) {
            return true;
        }
    }
    return false;
}

/* Definitions are as deep and models as nested as the parser lets them. */
static void stage_collect(struct stage *s, const struct worldfile_entity *entity)
{
    const struct worldfile_property *model = worldfile_property(entity, "model");
    const struct worldfile_entity *named = NULL;
    if (model && model->value_count == 1 && model->values[0].text) {
        named = worldfile_definition(s->source, model->values[0].text);
    }
    const struct worldfile_entity *definitions[2] = {entity->base, named};
    for (size_t i = 0; i < 2; i++) {
        if (definitions[i] && !stage_needs(s, definitions[i])) {
            s->needed[s->needed_count++] = definitions[i];
            stage_collect(s, definitions[i]);
        }
    }
    for (const struct worldfile_entity *e = entity->children; e; e = e->next) {
        stage_collect(s, e);
    }
}

/* A definition that takes the place of an earlier one of its name gets another name. */
static void stage_print_name(const struct stage *s, const struct worldfile_entity *definition)
{
    size_t earlier = 0;
    for (const struct worldfile_entity *e = definition->next; e; e = e->next) {
        earlier += strcmp(e->defines, definition->defines) == 0;
    }
    fputs(definition->defines, s->to);
    if (earlier > 0) {
        fprintf(s->to, "_%zu", earlier + 1);
    }
}

static void stage_print_type(const struct stage *s, const struct worldfile_entity *entity)
{
    if (entity->base) {
        stage_print_name(s, entity->base);
    } else {
        fputs(entity->type, s->to);
    }
}

static void stage_indent(const struct stage *s, int depth)
{
    fprintf(s->to, "%*s", 2 * depth, "");
}

static void stage_print_value(const struct stage *s, const struct worldfile_value *value)
{
    char number[MU_JSON_NUMBER_MAX];
    if (value->text) {
        fprintf(s->to, "\"%s\"", value->text);
        return;
    }
    mu_json_number(number, value->number);
    fputs(number, s->to);
}

/* Pictures stay where they are: their paths change. */
static mu_result stage_print_bitmap(const struct stage *s, const struct worldfile_property *p)
{
    char beside[MU_FAULT_FILE_MAX + 1];
    char path[PATH_MAX];
    if (!worldfile_path(p->at.file, p->values[0].text, beside, sizeof beside) ||
        !world_import_picture(s->options, beside, path, sizeof path) || strchr(path, '"')) {
        return mu_fault_at(s->fault, p->at.file, p->at.line, p->at.column,
                           "expected a picture with a shorter path without quotes");
    }
    fprintf(s->to, "bitmap \"%s\"\n", path);
    return MU_OK;
}

static mu_result stage_print_property(const struct stage *s, const struct worldfile_property *p)
{
    if (strcmp(p->key, "bitmap") == 0 && p->value_count == 1 && p->values[0].text) {
        return stage_print_bitmap(s, p);
    }
    if (strcmp(p->key, "model") == 0 && p->value_count == 1 && p->values[0].text) {
        fputs("model ", s->to); /* it was found when the world was loaded */
        stage_print_name(s, worldfile_definition(s->source, p->values[0].text));
        fputs("\n", s->to);
        return MU_OK;
    }
    fputs(p->key, s->to);
    if (p->index >= 0) {
        fprintf(s->to, "[%d]", p->index);
    }
    fputs(p->value_count == 1 ? " " : " [", s->to);
    for (size_t i = 0; i < p->value_count; i++) {
        fputs(i ? " " : "", s->to);
        stage_print_value(s, &p->values[i]);
    }
    fputs(p->value_count == 1 ? "\n" : "]\n", s->to);
    return MU_OK;
}

static mu_result stage_print_model(const struct stage *s, const struct worldfile_entity *entity,
                                   int depth);

static mu_result stage_print_body(const struct stage *s, const struct worldfile_entity *entity,
                                  int depth)
{
    int kinds = stage_kinds(entity);
    for (const struct worldfile_property *p = entity->properties; p; p = p->next) {
        if (properties_read_there(p->key, kinds)) {
            stage_indent(s, depth);
            MU_TRY(stage_print_property(s, p));
        }
    }
    for (const struct worldfile_entity *e = entity->children; e; e = e->next) {
        MU_TRY(stage_print_model(s, e, depth));
    }
    return MU_OK;
}

static mu_result stage_print_model(const struct stage *s, const struct worldfile_entity *entity,
                                   int depth)
{
    if (stage_kinds(entity) == 0) {
        return MU_OK;
    }
    stage_indent(s, depth);
    stage_print_type(s, entity);
    fputs(" (\n", s->to);
    MU_TRY(stage_print_body(s, entity, depth + 1));
    stage_indent(s, depth);
    fputs(")\n", s->to);
    return MU_OK;
}

/* The list begins with the latest one. */
static mu_result stage_print_definitions(const struct stage *s,
                                         const struct worldfile_entity *definition)
{
    const struct worldfile_entity *in_order[WORLDFILE_DEFINITIONS_MAX];
    size_t count = 0;
    for (; definition; definition = definition->next) {
        if (stage_needs(s, definition) && stage_kinds(definition) != 0) {
            in_order[count++] = definition;
        }
    }
    while (count > 0) {
        definition = in_order[--count];
        fputs("\ndefine ", s->to);
        stage_print_name(s, definition);
        fputs(" ", s->to);
        stage_print_type(s, definition);
        fputs(" (\n", s->to);
        MU_TRY(stage_print_body(s, definition, 1));
        fputs(")\n", s->to);
    }
    return MU_OK;
}

static mu_result stage_print(struct stage *s)
{
    const struct worldfile_entity *root = &s->source->root;
    fputs("# A world of Stage in one file, without what has no effect in muster.\n\n", s->to);
    for (const struct worldfile_property *p = root->properties; p; p = p->next) {
        if (properties_read_there(p->key, PROPERTY_WORLD)) {
            MU_TRY(stage_print_property(s, p));
        }
    }
    MU_TRY(stage_print_definitions(s, s->source->definitions));
    fputs("\n", s->to);
    for (const struct worldfile_entity *e = root->children; e; e = e->next) {
        MU_TRY(stage_print_model(s, e, 0));
    }
    return MU_OK;
}

mu_result world_files_import_stage(const struct world_files_options *options, FILE *to,
                                   struct mu_fault *fault)
{
    struct world *world = mu_startup_alloc(sizeof *world);
    struct stage *s = mu_startup_alloc(sizeof *s);
    MU_TRY(world_load(world, options->file, false, fault));
    *s = (struct stage){.options = options, .source = world->source, .to = to, .fault = fault};
    stage_collect(s, &world->source->root);
    for (const struct worldfile_entity *e = world->source->definitions; e; e = e->next) {
        if (strcmp(e->at.file, options->file) == 0 && !stage_needs(s, e)) {
            s->needed[s->needed_count++] = e; /* experiments may ask for it */
            stage_collect(s, e);
        }
    }
    return stage_print(s);
}
