/* SPDX-License-Identifier: Apache-2.0 */
/* Publishes the state of the run. */
#include "sim/session/parts.h"

#include "core/clock.h"
#include "muster/memory.h"

static const uint64_t STATUS_PERIOD_NS = 50000000;

void status_open(struct session *s)
{
    s->status.totals = mu_startup_array(s->totals_count, sizeof *s->status.totals);
    s->status.places = mu_startup_array(s->world->object_count, sizeof *s->status.places);
}

/* Lays out the totals of robots that have a controller, and behind them those of agents. */
static void totals_fill(struct session *s, muster_RunStatus *status)
{
    uint32_t robots = 0, agents = (uint32_t)(s->totals_count - s->robot_count);
    for (size_t i = 0; i < s->robot_count; i++) {
        if (s->agents.at[i].controlled) {
            s->status.totals[robots++] = s->totals[i].told;
        }
    }
    for (uint32_t i = 0; i < agents; i++) {
        s->status.totals[robots + i] = s->totals[s->robot_count + i].told;
    }
    status->robots._buffer = s->status.totals;
    status->robots._length = status->robots._maximum = robots;
    status->agents._buffer = s->status.totals + robots;
    status->agents._length = status->agents._maximum = agents;
}

static uint32_t places_fill(struct session *s)
{
    for (size_t i = 0; i < s->world->object_count; i++) {
        struct world_pose pose = engine_pose(s->engine, s->robot_count + i);
        s->status.places[i] = (muster_ObjectPlace){.name = s->world->objects[i].name,
                                                   .x_m = pose.x_m,
                                                   .y_m = pose.y_m,
                                                   .heading_rad = pose.heading_rad};
    }
    return (uint32_t)s->world->object_count;
}

bool status_tell(struct session *s, bool always)
{
    uint64_t now_ns = mu_clock_ns();
    if (!always && now_ns - s->status.told_wall_ns < STATUS_PERIOD_NS) {
        return true;
    }
    s->status.told_wall_ns = now_ns;
    muster_RunState state = phase_word(s);
    bool done = state == muster_RUN_DONE;
    static char none[] = "none";
    int64_t steps = s->step > 0 ? s->step : 0;
    muster_RunStatus status = {.simulator = s->name,
                               .state = state,
                               .step = steps,
                               .time_ns = (uint64_t)steps * s->options.step_ns,
                               .wall_ns = s->last_step_wall_ns - s->first_step_wall_ns,
                               .duration_ns = s->options.duration_ns,
                               .skipped = s->skipped,
                               .hash = done && !s->options.free ? s->hash_text : none,
                               .waits_for = s->waits_for};
    if (done) {
        totals_fill(s, &status);
    }
    status.objects._buffer = s->status.places;
    status.objects._length = status.objects._maximum = done ? places_fill(s) : 0;
    observe_status(s, &status);
    return bus_write(&s->status.writer, &status) == MU_OK;
}
