/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A simulator for who looks: says a Scene, then Frames of robots that go in circles, and no more.
 *   frame_feeder DOMAIN ROBOTS HZ SECONDS [NAME]
 * Each robot has 16 sonars, and each tenth a laser of 181 beams; each sends a mail every tenth
 * step. NAME stands before each robot's number and is its colour and each mail's content, too.
 * Prints "ready" when it begins, and "N frames" at the end.
 */
#include "bus/bus.h"
#include "core/clock.h"
#include "wire.h"

#include <math.h>
#include <muster/limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ROBOTS_MAX = 1000, SONARS = 16, LASER = 181, LASER_EACH = 10, MAIL_EACH = 10, WALLS = 4 };

static const double RADIUS_M = 0.2, SPACING_M = 1.6;

static char simulator[] = "sim", none[1];
static const char *name_start = "robot-";
static char names[ROBOTS_MAX][MU_NAME_MAX + 1], shown[ROBOTS_MAX][MU_NAME_MAX + 10];
static char color[MU_FIELD_MAX + 1], word[MU_FIELD_MAX + 1];
static uint32_t robots;
static double side_m;

static muster_Figure figures[ROBOTS_MAX];
static muster_RobotView views[ROBOTS_MAX];
static muster_Percept percepts[ROBOTS_MAX];
static muster_Act acts[ROBOTS_MAX];
static muster_Mail mails[ROBOTS_MAX];
static muster_Mount sonars[SONARS], laser;
static float sonar_m[ROBOTS_MAX][SONARS], laser_m[ROBOTS_MAX][LASER];

/* --- the scene -------------------------------------------------------------------------------- */

static void mounts_make(void)
{
    for (int i = 0; i < SONARS; i++) {
        sonars[i] = (muster_Mount){.x_m = 0.15 * cos(i * M_PI / 8),
                                   .y_m = 0.15 * sin(i * M_PI / 8),
                                   .heading_rad = i * M_PI / 8,
                                   .fov_rad = 0.3,
                                   .range_m = 5,
                                   .beams = 1};
    }
    laser = (muster_Mount){.fov_rad = M_PI, .range_m = 8, .beams = LASER};
}

static void centre_of(uint32_t i, double *x_m, double *y_m)
{
    uint32_t row = (uint32_t)ceil(sqrt(robots));
    *x_m = SPACING_M * (i % row + 0.5) - side_m / 2;
    *y_m = SPACING_M * (double)(i / row + 0.5) - side_m / 2;
}

static void figures_make(void)
{
    static float disc[2] = {0, 0};
    for (uint32_t i = 0; i < robots; i++) {
        muster_Figure *f = &figures[i];
        snprintf(names[i], sizeof names[i], "robot-%u", i + 1);
        snprintf(shown[i], sizeof shown[i], "%.27s%u", name_start, i + 1);
        *f = (muster_Figure){.name = shown[i], .color = color, .controlled = true};
        centre_of(i, &f->x_m, &f->y_m);
        f->shape = (muster_Outline){.rgb = 0x808080, .radius_m = RADIUS_M};
        f->shape.corners_m._buffer = disc;
        f->shape.corners_m._length = 2;
        f->sonars = (dds_sequence_muster_Mount){._length = SONARS, ._buffer = sonars};
        f->lasers = (dds_sequence_muster_Mount){._length = i % LASER_EACH == 0, ._buffer = &laser};
    }
}

static mu_result scene_say(const struct bus_writer *writer, char *world)
{
    static float corners[WALLS][8];
    static muster_Outline walls[WALLS];
    float far = (float)side_m / 2, near = far - 0.1f;
    for (int i = 0; i < WALLS; i++) {
        float sign = i % 2 ? 1 : -1;
        float across[8] = {-far, sign * near, far, sign * near, far, sign * far, -far, sign * far};
        for (int k = 0; k < 8; k++) {
            corners[i][k] = across[i < 2 ? k : k ^ 1];
        }
        walls[i] = (muster_Outline){.rgb = 0x404040};
        walls[i].corners_m._buffer = corners[i];
        walls[i].corners_m._length = 8;
    }
    muster_Scene scene = {.simulator = simulator,
                          .world = world,
                          .seed = 1,
                          .step_ns = 100000000,
                          .min_x_m = -side_m / 2,
                          .min_y_m = -side_m / 2,
                          .max_x_m = side_m / 2,
                          .max_y_m = side_m / 2};
    scene.walls = (dds_sequence_muster_Outline){._length = WALLS, ._buffer = walls};
    scene.robots = (dds_sequence_muster_Figure){._length = robots, ._buffer = figures};
    return bus_write(writer, &scene);
}

/* --- a frame ---------------------------------------------------------------------------------- */

