/* SPDX-License-Identifier: Apache-2.0 */
/* From a world file to bodies and obstacles. */
#include "suite.h"
#include "world/parse/parser.h"
#include "world/world_load.h"
#include "world_text.h"

#include <CUnit/Basic.h>
#include <fcntl.h>
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define NEAR(a, b) CU_ASSERT_DOUBLE_EQUAL(a, b, 1e-9)

static mu_result add(struct world *world, const char *name, const char *body,
                     const struct world_pose *pose)
{
    int kept = hush();
    mu_result r = world_add_robot(world, name, body, pose, NULL, &fault);
    unhush(kept);
    return r;
}

static void test_robot(void)
{
    struct world *w = load("define ear sensor ( range [0.1 3] fov 30 samples 1 )\n"
                           "define ring ranger ( ear ( pose [0.1 0.2 0 90] ) )\n"
                           "define bot position ( size [0.4 0.3 0.2] origin [-0.05 0.01 0 0]\n"
                           "  mass 7 velocity_bounds [-0.2 0.6 0 0 0 0 -90 45]\n"
                           "  acceleration_bounds [-1 0.5 0 0 0 0 -180 180]\n"
                           "  ring ( ear ( pose [0 0 0 -90] ) pose [1 0 0 90] )\n"
                           "  ranger ( sensor ( samples 180 ) ) )\n"
                           "bot ( name \"red\" color \"navy\" pose [1 2 0 270] )\n"
                           "bot ( )");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    CU_ASSERT_EQUAL_FATAL(w->robot_count, 2);
    const struct world_robot *r = &w->robots[0];
    CU_ASSERT_STRING_EQUAL(r->name, "red");
    CU_ASSERT_STRING_EQUAL(r->color, "navy");
    NEAR(r->pose.x_m, 1);
    NEAR(r->pose.heading_rad, -M_PI / 2);
    NEAR(r->length_m, 0.4);
    NEAR(r->width_m, 0.3);
    NEAR(r->origin_x_m, -0.05);
    NEAR(r->origin_y_m, 0.01);
    NEAR(r->mass_kg, 7);
    NEAR(r->forward_max_m_s, 0.6);
    NEAR(r->reverse_max_m_s, 0.2);
    NEAR(r->turn_max_rad_s, M_PI / 4);
    NEAR(r->forward_accel_m_s2, 0.5);
    NEAR(r->turn_accel_rad_s2, M_PI);
    CU_ASSERT_EQUAL(r->laser.samples, 180);
    CU_ASSERT_EQUAL_FATAL(r->sonar_count, 2); /* the laser is not one */
    NEAR(r->sonars[0].pose.x_m, 1 - 0.2);     /* the ranger's pose turns the sensor's */
    NEAR(r->sonars[0].pose.y_m, 0.1);
    NEAR(r->sonars[0].pose.heading_rad, M_PI);
    NEAR(r->sonars[0].range_min_m, 0.1);
    NEAR(r->sonars[0].range_max_m, 3);
    NEAR(r->sonars[0].fov_rad, M_PI / 6);
    NEAR(r->sonars[1].pose.heading_rad, 0);
    CU_ASSERT_STRING_EQUAL(w->robots[1].name, "bot_0");
    NEAR(w->min_x_m, -0.25); /* of the second robot's outline */
}

static void test_solids(void)
{
    struct world *w = load("model ( size [2 1 1] pose [3 4 0 90]\n"
                           "  model ( size [0.2 0.2] pose [1 0 0 0] ) )\n"
                           "model ( obstacle_return 0 ranger_return -0.1 )\n"
                           "model ( obstacle_return 0 ranger_return -1 )\n"
                           "model ( obstacle_return 0 ranger_return 0.5 origin [1 1 0 0] )");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    CU_ASSERT_EQUAL_FATAL(w->shape_count, 3);
    CU_ASSERT_EQUAL(w->shapes[0].kind, WORLD_BOX);
    NEAR(w->shapes[0].half_x_m, 1);
    NEAR(w->shapes[0].half_y_m, 0.5);
    NEAR(w->shapes[0].pose.heading_rad, M_PI / 2);
    NEAR(w->shapes[1].pose.x_m, 3);
    NEAR(w->shapes[1].pose.y_m, 5);
    NEAR(w->shapes[2].pose.x_m, 1);
    NEAR(w->max_x_m, 3.5);
    NEAR(w->max_y_m, 5.1);
}

