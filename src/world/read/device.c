/* SPDX-License-Identifier: Apache-2.0 */
/* Devices of robots: sensors, grippers, and the parts that carry them. */
#include "world/read/builder.h"

#include <math.h>
#include <string.h>

enum { DEVICE_RAYS_MAX = 32 };

/* The sonars of robots that have the same. */
struct world_ring {
    struct world_ring *next;
    size_t count;
    struct world_sonar sonars[]; /* without gaps of chance in them: they are compared as bytes */
};

/* The sonars of the robot that is read. */
struct device_sonars {
    struct world_sonar list[MU_SONARS_MAX];
    size_t count;
};

/* The device being read, and its mount. */
struct device_reader {
    struct builder *builder;
    struct world_robot *robot;
    struct device_sonars *sonars;
    struct world_pose mount; /* in the robot's frame */
    uint64_t period_ns;      /* of the ranger that is read */
    int depth;
};

/* A sensor of ranges, before it is known whether it is a sonar or the laser. */
struct device_range {
    struct world_pose pose;
    double view[3]; /* min_m, max_m, fov_deg */
    uint32_t samples;
    struct world_noise noise;
};

static mu_result device_read_period(struct builder *b, const struct worldfile_entity *entity,
                                    uint64_t *period_ns)
{
    double ms = 0;
    MU_TRY(builder_number(b, entity, (struct builder_numbers){"update_interval", &ms, 1, 1, NULL},
                          0, 1e9));
    *period_ns = (uint64_t)llround(ms * 1e6);
    return MU_OK;
}

/* A robot's consumption is the sum over its devices. */
static mu_result device_read_power(struct builder *b, const struct worldfile_entity *entity,
                                   struct world_robot *robot)
{
    double uses_w = 0;
    double takes_w = 0;
    MU_TRY(
        builder_number(b, entity, (struct builder_numbers){"watts", &uses_w, 1, 1, NULL}, 0, 1e9));
    MU_TRY(builder_number(b, entity, (struct builder_numbers){"take_watts", &takes_w, 1, 1, NULL},
                          0, 1e9));
    robot->power_w += uses_w;
    robot->take_w = fmax(robot->take_w, takes_w);
    return MU_OK;
}

static mu_result device_check_range(struct builder *b, const struct worldfile_entity *entity,
                                    const double view[3])
{
    struct mu_fault_place at = builder_place(entity, "range");
    if (!(view[0] >= 0 && view[1] > view[0] && view[1] <= BUILDER_POSE_MAX_M)) {
        return builder_fault(b, &at, "expected a range [min max] with 0 <= min < max, found %g, %g",
                             view[0], view[1]);
    }
    at = builder_place(entity, "fov");
    if (!(view[2] >= 0 && view[2] <= 360)) {
        return builder_fault(b, &at, "expected a field of view of 0 to 360 degrees, found %g",
                             view[2]);
    }
    return MU_OK;
}

static mu_result device_read_noise(struct builder *b, const struct worldfile_entity *entity,
                                   struct world_noise *noise)
{
    double v[3] = {0, 0, 0}; /* m, share, degrees */
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"noise", v, 1, 3, "l a"}));
    for (size_t i = 0; i < 3; i++) {
        if (!(v[i] >= 0 && v[i] <= 1e6)) {
            struct mu_fault_place at = builder_place(entity, "noise");
            return builder_fault(b, &at, "expected deviations of 0 or more, found %g", v[i]);
        }
    }
    *noise = (struct world_noise){v[0], v[1], v[2] * M_PI / 180};
    return MU_OK;
}

static mu_result device_read_range(struct device_reader *reader,
                                   const struct worldfile_entity *entity,
                                   struct device_range *range)
{
    struct builder *b = reader->builder;
    double *view = range->view;
    MU_TRY(builder_count(b, entity, "samples", MU_BEAMS_MAX, &range->samples));
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"view", view, 3, 3, "lla"}));
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"range", view, 2, 2, "ll"}));
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"range_min", &view[0], 1, 1, "l"}));
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"range_max", &view[1], 1, 1, "l"}));
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"fov", &view[2], 1, 1, "a"}));
    MU_TRY(device_check_range(b, entity, view));
    MU_TRY(device_read_noise(b, entity, &range->noise));
    return builder_pose(b, entity, reader->mount, &range->pose);
}

