/* SPDX-License-Identifier: Apache-2.0 */
#include "world/parse/parser.h"

#include "core/spell.h"

#include <stdio.h>
#include <string.h>

#define DEVICES (PROPERTY_RANGER | PROPERTY_CAMERA | PROPERTY_FINDER | PROPERTY_GRIPPER)
#define BODIES  (PROPERTY_SOLID | PROPERTY_ROBOT)
#define MOUNTED (PROPERTY_PART | DEVICES)
#define MODELS  (BODIES | MOUNTED)

/* The properties that are read.  values: as `muster world properties` shows them. */
static const struct {
    const char *key;
    int kinds;
    const char *values, *help;
} properties_read[] = {
    {"unit_length", PROPERTY_WORLD, "m, cm or mm", "what all lengths of the file are in"},
    {"unit_angle", PROPERTY_WORLD, "degrees or radians", "what all angles are in"},
    {"interval_sim", PROPERTY_WORLD, "ms", "length of a control step, a multiple of 20"},
    {"seed", PROPERTY_WORLD, "number", "of random places; without it, the run's (ours)"},
    {"name", MODELS, "text", "unique; without it, the type and a number"},
    {"pose", MODELS | PROPERTY_SENSOR, "[x y z heading]",
     "m and degrees, in the frame of what it stands in; z is passed over"},
    {"size", MODELS, "[x y z]", "m; 0.1 each without it; of what moves, 0.001 to 1000"},
    {"color", MODELS, "text", "an X11 name or \"#rrggbb\"; red without it"},
    {"color_rgba", MODELS, "[r g b a]", "the same as shares of 1; a is passed over"},
    {"origin", BODIES, "[x y z heading]", "the middle of the shape, seen from the pose"},
    {"obstacle_return", BODIES, "0 or 1", "whether bodies bump into it; 1"},
    {"ranger_return", BODIES, "number",
     "a laser's intensity; below 0: sonar and laser look through it; 1"},
    {"laser_return", BODIES, "number", "a laser's intensity; without it, as ranger_return"},
    {"blob_return", BODIES, "0 or 1", "whether the camera sees it; 1, on a mark on the floor 0"},
    {"gripper_return", BODIES, "0 or 1",
     "whether a gripper can take it; such a model at the top of the file can be moved"},
    {"fiducial_return", BODIES | PROPERTY_PART, "number", "that a fiducial finder reads; 0: none"},
    {"give_watts", BODIES, "W", "that it charges robots with that touch it"},
    {"bitmap", PROPERTY_SOLID, "text", "a floor plan, PNG or PNM, beside the file; dark is solid"},
    {"bitmap_threshold", PROPERTY_SOLID, "0 to 256", "greys below it are solid; 127 (ours)"},
    {"bitmap_negate", PROPERTY_SOLID, "0 or 1", "bright is solid (ours)"},
    {"boundary", PROPERTY_SOLID, "0 or 1", "walls of 0.2 m around it"},
    {"movable", PROPERTY_SOLID, "0 or 1", "it can be pushed (ours)"},
    {"friction", PROPERTY_SOLID, "0 to 10", "of a movable thing on the floor; 0.5"},
    {"mass", BODIES, "kg", "0.001 to 1e6; 10 without it"},
    {"drive", PROPERTY_ROBOT, "diff", "two wheels; omni and car are not supported"},
    {"velocity_bounds", PROPERTY_ROBOT, "[x x y y z z a a]",
     "each least and most: m/s and degrees/s; only x and a count"},
    {"acceleration_bounds", PROPERTY_ROBOT, "[x x y y z z a a]", "the same for accelerations"},
    {"localization", PROPERTY_ROBOT, "gps or odom", "what its position comes from"},
    {"localization_origin", PROPERTY_ROBOT, "[x y z heading]",
     "where the odometer counts from; where the robot starts"},
    {"odom_error", PROPERTY_ROBOT, "[x y z a]",
     "errors of the odometer as shares; [0.03 0.03 0 0.05] with odom, else 0"},
    {"gps_noise", PROPERTY_ROBOT, "[m drift]", "deviation in m, drift in m per root of s (ours)"},
    {"compass_noise", PROPERTY_ROBOT, "degrees", "deviation of the compass (ours)"},
    {"joules", BODIES, "J", "in the battery at the start; below 0: it never ends"},
    {"kjoules", BODIES, "kJ", "the same"},
    {"joules_capacity", BODIES, "J", "of a full battery; what is in it at the start"},
    {"kjoules_capacity", BODIES, "kJ", "the same"},
    {"watts", PROPERTY_ROBOT | MOUNTED, "W", "that it uses at all times; all of a robot add up"},
    {"take_watts", PROPERTY_ROBOT | MOUNTED, "W", "that the robot can be charged with"},
    {"update_interval", DEVICES, "ms", "between two readings; every control step without it"},
    {"range", PROPERTY_SENSOR, "[min max]", "m; [0 5]"},
    {"range", PROPERTY_CAMERA, "m", "12"},
    {"view", PROPERTY_SENSOR, "[min max fov]", "range and fov at once, as old files have it"},
    {"range_min", PROPERTY_FINDER | PROPERTY_SENSOR, "m", "0"},
    {"range_max", PROPERTY_FINDER | PROPERTY_SENSOR, "m", "8"},
    {"range_max_id", PROPERTY_FINDER, "m", "how far numbers can be read; 5"},
    {"fov", PROPERTY_SENSOR | PROPERTY_CAMERA | PROPERTY_FINDER, "degrees",
     "field of view; 15, of a camera 60, of a finder 180"},
    {"samples", PROPERTY_SENSOR, "number", "1: a sonar; more: the laser's beams"},
    {"noise", PROPERTY_SENSOR, "[m share degrees]",
     "deviations: constant, in proportion to the range, of the angle"},
    {"specular", PROPERTY_SENSOR, "degrees",
     "echoes of a sonar from flatter angles of incidence are lost; 0: none (ours)"},
    {"rays", PROPERTY_SENSOR, "number", "of a sonar over its cone, the nearest counts; 1 (ours)"},
    {"colors_count", PROPERTY_CAMERA, "number", "how many of `colors` count"},
    {"colors", PROPERTY_CAMERA, "[text ...]", "that it looks for; without them, all"},
    {"image", PROPERTY_CAMERA, "[columns rows]", "[80 60]"},
    {"pan", PROPERTY_CAMERA, "degrees", "where it looks to, from its pose"},
    {"paddle_size", PROPERTY_GRIPPER, "[x y z]", "as shares of its size; [0.66 0.1 0.4]"},
    {"paddle_state", PROPERTY_GRIPPER, "[text text]", "open or closed, down or up"},
    {"points", PROPERTY_BLOCK, "number", "corners of a polygon"},
    {"point", PROPERTY_BLOCK, "[x y]", "point[0] and so on; all blocks are scaled to the size"},
    {"model", PROPERTY_DISTRIBUTE, "word", "the definition of what is put there (ours)"},
    {"count", PROPERTY_DISTRIBUTE, "number", "how many (ours)"},
    {"region", PROPERTY_DISTRIBUTE, "[x0 y0 x1 y1]", "m; without it, all of the world (ours)"},
    {"gap", PROPERTY_DISTRIBUTE, "m", "that stays free around each; 0.05 (ours)"},
};

