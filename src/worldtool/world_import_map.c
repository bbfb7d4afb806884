/* SPDX-License-Identifier: Apache-2.0 */
/* muster world import of a map of ROS's map_server: a picture, and a YAML file that says how large.
 */
#include "core/json.h"
#include "core/text_file.h"
#include "experiment/yaml/yaml_tree.h"
#include "muster/memory.h"
#include "world/parse/parser.h"
#include "worldtool/worldtool.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAP_BYTES_MAX = 1 << 16 };

bool world_import_picture(const struct world_files_options *options, const char *picture,
                          char *path, size_t size)
{
    char own[PATH_MAX];
    char folder[PATH_MAX];
    char whole[PATH_MAX];
    if (!realpath(picture, own)) {
        return false;
    }
    const char *name = strrchr(own, '/') + 1;
    snprintf(folder, sizeof folder, "%s", options->out ? options->out : "");
    char *slash = strrchr(folder, '/');
    if (slash) {
        slash[1] = '\0';
    }
    bool beside = options->out && realpath(slash ? folder : ".", whole) &&
                  strlen(whole) == (size_t)(name - 1 - own) &&
                  strncmp(whole, own, strlen(whole)) == 0;
    int len = snprintf(path, size, "%s", beside ? name : own);
    return len > 0 && (size_t)len < size;
}

struct map {
    struct yaml_tree *tree;
    int root;
    struct mu_fault *fault;
    const char *image;
    double resolution_m; /* of a pixel */
    double origin[3];    /* of the picture's left lower corner: m, m, rad */
    double negate, occupied, free;
};

/* Reads a number of the map; without it, *value stays, unless it is needed. */
static mu_result map_number(struct map *m, int node, const char *what, double least, double most,
                            double *value)
{
    static const struct yaml_key real = {.kind = YAML_KEY_REAL};
    const char *text = yaml_tree_scalar(m->tree, node);
    if (yaml_keys_put(&real, value, text) || !(*value >= least && *value <= most)) {
        return yaml_tree_fault(m->tree, node ? node : m->root, m->fault,
                               "expected '%s' to be a number from %g to %g, not '%.40s'", what,
                               least, most, text[0] ? text : "nothing");
    }
    return MU_OK;
}

static mu_result map_read_optional(struct map *m, const char *key, double most, double *value)
{
    int node = yaml_tree_child(m->tree, m->root, key);
    return node ? map_number(m, node, key, 0, most, value) : MU_OK;
}

static mu_result map_read_origin(struct map *m)
{
    int node = yaml_tree_child(m->tree, m->root, "origin");
    if (yaml_tree_kind(m->tree, node) != YAML_TREE_LIST || yaml_tree_count(m->tree, node) != 3) {
        return yaml_tree_fault(m->tree, node ? node : m->root, m->fault,
                               "expected 'origin' to be a list of x, y and yaw");
    }
    for (size_t i = 0; i < 3; i++) {
        MU_TRY(map_number(m, yaml_tree_item(m->tree, node, i), "origin", -1e5, 1e5, &m->origin[i]));
    }
    return MU_OK;
}

static mu_result map_check_mode(struct map *m)
{
    int node = yaml_tree_child(m->tree, m->root, "mode");
    const char *mode = node ? yaml_tree_scalar(m->tree, node) : "trinary";
    if (strcmp(mode, "trinary") != 0 && strcmp(mode, "scale") != 0) {
        return yaml_tree_fault(m->tree, node, m->fault,
                               "expected a mode trinary or scale, not '%.40s'", mode);
    }
    return MU_OK;
}

static mu_result map_read(struct map *m)
{
    int image = yaml_tree_child(m->tree, m->root, "image");
    int resolution = yaml_tree_child(m->tree, m->root, "resolution");
    m->image = yaml_tree_scalar(m->tree, image);
    if (m->image[0] == '\0' || strpbrk(m->image, "\"\n")) {
        return yaml_tree_fault(m->tree, image ? image : m->root, m->fault,
                               "expected 'image' to be the name of a picture");
    }
    MU_TRY(map_number(m, resolution, "resolution", 1e-6, 1e4, &m->resolution_m));
    MU_TRY(map_read_origin(m));
    MU_TRY(map_read_optional(m, "negate", 1, &m->negate));
    MU_TRY(map_read_optional(m, "occupied_thresh", 1, &m->occupied));
    MU_TRY(map_read_optional(m, "free_thresh", 1, &m->free));
    if (!(m->free <= m->occupied)) {
        int node = yaml_tree_child(m->tree, m->root, "free_thresh");
        return yaml_tree_fault(m->tree, node ? node : m->root, m->fault,
                               "expected 'free_thresh' (%g) not above 'occupied_thresh' (%g)",
                               m->free, m->occupied);
    }
    return map_check_mode(m);
}