static mu_result device_add_sonar(struct device_reader *reader,
                                  const struct worldfile_entity *entity,
                                  const struct device_range *range)
{
    struct builder *b = reader->builder;
    struct device_sonars *sonars = reader->sonars;
    uint32_t rays = 1;
    double specular_deg = 0;
    MU_TRY(builder_count(b, entity, "rays", DEVICE_RAYS_MAX, &rays));
    MU_TRY(builder_number(b, entity, (struct builder_numbers){"specular", &specular_deg, 1, 1, "a"},
                          0, 90));
    if (sonars->count == MU_SONARS_MAX) {
        return builder_fault(b, &entity->at, "more than %d sonars on one robot", MU_SONARS_MAX);
    }
    sonars->list[sonars->count++] = (struct world_sonar){
        .pose = range->pose,
        .range_min_m = range->view[0],
        .range_max_m = range->view[1],
        .fov_rad = range->view[2] * M_PI / 180,
        .rays = rays > 0 ? rays : 1,
        .specular_rad = specular_deg * M_PI / 180,
        .noise = range->noise,
    };
    reader->robot->period_ns[MU_SENSOR_SONAR] = reader->period_ns;
    return MU_OK;
}

static void device_add_laser(struct device_reader *reader, const struct worldfile_entity *entity,
                             const struct device_range *range)
{
    struct world_robot *robot = reader->robot;
    if (robot->laser.samples > 0) {
        builder_warn(reader->builder, &entity->at, entity->type,
                     "is a second laser: a robot has one, and this one is left out");
        return;
    }
    robot->laser = (struct world_laser){
        .pose = range->pose,
        .range_min_m = range->view[0],
        .range_max_m = range->view[1],
        .fov_rad = range->view[2] * M_PI / 180,
        .samples = range->samples,
        .noise = range->noise,
    };
    robot->period_ns[MU_SENSOR_LASER] = reader->period_ns;
}

static mu_result device_add_range(struct device_reader *reader,
                                  const struct worldfile_entity *entity, struct device_range range)
{
    builder_warn_unknown(reader->builder, entity, PROPERTY_SENSOR);
    MU_TRY(device_read_range(reader, entity, &range));
    if (range.samples > 1) {
        device_add_laser(reader, entity, &range);
        return MU_OK;
    }
    return device_add_sonar(reader, entity, &range);
}

/* One sensor of a ranger.  With several samples it is a laser. */
static mu_result device_visit_sensor(void *context, const struct worldfile_entity *entity)
{
    struct device_reader *reader = context;
    struct builder *b = reader->builder;
    const char *kind = worldfile_kind(entity);
    MU_TRY(builder_count_model(b, entity, 0));
    if (strcmp(kind, "sensor") != 0) { /* blocks only draw the case */
        return builder_go_on(b, strcmp(kind, "block") == 0 ? MU_OK : builder_skip_model(b, entity));
    }
    struct device_range range = {.view = {0, 5, 15}, .samples = 1};
    return builder_go_on(b, device_add_range(reader, entity, range));
}

static mu_result device_read_ranger(struct device_reader *reader,
                                    const struct worldfile_entity *entity)
{
    builder_warn_unknown(reader->builder, entity, PROPERTY_RANGER);
    struct device_reader inside = *reader;
    MU_TRY(builder_pose(reader->builder, entity, reader->mount, &inside.mount));
    MU_TRY(device_read_period(reader->builder, entity, &inside.period_ns));
    return builder_children(entity, device_visit_sensor, &inside);
}

/* The ranger and its sensor in one, as Stage had it before version 4. */
static mu_result device_read_laser(struct device_reader *reader,
                                   const struct worldfile_entity *entity)
{
    struct device_range range = {.view = {0, 8, 180}, .samples = 180};
    MU_TRY(device_read_period(reader->builder, entity, &reader->period_ns));
    return device_add_range(reader, entity, range);
}

