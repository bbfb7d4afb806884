/* SPDX-License-Identifier: Apache-2.0 */
/* Changes of a running world from outside: places, pushes, resets. */
#include "sim/engine/engine_core.h"

#include <stdarg.h>
#include <stdio.h>

/* A stronger push would only throw the body out of the world. */
#define EDIT_FORCE_MAX_N 1e6

static mu_result edit_refuse(struct engine *e, const char **reason, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static mu_result edit_refuse(struct engine *e, const char **reason, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(e->reason, sizeof e->reason, format, args);
    va_end(args);
    *reason = e->reason;
    return MU_REFUSED;
}

static struct world_pose edit_start_pose(const struct engine *e, size_t body)
{
    return body < e->robot_count ? e->world->robots[body].pose
                                 : e->world->objects[body - e->robot_count].shape.pose;
}

/* Updates the state that depends on poses: the grid, and the readings of the grippers. */
static void edit_look_again(struct engine *e)
{
    e->grid_is_old = true;
    grip_feel_all(e);
}

/* @return whether a part belongs to a body and can be in the way of others */
static bool edit_part_is_of(const struct engine *e, size_t part, size_t body)
{
    return e->parts[part].body == (int32_t)body && e->parts[part].look->stops &&
           !e->outlines[part].away;
}

/* Checks whether all parts of a body have room at a pose, to which they move as one. */
static mu_result edit_check_place(struct engine *e, size_t body, struct world_pose pose,
                                  const char **reason)
{
    const struct ode_motion *m = &e->bodies[body].motion;
    double c = cos(pose.heading_rad);
    double s = sin(pose.heading_rad);
    double turn_c = c * m->c + s * m->s; /* rotates the old heading to the new one */
    double turn_s = s * m->c - c * m->s;
    for (size_t p = 0; p < e->part_count; p++) {
        if (!edit_part_is_of(e, p, body)) {
            continue;
        }
        struct solid solid = e->outlines[p];
        double x = solid.x - m->x;
        double y = solid.y - m->y;
        double own_c = solid.c;
        solid.x = pose.x_m + turn_c * x - turn_s * y;
        solid.y = pose.y_m + turn_s * x + turn_c * y;
        solid.c = turn_c * own_c - turn_s * solid.s;
        solid.s = turn_s * own_c + turn_c * solid.s;
        const char *other = space_obstacle(e, &solid, body, 0);
        if (other) {
            return edit_refuse(e, reason, "%s would overlap %s at %.3f %.3f", e->bodies[body].name,
                               other, pose.x_m, pose.y_m);
        }
    }
    return MU_OK;
}

static mu_result edit_check_free(struct engine *e, size_t body, const char **reason)
{
    if (bodies_is_held(e, body)) {
        int32_t bearer = e->objects[body - e->robot_count].bearer;
        return edit_refuse(e, reason, "%s is held by %s", e->bodies[body].name,
                           e->bodies[bearer].name);
    }
    return MU_OK;
}

mu_result engine_place(struct engine *e, size_t body, struct world_pose pose, const char **reason)
{
    MU_ASSERT(body < e->body_count);
    if (!isfinite(pose.heading_rad) || !bounds_holds(&e->bounds, pose.x_m, pose.y_m)) {
        return edit_refuse(e, reason, "%s: %g %g is outside the world", e->bodies[body].name,
                           pose.x_m, pose.y_m);
    }
    mu_result checked = edit_check_free(e, body, reason);
    checked = checked == MU_OK ? edit_check_place(e, body, pose, reason) : checked;
    if (checked != MU_OK) {
        return checked;
    }
    motion_put(e, body, pose);
    e->bodies[body].last_good = e->bodies[body].motion;
    edit_look_again(e);
    return MU_OK;
}

mu_result engine_push(struct engine *e, size_t body, const struct engine_force *force,
                      const char **reason)
{
    MU_ASSERT(body < e->body_count);
    double time_s = force->time_s > 0 ? force->time_s : e->dt_s;
    double per = force->time_s > 0 ? 1 : 1 / e->dt_s; /* an impulse acts in one substep */
    struct engine_force push = {per * force->x_n, per * force->y_n, per * force->turn_nm, time_s};
    double most = fmax(fmax(fabs(push.x_n), fabs(push.y_n)), fabs(push.turn_nm));
    bool finite = isfinite(push.x_n + push.y_n + push.turn_nm);
    if (!finite || !(force->time_s >= 0 && force->time_s <= 1e6) || most > EDIT_FORCE_MAX_N) {
        return edit_refuse(e, reason, "%s: expected a force of up to %g N for a time",
                           e->bodies[body].name, EDIT_FORCE_MAX_N);
    }
    mu_result checked = edit_check_free(e, body, reason);
    if (checked != MU_OK) {
        return checked;
    }
    struct engine_body *b = &e->bodies[body];
    b->push = push;
    b->push_substeps = (uint32_t)lround(ceil(time_s / e->dt_s - 1e-9));
    ode_world_sleep(body, false);
    b->asleep = false;
    return MU_OK;
}

mu_result engine_reset(struct engine *e, size_t body, const char **reason)
{
    MU_ASSERT(body < e->body_count);
    bool is_robot = body < e->robot_count;
    int32_t bearer = is_robot ? (int32_t)body : e->objects[body - e->robot_count].bearer;
    int32_t held = bearer == ENGINE_NO_BEARER ? GRIPPER_NOTHING : e->robots[bearer].gripper.holds;
    if (held != GRIPPER_NOTHING) {
        grip_let_go(e, (size_t)bearer);
    }
    e->grid_is_old = true;
    mu_result placed = engine_place(e, body, edit_start_pose(e, body), reason);
    if (placed != MU_OK && held != GRIPPER_NOTHING) {
        grip_take_back(e, (size_t)bearer, (size_t)held);
        edit_look_again(e);
    }
    if (placed == MU_OK && is_robot) {
        bodies_start_devices(e, body);
        motion_follow(e, body);
        edit_look_again(e);
    }
    return placed;
}

void engine_reset_all(struct engine *e)
{
    for (size_t i = 0; i < e->robot_count; i++) {
        grip_let_go(e, i);
        bodies_start_devices(e, i);
    }
    for (size_t b = 0; b < e->body_count; b++) {
        motion_put(e, b, edit_start_pose(e, b));
        e->bodies[b].last_good = e->bodies[b].motion;
    }
    edit_look_again(e);
}
