/* SPDX-License-Identifier: Apache-2.0 */
/* The bodies of robots: what Stage's `position` and the rangers on it say. */
#include "core/name.h"
#include "core/text.h"
#include "world/builder.h"

#include <math.h>
#include <string.h>

struct body_reader {
    struct builder *builder;
    struct world_robot *robot;
    struct world_pose mount; /* of the ranger that is read, in the robot's frame */
};

/* Stage's defaults for what a model file leaves out. */
static const double body_bounds[8] = {-1, 1, -1, 1, -1, 1, -90, 90};
static const double body_mass_kg = 10;

/* One transducer.  A sensor with several samples is a laser. */
static mu_result body_read_sensor(void *context, const struct worldfile_entity *entity)
{
    struct body_reader *reader = context;
    struct builder *b = reader->builder;
    struct world_robot *robot = reader->robot;
    const char *kind = worldfile_kind(entity);
    if (strcmp(kind, "sensor") != 0) { /* blocks only draw the case */
        return strcmp(kind, "block") == 0 ? MU_OK : builder_skip_model(b, entity);
    }
    builder_warn_unknown(b, entity, BUILDER_SENSOR);
    double samples = 1;
    double view[3] = {0, 5, 15}; /* min_m, max_m, fov_deg */
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"samples", &samples, 1, 1}));
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"view", view, 3, 3}));
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"range", view, 2, 2}));
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"fov", &view[2], 1, 1}));
    struct world_pose pose;
    MU_TRY(builder_pose(b, entity, reader->mount, &pose));
    if (samples > 1) {
        builder_warn(b, &entity->at, entity->type,
                     "has more than one sample: lasers are not supported yet");
        return MU_OK;
    }
    struct worldfile_place at = builder_place(entity, "range");
    if (!(view[0] >= 0 && view[1] > view[0] && view[1] <= BUILDER_POSE_MAX_M)) {
        return builder_fault(b, &at, "expected a range [min max] with 0 <= min < max, found %g, %g",
                             view[0], view[1]);
    }
    if (robot->sonar_count == MU_SONARS_MAX) {
        return builder_fault(b, &entity->at, "more than %d sonars on one robot", MU_SONARS_MAX);
    }
    robot->sonars[robot->sonar_count++] = (struct world_sonar){
        .pose = pose,
        .range_min_m = view[0],
        .range_max_m = view[1],
        .fov_rad = view[2] * M_PI / 180,
        .rays = 1,
    };
    return MU_OK;
}

static mu_result body_read_part(void *context, const struct worldfile_entity *entity)
{
    struct body_reader *reader = context;
    const char *kind = worldfile_kind(entity);
    if (strcmp(kind, "ranger") == 0) {
        builder_warn_unknown(reader->builder, entity, BUILDER_RANGER);
        MU_TRY(builder_pose(reader->builder, entity, (struct world_pose){0}, &reader->mount));
        return builder_children(entity, body_read_sensor, reader);
    }
    if (strcmp(kind, "block") == 0) { /* the outline is the size, which Stage's blocks fill */
        return MU_OK;
    }
    return builder_skip_model(reader->builder, entity);
}

/* Stage writes [x x y y z z heading heading], each min and max, angles in degrees. */
static mu_result body_read_bounds(struct builder *b, const struct worldfile_entity *entity,
                                  const char *key, double v[8])
{
    memcpy(v, body_bounds, sizeof body_bounds);
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){key, v, 8, 8}));
    for (size_t i = 0; i < 8; i += 2) {
        if (!(v[i] <= 0 && v[i + 1] >= 0)) {
            struct worldfile_place at = builder_place(entity, key);
            return builder_fault(b, &at, "expected '%s' with each min <= 0 <= max, found %g and %g",
                                 key, v[i], v[i + 1]);
        }
    }
    return MU_OK;
}