static mu_result device_read_sonar(struct device_reader *reader,
                                   const struct worldfile_entity *entity)
{
    struct device_range range = {.view = {0, 5, 15}, .samples = 1};
    MU_TRY(device_read_period(reader->builder, entity, &reader->period_ns));
    return device_add_range(reader, entity, range);
}

static mu_result device_read_color(struct builder *b, const struct worldfile_property *p,
                                   size_t index, struct world_camera *camera)
{
    const char *text = p->values[index].text;
    if (!text || !look_color(text, &camera->colors[camera->color_count])) {
        return builder_fault(b, &p->at, "expected a colour that X11 has, found '%.40s'",
                             text ? text : "a number");
    }
    camera->color_count++;
    return MU_OK;
}

static mu_result device_read_colors(struct builder *b, const struct worldfile_entity *entity,
                                    struct world_camera *camera)
{
    const struct worldfile_property *p = worldfile_property(entity, "colors");
    if (!p) {
        return MU_OK;
    }
    uint32_t count = (uint32_t)p->value_count;
    MU_TRY(builder_count(b, entity, "colors_count", (double)p->value_count, &count));
    if (count > MU_COLORS_MAX) {
        return builder_fault(b, &p->at, "expected %d colours at most, found %u", MU_COLORS_MAX,
                             count);
    }
    for (size_t i = 0; i < count; i++) {
        MU_TRY(device_read_color(b, p, i, camera));
    }
    return MU_OK;
}

static mu_result device_read_camera(struct device_reader *reader,
                                    const struct worldfile_entity *entity)
{
    struct builder *b = reader->builder;
    struct world_camera camera = {.range_m = 12};
    double image[2] = {80, 60};
    double fov_deg = 60;
    double pan_deg = 0;
    builder_warn_unknown(b, entity, PROPERTY_CAMERA);
    MU_TRY(builder_pose(b, entity, reader->mount, &camera.pose));
    MU_TRY(builder_number(b, entity, (struct builder_numbers){"range", &camera.range_m, 1, 1, "l"},
                          1e-3, BUILDER_POSE_MAX_M));
    MU_TRY(builder_number(b, entity, (struct builder_numbers){"fov", &fov_deg, 1, 1, "a"}, 1, 360));
    MU_TRY(
        builder_number(b, entity, (struct builder_numbers){"pan", &pan_deg, 1, 1, "a"}, -360, 360));
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"image", image, 2, 2, NULL}));
    if (!(image[0] >= 1 && image[0] <= MU_COLUMNS_MAX && image[1] >= 1 && image[1] <= 65535)) {
        struct mu_fault_place at = builder_place(entity, "image");
        return builder_fault(b, &at, "expected an image of 1 to %d columns, found [%g %g]",
                             MU_COLUMNS_MAX, image[0], image[1]);
    }
    camera.columns = (uint32_t)image[0];
    camera.rows = (uint32_t)image[1];
    camera.fov_rad = fov_deg * M_PI / 180;
    camera.pose = world_pose_in(camera.pose, (struct world_pose){0, 0, pan_deg * M_PI / 180});
    MU_TRY(device_read_colors(b, entity, &camera));
    if (reader->robot->camera.columns > 0) {
        builder_warn(b, &entity->at, entity->type,
                     "is a second camera: a robot has one, and this one is left out");
        return MU_OK;
    }
    reader->robot->camera = camera;
    return device_read_period(b, entity, &reader->robot->period_ns[MU_SENSOR_CAMERA]);
}

