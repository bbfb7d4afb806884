/* SPDX-License-Identifier: Apache-2.0 */
/* Where robots and things may stand, and random places. */
#include "suite.h"
#include "world/read/builder.h"
#include "world_text.h"

#include <glob.h>
#include <math.h>
#include <stdlib.h>

#define HALL "model ( size [10 10] boundary 1 )\n"

static void test_places_of_things(void)
{
    static const struct {
        const char *text;
        const char *says; /* NULL: all is well */
    } cases[] = {
        {"model ( name \"p\" movable 1 size [1 1] )", NULL},
        {"model ( name \"p\" movable 1 size [1 1] pose [4.6 0] )", "thing 'p' at 4.600 0.000 over"},
        {"model ( name \"p\" movable 1 size [1 1] pose [20 0] )", "outside"},
        {"model ( name \"p\" movable 1 size [1 1] )\nmodel ( movable 1 pose [0.4 0] )",
         "overlaps thing 'p'"},
        {"model ( name \"p\" movable 1 size [1 1] )\nposition ( name \"a\" pose [0.4 0] )",
         "overlaps robot 'a'"},
        /* What does not stop is in nobody's way. */
        {"model ( size [2 2] obstacle_return 0 )\nposition ( name \"a\" )", NULL},
        {"position ( name \"ghost\" obstacle_return 0 )\nposition ( name \"a\" )", NULL},
        /* A gripper reaches 0.1 + 0.1 m ahead of its pose; its robot is not in its way. */
        {"position ( name \"a\" size [0.4 0.4] pose [4.65 0] gripper ( pose [0.24 0] ) )", NULL},
        {"position ( name \"a\" size [0.4 0.4] pose [4.67 0] gripper ( pose [0.24 0] ) )",
         "the gripper of robot 'a' at"},
        {"position ( name \"a\" size [0.4 0.4] gripper ( pose [0.24 0] ) )\n"
         "position ( name \"b\" size [0.4 0.4] pose [0.5 0] )",
         "the gripper of robot 'a' at 0.240 0.000 overlaps robot 'b'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[512];
        snprintf(text, sizeof text, HALL "%s", cases[i].text);
        const struct world *w = load(text);
        CU_ASSERT_PTR_NOT_NULL_FATAL(w);
        CU_ASSERT_EQUAL(check_places(w), cases[i].says ? MU_FAULT_FILE : MU_OK);
        if (cases[i].says) {
            CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, cases[i].says));
            CU_ASSERT(fault.line >= 2);
        }
    }
}

static size_t told;

static void tell(void *self, const struct mu_fault *f, bool mistake)
{
    (void)self;
    CU_ASSERT_TRUE(mistake);
    CU_ASSERT(f->line > 0);
    told++;
}

static void test_a_listener_hears_of_every_place(void)
{
    const struct mu_fault_listener listener = {.tell = tell};
    const struct world *w = load(HALL "position ( name \"a\" ) position ( name \"b\" )\n"
                                      "position ( name \"c\" pose [5 0] )\n"
                                      "model ( movable 1 pose [50 0] )");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    told = 0;
    CU_ASSERT_EQUAL(world_check_places(w, &listener, &fault), MU_FAULT_FILE);
    CU_ASSERT_EQUAL(told, 3);
}

/* Four lines. */
#define KINDS                                                             \
    "define bot position ( size [0.5 0.4] localization_origin [0 0 0 0] " \
    "gripper ( pose [0.35 0 0 0] ) )\n"                                   \
    "define puck model ( size [0.1 0.1] gripper_return 1 )\n"             \
    "define post model ( size [1 1] )\npost ( )\n"

static void test_distribute(void)
{
    const char *text = HALL KINDS "distribute ( model bot count 20 )\n"
                                  "distribute ( model \"puck\" count 30 region [-4 -4 0 4] gap 0 )";
    const struct world *w = load(text);
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    CU_ASSERT_EQUAL_FATAL(w->robot_count, 20);
    CU_ASSERT_EQUAL_FATAL(w->object_count, 30);
    CU_ASSERT_EQUAL(check_places(w), MU_OK);
    CU_ASSERT_STRING_EQUAL(w->robots[0].name, "bot_0");
    CU_ASSERT_STRING_EQUAL(w->robots[19].name, "bot_19");
    CU_ASSERT_STRING_EQUAL(w->objects[29].name, "puck_29");
    for (size_t i = 0; i < w->object_count; i++) {
        const struct world_pose *pose = &w->objects[i].shape.pose;
        CU_ASSERT(pose->x_m >= -4 && pose->x_m <= 0 && fabs(pose->y_m) <= 4);
    }
    CU_ASSERT_DOUBLE_EQUAL(w->robots[3].odometry.start.x_m, w->robots[3].pose.x_m, 1e-9);
}