static void test_boundary_has_its_inner_faces_at_the_size(void)
{
    struct world *w = load("model ( size [4 2] boundary 1 )");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    CU_ASSERT_EQUAL_FATAL(w->shape_count, 4);
    NEAR(w->shapes[0].pose.x_m + w->shapes[0].half_x_m, -2);
    NEAR(w->shapes[1].pose.y_m + w->shapes[1].half_y_m, -1);
    NEAR(w->shapes[2].pose.x_m - w->shapes[2].half_x_m, 2);
    NEAR(w->shapes[3].pose.y_m - w->shapes[3].half_y_m, 1);
}

static void test_blocks(void)
{
    /* Two blocks that fill the size together: a rectangle, and a triangle in its box. */
    struct world *w = load("model ( size [4 2]\n"
                           "  block ( points 4 point[0] [0 0] point[1] [5 0] point[2] [5 10]\n"
                           "    point[3] [0 10] z [0 1] )\n"
                           "  block ( points 3 point[0] [5 0] point[1] [10 0] point[2] [5 10] ) )");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    CU_ASSERT_EQUAL_FATAL(w->shape_count, 2);
    NEAR(w->shapes[0].pose.x_m, -1);
    NEAR(w->shapes[0].half_x_m, 1);
    NEAR(w->shapes[0].half_y_m, 1);
    NEAR(w->shapes[1].half_x_m * w->shapes[1].half_y_m, 1);
    /* A turned square stays a square. */
    w = load("model ( size [2 2] block ( points 4 point[0] [1 0] point[1] [2 1]\n"
             "  point[2] [1 2] point[3] [0 1] ) )");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    NEAR(w->shapes[0].half_x_m, sqrt(2) / 2);
    NEAR(w->shapes[0].half_y_m, sqrt(2) / 2);
    NEAR(fabs(fabs(remainder(w->shapes[0].pose.heading_rad, M_PI / 2))), M_PI / 4);
    /* Eight corners on a circle make a disc. */
    w = load("model ( size [2 2] block ( points 8 point[0] [1 0] point[1] [.7071 .7071]\n"
             "  point[2] [0 1] point[3] [-.7071 .7071] point[4] [-1 0] point[5] [-.7071 -.7071]\n"
             "  point[6] [0 -1] point[7] [.7071 -.7071] ) )");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    CU_ASSERT_EQUAL(w->shapes[0].kind, WORLD_DISC);
    CU_ASSERT_DOUBLE_EQUAL(w->shapes[0].radius_m, 1, 1e-4);
}

/* Loads a world with one floor plan of 4 x 2 m. */
static struct world *load_bitmap(const char *bytes, size_t len)
{
    char path[] = "/tmp/muster-bitmap-XXXXXX";
    char text[128];
    put(path, bytes, len);
    snprintf(text, sizeof text, "model ( size [4 2] pose [10 0 0 0] bitmap \"%s\" )",
             strrchr(path, '/') + 1);
    struct world *w = load(text);
    unlink(path);
    return w;
}

#define PICTURE(bytes)           \
    {                            \
        bytes, sizeof(bytes) - 1 \
    }