static mu_result device_read_finder(struct device_reader *reader,
                                    const struct worldfile_entity *entity)
{
    struct builder *b = reader->builder;
    struct world_fiducial_finder finder = {.range_max_m = 8, .range_id_m = 5};
    double fov_deg = 180;
    builder_warn_unknown(b, entity, PROPERTY_FINDER);
    MU_TRY(builder_pose(b, entity, reader->mount, &finder.pose));
    MU_TRY(builder_numbers(b, entity,
                           (struct builder_numbers){"range_min", &finder.range_min_m, 1, 1, "l"}));
    MU_TRY(builder_numbers(b, entity,
                           (struct builder_numbers){"range_max", &finder.range_max_m, 1, 1, "l"}));
    MU_TRY(builder_number(b, entity,
                          (struct builder_numbers){"range_max_id", &finder.range_id_m, 1, 1, "l"},
                          0, BUILDER_POSE_MAX_M));
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"fov", &fov_deg, 1, 1, "a"}));
    double view[3] = {finder.range_min_m, finder.range_max_m, fov_deg};
    MU_TRY(device_check_range(b, entity, view));
    finder.fov_rad = fov_deg * M_PI / 180;
    if (reader->robot->finder.range_max_m > 0) {
        builder_warn(b, &entity->at, entity->type,
                     "is a second fiducial finder: a robot has one, and this one is left out");
        return MU_OK;
    }
    reader->robot->finder = finder;
    return device_read_period(b, entity, &reader->robot->period_ns[MU_SENSOR_FIDUCIALS]);
}

static mu_result device_read_paddles(struct builder *b, const struct worldfile_entity *entity,
                                     struct world_gripper *gripper)
{
    const struct worldfile_property *p = worldfile_property(entity, "paddle_state");
    if (!p) {
        return MU_OK;
    }
    const char *paddles = p->value_count == 2 ? p->values[0].text : NULL;
    const char *lift = p->value_count == 2 ? p->values[1].text : NULL;
    if (!paddles || !lift || (strcmp(paddles, "open") != 0 && strcmp(paddles, "closed") != 0) ||
        (strcmp(lift, "down") != 0 && strcmp(lift, "up") != 0)) {
        return builder_fault(b, &p->at,
                             "expected 'paddle_state' [\"open\" or \"closed\" \"down\" or \"up\"]");
    }
    gripper->starts_closed = strcmp(paddles, "closed") == 0;
    gripper->starts_lifted = strcmp(lift, "up") == 0;
    return MU_OK;
}

/* Stage's size is that of case and paddles together, and its pose their common middle. */
static mu_result device_read_gripper(struct device_reader *reader,
                                     const struct worldfile_entity *entity)
{
    struct builder *b = reader->builder;
    struct world_gripper gripper = {0};
    double size_m[2] = {0.2, 0.3};
    double share[3] = {0.66, 0.1, 0.4};
    builder_warn_unknown(b, entity, PROPERTY_GRIPPER);
    MU_TRY(builder_pose(b, entity, reader->mount, &gripper.pose));
    if (worldfile_property(entity, "size")) {
        MU_TRY(builder_size(b, entity, size_m));
    }
    MU_TRY(builder_numbers(b, entity, (struct builder_numbers){"paddle_size", share, 2, 3, NULL}));
    if (!(share[0] > 0 && share[0] < 1 && share[1] > 0 && share[1] < 0.5)) {
        struct mu_fault_place at = builder_place(entity, "paddle_size");
        return builder_fault(b, &at,
                             "expected paddles of 0 to 1 of the length and 0 to 0.5 of the "
                             "width, found [%g %g]",
                             share[0], share[1]);
    }
    MU_TRY(device_read_paddles(b, entity, &gripper));
    gripper.paddle_length_m = share[0] * size_m[0];
    gripper.paddle_width_m = share[1] * size_m[1];
    gripper.length_m = size_m[0] - gripper.paddle_length_m;
    gripper.width_m = size_m[1];
    gripper.pose =
        world_pose_in(gripper.pose, (struct world_pose){-gripper.paddle_length_m / 2, 0, 0});
    if (reader->robot->gripper.length_m > 0) {
        builder_warn(b, &entity->at, entity->type,
                     "is a second gripper: a robot has one, and this one is left out");
        return MU_OK;
    }
    reader->robot->gripper = gripper;
    return MU_OK;
}

static mu_result device_visit(void *context, const struct worldfile_entity *entity);

