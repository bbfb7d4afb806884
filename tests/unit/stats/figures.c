/* SPDX-License-Identifier: Apache-2.0 */
/* What a run amounts to, against what a slow look at all of it says. */
#include "core/random.h"
#include "muster/memory.h"
#include "stats/stats.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <muster/stats.h>
#include <stdio.h>
#include <string.h>

enum { STEPS = 60, CROWD = 1000, FEW = 5, SIDE = 30 };

static mu_stats *stats;
static struct mu_figure figures[MU_ROBOTS_MAX];
static struct mu_robot_view views[MU_ROBOTS_MAX];
static char names[MU_ROBOTS_MAX][24];
static double nearest_m[CROWD][CROWD], nearest_s[CROWD][CROWD];

static const float square[4][8] = {{-1.1F, -1, -1, -1, -1, 9, -1.1F, 9},
                                   {9, -1, 9.1F, -1, 9.1F, 9, 9, 9},
                                   {-1.1F, -1.1F, 9.1F, -1.1F, 9.1F, -1, -1.1F, -1},
                                   {-1.1F, 9, 9.1F, 9, 9.1F, 9.1F, -1.1F, 9.1F}};

static struct mu_scene scene_of(size_t robots, struct mu_outline *walls)
{
    for (size_t i = 0; i < 4; i++) {
        walls[i] = (struct mu_outline){.corner_count = 4, .corners_m = square[i]};
    }
    for (size_t i = 0; i < robots; i++) {
        snprintf(names[i], sizeof names[i], "r%zu", i);
        figures[i] = (struct mu_figure){.name = names[i], .controlled = true};
        views[i] = (struct mu_robot_view){.name = names[i], .state = MU_RUNNING};
    }
    return (struct mu_scene){.step_ns = MU_STEP_NS,
                             .min_x_m = -1.5,
                             .min_y_m = -1.5,
                             .max_x_m = 9.5,
                             .max_y_m = 9.5,
                             .wall_count = 4,
                             .walls = walls,
                             .robot_count = robots,
                             .robots = figures};
}

static struct mu_frame frame_of(int64_t step, size_t robots)
{
    return (struct mu_frame){.step = step,
                             .time_ns = (uint64_t)step * MU_STEP_NS,
                             .robot_count = robots,
                             .robots = views};
}

/* --- nearest approaches ----------------------------------------------------------------------- */

static void reference_clear(size_t robots)
{
    for (size_t i = 0; i < robots; i++) {
        for (size_t j = 0; j < robots; j++) {
            nearest_m[i][j] = INFINITY;
        }
    }
}

static void reference_take(size_t robots, double time_s)
{
    for (size_t i = 0; i < robots; i++) {
        for (size_t j = i + 1; j < robots; j++) {
            double m = hypot(views[i].x_m - views[j].x_m, views[i].y_m - views[j].y_m);
            if (m < nearest_m[i][j]) {
                nearest_m[i][j] = m;
                nearest_s[i][j] = time_s;
            }
        }
    }
}

static void crowd_walk(size_t robots, struct mu_random *random, double side_m)
{
    for (size_t i = 0; i < robots; i++) {
        views[i].x_m = (double)mu_random_between(random, -1000000, 1000000) * side_m * 1e-6;
        views[i].y_m = (double)mu_random_between(random, -1000000, 1000000) * side_m * 1e-6;
    }
}

static size_t reference_count(size_t robots, double near_m)
{
    size_t count = 0;
    for (size_t i = 0; i < robots; i++) {
        for (size_t j = i + 1; j < robots; j++) {
            count += nearest_m[i][j] < near_m;
        }
    }
    return count;
}