static void test_bitmaps(void)
{
    /* The same picture, 4 x 2 pixels, in all formats: ##.. / .... and a speck at the end. */
    static const struct {
        const char *bytes;
        size_t len;
    } pictures[] = {
        PICTURE("P1 # plain\n4 2\n1100\n0001\n"),
        PICTURE("P2\n4 2 10\n0 0 10 10 10 10 10 0\n"),
        PICTURE("P4\n4 2\n\xc0\x10"),
        PICTURE("P5\n4 2\n255\n\x00\x00\xff\xff\xff\xff\xff\x00"),
        PICTURE("P5 4 2 256\n\0\0\0\0\1\0\1\0\1\0\1\0\1\0\0\0"),
    };
    for (size_t i = 0; i < sizeof pictures / sizeof pictures[0]; i++) {
        struct world *w = load_bitmap(pictures[i].bytes, pictures[i].len);
        CU_ASSERT_PTR_NOT_NULL_FATAL(w);
        CU_ASSERT_EQUAL_FATAL(w->shape_count, 2);
        NEAR(w->shapes[0].pose.x_m, 9);
        NEAR(w->shapes[0].pose.y_m, 0.5);
        NEAR(w->shapes[0].half_x_m, 1);
        NEAR(w->shapes[0].half_y_m, 0.5);
        NEAR(w->shapes[1].pose.x_m, 11.5);
        NEAR(w->shapes[1].pose.y_m, -0.5);
    }
    static const unsigned char png[] = {
        0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
        0x44, 0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x00, 0x00, 0x00,
        0x00, 0xd1, 0x49, 0x20, 0x56, 0x00, 0x00, 0x00, 0x0b, 0x49, 0x44, 0x41, 0x54, 0x78,
        0x9c, 0x63, 0x60, 0xf8, 0x0f, 0x00, 0x01, 0x02, 0x01, 0x00, 0x42, 0xbe, 0xbc, 0x68,
        0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82,
    };
    struct world *w = load_bitmap((const char *)png, sizeof png); /* black, white */
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    CU_ASSERT_EQUAL_FATAL(w->shape_count, 1);
    NEAR(w->shapes[0].pose.x_m, 9);
    NEAR(w->shapes[0].half_y_m, 1);
    CU_ASSERT_PTR_NULL(load_bitmap((const char *)png, sizeof png - 20));
    static const char *const bad[] = {
        "",          "P",           "P9 1 1\n",        "P1 0 1\n",  "P1 2 2 1", "P1 99999 2\n1",
        "P1 -1 2\n", "P2 2 2 0\n1", "P5 2 2 70000\n1", "P4 9 1\n1", "GIF89a",   "\x89PNG\r\n\x1a\n",
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        CU_ASSERT_PTR_NULL(load_bitmap(bad[i], strlen(bad[i])));
        CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "cannot read the bitmap"));
        CU_ASSERT_EQUAL(fault.line, 1);
    }
}

static void test_mistakes_are_refused_with_their_place(void)
{
    static const struct {
        const char *text;
        int line;
        const char *says;
    } cases[] = {
        {"model (\nsize [0 1] )", 2, "size above 0"},
        {"model (\n\nsize [1 -1] )", 3, "size above 0"},
        {"model ( size 3 )", 1, "expected 2 to 3 numbers for 'size', found 1"},
        {"model ( size [a b] )", 1, "expected a number for 'size', found 'a'"},
        {"model ( pose [nan 0 0 0] )", 1, "expected a number for 'pose', found 'nan'"},
        {"model ( pose [1e999 0] )", 1, "finite"},
        {"model ( pose [1e9 0] )", 1, "expected a place within"},
        {"model ( name \"a\" )\nmodle ( )", 2, "found 'modle'"},
        {"position (\nname \"red\" )\nposition (\nname \"red\" )", 4, "'red' already"},
        {"position ( name \"3x\" )", 1, "found '3x'"},
        {"position ( name \"all\" )", 1, "reserved"},
        {"position ( name 3 )", 1, "expected a text for 'name'"},
        {"position ( mass 0 )", 1, "'mass' of 0.001 to 1e+06"},
        {"position ( velocity_bounds [1 2 0 0 0 0 0 0] )", 1, "min <= 0 <= max"},
        {"position ( velocity_bounds [-1 1] )", 1, "expected 8 numbers"},
        {"position ( acceleration_bounds [0 0 0 0 0 0 0 0] )", 1, "could not move"},
        {"position ( ranger (\nsensor ( range [2 1] ) ) )", 2, "0 <= min < max"},
        {"position ( rangr ( ) )", 1, "found 'rangr'"},
        {"model ( block ( points 2 ) )", 1, "3 to 256 points"},
        {"model ( block ( points 3 point[0] [0 0] point[2] [1 1] ) )", 1, "expected point[1]"},
        {"model ( block ( points 3 point[0] [0 0] point[1] [1 1] point[2] [2 2] ) )", 1, "area"},
        {"model ( bitmap \"muster-no-such.png\" )", 1, "no such file"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CU_ASSERT_PTR_NULL(load(cases[i].text));
        CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, cases[i].says));
        CU_ASSERT_EQUAL(fault.line, cases[i].line);
        CU_ASSERT_PTR_NOT_NULL(strstr(fault.file, "muster-world-"));
    }
}

