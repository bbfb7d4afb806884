/* SPDX-License-Identifier: Apache-2.0 */
/* Orders for later and events, as a session sees them. */
#include "core/clock.h"
#include "core/log.h"
#include "sim/session/session.h"

#include <string.h>

static const int64_t HOLD_WAIT_NS = 5000000;
static const uint64_t HOLD_PATIENCE_NS = 5000000000;

static int body_find(const void *self, const char *name)
{
    const struct session *s = self;
    return (int)session_body_find(s, name);
}

static void body_numbers(const void *self, int body, struct condition_numbers *out)
{
    const struct session *s = self;
    struct world_pose pose = engine_pose(s->engine, (size_t)body);
    *out = (struct condition_numbers){
        .x_m = pose.x_m, .y_m = pose.y_m, .heading_rad = pose.heading_rad};
    if ((size_t)body < s->robot_count) {
        const struct session_robot *r = &s->robots[body];
        const struct tally *t = &s->tallies[body];
        out->distance_m = t->distance_m;
        out->stalls = t->stalls;
        out->stalled_s = t->stalled_s;
        out->mail_sent = (double)r->mails_sent;
        out->mail_received = (double)r->mails_received;
        out->rule_firings = (double)r->firings;
    }
}

static bool robot_stalled(const void *self, int robot)
{
    const struct session *s = self;
    return s->robots[robot].percept.stalled;
}

static bool robot_counts(const void *self, int robot)
{
    const struct session *s = self;
    return s->robots[robot].controlled;
}

void session_script_open(struct session *s)
{
    s->body_names =
        (struct condition_names){.find = body_find, .self = s, .robots = (int)s->robot_count};
    s->script = script_open(&s->body_names);
}

void session_script_act(struct session *s, size_t robot, const muster_Act *act)
{
    script_act(s->script, (int)robot, act);
}

void session_script_look(struct session *s)
{
    const struct condition_view view = {.time_s =
                                            (double)s->step * (double)s->options.step_ns * 1e-9,
                                        .self = s,
                                        .numbers = body_numbers,
                                        .stalled = robot_stalled,
                                        .counts = robot_counts,
                                        .robots = (int)s->robot_count};
    const muster_RunCommand *c;
    script_look(s->script, (uint64_t)s->step * s->options.step_ns, &view);
    while ((c = script_next(s->script))) {
        if (order_queue_put(s->orders, c) != MU_OK) {
            session_order_refuse(s, c, "too many orders in one step");
        }
    }
}

void session_script_undo(struct session *s, const muster_RunCommand *c)
{
    char why[CONDITION_WHY_MAX];
    static char none[1];
    muster_RunCommand back = *c;
    back.on = !c->on;
    back.due_ns = (uint64_t)s->step * s->options.step_ns + (uint64_t)(c->time_s * 1e9);
    back.time_s = 0;
    back.when = none;
    if (script_put(s->script, &back, why) != MU_OK) {
        mu_log(MU_LOG_WARNING, "undo-lost", "name=%s", c->name);
    }
}

/* Whoever asked for it says RUN_GO when he is done. */
void session_script_hold(struct session *s)
{
    uint64_t until_ns = mu_clock_ns() + HOLD_PATIENCE_NS;
    s->go = s->options.free;
    while (!s->go && !s->end && mu_clock_ns() < until_ns) {
        bus_wait(&s->bus, 1, HOLD_WAIT_NS);
        session_take(s);
        (void)session_tell(s, muster_RUN_RUNNING, false);
    }
}