static void robot_make(uint32_t i, int64_t step, double hz)
{
    double x_m, y_m, angle = 0.6 * (double)step / hz + i;
    centre_of(i, &x_m, &y_m);
    views[i] =
        (muster_RobotView){.name = names[i],
                           .state = i % 7 == 6 ? muster_STATE_SUSPENDED : muster_STATE_RUNNING,
                           .x_m = x_m + 0.5 * cos(angle),
                           .y_m = y_m + 0.5 * sin(angle),
                           .heading_rad = remainder(angle + M_PI / 2, 2 * M_PI),
                           .forward_m_s = 0.3,
                           .turn_rad_s = 0.6,
                           .goal = none,
                           .stalled = i % 11 == 10,
                           .distance_m = 0.3 * (double)step / hz,
                           .firings = (uint64_t)step * 3};
    for (int k = 0; k < SONARS; k++) {
        sonar_m[i][k] = (float)(0.4 + 0.3 * k + 0.3 * sin(angle + k));
    }
    for (int k = 0; k < LASER; k++) {
        laser_m[i][k] = (float)(2.0 + sin(angle + k * 0.1));
    }
    percepts[i] = (muster_Percept){.robot = names[i]};
    percepts[i].sonar_m._buffer = sonar_m[i];
    percepts[i].sonar_m._length = SONARS;
    percepts[i].laser_m._buffer = laser_m[i];
    percepts[i].laser_m._length = i % LASER_EACH == 0 ? LASER : 0;
}

static void act_make(uint32_t i, int64_t step)
{
    mails[i] = (muster_Mail){.src = names[i],
                             .seq = (uint64_t)step + 1,
                             .dst = i % 2 ? word : names[(i + 1) % robots],
                             .layer = 3,
                             .performative = none,
                             .language = none,
                             .ontology = none,
                             .reply_with = none,
                             .in_reply_to = none,
                             .conversation = none,
                             .due_ns = -1,
                             .content = word};
    acts[i] = (muster_Act){.agent = names[i],
                           .state = muster_STATE_RUNNING,
                           .firings = 3,
                           .rules = none,
                           .goal = none,
                           .diary = none};
    acts[i].mails._buffer = &mails[i];
    acts[i].mails._length = (step + i) % MAIL_EACH == 0;
}

static mu_result frame_say(const struct bus_writer *writer, int64_t step, double hz)
{
    for (uint32_t i = 0; i < robots; i++) {
        robot_make(i, step, hz);
        act_make(i, step);
    }
    muster_Frame f = {.simulator = simulator,
                      .step = step,
                      .time_ns = (uint64_t)((double)step * 1e9 / hz),
                      .wall_ns = (uint64_t)((double)step * 1e9 / hz),
                      .digest = 1};
    f.robots = (dds_sequence_muster_RobotView){._length = robots, ._buffer = views};
    f.percepts = (dds_sequence_muster_Percept){._length = robots, ._buffer = percepts};
    f.acts = (dds_sequence_muster_Act){._length = robots, ._buffer = acts};
    return bus_write(writer, &f);
}

/* --- time ------------------------------------------------------------------------------------- */

static void sleep_until(uint64_t ns)
{
    struct timespec t = {.tv_sec = (time_t)(ns / 1000000000u), .tv_nsec = (long)(ns % 1000000000u)};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, NULL);
}

static int feed(const struct bus_writer *frames, double hz, double seconds)
{
    uint64_t began_ns = mu_clock_ns();
    int64_t step = 0;
    for (; (double)step < hz * seconds; step++) {
        sleep_until(began_ns + (uint64_t)((double)step * 1e9 / hz));
        if (frame_say(frames, step, hz) == MU_FAULT_DDS) {
            return 1;
        }
    }
    printf("%lld frames\n", (long long)step);
    return 0;
}

int main(int argc, char **argv)
{
    static char world[] = "fed.world";
    static struct bus bus;
    struct bus_writer scenes, frames;
    if (argc < 5) {
        fprintf(stderr, "usage: frame_feeder DOMAIN ROBOTS HZ SECONDS [NAME]\n");
        return 2;
    }
    robots = (uint32_t)atol(argv[2]) < ROBOTS_MAX ? (uint32_t)atol(argv[2]) : ROBOTS_MAX;
    name_start = argc > 5 ? argv[5] : name_start;
    snprintf(color, sizeof color, "%.60s", argc > 5 ? argv[5] : "#808080");
    snprintf(word, sizeof word, "%.60s", argc > 5 ? argv[5] : "all");
    side_m = SPACING_M * ceil(sqrt(robots)) + 1;
    struct bus_options options = {
        .domain = (int)atol(argv[1]), .place = BUS_SIMULATOR, .name = "frame_feeder"};
    if (bus_open(&bus, &options) != MU_OK ||
        bus_writer_open(&bus, BUS_SCENE, NULL, NULL, &scenes) != MU_OK ||
        bus_writer_open(&bus, BUS_FRAME, "latest", NULL, &frames) != MU_OK) {
        return 1;
    }
    mounts_make();
    figures_make();
    if (scene_say(&scenes, world) != MU_OK) {
        return 1;
    }
    puts("ready");
    fflush(stdout);
    int code = feed(&frames, strtod(argv[3], NULL), strtod(argv[4], NULL));
    bus_close(&bus);
    return code;
}
