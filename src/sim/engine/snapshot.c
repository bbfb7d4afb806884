/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Snapshots of the engine: one walk over the state that changes in a run.  It writes, checks or
 * reads by the mode of the block.  A snapshot holds no data of the world file, and none that
 * follows from the rest.
 */
#include "sim/engine/engine_core.h"

static const uint64_t SNAPSHOT_MAGIC = 0x70616e736d75736dull; /* "msumsnap" */
static const uint64_t SNAPSHOT_VERSION = 1;

/* A larger number is neither a position nor a speed in any world. */
#define SNAPSHOT_MOST 1e9

/* The norm of a unit quaternion, with the error of the steps. */
#define SNAPSHOT_UNIT 1.000001

/* --- fingerprint ------------------------------------------------------------------------------ */

static void snapshot_add(struct block *b, double value)
{
    block_double(b, &value, -INFINITY, INFINITY);
}

static void snapshot_add_name(struct block *b, const char *name)
{
    for (size_t i = 0; i == 0 || name[i - 1]; i++) {
        uint64_t letter = (unsigned char)name[i];
        (void)block_number(b, &letter, UINT8_MAX);
    }
}

static void snapshot_add_pose(struct block *b, const struct world_pose *pose)
{
    snapshot_add(b, pose->x_m);
    snapshot_add(b, pose->y_m);
    snapshot_add(b, pose->heading_rad);
}

static void snapshot_add_shape(struct block *b, const struct world_shape *shape)
{
    bool disc = shape->kind == WORLD_DISC;
    snapshot_add(b, disc);
    snapshot_add_pose(b, &shape->pose);
    snapshot_add(b, disc ? shape->radius_m : shape->half_x_m);
    snapshot_add(b, disc ? shape->radius_m : shape->half_y_m);
    snapshot_add(b, shape->look.stops);
    snapshot_add(b, shape->look.graspable);
    snapshot_add(b, shape->look.give_w);
}

static void snapshot_add_robot(struct block *b, const struct world_robot *r)
{
    const double values[] = {r->length_m,
                             r->width_m,
                             r->origin_x_m,
                             r->origin_y_m,
                             r->mass_kg,
                             r->forward_max_m_s,
                             r->reverse_max_m_s,
                             r->turn_max_rad_s,
                             r->forward_accel_m_s2,
                             r->turn_accel_rad_s2,
                             r->odometry.forward_error,
                             r->odometry.turn_error,
                             r->gps_noise_m,
                             r->gps_drift_m,
                             r->compass_noise_rad,
                             r->battery_max_j,
                             r->power_w,
                             r->take_w,
                             r->gripper.length_m,
                             r->gripper.width_m,
                             r->gripper.paddle_length_m,
                             r->gripper.paddle_width_m};
    snapshot_add_name(b, r->name);
    snapshot_add_pose(b, &r->pose);
    snapshot_add_pose(b, &r->gripper.pose);
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        snapshot_add(b, values[i]);
    }
}

/* @return a number that differs for another world, seed or step */
static uint64_t snapshot_fingerprint(const struct engine *e)
{
    const struct world *w = e->world;
    struct block b = block_open(BLOCK_MEASURE, NULL, 0);
    uint64_t seed = e->seed;
    (void)block_number(&b, &seed, UINT64_MAX);
    snapshot_add(&b, e->dt_s);
    snapshot_add(&b, e->substeps_per_step);
    for (size_t i = 0; i < w->shape_count; i++) {
        snapshot_add_shape(&b, &w->shapes[i]);
    }
    for (size_t k = 0; k < w->object_count; k++) {
        snapshot_add_name(&b, w->objects[k].name);
        snapshot_add_shape(&b, &w->objects[k].shape);
        snapshot_add(&b, w->objects[k].mass_kg);
        snapshot_add(&b, w->objects[k].friction);
    }
    for (size_t i = 0; i < w->robot_count; i++) {
        snapshot_add_robot(&b, &w->robots[i]);
    }
    return b.sum;
}

/* --- the walk --------------------------------------------------------------------------------- */

static void snapshot_walk_counter(struct block *b, uint32_t *counter)
{
    uint64_t number = *counter;
    (void)block_number(b, &number, UINT32_MAX);
    *counter = (uint32_t)number;
}

