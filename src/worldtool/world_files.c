/* SPDX-License-Identifier: Apache-2.0 */
/* muster world check, draw, import, properties: the verbs that need no run. */
#include "worldtool/worldtool.h"

#include "core/exits.h"
#include "core/json.h"
#include "core/options.h"
#include "core/text_file.h"
#include "muster/memory.h"
#include "world/parse/parser.h"
#include "world/world_load.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* --- draw and import ----------------------------------------------------------------------------
 */

static bool import_is_map(const char *path)
{
    const char *dot = strrchr(path, '.');
    return dot && (strcmp(dot, ".yaml") == 0 || strcmp(dot, ".yml") == 0);
}

typedef mu_result files_writer(const struct world_files_options *options, FILE *to,
                               struct mu_fault *fault);

static int files_write(const struct world_files_options *options, files_writer *write)
{
    struct mu_draft out;
    struct mu_fault fault = {.text = ""};
    if (options->out && mu_draft_open(&out, NULL, options->out, &fault) != MU_OK) {
        mu_fault_print(&fault);
        return MU_EXIT_WRITE;
    }
    mu_result done = write(options, options->out ? out.file : stdout, &fault);
    if (done != MU_OK) {
        mu_fault_print(&fault);
    }
    if (options->out && mu_draft_close(&out, done == MU_OK, &fault) != MU_OK) {
        mu_fault_print(&fault);
        return MU_EXIT_WRITE;
    }
    return mu_exit_for(done);
}

static int files_draw(const struct world_files_options *options)
{
    return files_write(options, world_files_draw);
}

static int files_import(const struct world_files_options *options)
{
    return files_write(options, import_is_map(options->file) ? world_files_import_map
                                                             : world_files_import_stage);
}

/* --- check --------------------------------------------------------------------------------------
 */

struct check {
    const struct world_files_options *options;
    size_t mistakes, warnings;
};

static void check_tell(void *self, const struct mu_fault *fault, bool mistake)
{
    struct check *check = self;
    *(mistake ? &check->mistakes : &check->warnings) += 1;
    if (!check->options->json) {
        mu_fault_print_to(stdout, fault, mistake ? "" : "warning: ");
        return;
    }
    struct mu_json j = mu_json_line(stdout);
    mu_json_string(&j, "kind", mistake ? "mistake" : "warning");
    mu_json_string(&j, "file", fault->file);
    mu_json_int(&j, "line", fault->line);
    mu_json_int(&j, "column", fault->column);
    mu_json_string(&j, "text", fault->text);
    mu_json_end(&j);
}

/* What a world holds, in numbers. */
struct check_row {
    const char *name, *text; /* of the JSON's key, of the line */
    size_t count;
};

enum { CHECK_ROWS = 9 };

static void check_count(const struct world *w, struct check_row rows[CHECK_ROWS])
{
    static const struct check_row empty[CHECK_ROWS] = {
        {"obstacles", "pieces that stand still", 0},
        {"objects", "things that can be moved", 0},
        {"robots", "robots", 0},
        {"sonars", "sonars", 0},
        {"lasers", "lasers", 0},
        {"cameras", "cameras", 0},
        {"finders", "fiducial finders", 0},
        {"grippers", "grippers", 0},
        {"batteries", "batteries", 0},
    };
    memcpy(rows, empty, sizeof empty);
    rows[0].count = w->shape_count;
    rows[1].count = w->object_count;
    rows[2].count = w->robot_count;
    for (size_t i = 0; i < w->robot_count; i++) {
        const struct world_robot *r = &w->robots[i];
        rows[3].count += r->sonar_count;
        rows[4].count += r->laser.samples > 0;
        rows[5].count += r->camera.columns > 0;
        rows[6].count += r->finder.range_max_m > 0;
        rows[7].count += r->gripper.length_m > 0;
        rows[8].count += r->battery_max_j > 0;
    }
}

static void check_print(const struct world *w)
{
    struct check_row rows[CHECK_ROWS];
    check_count(w, rows);
    printf("%s is a world of %.2f x %.2f m, from %.2f %.2f to %.2f %.2f\n", w->file,
           w->max_x_m - w->min_x_m, w->max_y_m - w->min_y_m, w->min_x_m, w->min_y_m, w->max_x_m,
           w->max_y_m);
    for (size_t i = 0; i < CHECK_ROWS; i++) {
        if (rows[i].count > 0) {
            printf("  %-24s %zu\n", rows[i].text, rows[i].count);
        }
    }
}

static void check_print_json(const struct world *w, const struct check *check)
{
    struct check_row rows[CHECK_ROWS];
    check_count(w, rows);
    struct mu_json j = mu_json_line(stdout);
    mu_json_string(&j, "kind", "world");
    mu_json_string(&j, "file", w->file);
    mu_json_uint(&j, "mistakes", check->mistakes);
    mu_json_uint(&j, "warnings", check->warnings);
    mu_json_real(&j, "min_x_m", w->min_x_m);
    mu_json_real(&j, "min_y_m", w->min_y_m);
    mu_json_real(&j, "max_x_m", w->max_x_m);
    mu_json_real(&j, "max_y_m", w->max_y_m);
    for (size_t i = 0; i < CHECK_ROWS; i++) {
        mu_json_uint(&j, rows[i].name, rows[i].count);
    }
    mu_json_end(&j);
}

/* Loads a world and looks at its places.  @return MU_OK when all is well */
static mu_result check_world(struct world *world, struct check *check)
{
    struct mu_fault fault = {.text = ""};
    struct mu_fault_listener listener = {.tell = check_tell, .self = check};
    struct world_options options = {.seed = (uint64_t)check->options->seed, .listener = &listener};
    mu_result opened = world_open(world, check->options->file, &options, &fault);
    if (opened != MU_OK && check->mistakes == 0) {
        check_tell(check, &fault, true); /* there is no file to go on with */
        return opened;
    }
    mu_result placed = world_check_places(world, &listener, &fault);
    return opened != MU_OK ? opened : placed;
}

static int files_check(const struct world_files_options *options)
{
    struct check check = {.options = options};
    struct world *world = mu_startup_alloc(sizeof *world);
    mu_result done = check_world(world, &check);
    if (options->json) {
        check_print_json(world, &check);
    } else if (done == MU_OK) {
        check_print(world);
    } else {
        printf("%zu mistake%s, %zu warning%s\n", check.mistakes, check.mistakes == 1 ? "" : "s",
               check.warnings, check.warnings == 1 ? "" : "s");
    }
    return mu_exit_for(done);
}

static int files_properties(const struct world_files_options *options)
{
    (void)options;
    properties_print();
    return MU_EXIT_DONE;
}

/* --- the verb -----------------------------------------------------------------------------------
 */

int world_files_run(const struct mu_options *o, struct world_files_options *options)
{
    static const struct {
        const char *word;
        size_t words; /* with this one */
        int (*run)(const struct world_files_options *options);
    } requests[] = {
        {"check", 2, files_check},
        {"draw", 2, files_draw},
        {"import", 2, files_import},
        {"properties", 1, files_properties},
    };
    for (size_t i = 0; i < sizeof requests / sizeof requests[0]; i++) {
        if (o->words_count == requests[i].words && strcmp(o->words[0], requests[i].word) == 0) {
            options->file = o->words_count > 1 ? o->words[1] : NULL;
            return requests[i].run(options);
        }
    }
    fprintf(stderr, "muster world: expected check FILE, draw FILE, import FILE or properties, for "
                    "example: muster world check worlds/arena.world; or, of a run that lives, "
                    "place, push, reset, sensor, pace or save\n");
    return MU_EXIT_USAGE;
}
