/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file rich.h
 * Samples of what observers see that have something in each of their fields.
 */
#ifndef MUSTER_TESTS_RICH_H
#define MUSTER_TESTS_RICH_H

#include "samples.h"

#include <stdio.h>

#define RICH_LIST(type, buffer, count) ((dds_sequence_##type){count, count, buffer, false})

/** @return a Scene with walls, two robots and a thing; good until the next call */
static inline muster_Scene rich_scene(void)
{
    static float wall_m[] = {2, -2, 2.5F, -2, 2.5F, 2, 2, 2}, disc_m[] = {0, 0};
    static muster_Outline walls[2];
    static muster_Figure robots[2], things[1];
    static muster_Mount mounts[2];
    walls[0] = (muster_Outline){.rgb = 7, .corners_m = {8, 8, wall_m, false}};
    walls[1] = (muster_Outline){.radius_m = 0.3, .flat = true, .corners_m = {2, 2, disc_m, false}};
    mounts[0] = (muster_Mount){.fov_rad = 3, .range_m = 8, .beams = 4};
    mounts[1] = (muster_Mount){.x_m = 0.1, .fov_rad = 0.3, .range_m = 5, .beams = 1};
    for (int i = 0; i < 2; i++) {
        robots[i] = (muster_Figure){.name = words(i ? "blue" : "red"),
                                    .color = words("#ff0000"),
                                    .shape = walls[1],
                                    .controlled = true};
        robots[i].sonars = RICH_LIST(muster_Mount, mounts, 2);
        robots[i].lasers = RICH_LIST(muster_Mount, mounts, 1);
    }
    things[0] = (muster_Figure){.name = words("puck"), .color = words("red"), .shape = walls[0]};
    muster_Scene s = {.simulator = words("sim"),
                      .world = words("arena.world"),
                      .seed = 1,
                      .step_ns = 100000000,
                      .min_x_m = -3,
                      .min_y_m = -3,
                      .max_x_m = 3,
                      .max_y_m = 3};
    s.walls = RICH_LIST(muster_Outline, walls, 2);
    s.robots = RICH_LIST(muster_Figure, robots, 2);
    s.objects = RICH_LIST(muster_Figure, things, 1);
    return s;
}

static inline muster_Percept rich_percept(const char *robot)
{
    static float sonar_m[] = {0.5F, 1, 5, 5}, laser_m[] = {8, 8, 0.25F};
    static muster_Blob blob = {.bearing_rad = 0.1, .width_rad = 0.2, .range_m = 1};
    static muster_Fiducial fiducial = {.bearing_rad = 0.1, .range_m = 1, .heading_rad = 2};
    muster_Percept p = {.robot = words(robot), .x_m = 1, .battery_share = 0.5};
    p.sonar_m._buffer = sonar_m;
    p.sonar_m._length = p.sonar_m._maximum = 4;
    p.laser_m._buffer = laser_m;
    p.laser_m._length = p.laser_m._maximum = 3;
    p.blobs = RICH_LIST(muster_Blob, &blob, 1);
    p.fiducials = RICH_LIST(muster_Fiducial, &fiducial, 1);
    return p;
}

/** @return a Frame in which two robots act, write and think, somebody outside says something, and a
 * hand moves the thing; good until the next call */
static inline muster_Frame rich_frame(int64_t step)
{
    static muster_RobotView robots[2];
    static muster_ObjectPlace thing;
    static muster_Percept percepts[2];
    static muster_Act acts[2];
    static muster_Mail mails[3];
    static muster_RunCommand order;
    static char diary[512];
    bool stalled = step % 5 > 2;
    snprintf(diary, sizeof diary,
             "%sS\n+%lld (position %lld.0 1000.0 2000.0)\nM blue 7 tell near 2000.0\n"
             "+%lld (message near 2000.0)\nR go %lld,%lld,*\nV 300.0 20.0\n"
             "T blue tell near 2000.0\n+%lld (goal goto 1000.0 2000.0)\n-%lld\nA see 12,9\n~ 3\n",
             step == 0 ? "0\nL (wander)\n" : "", (long long)(10 * step), (long long)step,
             (long long)(10 * step + 1), (long long)(10 * step), (long long)(10 * step + 1),
             (long long)(10 * step + 2), (long long)(10 * step - 9));
    for (uint64_t i = 0; i < 3; i++) {
        mails[i] = letter(i ? "blue" : "red", (uint64_t)step + i + 1, "blue", "near 2000.0");
    }
    for (int i = 0; i < 2; i++) {
        robots[i] = (muster_RobotView){.name = words(i ? "blue" : "red"),
                                       .state = muster_STATE_RUNNING,
                                       .x_m = 0.1 * (double)step,
                                       .stalled = stalled,
                                       .distance_m = 0.1 * (double)step};
        percepts[i] = rich_percept(i ? "blue" : "red");
        acts[i] = (muster_Act){.agent = words(i ? "blue" : "red"),
                               .state = muster_STATE_RUNNING,
                               .drives = true,
                               .forward_m_s = 0.3,
                               .firings = 2,
                               .rules = words("go see"),
                               .diary = diary};
        acts[i].mails = RICH_LIST(muster_Mail, mails + i, 1);
    }
    thing = (muster_ObjectPlace){.name = words("puck"), .x_m = 1};
    order = (muster_RunCommand){.simulator = words("sim"),
                                .source = words("operator"),
                                .order = muster_RUN_PLACE,
                                .name = words("puck"),
                                .file = words(""),
                                .when = words("")};
    muster_Frame f = {.simulator = words("sim"),
                      .step = step,
                      .time_ns = (uint64_t)step * 100000000,
                      .wall_ns = (uint64_t)step,
                      .digest = 77};
    f.robots = RICH_LIST(muster_RobotView, robots, 2);
    f.objects = RICH_LIST(muster_ObjectPlace, &thing, 1);
    f.percepts = RICH_LIST(muster_Percept, percepts, 2);
    f.acts = RICH_LIST(muster_Act, acts, 2);
    f.outside = RICH_LIST(muster_Mail, mails + 2, 1);
    f.orders = RICH_LIST(muster_RunCommand, &order, 1);
    return f;
}

/** @return how a run ended; good until the next call */
static inline muster_RunStatus rich_status(void)
{
    static muster_RobotTotals totals;
    static muster_ObjectPlace thing;
    totals = (muster_RobotTotals){.robot = words("red")};
    thing = (muster_ObjectPlace){.name = words("puck")};
    muster_RunStatus s = {.simulator = words("sim"),
                          .state = muster_RUN_DONE,
                          .step = 9,
                          .time_ns = 900000000,
                          .hash = words("none"),
                          .waits_for = words("")};
    s.robots = RICH_LIST(muster_RobotTotals, &totals, 1);
    s.objects = RICH_LIST(muster_ObjectPlace, &thing, 1);
    return s;
}

#endif
