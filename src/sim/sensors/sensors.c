/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/sensors/sensors.h"

#include "muster/memory.h"
#include "sim/sensors/models.h"
#include "sim/sensors/pool.h"

#include <string.h>

enum {
    SENSORS_PIECE = 16,   /* robots that a thread takes at a time */
    SENSORS_POOL_MIN = 32 /* with fewer robots, waking a thread takes longer than it saves */
};

#define SENSORS_NEVER UINT64_MAX

/* The sensor that reads a list, of those that must be asked for: the others are parts of it. */
#define SENSORS_OF(senses) ((uint32_t)__builtin_ctz(senses))

/* @return the bits of a sensor and of its parts */
static inline uint32_t sensors_parts(uint32_t sensor)
{
    uint32_t parts = 1u << sensor;
#define PARTS(id, senses, ...) parts |= SENSORS_OF(senses) == sensor ? (senses) : 0u;
    MU_CHANNELS(PARTS)
#undef PARTS
    return parts;
}

/* @return the bits of the sensors that use the solids that gather_near lists */
static inline uint32_t sensors_near(void)
{
    return sensors_parts(MU_SENSOR_LASER) | sensors_parts(MU_SENSOR_CAMERA) |
           sensors_parts(MU_SENSOR_FIDUCIALS);
}

/* The models of all robots with the same sensors. */
struct sensors_kind {
    const struct world_robot *model;
    struct sonar_ring sonars;
    struct laser laser;
    struct camera camera;
    struct fiducials finder;
    uint32_t has;                 /* bits of enum mu_sense */
    double reach_m;               /* reach of laser, camera and finder */
    size_t room[MU_SENSOR_COUNT]; /* most elements of the lists of each sensor */
};

struct sensors_robot {
    const struct sensors_kind *kind;
    struct frame frame;
    uint64_t period_ns[MU_SENSOR_COUNT];
    uint64_t read_ns[MU_SENSOR_COUNT]; /* SENSORS_NEVER: not yet */
    struct sensors_lists lists;
};

struct sensors {
    struct sensors_scene scene;
    struct gather gather;
    struct sensors_kind *kinds;
    size_t kind_count;
    struct sensors_robot *robots;
    size_t robot_count;
    struct sensors_lists memory;
    struct sensing *workers; /* one for each thread */
    struct pool *pool;
    /* Of the present job: */
    const uint32_t *wanted;
    uint64_t step;
};

/* --- start ------------------------------------------------------------------------------------ */

static bool sensors_same_ring(const struct world_robot *a, const struct world_robot *b)
{
    return a->sonar_count == b->sonar_count &&
           (a->sonar_count == 0 || a->sonars == b->sonars ||
            memcmp(a->sonars, b->sonars, a->sonar_count * sizeof a->sonars[0]) == 0);
}

static bool sensors_alike(const struct world_robot *a, const struct world_robot *b)
{
    return sensors_same_ring(a, b) && memcmp(&a->laser, &b->laser, sizeof a->laser) == 0 &&
           memcmp(&a->camera, &b->camera, sizeof a->camera) == 0 &&
           memcmp(&a->finder, &b->finder, sizeof a->finder) == 0;
}

static void sensors_kind_init(struct sensors_kind *kind, const struct world_robot *model)
{
    kind->model = model;
    sonar_init(&kind->sonars, model);
    laser_init(&kind->laser, &model->laser);
    camera_init(&kind->camera, &model->camera);
    fiducials_init(&kind->finder, &model->finder);
    double laser_m = laser_reach(&kind->laser);
    double camera_m = camera_reach(&kind->camera);
    double finder_m = fiducials_reach(&kind->finder);
    kind->reach_m = fmax(laser_m, fmax(camera_m, finder_m));
    kind->room[MU_SENSOR_SONAR] = kind->sonars.count;
    kind->room[MU_SENSOR_LASER] = kind->laser.table.count;
    kind->room[MU_SENSOR_CAMERA] = kind->camera.table.count > 0 ? MU_BLOBS_MAX : 0;
    kind->room[MU_SENSOR_FIDUCIALS] = finder_m > 0 ? MU_FIDUCIALS_MAX : 0;
    for (uint32_t k = 0; k < MU_SENSOR_COUNT; k++) {
        kind->has |= kind->room[k] > 0 ? sensors_parts(k) : 0;
    }
}