static void snapshot_walk_place(const struct engine *e, struct block *b, double *x, double *y)
{
    block_double(b, x, e->bounds.min_x, e->bounds.max_x);
    block_double(b, y, e->bounds.min_y, e->bounds.max_y);
}

/* Height, roll and pitch are 0, of either sign. */
static void snapshot_walk_state(struct engine *e, struct block *b, size_t body)
{
    double s[ENGINE_STATE_DOUBLES];
    ode_world_state(body, s);
    snapshot_walk_place(e, b, &s[0], &s[1]);
    for (size_t i = 2; i < ENGINE_STATE_DOUBLES; i++) {
        bool is_turn = i == 3 || i == 6;
        bool is_flat = i == 2 || i == 4 || i == 5 || i == 9 || i == 10 || i == 11;
        double most = is_turn ? SNAPSHOT_UNIT : is_flat ? 0 : SNAPSHOT_MOST;
        block_double(b, &s[i], -most, most);
    }
    if (b->mode == BLOCK_READ) {
        ode_world_set_state(body, s);
    }
}

static void snapshot_walk_body(struct engine *e, struct block *b, size_t i)
{
    struct engine_body *body = &e->bodies[i];
    struct ode_motion *good = &body->last_good;
    snapshot_walk_state(e, b, i);
    snapshot_walk_place(e, b, &good->x, &good->y);
    block_double(b, &good->c, -SNAPSHOT_UNIT, SNAPSHOT_UNIT);
    block_double(b, &good->s, -SNAPSHOT_UNIT, SNAPSHOT_UNIT);
    double *const push[] = {&body->push.x_n, &body->push.y_n, &body->push.turn_nm};
    for (size_t k = 0; k < sizeof push / sizeof push[0]; k++) {
        block_double(b, push[k], -SNAPSHOT_MOST, SNAPSHOT_MOST);
    }
    snapshot_walk_counter(b, &body->push_substeps);
    block_flag(b, &body->asleep);
    block_flag(b, &body->fault);
    (void)block_number(b, &body->faults, UINT64_MAX);
    if (b->mode == BLOCK_READ) {
        ode_world_sleep(i, body->asleep);
    }
}

static void snapshot_walk_drive(struct block *b, struct drive *d)
{
    const struct drive_limits *l = &d->limits;
    block_double(b, &d->aim_forward_m_s, -l->reverse_max_m_s, l->forward_max_m_s);
    block_double(b, &d->aim_turn_rad_s, -l->turn_max_rad_s, l->turn_max_rad_s);
    block_double(b, &d->forward_m_s, -SNAPSHOT_MOST, SNAPSHOT_MOST);
    block_double(b, &d->turn_rad_s, -SNAPSHOT_MOST, SNAPSHOT_MOST);
    block_double(b, &d->held_up_s, 0, INFINITY);
}

static void snapshot_walk_gripper(struct engine *e, struct block *b, size_t robot)
{
    struct gripper *g = &e->robots[robot].gripper;
    block_flag(b, &g->closes);
    block_flag(b, &g->lifts);
    block_double(b, &g->closed, 0, 1);
    block_double(b, &g->lifted, 0, 1);
    int32_t holds = block_index(b, &g->holds, g->make ? e->object_count : 0);
    if (!b->bad && holds != GRIPPER_NOTHING) { /* each object in at most one gripper */
        b->bad = e->objects[holds].claimed && b->mode == BLOCK_CHECK;
        e->objects[holds].claimed = true;
    }
}

static void snapshot_walk_robot(struct engine *e, struct block *b, size_t i)
{
    struct engine_robot *r = &e->robots[i];
    double *const free[] = {&r->odometer.pose.x_m, &r->odometer.pose.y_m, &r->gps.off_x_m,
                            &r->gps.off_y_m};
    snapshot_walk_drive(b, &r->drive);
    for (size_t k = 0; k < sizeof free / sizeof free[0]; k++) {
        block_double(b, free[k], -INFINITY, INFINITY);
    }
    block_double(b, &r->odometer.pose.heading_rad, -M_PI, M_PI);
    block_double(b, &r->battery.joules, 0, r->battery.full_j);
    snapshot_walk_counter(b, &r->bumpers);
    snapshot_walk_gripper(e, b, i);
}

