/* SPDX-License-Identifier: Apache-2.0 */
/* The bodies of robots: Stage's `position`. */
#include "core/name.h"
#include "core/text.h"
#include "world/read/builder.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Stage's defaults for properties that a file leaves out. */
static const double body_bounds[8] = {-1, 1, -1, 1, -1, 1, -90, 90};
static const double body_mass_kg = 10;

#define BODY_BOUND 1e5 /* of speeds and accelerations; the physics has closer ones */

/* Stage writes [x x y y z z heading heading], each min and max, angles in degrees. */
static mu_result body_read_bounds(struct builder *b, const struct worldfile_entity *entity,
                                  const char *key, double v[8])
{
    memcpy(v, body_bounds, sizeof body_bounds);
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){key, v, 8, 8, "llllllaa"}));
    for (size_t i = 0; i < 8; i += 2) {
        if (!(v[i] <= 0 && v[i + 1] >= 0 && v[i] >= -BODY_BOUND && v[i + 1] <= BODY_BOUND)) {
            struct mu_fault_place at = builder_place(entity, key);
            return builder_fault(b, &at,
                                 "expected '%s' with each min <= 0 <= max, up to %g, found %g and "
                                 "%g",
                                 key, BODY_BOUND, v[i], v[i + 1]);
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
        struct mu_fault_place at = builder_place(entity, "acceleration_bounds");
        return builder_fault(b, &at, "expected accelerations above 0: the robot could not move");
    }
    robot->mass_kg = body_mass_kg;
    MU_TRY(builder_number(b, entity, (struct builder_numbers){"mass", &robot->mass_kg, 1, 1, NULL},
                          1e-3, 1e6));
    return MU_OK;
}

static mu_result body_read_drive(struct builder *b, const struct worldfile_entity *entity)
{
    const char *drive = "diff";
    MU_TRY(builder_text(b, entity, "drive", &drive));
    struct mu_fault_place at = builder_place(entity, "drive");
    if (strcmp(drive, "omni") == 0 || strcmp(drive, "car") == 0) {
        builder_warn(b, &at, drive, "is not supported: a robot drives on two wheels (\"diff\")");
    } else if (strcmp(drive, "diff") != 0) {
        return builder_fault(b, &at, "expected a drive \"diff\", found '%.40s'", drive);
    }
    return MU_OK;
}

/* The errors of Stage's odometer, for a position that comes from it. */
static const double body_odom_error[4] = {0.03, 0.03, 0, 0.05};

static mu_result body_read_odometer(struct builder *b, const struct worldfile_entity *entity,
                                    struct world_robot *robot)
{
    double error[4] = {0, 0, 0, 0}; /* x y z heading; or x y heading, as older files have it */
    const char *localization = "gps";
    MU_TRY(builder_text(b, entity, "localization", &localization));
    robot->reads_odometer = strcmp(localization, "odom") == 0;
    if (!robot->reads_odometer && strcmp(localization, "gps") != 0) {
        struct mu_fault_place at = builder_place(entity, "localization");
        return builder_fault(b, &at, "expected a localization \"gps\" or \"odom\", found '%.40s'",
                             localization);
    }
    if (robot->reads_odometer) {
        memcpy(error, body_odom_error, sizeof error);
    }
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"odom_error", error, 3, 4, NULL}));
    const struct worldfile_property *p = worldfile_property(entity, "odom_error");
    for (size_t i = 0; i < 4; i++) {
        if (!(error[i] >= 0 && error[i] <= 2)) {
            return builder_fault(b, &p->at, "expected shares of 0 to 2, found %g", error[i]);
        }
    }
    robot->odometry.forward_error = error[0];
    robot->odometry.side_error = error[1];
    robot->odometry.turn_error = p && p->value_count == 3 ? error[2] : error[3];
    return MU_OK;
}

mu_result body_read_start(struct builder *b, const struct worldfile_entity *entity,
                          struct world_robot *robot)
{
    double v[4] = {0, 0, 0, 0};
    struct world_odometry *odometry = &robot->odometry;
    odometry->start = (struct world_pose){0}; /* it counts from where the robot stands */
    odometry->true_start = false;
    if (!entity || !worldfile_property(entity, "localization_origin")) {
        return MU_OK;
    }
    MU_TRY(builder_numbers(b, entity,
                           (struct builder_numbers){"localization_origin", v, 2, 4, "llla"}));
    if (fabs(v[0]) > BUILDER_POSE_MAX_M || fabs(v[1]) > BUILDER_POSE_MAX_M) {
        struct mu_fault_place at = builder_place(entity, "localization_origin");
        return builder_fault(b, &at, "expected a place within %g m", BUILDER_POSE_MAX_M);
    }
    struct world_pose origin = {v[0], v[1], remainder(v[3], 360) * M_PI / 180};
    odometry->start = world_pose_from(origin, robot->pose);
    odometry->true_start = v[0] == 0 && v[1] == 0 && v[3] == 0;
    return MU_OK;
}