enum { PROPERTIES_READ = sizeof properties_read / sizeof properties_read[0] };

/* Passed over without a word where they are not read: a window, a raster, how a case looks. */
static const char *const properties_silent[] = {
    "alwayson",
    "debug",
    "ignore_zloc",
    "interval_real",
    "map_resolution",
    "noblocks",
    "paused",
    "resolution",
    "speedup",
    "stack_children",
    "threads",
    "trail_length",
    "trail_interval",
    "z",
    "color",
    "color_rgba",
    "size",
    "name",
    "update_interval",
    "obstacle_return",
    "ranger_return",
    "blob_return",
    "gripper_return",
};

/* Properties of Stage without effect here; they are no spelling mistakes. */
static const char *const properties_of_stage[] = {
    "add_noise",
    "autosnatch",
    "bcount",
    "blength",
    "blobfinder_return",
    "bpose",
    "channel_count",
    "channels",
    "ctrl",
    "event_queue",
    "fiducial_key",
    "file_open",
    "lit",
    "max_range",
    "max_speed",
    "min_range",
    "odom",
    "pantilt",
    "power_on",
    "quit_time",
    "range_dependent",
    "say",
    "scount",
    "shape",
    "show_clock",
    "show_clock_interval",
    "size3",
    "spose",
    "ssize",
    "sview",
    "velocity",
    "watchdog",
    "wheelbase",
};

