/* SPDX-License-Identifier: Apache-2.0 */
#include "story/story.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- what is near ----------------------------------------------------------------------------- */

struct point {
    double x_m, y_m;
};

static struct point corner(const muster_Outline *o, size_t index)
{
    const float *at = o->corners_m._buffer + 2 * index;
    return (struct point){(double)at[0], (double)at[1]};
}

static double edge_distance(struct point p, struct point a, struct point b)
{
    struct point along = {b.x_m - a.x_m, b.y_m - a.y_m}, from = {p.x_m - a.x_m, p.y_m - a.y_m};
    double length2 = along.x_m * along.x_m + along.y_m * along.y_m;
    double share = length2 > 0 ? (from.x_m * along.x_m + from.y_m * along.y_m) / length2 : 0;
    share = fmax(0, fmin(1, share));
    return hypot(from.x_m - share * along.x_m, from.y_m - share * along.y_m);
}

static double wall_distance(const muster_Outline *wall, struct point p)
{
    size_t count = wall->corners_m._length / 2;
    double least = INFINITY;
    for (size_t i = 0; i < count; i++) {
        least = fmin(least, edge_distance(p, corner(wall, i), corner(wall, (i + 1) % count)));
    }
    return fabs(least - wall->radius_m);
}

static void near_note(struct stall *s, const char *what, double distance_m)
{
    if (distance_m < s->near_m) {
        s->near_m = distance_m;
        snprintf(s->near, sizeof s->near, "%s", what);
    }
}

static void near_find(const struct recording *r, const muster_Frame *f, uint32_t robot,
                      struct stall *s)
{
    s->near_m = INFINITY;
    for (uint32_t i = 0; i < f->robots._length; i++) {
        const muster_RobotView *other = &f->robots._buffer[i];
        if (i != robot) {
            near_note(s, other->name, hypot(other->x_m - s->x_m, other->y_m - s->y_m));
        }
    }
    for (uint32_t i = 0; r->scene && i < r->scene->walls._length; i++) {
        near_note(s, "a wall",
                  wall_distance(&r->scene->walls._buffer[i], (struct point){s->x_m, s->y_m}));
    }
}

/* --- stalls ----------------------------------------------------------------------------------- */

/* What the step before told the motors. */
struct told {
    double forward_m_s, turn_rad_s;
    muster_State state;
};

static struct stall stall_begin(const struct recording *r, const muster_Frame *f, uint32_t robot,
                                const struct told *told)
{
    const muster_RobotView *v = &f->robots._buffer[robot];
    struct stall s = {.from = f->step,
                      .to = f->step,
                      .x_m = v->x_m,
                      .y_m = v->y_m,
                      .forward_m_s = told->forward_m_s,
                      .turn_rad_s = told->turn_rad_s,
                      .state = told->state};
    near_find(r, f, robot, &s);
    return s;
}

size_t stalls_find(struct recording *r, uint32_t robot, struct stall *stalls, size_t most)
{
    size_t count = 0;
    bool stalled = false;
    struct told told = {.state = muster_STATE_STANDBY};
    recording_rewind(r);
    for (const muster_Frame *f = recording_next(r); f; f = recording_next(r)) {
        if (robot >= f->robots._length) {
            continue;
        }
        const muster_RobotView *v = &f->robots._buffer[robot];
        if (v->stalled && !stalled && ++count <= most) {
            stalls[count - 1] = stall_begin(r, f, robot, &told);
        } else if (v->stalled && count > 0 && count <= most) {
            stalls[count - 1].to = f->step;
        }
        stalled = v->stalled;
        told = (struct told){v->command_forward_m_s, v->command_turn_rad_s, v->state};
    }
    return count;
}

const struct stall *stalls_at(const struct stall *stalls, size_t count, int64_t step)
{
    const struct stall *best = NULL;
    int64_t least = INT64_MAX;
    for (size_t i = 0; i < count; i++) {
        const struct stall *s = &stalls[i];
        int64_t away = step < s->from ? s->from - step : step > s->to ? step - s->to : 0;
        if (away < least) {
            least = away;
            best = s;
        }
    }
    return best;
}

uint32_t stalls_robot(struct recording *r, const char *name)
{
    recording_rewind(r);
    const muster_Frame *f = recording_next(r);
    for (uint32_t i = 0; f && i < f->robots._length; i++) {
        if (strcmp(f->robots._buffer[i].name, name) == 0) {
            return i;
        }
    }
    return MU_NONE;
}