/* A model on a robot adds no matter to it, but its fiducial counts for the robot. */
static mu_result device_read_part(struct device_reader *reader,
                                  const struct worldfile_entity *entity)
{
    struct builder *b = reader->builder;
    struct device_reader inside = *reader;
    builder_warn_unknown(b, entity, PROPERTY_PART);
    builder_warn(b, &entity->at, entity->type, "adds no shape to a robot: its outline is its size");
    struct world_look look;
    MU_TRY(look_read(b, entity, &look));
    if (look.fiducial) {
        reader->robot->look.fiducial = look.fiducial;
    }
    MU_TRY(builder_pose(b, entity, reader->mount, &inside.mount));
    inside.depth++;
    return builder_children(entity, device_visit, &inside);
}

static mu_result device_read_nothing(struct device_reader *reader,
                                     const struct worldfile_entity *entity)
{
    (void)reader;
    (void)entity;
    return MU_OK;
}

static mu_result device_read_bumper(struct device_reader *reader,
                                    const struct worldfile_entity *entity)
{
    builder_warn(reader->builder, &entity->at, "bumper",
                 "is there on every robot, in eight sectors: it needs no model");
    return MU_OK;
}

static mu_result device_visit(void *context, const struct worldfile_entity *entity)
{
    static const struct {
        const char *kind;
        mu_result (*read)(struct device_reader *reader, const struct worldfile_entity *entity);
    } kinds[] = {
        {"ranger", device_read_ranger},   {"laser", device_read_laser},
        {"sonar", device_read_sonar},     {"blobfinder", device_read_camera},
        {"fiducial", device_read_finder}, {"gripper", device_read_gripper},
        {"model", device_read_part},      {"bumper", device_read_bumper},
        {"block", device_read_nothing}, /* the outline is the size, which Stage's blocks fill */
    };
    struct device_reader *reader = context;
    struct builder *b = reader->builder;
    MU_TRY(builder_count_model(b, entity, reader->depth));
    const char *kind = worldfile_kind(entity);
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (strcmp(kinds[i].kind, kind) == 0) {
            struct device_reader own = *reader;
            MU_TRY(builder_go_on(b, device_read_power(b, entity, reader->robot)));
            return builder_go_on(b, kinds[i].read(&own, entity));
        }
    }
    return builder_go_on(b, builder_skip_model(b, entity));
}

/* @return the ring that has these sonars; NULL: none has */
static const struct world_ring *device_find_ring(const struct world *world,
                                                 const struct device_sonars *sonars)
{
    const struct world_ring *ring = world->rings;
    while (ring && (ring->count != sonars->count ||
                    memcmp(ring->sonars, sonars->list, ring->count * sizeof ring->sonars[0]))) {
        ring = ring->next;
    }
    return ring;
}

/* @return NULL: there is no room */
static const struct world_ring *device_add_ring(struct world *world,
                                                const struct device_sonars *sonars)
{
    size_t bytes = sonars->count * sizeof sonars->list[0];
    struct world_ring *ring = worldfile_take(world->source, sizeof *ring + bytes);
    if (ring) {
        ring->next = world->rings;
        ring->count = sonars->count;
        memcpy(ring->sonars, sonars->list, bytes);
        world->rings = ring;
    }
    return ring;
}

static mu_result device_share_ring(struct builder *b, const struct worldfile_entity *entity,
                                   const struct device_sonars *sonars, struct world_robot *robot)
{
    const struct world_ring *ring = device_find_ring(b->world, sonars);
    ring = ring ? ring : device_add_ring(b->world, sonars);
    if (!ring) {
        return builder_full(b, &entity->at, "the world is too large: more than %d bytes",
                            WORLDFILE_BYTES_MAX);
    }
    robot->sonars = ring->sonars;
    robot->sonar_count = ring->count;
    return MU_OK;
}

mu_result device_read_all(struct builder *b, const struct worldfile_entity *entity,
                          struct world_robot *robot)
{
    struct device_sonars sonars;
    memset(&sonars, 0, sizeof sonars);
    struct device_reader reader = {.builder = b, .robot = robot, .sonars = &sonars};
    MU_TRY(builder_go_on(b, device_read_power(b, entity, robot)));
    MU_TRY(builder_children(entity, device_visit, &reader));
    return device_share_ring(b, entity, &sonars, robot);
}