static bool properties_listed(const char *const *list, size_t count, const char *key)
{
    for (size_t i = 0; i < count; i++) {
        if (strcmp(list[i], key) == 0) {
            return true;
        }
    }
    return false;
}

#define LISTED(list, key) properties_listed(list, sizeof(list) / sizeof(list)[0], key)

bool properties_read_there(const char *key, int kinds)
{
    for (size_t i = 0; i < PROPERTIES_READ; i++) {
        if ((properties_read[i].kinds & kinds) && strcmp(properties_read[i].key, key) == 0) {
            return true;
        }
    }
    return false;
}

bool properties_known(const char *key, enum property_kind kind)
{
    return strncmp(key, "gui_", 4) == 0 || strncmp(key, "show_", 5) == 0 ||
           LISTED(properties_silent, key) || properties_read_there(key, (int)kind);
}

const char *properties_near(const char *key, enum property_kind kind)
{
    if (LISTED(properties_of_stage, key)) {
        return NULL;
    }
    struct mu_spell spell;
    mu_spell_init(&spell, key);
    for (size_t i = 0; i < PROPERTIES_READ; i++) {
        if (strcmp(properties_read[i].key, key) == 0) {
            return NULL; /* a good word in the wrong place */
        }
        if (properties_read[i].kinds & (int)kind) {
            mu_spell_offer(&spell, properties_read[i].key);
        }
    }
    return spell.nearest;
}

/* Prints the owners of a row, in the words of a world file. */
static void properties_print_kinds(int kinds)
{
    static const struct {
        int bits;
        const char *text;
    } names[] = {
        {PROPERTY_WORLD, "the file"},        {PROPERTY_SOLID, "model"},
        {PROPERTY_ROBOT, "position"},        {PROPERTY_PART, "model on a position"},
        {PROPERTY_RANGER, "ranger"},         {PROPERTY_SENSOR, "sensor, laser, sonar"},
        {PROPERTY_CAMERA, "blobfinder"},     {PROPERTY_FINDER, "fiducial"},
        {PROPERTY_GRIPPER, "gripper"},       {PROPERTY_BLOCK, "block"},
        {PROPERTY_DISTRIBUTE, "distribute"},
    };
    const char *comma = "";
    if ((kinds & MODELS) == MODELS) {
        fputs("all models", stdout);
        kinds &= ~MODELS;
        comma = ", ";
    }
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (kinds & names[i].bits) {
            printf("%s%s", comma, names[i].text);
            comma = ", ";
        }
    }
}

void properties_print(void)
{
    puts("| Property | Of | Values | Meaning |\n| --- | --- | --- | --- |");
    for (size_t i = 0; i < PROPERTIES_READ; i++) {
        printf("| `%s` | ", properties_read[i].key);
        properties_print_kinds(properties_read[i].kinds);
        printf(" | %s | %s |\n", properties_read[i].values, properties_read[i].help);
    }
}