/* @param steps  so few that there is room for all pairs that come near */
static void approach_check(size_t robots, int steps, double side_m, double near_m)
{
    struct mu_outline walls[4];
    struct mu_scene scene = scene_of(robots, walls);
    struct mu_random random;
    mu_random_seed(&random, robots, "approach");
    reference_clear(robots);
    mu_stats_begin(stats, &scene);
    for (int step = 0; step < steps; step++) {
        struct mu_frame frame = frame_of(step, robots);
        crowd_walk(robots, &random, side_m);
        reference_take(robots, step * 0.1);
        mu_stats_take(stats, &frame);
    }
    struct mu_stats_pair p;
    size_t wrong = 0, count = 0;
    for (; mu_stats_pair(stats, count, &p); count++) {
        wrong += p.one >= p.other || p.near_m != nearest_m[p.one][p.other] ||
                 fabs(p.time_s - nearest_s[p.one][p.other]) > 1e-9;
    }
    CU_ASSERT_EQUAL(wrong, 0);
    CU_ASSERT_EQUAL(count, reference_count(robots, near_m));
    CU_ASSERT_EQUAL(mu_stats_team(stats).pairs_refused, 0);
    for (size_t i = 0; i < robots; i++) {
        double best_m = INFINITY;
        for (size_t j = 0; j < robots; j++) {
            best_m = j == i ? best_m : fmin(best_m, nearest_m[i < j ? i : j][i < j ? j : i]);
        }
        const struct mu_stats_robot *r = mu_stats_robot(stats, i);
        wrong += best_m < near_m ? r->nearest_m != best_m : r->nearest_m >= 0;
    }
    CU_ASSERT_EQUAL(wrong, 0);
}

static void test_every_pair_of_a_few(void)
{
    approach_check(FEW, STEPS, SIDE, INFINITY);
    approach_check(MU_STATS_ALL_PAIRS, 3, SIDE, INFINITY);
}

static void test_pairs_of_a_crowd_that_come_near(void)
{
    approach_check(CROWD, 4, 50, MU_STATS_NEAR_M);
    approach_check(CROWD, 2, 1e7, MU_STATS_NEAR_M); /* too far apart for cells of their own */
}

static void test_a_crush_has_room_for_some(void)
{
    struct mu_outline walls[4];
    struct mu_scene scene = scene_of(CROWD, walls);
    struct mu_frame frame = frame_of(0, CROWD);
    struct mu_stats_pair p;
    mu_stats_begin(stats, &scene);
    mu_stats_take(stats, &frame); /* all of them in one place */
    CU_ASSERT(mu_stats_pair(stats, MU_STATS_PAIRS_MAX - 1, &p));
    CU_ASSERT_FALSE(mu_stats_pair(stats, MU_STATS_PAIRS_MAX, &p));
    CU_ASSERT(mu_stats_team(stats).pairs_refused > 0);
}

/* --- the floor -------------------------------------------------------------------------------- */