static void test_places(void)
{
    static const struct {
        const char *robots;
        const char *says;
    } cases[] = {
        {"position ( size [1 1] pose [0 0] name \"a\" )", NULL},
        {"position ( size [1 1] pose [4.49 0] name \"a\" )", NULL},
        {"position ( size [1 1] pose [4.51 0] name \"a\" )", "overlaps an obstacle"},
        {"position ( size [1 1] pose [4.4 0 0 45] name \"a\" )", "overlaps an obstacle"},
        {"position ( size [1 1] pose [6 0] name \"a\" )", "outside"},
        {"position ( size [1 1] name \"a\" ) position ( size [1 1] pose [1.01 0] name \"b\" )",
         NULL},
        {"position ( size [1 1] name \"a\" ) position ( size [1 1] pose [0.99 0] name \"b\" )",
         "overlaps robot 'a'"},
        {"position ( size [1 1] name \"a\" ) position ( size [1 1] pose [1.05 0 0 45] name \"b\" )",
         "overlaps robot 'a'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[256];
        snprintf(text, sizeof text, "model ( size [10 10] boundary 1 )\n%s", cases[i].robots);
        struct world *w = load(text);
        CU_ASSERT_PTR_NOT_NULL_FATAL(w);
        CU_ASSERT_EQUAL(check_places(w), cases[i].says ? MU_FAULT_FILE : MU_OK);
        if (cases[i].says) {
            CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, cases[i].says));
            CU_ASSERT_EQUAL(fault.line, 2);
        }
    }
}

static void test_fits(void)
{
    static const struct {
        double x_m, y_m, clear_m;
        bool fits;
    } cases[] = {
        {0, 3, 0, true},     {4.49, 0, 0, true},     {4.49, 0, 0.02, false}, {4.51, 0, 0, false},
        {6, 0, 0, false},    {-1.99, 0, 0, false},   {-2.01, 0, 0, true},    {-2.01, 0, 0.1, false},
        {-3, 2.55, 0, true}, {-3, 2.55, 0.1, false},
    };
    struct world *w = load("model ( size [10 10] boundary 1 )\n"
                           "define bot position ( size [1 1] )\n"
                           "bot ( name \"first\" ) bot ( name \"a\" pose [3 3] )\n"
                           "bot ( name \"b\" pose [-1 0] ) bot ( name \"c\" pose [-3 3.6] )");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    CU_ASSERT(!world_robot_fits(w, "nobody", 0));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct world_pose pose = {cases[i].x_m, cases[i].y_m, 0};
        CU_ASSERT_EQUAL(add(w, "first", NULL, &pose), MU_OK);
        CU_ASSERT_EQUAL(world_robot_fits(w, "first", cases[i].clear_m), cases[i].fits);
    }
}

static void test_add_robot(void)
{
    struct world *w = load("define bot position ( size [1 1] mass 3 )\n"
                           "define box model ( )\n"
                           "box ( name \"thing\" pose [9 9] )\n"
                           "bot ( name \"red\" pose [1 0 0 0] color \"pink\" )");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    struct world_pose pose = {2, 3, 7};
    CU_ASSERT_EQUAL(add(w, "red", NULL, &pose), MU_OK);
    CU_ASSERT_EQUAL(w->robot_count, 1);
    NEAR(w->robots[0].pose.y_m, 3);
    NEAR(w->robots[0].pose.heading_rad, 7 - 2 * M_PI);
    CU_ASSERT_EQUAL(add(w, "red", "bot", NULL), MU_OK);
    NEAR(w->robots[0].pose.y_m, 3);
    CU_ASSERT_STRING_EQUAL(w->robots[0].color, "pink");
    pose.x_m = 20;
    CU_ASSERT_EQUAL(add(w, "blue", "bot", &pose), MU_OK);
    CU_ASSERT_EQUAL_FATAL(w->robot_count, 2);
    CU_ASSERT_STRING_EQUAL(w->robots[1].name, "blue");
    NEAR(w->robots[1].mass_kg, 3);
    CU_ASSERT(w->max_x_m > 20);
    CU_ASSERT_EQUAL(add(w, "green", "bot", NULL), MU_FAULT_FILE);
    CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "expected a pose"));
    CU_ASSERT_EQUAL(add(w, "green", NULL, &pose), MU_FAULT_FILE);
    CU_ASSERT_EQUAL(add(w, "green", "box", &pose), MU_FAULT_FILE);
    CU_ASSERT_EQUAL(add(w, "green", "bto", &pose), MU_FAULT_FILE);
    CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "bot"));
    CU_ASSERT_EQUAL(add(w, "thing", "bot", &pose), MU_FAULT_FILE);
    CU_ASSERT_EQUAL(add(w, "all", "bot", &pose), MU_FAULT_FILE);
    pose.x_m = (double)NAN;
    CU_ASSERT_EQUAL(add(w, "green", "bot", &pose), MU_FAULT_FILE);
    CU_ASSERT_EQUAL(w->robot_count, 2);
}