static mu_result body_read_errors(struct builder *b, const struct worldfile_entity *entity,
                                  struct world_robot *robot)
{
    double gps[2] = {0, 0};
    double compass_deg = 0;
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"gps_noise", gps, 1, 2, "ll"}));
    MU_TRY(builder_number(
        b, entity, (struct builder_numbers){"compass_noise", &compass_deg, 1, 1, "a"}, 0, 360));
    if (!(gps[0] >= 0 && gps[0] <= 1e6 && gps[1] >= 0 && gps[1] <= 1e6)) {
        struct mu_fault_place at = builder_place(entity, "gps_noise");
        return builder_fault(b, &at, "expected deviations of 0 or more, found [%g %g]", gps[0],
                             gps[1]);
    }
    robot->gps_noise_m = gps[0];
    robot->gps_drift_m = gps[1];
    robot->compass_noise_rad = compass_deg * M_PI / 180;
    return MU_OK;
}

/* Energy stands in joules, or in kilojoules, which count more. */
static mu_result body_read_energy(struct builder *b, const struct worldfile_entity *entity,
                                  const char *const keys[2], double *energy_j)
{
    double kilo = 0;
    MU_TRY(builder_number(b, entity, (struct builder_numbers){keys[0], energy_j, 1, 1, NULL}, -1e12,
                          1e12));
    MU_TRY(
        builder_number(b, entity, (struct builder_numbers){keys[1], &kilo, 1, 1, NULL}, -1e9, 1e9));
    *energy_j = kilo != 0 ? kilo * 1000 : *energy_j;
    return MU_OK;
}

static mu_result body_read_battery(struct builder *b, const struct worldfile_entity *entity,
                                   struct world_robot *robot)
{
    static const char *const stored[2] = {"joules", "kjoules"};
    static const char *const full[2] = {"joules_capacity", "kjoules_capacity"};
    double stored_j = 0;
    double full_j = 0;
    MU_TRY(body_read_energy(b, entity, stored, &stored_j));
    MU_TRY(body_read_energy(b, entity, full, &full_j));
    if (stored_j < 0) { /* Stage's infinite store */
        return MU_OK;
    }
    robot->battery_max_j = full_j > 0 ? full_j : stored_j;
    robot->battery_j = fmin(stored_j, robot->battery_max_j);
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
    struct mu_fault_place at = builder_place(entity, "name");
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

static mu_result body_read_outline(struct builder *b, const struct worldfile_entity *entity,
                                   struct world_robot *robot)
{
    double size_m[2];
    MU_TRY(builder_size(b, entity, size_m));
    MU_TRY(builder_check_body(b, entity, size_m[0], size_m[1]));
    robot->length_m = size_m[0];
    robot->width_m = size_m[1];
    double origin[4] = {0, 0, 0, 0};
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"origin", origin, 2, 4, "llla"}));
    if (fabs(origin[0]) > robot->length_m || fabs(origin[1]) > robot->width_m) {
        struct mu_fault_place at = builder_place(entity, "origin");
        return builder_fault(b, &at, "expected an origin on the robot");
    }
    robot->origin_x_m = origin[0];
    robot->origin_y_m = origin[1];
    return MU_OK;
}

/* The colour of its track is the file's own word for it. */
static mu_result body_read_color(struct builder *b, const struct worldfile_entity *entity,
                                 struct world_robot *robot)
{
    const char *color = "red"; /* as Stage's models without a colour */
    MU_TRY(builder_text(b, entity, "color", &color));
    uint32_t rgb;
    if (!look_color(color, &rgb) || rgb != robot->look.rgb) { /* color_rgba */
        snprintf(robot->color, sizeof robot->color, "#%06x", robot->look.rgb);
    } else if (!mu_text_copy(robot->color, sizeof robot->color, color)) {
        snprintf(robot->color, sizeof robot->color, "#%06x", rgb);
    }
    return MU_OK;
}

mu_result body_read(struct builder *b, const struct worldfile_entity *entity,
                    struct world_pose frame, struct world_robot *robot)
{
    static mu_result (*const parts[])(struct builder * b, const struct worldfile_entity *entity,
                                      struct world_robot *robot) = {
        body_read_name,  body_read_outline, body_read_color,   body_read_limits, body_read_odometer,
        body_read_start, body_read_errors,  body_read_battery, device_read_all,
    };
    *robot = (struct world_robot){.length_m = 0.1, .width_m = 0.1};
    builder_warn_unknown(b, entity, PROPERTY_ROBOT);
    MU_TRY(builder_go_on(b, body_read_drive(b, entity)));
    mu_result placed = builder_pose(b, entity, frame, &robot->pose);
    placed = placed == MU_OK ? body_read_outline(b, entity, robot) : placed;
    b->misplaced = placed != MU_OK;
    MU_TRY(builder_go_on(b, placed));
    MU_TRY(builder_go_on(b, look_read(b, entity, &robot->look)));
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        MU_TRY(builder_go_on(b, parts[i](b, entity, robot)));
    }
    return MU_OK;
}