static mu_result body_read_limits(struct builder *b, const struct worldfile_entity *entity,
                                  struct world_robot *robot)
{
    double v[8];
    MU_TRY(body_read_bounds(b, entity, "velocity_bounds", v));
    robot->forward_max_m_s = v[1];
    robot->reverse_max_m_s = -v[0];
    robot->turn_max_rad_s = fmin(-v[6], v[7]) * M_PI / 180;
    MU_TRY(body_read_bounds(b, entity, "acceleration_bounds", v));
    robot->forward_accel_m_s2 = v[1];
    robot->turn_accel_rad_s2 = fmin(-v[6], v[7]) * M_PI / 180;
    if (!(robot->forward_accel_m_s2 > 0 && robot->turn_accel_rad_s2 > 0)) {
        struct worldfile_place at = builder_place(entity, "acceleration_bounds");
        return builder_fault(b, &at, "expected accelerations above 0: the robot could not move");
    }
    robot->mass_kg = body_mass_kg;
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"mass", &robot->mass_kg, 1, 1}));
    if (!(robot->mass_kg > 0 && robot->mass_kg <= 1e6)) {
        struct worldfile_place at = builder_place(entity, "mass");
        return builder_fault(b, &at, "expected a mass above 0 and up to 1e6 kg, found %g",
                             robot->mass_kg);
    }
    return MU_OK;
}

/* Of what Stage simulates in several ways, the one that muster does. */
static mu_result body_warn_choices(struct builder *b, const struct worldfile_entity *entity)
{
    static const struct {
        const char *key, *is, *warning;
    } choices[] = {
        {"drive", "diff", "is not supported: a robot drives on two wheels (\"diff\")"},
        {"localization", "gps", "is not supported: the position is exact (\"gps\")"},
    };
    for (size_t i = 0; i < sizeof choices / sizeof choices[0]; i++) {
        const char *text = choices[i].is;
        MU_TRY(builder_text(b, entity, choices[i].key, &text));
        if (strcmp(text, choices[i].is) != 0) {
            struct worldfile_place at = builder_place(entity, choices[i].key);
            builder_warn(b, &at, text, choices[i].warning);
        }
    }
    return MU_OK;
}

static mu_result body_read_name(struct builder *b, const struct worldfile_entity *entity,
                                struct world_robot *robot)
{
    const char *name = NULL;
    MU_TRY(builder_text(b, entity, "name", &name));
    if (!name) {
        robot->name[0] = '\0';
        return MU_OK;
    }
    struct worldfile_place at = builder_place(entity, "name");
    if (!mu_name_valid(name)) {
        return builder_fault(b, &at,
                             "expected a robot's name of a letter or '_', then letters, digits and "
                             "'_.-', %d in all, found '%.40s'",
                             MU_NAME_MAX, name);
    }
    if (mu_name_reserved(name)) {
        return builder_fault(b, &at, "expected another name for a robot: '%s' is reserved", name);
    }
    mu_text_copy(robot->name, sizeof robot->name, name);
    return MU_OK;
}

mu_result body_read(struct builder *b, const struct worldfile_entity *entity,
                    struct world_pose frame, struct world_robot *robot)
{
    *robot = (struct world_robot){.color = "red", /* as Stage's models without a colour */
                                  .look = {.stops = true, .echoes = true, .shows = true}};
    builder_warn_unknown(b, entity, BUILDER_ROBOT);
    MU_TRY(body_warn_choices(b, entity));
    MU_TRY(body_read_name(b, entity, robot));
    MU_TRY(builder_pose(b, entity, frame, &robot->pose));
    double size_m[2];
    MU_TRY(builder_size(b, entity, size_m));
    robot->length_m = size_m[0];
    robot->width_m = size_m[1];
    double origin[4] = {0, 0, 0, 0};
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"origin", origin, 2, 4}));
    if (fabs(origin[0]) > robot->length_m || fabs(origin[1]) > robot->width_m) {
        struct worldfile_place at = builder_place(entity, "origin");
        return builder_fault(b, &at, "expected an origin on the robot");
    }
    robot->origin_x_m = origin[0];
    robot->origin_y_m = origin[1];
    const char *color = robot->color;
    MU_TRY(builder_text(b, entity, "color", &color));
    char copy[sizeof robot->color];
    if (!mu_text_copy(copy, sizeof copy, color)) {
        struct worldfile_place at = builder_place(entity, "color");
        return builder_fault(b, &at, "expected a colour of at most %zu letters", sizeof copy - 1);
    }
    memcpy(robot->color, copy, sizeof copy);
    MU_TRY(body_read_limits(b, entity, robot));
    struct body_reader reader = {.builder = b, .robot = robot};
    return builder_children(entity, body_read_part, &reader);
}
