/* SPDX-License-Identifier: Apache-2.0 */
/* What comes of a simulator, and what observers see of a run. */
#include "bus/check.h"
#include "bus/check_fields.h"
#include "bus/wire/percept.h"

#include <math.h>

/* Corners of an outline, and its numbers. */
enum { CORNERS_MAX = 64 };

/* A path, and why an order was refused, in bytes. */
enum { FILE_TEXT_MAX = 1023, REASON_TEXT_MAX = 255 };

static bool ranges_ok(const float *range_m, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        if (!isfinite(range_m[i])) {
            return false;
        }
    }
    return true;
}

static bool percepts_ok(const muster_Percept *percepts, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        if (!is_name(percepts[i].robot) || !percept_ok(&percepts[i])) {
            return false;
        }
    }
    return true;
}

bool check_sense(const void *sample)
{
    const muster_Sense *s = sample;
    return is_process(s->process) && s->robots._length <= MU_LOCAL_AGENTS_MAX &&
           percepts_ok(s->robots._buffer, s->robots._length);
}

static bool numbers_ok(const double numbers[], size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(numbers[i])) {
            return false;
        }
    }
    return true;
}

bool check_run_command(const void *sample)
{
    const muster_RunCommand *c = sample;
    const double numbers[] = {c->x_m,       c->y_m,       c->heading_rad, c->force_x_n,
                              c->force_y_n, c->torque_nm, c->time_s,      c->rate};
    return numbers_ok(numbers, sizeof numbers / sizeof numbers[0]) && is_process(c->simulator) &&
           text_fits(c->source, MU_PROCESS_MAX) && (unsigned)c->order <= muster_RUN_HOLD &&
           text_fits(c->name, MU_FIELD_MAX) && text_fits(c->file, FILE_TEXT_MAX) &&
           text_fits(c->when, MU_CONDITION_MAX);
}

bool check_run_answer(const void *sample)
{
    const muster_RunAnswer *a = sample;
    return is_process(a->simulator) && text_fits(a->source, MU_PROCESS_MAX) &&
           (unsigned)a->result <= muster_ORDER_NOT_WRITTEN && text_fits(a->reason, REASON_TEXT_MAX);
}

static bool objects_ok(const muster_ObjectPlace *objects, uint32_t count)
{
    bool fit = count <= MU_OBJECTS_MAX;
    for (uint32_t i = 0; fit && i < count; i++) {
        const muster_ObjectPlace *o = &objects[i];
        fit = text_fits(o->name, MU_NAME_MAX) && isfinite(o->x_m) && isfinite(o->y_m) &&
              isfinite(o->heading_rad);
    }
    return fit;
}

bool check_run_status(const void *sample)
{
    const muster_RunStatus *s = sample;
    if (!is_process(s->simulator) || !text_fits(s->hash, MU_FIELD_MAX + 1) ||
        !text_fits(s->waits_for, MU_CONTENT_MAX) || s->robots._length > MU_ROBOTS_MAX) {
        return false;
    }
    for (uint32_t i = 0; i < s->robots._length; i++) {
        if (!is_name(s->robots._buffer[i].robot)) {
            return false;
        }
    }
    return objects_ok(s->objects._buffer, s->objects._length);
}

/* --- what observers see ----------------------------------------------------------------------- */

static bool outline_ok(const muster_Outline *o)
{
    return isfinite(o->radius_m) && o->corners_m._length <= 2 * CORNERS_MAX &&
           o->corners_m._length % 2 == 0 && ranges_ok(o->corners_m._buffer, o->corners_m._length);
}

static bool mounts_ok(const muster_Mount *mounts, uint32_t count)
{
    bool fit = count <= MU_SONARS_MAX;
    for (uint32_t i = 0; fit && i < count; i++) {
        const muster_Mount *m = &mounts[i];
        const double numbers[] = {m->x_m, m->y_m, m->heading_rad, m->fov_rad, m->range_m};
        fit = numbers_ok(numbers, sizeof numbers / sizeof numbers[0]) && m->beams <= MU_BEAMS_MAX;
    }
    return fit;
}

static bool figures_ok(const muster_Figure *figures, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const muster_Figure *f = &figures[i];
        const double numbers[] = {f->x_m, f->y_m, f->heading_rad};
        if (!text_fits(f->name, MU_NAME_MAX) || !text_fits(f->color, MU_FIELD_MAX) ||
            !numbers_ok(numbers, sizeof numbers / sizeof numbers[0]) || !outline_ok(&f->shape) ||
            !mounts_ok(f->sonars._buffer, f->sonars._length) ||
            !mounts_ok(f->lasers._buffer, f->lasers._length) ||
            !mounts_ok(f->cameras._buffer, f->cameras._length) ||
            !mounts_ok(f->fiducial_finders._buffer, f->fiducial_finders._length)) {
            return false;
        }
    }
    return true;
}

bool check_scene(const void *sample)
{
    const muster_Scene *s = sample;
    const double numbers[] = {s->min_x_m, s->min_y_m, s->max_x_m, s->max_y_m};
    if (!is_process(s->simulator) || !text_fits(s->world, FILE_TEXT_MAX) ||
        !numbers_ok(numbers, sizeof numbers / sizeof numbers[0]) ||
        s->robots._length > MU_ROBOTS_MAX || s->objects._length > MU_OBJECTS_MAX) {
        return false;
    }
    for (uint32_t i = 0; i < s->walls._length; i++) {
        if (!outline_ok(&s->walls._buffer[i])) {
            return false;
        }
    }
    return figures_ok(s->robots._buffer, s->robots._length) &&
           figures_ok(s->objects._buffer, s->objects._length);
}

static bool views_ok(const muster_RobotView *views, uint32_t count)
{
    bool fit = count <= MU_ROBOTS_MAX;
    for (uint32_t i = 0; fit && i < count; i++) {
        const muster_RobotView *v = &views[i];
        const double numbers[] = {v->x_m,
                                  v->y_m,
                                  v->heading_rad,
                                  v->forward_m_s,
                                  v->turn_rad_s,
                                  v->command_forward_m_s,
                                  v->command_turn_rad_s,
                                  v->distance_m,
                                  v->stalled_s};
        fit = is_name(v->name) && text_fits(v->goal, MU_FIELD_MAX) &&
              numbers_ok(numbers, sizeof numbers / sizeof numbers[0]);
    }
    return fit;
}

static bool agents_ok(const muster_AgentView *agents, uint32_t count)
{
    bool fit = count <= MU_AGENTS_MAX;
    for (uint32_t i = 0; fit && i < count; i++) {
        fit = is_name(agents[i].name);
    }
    return fit;
}

static bool orders_ok(const muster_RunCommand *orders, uint32_t count)
{
    bool fit = count <= MU_ORDERS_MAX;
    for (uint32_t i = 0; fit && i < count; i++) {
        fit = check_run_command(&orders[i]);
    }
    return fit;
}

bool check_frame(const void *sample)
{
    const muster_Frame *f = sample;
    return is_process(f->simulator) && f->acts._length <= MU_FRAME_ACTS_MAX &&
           f->percepts._length <= MU_ROBOTS_MAX && f->outside._length <= MU_FRAME_MAILS_MAX &&
           views_ok(f->robots._buffer, f->robots._length) &&
           agents_ok(f->agents._buffer, f->agents._length) &&
           objects_ok(f->objects._buffer, f->objects._length) &&
           percepts_ok(f->percepts._buffer, f->percepts._length) &&
           check_acts(f->acts._buffer, f->acts._length) &&
           check_mails(f->outside._buffer, f->outside._length) &&
           orders_ok(f->orders._buffer, f->orders._length);
}