static void test_explored_by_each_and_together(void)
{
    struct mu_outline walls[4];
    struct mu_scene scene = scene_of(3, walls);
    scene.robots = figures;
    figures[2].controlled = false;
    mu_stats_begin(stats, &scene);
    for (int step = 0; step < 40; step++) {
        struct mu_frame frame = frame_of(step, 3);
        views[0].x_m = 0.25 + step * 0.1; /* nine cells of 0.5 m: 0.25 to 4.15 */
        views[0].y_m = 0.25;
        views[1].x_m = 0.25;
        views[1].y_m = 0.25 + (step < 20 ? step : 19) * 0.1; /* five: one of them the same */
        views[2].x_m = 8;
        views[2].y_m = 8;
        mu_stats_take(stats, &frame);
    }
    /* 20 x 20 cells of floor; the walls touch 1 of 10 fine rows of those beside them at most. */
    CU_ASSERT_DOUBLE_EQUAL(mu_stats_robot(stats, 0)->explored, 9.0 / 400, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(mu_stats_robot(stats, 1)->explored, 5.0 / 400, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(mu_stats_robot(stats, 2)->explored, 0, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(mu_stats_team(stats).explored, 13.0 / 400, 1e-12);
}

static void test_worlds_without_a_floor(void)
{
    struct mu_outline walls[4];
    struct mu_scene scene = scene_of(1, walls);
    struct mu_frame frame = frame_of(0, 1);
    scene.max_x_m = scene.min_x_m;
    mu_stats_begin(stats, &scene);
    mu_stats_take(stats, &frame);
    CU_ASSERT_EQUAL(mu_stats_team(stats).explored, -1);
    scene.max_x_m = 1e6;
    scene.max_y_m = 1e6;
    mu_stats_begin(stats, &scene);
    mu_stats_take(stats, &frame);
    CU_ASSERT_EQUAL(mu_stats_robot(stats, 0)->explored, -1);
}

/* --- robots and mail -------------------------------------------------------------------------- */

static void test_who_is_most_efficient(void)
{
    struct mu_outline walls[4];
    struct mu_scene scene = scene_of(3, walls);
    figures[2].controlled = false;
    mu_stats_begin(stats, &scene);
    CU_ASSERT_PTR_NULL(mu_stats_team(stats).most_efficient);
    struct mu_frame frame = frame_of(100, 3);
    views[0].distance_m = 3;
    views[1].distance_m = 2;
    views[1].stalled_s = 5; /* 2 m in the 5 s that it was free: more than 3 m in 10 s */
    views[2].distance_m = 50;
    frame.missed = 7;
    mu_stats_take(stats, &frame);
    struct mu_stats_team t = mu_stats_team(stats);
    CU_ASSERT_STRING_EQUAL(t.most_efficient, "r1");
    CU_ASSERT_DOUBLE_EQUAL(mu_stats_robot(stats, 1)->efficiency_m_s, 0.4, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(mu_stats_robot(stats, 0)->mean_speed_m_s, 0.3, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(t.distance_m, 55, 1e-12);
    CU_ASSERT_EQUAL(t.missed, 7);
    mu_stats_take(stats, &frame); /* again: had before */
    CU_ASSERT_EQUAL(mu_stats_team(stats).missed, 7);
}

/* Who was stalled for most of the time is no candidate. */
static void test_efficiency(void)
{
    CU_ASSERT_DOUBLE_EQUAL(mu_stats_efficiency(2, 10, 5, 0.1), 0.4, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(mu_stats_efficiency(2, 10, 0, 0.1), 0.2, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(mu_stats_efficiency(0.01, 10, 10, 0.1), 0, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(mu_stats_efficiency(3, 90, 84, 0.1), 0, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(mu_stats_efficiency(0, 0, 0, 0.1), 0, 1e-12);
}

static void test_mail_by_performative(void)
{
    static char words[80][24];
    struct mu_mail mails[80 + 2];
    struct mu_outline walls[4];
    struct mu_scene scene = scene_of(1, walls);
    for (size_t i = 0; i < 80; i++) {
        snprintf(words[i], sizeof words[i], "p%zu", i);
        mails[i] = (struct mu_mail){.performative = words[i]};
    }
    mails[80] = mails[81] = mails[0];
    struct mu_act_view act = {.agent = "r0", .mail_count = 82, .mails = mails, .diary = ""};
    struct mu_frame frame = frame_of(0, 1);
    frame.act_count = 1;
    frame.acts = &act;
    frame.outside_count = 3;
    mu_stats_begin(stats, &scene);
    mu_stats_take(stats, &frame);
    uint64_t count = 0;
    READS(mu_stats_performative(stats, 0, &count), "p0");
    CU_ASSERT_EQUAL(count, 3);
    READS(mu_stats_performative(stats, 63, &count), "p63");
    READS(mu_stats_performative(stats, 64, &count), "*");
    CU_ASSERT_EQUAL(count, 16);
    CU_ASSERT_PTR_NULL(mu_stats_performative(stats, 65, &count));
    CU_ASSERT_EQUAL(mu_stats_team(stats).mails_outside, 3);
}

static void test_time_to_a_goal(void)
{
    struct mu_outline walls[4];
    struct mu_scene scene = scene_of(2, walls);
    mu_stats_begin(stats, &scene);
    CU_ASSERT_EQUAL(mu_stats_goal(stats, "r0", 1, 0, 0.25), MU_OK);
    CU_ASSERT_EQUAL(mu_stats_goal(stats, "nobody", 1, 0, 0.25), MU_ABSENT);
    CU_ASSERT_EQUAL(mu_stats_goal(stats, "r0", NAN, 0, 0.25), MU_MALFORMED);
    struct mu_act_view act = {.agent = "r1",
                              .diary = "R go 1\n+12 (goal gohome 0.0 -2000.0)\n+13 (goal stay)"};
    for (int step = 0; step < 30; step++) {
        struct mu_frame frame = frame_of(step, 2);
        frame.act_count = step == 4;
        frame.acts = &act;
        views[0].x_m = step * 0.05; /* 0.75 at step 15 */
        views[1].y_m = -step * 0.1; /* 1.8 at step 18 */
        mu_stats_take(stats, &frame);
    }
    const struct mu_stats_robot *r = mu_stats_robot(stats, 0);
    CU_ASSERT_TRUE(r->has_goal && r->there);
    CU_ASSERT_DOUBLE_EQUAL(r->goal_s, 1.5, 0.1001);
    r = mu_stats_robot(stats, 1);
    CU_ASSERT_TRUE(r->has_goal && r->there);
    CU_ASSERT_DOUBLE_EQUAL(r->goal_y_m, -2, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(r->goal_s, 1.4, 0.1001);
}

static void test_goals_in_diaries(void)
{
    static const char *const none[] = {"",
                                       "+",
                                       "+1 (goal wander)",
                                       "-1 (goal gohome 1 2)",
                                       "+1 (goal gohome 1 2 3)",
                                       "+1 (goal gohome 1e300 2)",
                                       "+1 (goal gohome nan 2)",
                                       "+x (goal gohome 1 2)",
                                       "+1 (goals gohome 1 2)"};
    double x_m, y_m;
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
        CU_ASSERT_FALSE(goal_in_diary(none[i], &x_m, &y_m));
    }
    CU_ASSERT_TRUE(
        goal_in_diary("S\n+1 (goal gohome 1 2)\n+2 (goal goto 3e3 -4.5)\n~ 3", &x_m, &y_m));
    CU_ASSERT_DOUBLE_EQUAL(x_m, 3, 1e-12);
    CU_ASSERT_DOUBLE_EQUAL(y_m, -0.0045, 1e-12);
}

static void test_without_a_scene(void)
{
    struct mu_outline walls[4];
    (void)scene_of(2, walls);
    mu_stats_begin(stats, NULL);
    struct mu_frame frame = frame_of(5, 2);
    views[1].distance_m = 4;
    mu_stats_take(stats, &frame);
    CU_ASSERT_EQUAL(mu_stats_count(stats), 2);
    READS(mu_stats_robot(stats, 1)->name, "r1");
    CU_ASSERT_DOUBLE_EQUAL(mu_stats_robot(stats, 1)->distance_m, 4, 1e-12);
    CU_ASSERT_EQUAL(mu_stats_team(stats).explored, -1);
    frame = frame_of(6, 1); /* of another run */
    mu_stats_take(stats, &frame);
    CU_ASSERT_EQUAL(mu_stats_team(stats).step, 5);
    CU_ASSERT_PTR_NULL(mu_stats_robot(stats, 2));
}

int main(void)
{
    stats = mu_stats_open();
    mu_memory_seal();
    CU_TestInfo tests[] = {
        {"every pair of a few robots", test_every_pair_of_a_few},
        {"pairs of a crowd that come near", test_pairs_of_a_crowd_that_come_near},
        {"a crush has room for some pairs", test_a_crush_has_room_for_some},
        {"explored by each robot, and together", test_explored_by_each_and_together},
        {"worlds without a floor", test_worlds_without_a_floor},
        {"who is most efficient", test_who_is_most_efficient},
        {"efficiency", test_efficiency},
        {"mail by performative", test_mail_by_performative},
        {"time to a goal", test_time_to_a_goal},
        {"goals in diaries", test_goals_in_diaries},
        {"without a Scene", test_without_a_scene},
        CU_TEST_INFO_NULL,
    };
    return suite_run("figures of a run", tests);
}