static void snapshot_walk_object(struct engine *e, struct block *b, size_t k)
{
    struct engine_object *o = &e->objects[k];
    double *const grip[] = {&o->x, &o->y, &o->c, &o->s};
    for (size_t i = 0; i < sizeof grip / sizeof grip[0]; i++) {
        block_double(b, grip[i], -SNAPSHOT_MOST, SNAPSHOT_MOST);
    }
}

/* The last number is the sum of all numbers before it. */
static void snapshot_walk(struct engine *e, struct block *b)
{
    uint64_t magic = SNAPSHOT_MAGIC;
    uint64_t version = SNAPSHOT_VERSION;
    uint64_t world = snapshot_fingerprint(e);
    (void)block_number(b, &magic, UINT64_MAX);
    (void)block_number(b, &version, UINT64_MAX);
    (void)block_number(b, &world, UINT64_MAX);
    (void)block_number(b, &e->steps, UINT64_MAX);
    (void)block_number(b, &e->substeps, UINT64_MAX);
    for (size_t k = 0; k < e->object_count; k++) {
        e->objects[k].claimed = false;
        snapshot_walk_object(e, b, k);
    }
    for (size_t i = 0; i < e->robot_count; i++) {
        snapshot_walk_robot(e, b, i);
    }
    for (size_t i = 0; i < e->body_count; i++) {
        snapshot_walk_body(e, b, i);
    }
    uint64_t sum = b->sum;
    uint64_t found = block_number(b, &sum, UINT64_MAX);
    b->bad = b->bad || (b->mode == BLOCK_CHECK && found != sum);
}

/* --- writing and reading ---------------------------------------------------------------------- */

size_t engine_save_size(const struct engine *e)
{
    struct block b = block_open(BLOCK_MEASURE, NULL, 0);
    snapshot_walk((struct engine *)(uintptr_t)e, &b); /* BLOCK_MEASURE changes nothing */
    return b.used;
}

void engine_save(struct engine *e, unsigned char *bytes)
{
    struct block b = block_open(BLOCK_WRITE, bytes, SIZE_MAX);
    snapshot_walk(e, &b);
}

/* Checks the first three numbers: magic, version, fingerprint. */
static mu_result snapshot_check_head(const struct engine *e, struct block *b, const char **reason)
{
    uint64_t none = 0;
    uint64_t magic = block_number(b, &none, UINT64_MAX);
    uint64_t version = block_number(b, &none, UINT64_MAX);
    uint64_t world = block_number(b, &none, UINT64_MAX);
    if (b->bad || magic != SNAPSHOT_MAGIC) {
        *reason = "this is no snapshot";
        return MU_MALFORMED;
    }
    if (version != SNAPSHOT_VERSION) {
        *reason = "the snapshot is of another version of muster";
        return MU_MALFORMED;
    }
    if (world != snapshot_fingerprint(e)) {
        *reason = "the snapshot is of another world, or of another seed or step";
        return MU_REFUSED;
    }
    return MU_OK;
}

/* Computes the state that follows from the numbers that were read. */
static void snapshot_rebuild(struct engine *e)
{
    for (size_t k = 0; k < e->object_count; k++) {
        e->objects[k].bearer = ENGINE_NO_BEARER;
        e->parts[bodies_object_part(e, k)].body = (int32_t)(e->robot_count + k);
        e->outlines[bodies_object_part(e, k)].away = false;
        motion_follow(e, e->robot_count + k);
    }
    for (size_t i = 0; i < e->robot_count; i++) {
        e->robots[i].odometer.turned = true;
        grip_resume(e, i);
        motion_follow(e, i);
    }
    e->grid_is_old = true;
    sensors_forget(e->sensors);
    grip_feel_all(e);
}

mu_result engine_restore(struct engine *e, const unsigned char *bytes, size_t count,
                         const char **reason)
{
    unsigned char *from =
        (unsigned char *)(uintptr_t)bytes; /* BLOCK_CHECK and BLOCK_READ do not write there */
    struct block head = block_open(BLOCK_CHECK, from, count);
    mu_result checked = snapshot_check_head(e, &head, reason);
    if (checked != MU_OK) {
        return checked;
    }
    struct block check = block_open(BLOCK_CHECK, from, count);
    snapshot_walk(e, &check);
    if (check.bad || check.used != count) {
        *reason = "the snapshot is not whole";
        return MU_MALFORMED;
    }
    struct block b = block_open(BLOCK_READ, from, count);
    snapshot_walk(e, &b);
    snapshot_rebuild(e);
    return MU_OK;
}