/* The places come of the seed alone: the file's own, else the one that the world is opened with. */
static void test_distribute_follows_the_seed(void)
{
    const char *text = HALL KINDS "distribute ( model bot count 5 )";
    const char *seeded = HALL KINDS "seed 4 distribute ( model bot count 5 )";
    const struct world *one = load_with(text, &(struct world_options){.seed = 1});
    const struct world *again = load_with(text, &(struct world_options){.seed = 1});
    const struct world *two = load_with(text, &(struct world_options){.seed = 2});
    const struct world *four = load_with(text, &(struct world_options){.seed = 4});
    const struct world *own = load_with(seeded, &(struct world_options){.seed = 1});
    CU_ASSERT_FATAL(one && again && two && four && own);
    bool differs = false;
    for (size_t i = 0; i < 5; i++) {
        const struct world_pose *pose = &one->robots[i].pose;
        CU_ASSERT_EQUAL(memcmp(pose, &again->robots[i].pose, sizeof *pose), 0);
        CU_ASSERT_EQUAL(memcmp(&four->robots[i].pose, &own->robots[i].pose, sizeof *pose), 0);
        differs = differs || memcmp(pose, &two->robots[i].pose, sizeof *pose) != 0;
    }
    CU_ASSERT_TRUE(differs);
}

static void test_distribute_says_what_is_wrong(void)
{
    static const struct {
        const char *text;
        const char *says;
    } cases[] = {
        {"distribute ( count 3 )", "expected 'model'"},
        {"distribute ( model nobody )", "found 'nobody'"},
        {"distribute ( model post )", "can be moved"},
        {"distribute ( model bot count -1 )", "whole number"},
        {"distribute ( model bot region [1 1 0 0] )", "x0 < x1"},
        {"distribute ( model bot region [0 0 0.3 0.3] )", "found it for 0 in 1000 tries"},
        {"distribute ( model bot count 400 region [1 1 3 3] )", "expected room for 400 of 'bot'"},
        {"distribute ( model puck count 100000 gap 0 )", "more than 4096 things"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[512];
        snprintf(
            text, sizeof text,
            "model ( size [10 10] boundary 1 )\nmodel ( size [200 200] obstacle_return 0 )\n" KINDS
            "%s",
            cases[i].text);
        CU_ASSERT_PTR_NULL(load(text));
        CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, cases[i].says));
        CU_ASSERT_EQUAL(fault.line, 7);
    }
}

/* Worlds that hold nothing, or next to nothing, are worlds all the same. */
static void test_worlds_of_no_size(void)
{
    static const char *const texts[] = {
        "",
        "# nothing\n",
        "position ( )",
        "model ( size [1e-9 1e-9] )",
        "model ( movable 1 size [1e-3 1e-3] )",
        "window ( size [0 0] )",
        "model ( size [1e-9 1e-9] boundary 1 )",
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        const struct world *w = load(texts[i]);
        CU_ASSERT_PTR_NOT_NULL_FATAL(w);
        CU_ASSERT_EQUAL(check_places(w), MU_OK);
        CU_ASSERT(isfinite(w->min_x_m) && isfinite(w->max_y_m) && w->min_x_m <= w->max_x_m);
    }
    CU_ASSERT_PTR_NULL(load("model ( size [0 0 0] )"));
    CU_ASSERT_PTR_NULL(load("model ( movable 1 size [1e-4 1] )"));
    CU_ASSERT_PTR_NULL(load("position ( size [1 1e-4] )"));
    CU_ASSERT_PTR_NULL(load("position ( size [1 1001] )"));
    CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "a body of 0.001 to 1000 m"));
    CU_ASSERT_PTR_NULL(load("distribute ( model a ) define a position ( )"));
}

/* Every world that comes with muster, with whatever seed. */
static void test_own_worlds(void)
{
    glob_t found = {0};
    CU_ASSERT_EQUAL_FATAL(glob("worlds/*.world", 0, NULL, &found), 0);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        for (uint64_t seed = 1; seed <= 5; seed++) {
            CU_ASSERT_FATAL(worlds_used < sizeof worlds / sizeof worlds[0]);
            struct world *w = &worlds[worlds_used++];
            const struct world_options options = {.seed = seed};
            CU_ASSERT_EQUAL_FATAL(world_open(w, found.gl_pathv[i], &options, &fault), MU_OK);
            CU_ASSERT_EQUAL(world_check_places(w, NULL, &fault), MU_OK);
            CU_ASSERT(w->robot_count >= 1);
        }
    }
    globfree(&found);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"places of things and grippers", test_places_of_things},
        {"a listener hears of every place", test_a_listener_hears_of_every_place},
        {"distribute", test_distribute},
        {"distribute follows the seed", test_distribute_follows_the_seed},
        {"distribute says what is wrong", test_distribute_says_what_is_wrong},
        {"worlds of no size", test_worlds_of_no_size},
        {"muster's own worlds", test_own_worlds},
        CU_TEST_INFO_NULL,
    };
    return suite_run("world/places", tests);
}