static void map_print_number(FILE *to, double value)
{
    char number[MU_JSON_NUMBER_MAX];
    mu_json_number(number, value);
    fputs(number, to);
}

static void map_print_list(FILE *to, const char *key, const double *values, size_t count)
{
    fprintf(to, "  %s [", key);
    for (size_t i = 0; i < count; i++) {
        fputs(i ? " " : "", to);
        map_print_number(to, values[i]);
    }
    fputs("]\n", to);
}

/*
 * A pixel is occupied where (255 - grey) / 255 is above a threshold, or grey / 255 in a map that is
 * negated; what is not known counts as free.
 */
static void map_print(FILE *to, const struct map *m, const struct bitmap *bitmap, const char *path)
{
    double size[3] = {bitmap->width * m->resolution_m, bitmap->height * m->resolution_m, 1};
    double c = cos(m->origin[2]);
    double s = sin(m->origin[2]);
    double pose[4] = {m->origin[0] + c * size[0] / 2 - s * size[1] / 2,
                      m->origin[1] + s * size[0] / 2 + c * size[1] / 2, 0,
                      m->origin[2] * 180 / M_PI};
    fputs("# A map of ROS's map_server.  Its frame is the world's.\n\nmodel\n(\n  name \"map\"\n"
          "  color \"gray30\"\n",
          to);
    fprintf(to, "  bitmap \"%s\"\n  bitmap_threshold ", path);
    map_print_number(to, 255 * (1 - m->occupied));
    fprintf(to, "   # of 255: what ROS takes for occupied\n%s",
            m->negate != 0 ? "  bitmap_negate 1\n" : "");
    map_print_list(to, "size", size, 3);
    map_print_list(to, "pose", pose, 4);
    fputs(")\n", to);
}

static mu_result map_read_picture(struct map *m, const struct world_files_options *options,
                                  struct bitmap *bitmap, char path[PATH_MAX])
{
    static struct world_file memory;
    const struct bitmap_rule rule = {.threshold = BITMAP_THRESHOLD};
    char beside[MU_FAULT_FILE_MAX + 1];
    int node = yaml_tree_child(m->tree, m->root, "image");
    if (!worldfile_path(options->file, m->image, beside, sizeof beside)) {
        return yaml_tree_fault(m->tree, node, m->fault, "expected a shorter path");
    }
    worldfile_init(&memory);
    const char *problem = bitmap_read(bitmap, beside, &rule, &memory);
    if (problem) {
        return yaml_tree_fault(m->tree, node, m->fault, "cannot read the picture '%.200s': %s",
                               beside, problem);
    }
    if (!world_import_picture(options, beside, path, PATH_MAX) || strchr(path, '"')) {
        return yaml_tree_fault(m->tree, node, m->fault, "expected a path without quotes");
    }
    return MU_OK;
}

static mu_result map_import(struct map *m, const struct world_files_options *options, FILE *to)
{
    struct bitmap bitmap;
    char path[PATH_MAX];
    m->root = yaml_tree_root(m->tree);
    if (yaml_tree_kind(m->tree, m->root) != YAML_TREE_MAPPING) {
        return mu_fault_at(m->fault, options->file, 1, 1,
                           "expected a map: image, resolution, origin, ...");
    }
    MU_TRY(map_read(m));
    MU_TRY(map_read_picture(m, options, &bitmap, path));
    map_print(to, m, &bitmap, path);
    return MU_OK;
}

mu_result world_files_import_map(const struct world_files_options *options, FILE *to,
                                 struct mu_fault *fault)
{
    struct mu_text text = mu_text_in(mu_startup_alloc(MAP_BYTES_MAX), MAP_BYTES_MAX);
    if (mu_text_file_read(options->file, &text, fault) != MU_OK) {
        return MU_FAULT_FILE;
    }
    if (text.cut) {
        return mu_fault_at(fault, options->file, 0, 0, "expected a map of less than %d bytes",
                           MAP_BYTES_MAX);
    }
    struct map m = {.fault = fault, .occupied = 0.65, .free = 0.196}; /* map_server's defaults */
    MU_TRY(yaml_tree_open(&m.tree, options->file, text.at, text.len, fault));
    mu_result done = map_import(&m, options, to);
    yaml_tree_close(m.tree);
    return done;
}