static void test_limits(void)
{
    struct world *w = load("define bot position ( )");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    struct world_pose pose = {0, 0, 0};
    int kept = hush();
    mu_result r = MU_OK;
    for (size_t i = 0; i < MU_ROBOTS_MAX && r == MU_OK; i++) {
        char name[16];
        snprintf(name, sizeof name, "r%zu", i);
        r = world_add_robot(w, name, "bot", &pose, NULL, &fault);
    }
    CU_ASSERT_EQUAL(r, MU_OK);
    CU_ASSERT_EQUAL(world_add_robot(w, "one-too-many", "bot", &pose, NULL, &fault), MU_FAULT_FILE);
    unhush(kept);
    CU_ASSERT_EQUAL(w->robot_count, MU_ROBOTS_MAX);

    static char text[4096];
    for (size_t extra = 0; extra < 2; extra++) {
        size_t len = (size_t)snprintf(text, sizeof text, "position ( ranger (");
        for (size_t i = 0; i < MU_SONARS_MAX + extra; i++) {
            len += (size_t)snprintf(text + len, sizeof text - len, " sensor ( )");
        }
        snprintf(text + len, sizeof text - len, " ) )");
        CU_ASSERT_EQUAL(load(text) == NULL, extra == 1);
    }
    /* Definitions that double: 2^17 models from a few lines. */
    size_t len = (size_t)snprintf(text, sizeof text, "define m0 model ( )\n");
    for (int i = 1; i <= 17; i++) {
        len += (size_t)snprintf(text + len, sizeof text - len,
                                "define m%d model ( m%d ( ) m%d ( ) obstacle_return 0 "
                                "ranger_return 0 )\n",
                                i, i - 1, i - 1);
    }
    snprintf(text + len, sizeof text - len, "m17 ( )");
    CU_ASSERT_PTR_NULL(load(text));
    CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "more than"));
}

static void test_arena(void)
{
    struct world *w = &worlds[worlds_used++];
    CU_ASSERT_EQUAL_FATAL(world_load(w, "worlds/arena.world", false, &fault), MU_OK);
    CU_ASSERT_EQUAL(world_check_places(w, NULL, &fault), MU_OK);
    CU_ASSERT_EQUAL_FATAL(w->robot_count, 4);
    static const char *const names[] = {"red", "blue", "green", "yellow"};
    static const double front_deg[] = {90, 50, 30, 10, -10, -30, -50, -90};
    for (size_t i = 0; i < 4; i++) {
        CU_ASSERT_STRING_EQUAL(w->robots[i].name, names[i]);
        NEAR(w->robots[i].pose.x_m, w->robots[0].pose.x_m - (double)i);
        CU_ASSERT_EQUAL_FATAL(w->robots[i].sonar_count, 16);
        for (size_t k = 0; k < 8; k++) {
            NEAR(w->robots[i].sonars[k].pose.heading_rad, front_deg[k] * M_PI / 180);
            NEAR(w->robots[i].sonars[k].range_max_m, 5);
        }
    }
}

static void test_stage_worlds(void)
{
    const char *data = getenv("MUSTER_TEST_DATA");
    char pattern[512];
    snprintf(pattern, sizeof pattern, "%s/stage-worlds/*.world", data ? data : "");
    glob_t found = {0};
    if (!data || glob(pattern, 0, NULL, &found) != 0) {
        printf("(skipped: MUSTER_TEST_DATA holds no stage-worlds) ");
        return;
    }
    for (size_t i = 0; i < found.gl_pathc; i++) {
        struct world *w = &worlds[worlds_used++];
        CU_ASSERT_EQUAL_FATAL(world_load(w, found.gl_pathv[i], true, &fault), MU_OK);
        CU_ASSERT_EQUAL(world_check_places(w, NULL, &fault), MU_OK);
        CU_ASSERT(w->robot_count >= 1);
    }
    globfree(&found);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"robot", test_robot},
        {"solids", test_solids},
        {"boundary", test_boundary_has_its_inner_faces_at_the_size},
        {"blocks", test_blocks},
        {"bitmaps", test_bitmaps},
        {"mistakes are refused with their place", test_mistakes_are_refused_with_their_place},
        {"places", test_places},
        {"whether a robot fits", test_fits},
        {"add a robot", test_add_robot},
        {"limit: robots, sonars, models", test_limits},
        {"the arena", test_arena},
        {"Stage's own worlds", test_stage_worlds},
        CU_TEST_INFO_NULL,
    };
    return suite_run("world/world", tests);
}