static const struct sensors_kind *sensors_kind_of(struct sensors *s,
                                                  const struct world_robot *model)
{
    for (size_t k = 0; k < s->kind_count; k++) {
        if (sensors_alike(s->kinds[k].model, model)) {
            return &s->kinds[k];
        }
    }
    sensors_kind_init(&s->kinds[s->kind_count], model);
    return &s->kinds[s->kind_count++];
}

static void sensors_robot_init(struct sensors *s, size_t i)
{
    struct sensors_robot *r = &s->robots[i];
    const struct world_robot *model = &s->scene.world->robots[i];
    r->kind = sensors_kind_of(s, model);
    for (uint32_t k = MU_SENSOR_COUNT; k-- > 0;) { /* a part has the period of its sensor */
        for (uint32_t part = k; part < MU_SENSOR_COUNT; part++) {
            if (sensors_parts(k) & 1u << part) {
                r->period_ns[part] = model->period_ns[k];
            }
        }
    }
#define RESERVE(id, senses, type, list, count, ...) \
    s->memory.count += r->kind->room[SENSORS_OF(senses)];
    MU_CHANNELS(RESERVE)
#undef RESERVE
}

/* The length of a plain list is its room, from the first reading on. */
static void sensors_lists_init(struct sensors *s)
{
#define TAKE(id, senses, type, list, count, ...) \
    s->memory.list = mu_startup_array(s->memory.count, sizeof(type));
    MU_CHANNELS(TAKE)
#undef TAKE
    struct sensors_lists next = s->memory;
    for (size_t i = 0; i < s->robot_count; i++) {
        struct sensors_robot *r = &s->robots[i];
#define SHARE(id, senses, type, list, count, ...)       \
    r->lists.list = next.list;                          \
    r->lists.count = r->kind->room[SENSORS_OF(senses)]; \
    next.list += r->lists.count;
        MU_CHANNELS(SHARE)
#undef SHARE
    }
}

void sensors_forget(struct sensors *s)
{
    for (size_t i = 0; i < s->robot_count; i++) {
        for (size_t k = 0; k < MU_SENSOR_COUNT; k++) {
            s->robots[i].read_ns[k] = SENSORS_NEVER;
        }
    }
}

static void sensors_workers_init(struct sensors *s)
{
    size_t beams = 0;
    size_t rays = 0;
    for (size_t k = 0; k < s->kind_count; k++) {
        const struct sensors_kind *kind = &s->kinds[k];
        rays = kind->sonars.ray_count > rays ? kind->sonars.ray_count : rays;
        beams = kind->laser.table.count > beams ? kind->laser.table.count : beams;
        beams = kind->camera.table.count > beams ? kind->camera.table.count : beams;
    }
    size_t threads = pool_threads(s->pool);
    s->workers = mu_startup_array(threads, sizeof *s->workers);
    for (size_t k = 0; k < threads; k++) {
        struct sensing *worker = &s->workers[k];
        *worker =
            (struct sensing){.grid = s->scene.grid, .gather = &s->gather, .seed = s->scene.seed};
        gather_list_init(&worker->near, &s->gather);
        fan_rays_init(&worker->rays, rays);
        worker->range_m = mu_startup_array(beams + FAN_PAD, sizeof(double));
        worker->hit = mu_startup_array(beams + FAN_PAD, sizeof(int64_t));
    }
}

struct sensors *sensors_open(const struct sensors_scene *scene)
{
    struct sensors *s = mu_startup_alloc(sizeof *s);
    s->scene = *scene;
    s->robot_count = scene->world->robot_count;
    s->robots = mu_startup_array(s->robot_count, sizeof *s->robots);
    s->kinds = mu_startup_array(s->robot_count, sizeof *s->kinds);
    for (size_t i = 0; i < s->robot_count; i++) {
        sensors_robot_init(s, i);
    }
    sensors_lists_init(s);
    sensors_forget(s);
    const struct grid_layer *still = &scene->grid->still;
    const struct grid_layer *moving = &scene->grid->moving;
    gather_init(&s->gather, still->solids, still->count, moving->solids, moving->count);
    (void)fan_kernel(); /* chosen before there are threads */
    s->pool = s->robot_count < SENSORS_POOL_MIN ? NULL : pool_open(scene->threads);
    sensors_workers_init(s);
    return s;
}

