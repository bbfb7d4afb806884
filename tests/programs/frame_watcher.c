/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Looks at a run as any observer could, and prints a line for each thing that it sees, until it has
 * seen the last step, or the simulator has left:
 *   frame_watcher DOMAIN every|latest
 *   scene WORLD SEED STEP_NS WALLS ROBOTS OBJECTS
 *   figure NAME CONTROLLED SONARS LASERS X Y HEADING
 *   frame STEP TIME_NS DIGEST ROBOTS OBJECTS PERCEPTS
 *   robot STEP NAME STATE X Y HEADING FORWARD TURN STALLED DISTANCE STALLED_S STALLS
 *   count STEP NAME FIRINGS SENT RECEIVED COMMAND_FORWARD COMMAND_TURN
 *   act STEP AGENT FIRINGS MAILS RULES
 *   outside STEP FROM TO CONTENT
 *   order STEP SOURCE ORDER NAME
 *   end FRAMES MISSED MALFORMED
 */
#include "bus/bus.h"
#include "wire.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct bus bus;
static struct bus_reader scenes, frames, statuses;
static uint64_t seen, missed;
static int64_t next_step;
static int64_t last_step = -1; /* of the run; -1: it is not over */

static void scene_print(const muster_Scene *s)
{
    printf("scene %s %" PRIu64 " %" PRIu64 " %u %u %u\n", s->world, s->seed, s->step_ns,
           s->walls._length, s->robots._length, s->objects._length);
    for (uint32_t i = 0; i < s->robots._length; i++) {
        const muster_Figure *f = &s->robots._buffer[i];
        printf("figure %s %d %u %u %.17g %.17g %.17g\n", f->name, f->controlled, f->sonars._length,
               f->lasers._length, f->x_m, f->y_m, f->heading_rad);
    }
}

static void robot_print(int64_t step, const muster_RobotView *r)
{
    printf("robot %" PRId64 " %s %d %.17g %.17g %.17g %.17g %.17g %d %.17g %.17g %u\n", step,
           r->name, (int)r->state, r->x_m, r->y_m, r->heading_rad, r->forward_m_s, r->turn_rad_s,
           r->stalled, r->distance_m, r->stalled_s, r->stalls);
    printf("count %" PRId64 " %s %" PRIu64 " %" PRIu64 " %" PRIu64 " %.17g %.17g\n", step, r->name,
           r->firings, r->mails_sent, r->mails_received, r->command_forward_m_s,
           r->command_turn_rad_s);
}

static void lists_print(const muster_Frame *f)
{
    for (uint32_t i = 0; i < f->acts._length; i++) {
        const muster_Act *a = &f->acts._buffer[i];
        printf("act %" PRId64 " %s %u %u %s\n", f->step, a->agent, a->firings, a->mails._length,
               a->rules);
    }
    for (uint32_t i = 0; i < f->outside._length; i++) {
        const muster_Mail *m = &f->outside._buffer[i];
        printf("outside %" PRId64 " %s %s %s\n", f->step, m->src, m->dst, m->content);
    }
    for (uint32_t i = 0; i < f->orders._length; i++) {
        const muster_RunCommand *c = &f->orders._buffer[i];
        printf("order %" PRId64 " %s %d %s\n", f->step, c->source, (int)c->order, c->name);
    }
}

static void frame_print(const muster_Frame *f)
{
    seen++;
    missed += f->step > next_step ? (uint64_t)(f->step - next_step) : 0;
    next_step = f->step + 1;
    printf("frame %" PRId64 " %" PRIu64 " %016" PRIx64 " %u %u %u\n", f->step, f->time_ns,
           f->digest, f->robots._length, f->objects._length, f->percepts._length);
    for (uint32_t i = 0; i < f->robots._length; i++) {
        robot_print(f->step, &f->robots._buffer[i]);
    }
    lists_print(f);
}

static void statuses_look(void)
{
    enum bus_life life;
    const muster_RunStatus *status;
    while ((status = bus_next(&statuses, &life))) {
        if (life == BUS_DATA && status->state == muster_RUN_DONE) {
            last_step = status->step;
        }
    }
}

/* @return whether there is nothing more to come */
static bool look(void)
{
    enum bus_life life;
    const void *sample;
    statuses_look();
    while ((sample = bus_next(&scenes, &life))) {
        if (life == BUS_DATA) {
            scene_print(sample);
        }
    }
    while ((sample = bus_next(&frames, &life))) {
        if (life == BUS_DATA) {
            frame_print(sample);
            fflush(stdout);
        }
    }
    bool whole = last_step >= 0 && next_step > last_step;
    return seen > 0 && (whole || bus_reader_matches(&frames) == 0);
}

int main(int argc, char **argv)
{
    struct bus_options options = {.domain = argc == 3 ? (int)strtol(argv[1], NULL, 10) : -1,
                                  .place = BUS_OBSERVER,
                                  .name = "frame_watcher"};
    if (options.domain < 0 || bus_open(&bus, &options) != MU_OK ||
        bus_reader_open(&bus, BUS_SCENE, NULL, &scenes) != MU_OK ||
        bus_reader_open(&bus, BUS_RUN_STATUS, NULL, &statuses) != MU_OK ||
        bus_reader_open(&bus, BUS_FRAME, argv[2], &frames) != MU_OK) {
        return 4;
    }
    while (!look()) {
        bus_wait(&bus, 0, 20000000);
    }
    (void)look(); /* what came with the end */
    printf("end %" PRIu64 " %" PRIu64 " %" PRIu64 "\n", seen, missed, bus.malformed);
    bus_close(&bus);
    return 0;
}