void sensors_close(struct sensors *s)
{
    pool_close(s->pool);
}

void sensors_place(struct sensors *s, size_t robot, const struct frame *frame)
{
    s->robots[robot].frame = *frame;
}

/* --- reading ---------------------------------------------------------------------------------- */

/*
 * Periods begin at multiples of their length, so that sensors with the same period are read
 * together.
 */
static bool sensors_due(const struct sensors_robot *r, enum mu_sensor sensor, uint64_t now_ns)
{
    uint64_t period_ns = r->period_ns[sensor];
    uint64_t read_ns = r->read_ns[sensor];
    return period_ns == 0 || read_ns == SENSORS_NEVER || now_ns / period_ns != read_ns / period_ns;
}

/* @return the sensors to read now; marks them as read */
static uint32_t sensors_take_due(const struct sensors *s, struct sensors_robot *r, uint32_t wanted)
{
    uint64_t now_ns = s->step * s->scene.step_ns;
    uint32_t due = 0;
    for (uint32_t k = 0; k < MU_SENSOR_COUNT; k++) {
        if ((wanted & r->kind->has & (1u << k)) && sensors_due(r, (enum mu_sensor)k, now_ns)) {
            due |= 1u << k;
            r->read_ns[k] = now_ns;
        }
    }
    return due;
}

static void sensors_read_robot(const struct sensors *s, size_t i, uint32_t wanted,
                               struct sensing *at)
{
    struct sensors_robot *r = &s->robots[i];
    const struct sensors_kind *kind = r->kind;
    uint32_t due = sensors_take_due(s, r, wanted);
    at->robot = r->frame;
    at->self = (int32_t)i;
    at->step = s->step;
    at->due = due;
    at->lists = &r->lists;
    if (due & sensors_near()) {
        struct gather_circle circle = {r->frame.x, r->frame.y, kind->reach_m};
        gather_near(&s->gather, &circle, at->self, &at->near);
    }
    if (due & MU_SENSE_SONAR) {
        sonar_read(&kind->sonars, at, r->lists.sonar_m);
    }
    if (due & sensors_parts(MU_SENSOR_LASER)) {
        laser_read(&kind->laser, at);
    }
    if (due & MU_SENSE_CAMERA) {
        r->lists.blob_count = camera_read(&kind->camera, at, r->lists.blobs);
    }
    if (due & MU_SENSE_FIDUCIALS) {
        r->lists.fiducial_count = fiducials_read(&kind->finder, at, r->lists.fiducials);
    }
}

static void sensors_read_piece(void *context, size_t worker, size_t piece)
{
    struct sensors *s = context;
    size_t begin = piece * SENSORS_PIECE;
    size_t end = begin + SENSORS_PIECE < s->robot_count ? begin + SENSORS_PIECE : s->robot_count;
    for (size_t i = begin; i < end; i++) {
        sensors_read_robot(s, i, s->wanted[i], &s->workers[worker]);
    }
}

static bool sensors_any_gathered(const struct sensors *s, const uint32_t wanted[])
{
    uint32_t any = 0;
    for (size_t i = 0; i < s->robot_count; i++) {
        any |= wanted[i] & s->robots[i].kind->has;
    }
    return any & (sensors_near() | MU_SENSE_SONAR);
}

void sensors_read_all(struct sensors *s, const uint32_t wanted[], uint64_t step)
{
    s->wanted = wanted;
    s->step = step;
    if (sensors_any_gathered(s, wanted)) {
        gather_update(&s->gather);
    }
    size_t pieces = (s->robot_count + SENSORS_PIECE - 1) / SENSORS_PIECE;
    pool_run(s->pool, pieces, sensors_read_piece, s);
}

void sensors_tell(const struct sensors *s, size_t robot, uint32_t wanted, struct mu_percept *out)
{
    const struct sensors_robot *r = &s->robots[robot];
    uint32_t told = wanted & r->kind->has;
#define TELL(id, senses, type, list, count, ...) \
    if ((told & (senses)) == (senses)) {         \
        out->list = r->lists.list;               \
        out->count = r->lists.count;             \
    }
    MU_CHANNELS(TELL)
#undef TELL
}
