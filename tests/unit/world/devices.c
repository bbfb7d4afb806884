/* SPDX-License-Identifier: Apache-2.0 */
/* What stands on robots and how things look: sensors, grippers, batteries, colours, units. */
#include "suite.h"
#include "world/read/builder.h"
#include "world_text.h"

#include <math.h>
#include <stdlib.h>

#define NEAR(a, b) CU_ASSERT_DOUBLE_EQUAL(a, b, 1e-9)

static const struct world_robot *robot_of(const char *body)
{
    char text[1024];
    snprintf(text, sizeof text, "position ( name \"red\" size [0.4 0.4] pose [1 2 0 90]\n%s )",
             body);
    const struct world *w = load(text);
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    CU_ASSERT_EQUAL_FATAL(w->robot_count, 1);
    return &w->robots[0];
}

static void test_laser(void)
{
    const struct world_robot *r =
        robot_of("ranger ( pose [0.1 0 0 90] update_interval 200\n"
                 "  sensor ( range [0.2 6] fov 270 samples 541 pose [0.2 0 0 0]\n"
                 "    noise [0.01 0.02 0.5] ) )");
    CU_ASSERT_EQUAL(r->sonar_count, 0);
    CU_ASSERT_EQUAL(r->laser.samples, 541);
    NEAR(r->laser.fov_rad, 1.5 * M_PI);
    NEAR(r->laser.range_min_m, 0.2);
    NEAR(r->laser.range_max_m, 6);
    NEAR(r->laser.pose.x_m, 0.1);
    NEAR(r->laser.pose.y_m, 0.2);
    NEAR(r->laser.pose.heading_rad, M_PI / 2);
    NEAR(r->laser.noise.constant_m, 0.01);
    NEAR(r->laser.noise.per_m, 0.02);
    NEAR(r->laser.noise.angle_rad, 0.5 * M_PI / 180);
    CU_ASSERT_EQUAL(r->period_ns[MU_SENSOR_LASER], 200000000u);
    CU_ASSERT_EQUAL(r->period_ns[MU_SENSOR_SONAR], 0);
    r = robot_of("laser ( ) laser ( samples 90 )"); /* as Stage 3 had it; the first one stays */
    CU_ASSERT_EQUAL(r->laser.samples, 180);
    NEAR(r->laser.range_max_m, 8);
    NEAR(r->laser.fov_rad, M_PI);
}

static void test_sonar(void)
{
    const struct world_robot *r =
        robot_of("ranger ( sensor ( view [0.1 4 30] rays 5 specular 60 noise [0.05] )\n"
                 "  sensor ( ) )\nsonar ( pose [0 0.1 0 180] range_max 3 )");
    CU_ASSERT_EQUAL_FATAL(r->sonar_count, 3);
    CU_ASSERT_EQUAL(r->laser.samples, 0);
    CU_ASSERT_EQUAL(r->sonars[0].rays, 5);
    NEAR(r->sonars[0].specular_rad, M_PI / 3);
    NEAR(r->sonars[0].range_min_m, 0.1);
    NEAR(r->sonars[0].range_max_m, 4);
    NEAR(r->sonars[0].fov_rad, M_PI / 6);
    NEAR(r->sonars[0].noise.constant_m, 0.05);
    CU_ASSERT_EQUAL(r->sonars[1].rays, 1);
    NEAR(r->sonars[1].specular_rad, 0);
    NEAR(r->sonars[1].noise.constant_m, 0);
    NEAR(r->sonars[2].range_max_m, 3);
    NEAR(r->sonars[2].pose.y_m, 0.1);
}

static void test_robots_with_the_same_ring_share_it(void)
{
    struct world *w =
        load("define bot position ( size [0.1 0.1] sonar ( ) sonar ( range_max 3 ) )\n"
             "bot ( pose [0 0 0 0] ) bot ( pose [1 0 0 0] )\n"
             "bot ( pose [2 0 0 0] sonar ( ) ) bot ( pose [3 0 0 0] )\n"
             "position ( pose [4 0 0 0] )");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    CU_ASSERT_EQUAL_FATAL(w->robot_count, 5);
    const struct world_robot *r = w->robots;
    CU_ASSERT_EQUAL(r[0].sonar_count, 2);
    NEAR(r[0].sonars[1].range_max_m, 3);
    CU_ASSERT_PTR_EQUAL(r[1].sonars, r[0].sonars);
    CU_ASSERT_EQUAL(r[2].sonar_count, 3);
    CU_ASSERT_PTR_NOT_EQUAL(r[2].sonars, r[0].sonars);
    CU_ASSERT_PTR_EQUAL(r[3].sonars, r[0].sonars);
    CU_ASSERT_EQUAL(r[4].sonar_count, 0);
    struct world_pose pose = {5, 0, 0};
    CU_ASSERT_EQUAL(world_add_robot(w, "late", "bot", &pose, NULL, &fault), MU_OK);
    CU_ASSERT_EQUAL(r[5].sonar_count, 2);
    CU_ASSERT_PTR_EQUAL(r[5].sonars, r[0].sonars);
}

static void test_camera_finder_and_gripper(void)
{
    const struct world_robot *r =
        robot_of("blobfinder ( colors_count 2 colors [ \"red\" \"Navy Blue\" \"green\" ]\n"
                 "  image [160 120] range 5 fov 90 pan 30 update_interval 500 )\n"
                 "fiducial ( range_max 6 range_max_id 4 fov 60 pose [0.1 0 0 0] )\n"
                 "gripper ( pose [0.3 0 0 0] size [0.2 0.3 0.2] paddle_size [0.5 0.1 0.4]\n"
                 "  paddle_state [ \"closed\" \"up\" ] )");
    CU_ASSERT_EQUAL(r->camera.columns, 160);
    CU_ASSERT_EQUAL(r->camera.rows, 120);
    CU_ASSERT_EQUAL_FATAL(r->camera.color_count, 2);
    CU_ASSERT_EQUAL(r->camera.colors[1], 0x000080);
    NEAR(r->camera.range_m, 5);
    NEAR(r->camera.fov_rad, M_PI / 2);
    NEAR(r->camera.pose.heading_rad, M_PI / 6);
    CU_ASSERT_EQUAL(r->period_ns[MU_SENSOR_CAMERA], 500000000u);
    NEAR(r->finder.range_max_m, 6);
    NEAR(r->finder.range_id_m, 4);
    NEAR(r->finder.fov_rad, M_PI / 3);
    NEAR(r->finder.pose.x_m, 0.1);
    NEAR(r->gripper.length_m, 0.1);
    NEAR(r->gripper.paddle_length_m, 0.1);
    NEAR(r->gripper.paddle_width_m, 0.03);
    NEAR(r->gripper.width_m, 0.3);
    NEAR(r->gripper.pose.x_m, 0.25); /* the case is the rear half */
    CU_ASSERT_TRUE(r->gripper.starts_closed && r->gripper.starts_lifted);
    r = robot_of("blobfinder ( ) fiducial ( ) gripper ( )"); /* Stage's defaults */
    CU_ASSERT_EQUAL(r->camera.columns, 80);
    CU_ASSERT_EQUAL(r->camera.color_count, 0);
    NEAR(r->camera.fov_rad, M_PI / 3);
    NEAR(r->finder.fov_rad, M_PI);
    NEAR(r->gripper.length_m + r->gripper.paddle_length_m, 0.2);
    CU_ASSERT_FALSE(r->gripper.starts_closed || r->gripper.starts_lifted);
    r = robot_of("");
    CU_ASSERT_EQUAL(r->camera.columns, 0);
    NEAR(r->finder.range_max_m, 0);
    NEAR(r->gripper.length_m, 0);
}

static void test_odometer_and_errors(void)
{
    const struct world_robot *r = robot_of("");
    CU_ASSERT_FALSE(r->reads_odometer);
    NEAR(r->odometry.forward_error, 0);
    NEAR(r->odometry.start.x_m, 0);
    CU_ASSERT_FALSE(r->odometry.true_start);
    r = robot_of("localization \"odom\"");
    CU_ASSERT_TRUE(r->reads_odometer);
    NEAR(r->odometry.forward_error, 0.03);
    NEAR(r->odometry.turn_error, 0.05);
    r = robot_of("localization \"odom\" odom_error [0.1 0.2 0.3]");
    NEAR(r->odometry.side_error, 0.2);
    NEAR(r->odometry.turn_error, 0.3);
    r = robot_of("odom_error [0.1 0.2 0.3 0.4] localization_origin [0 0 0 0]");
    NEAR(r->odometry.turn_error, 0.4);
    CU_ASSERT_TRUE(r->odometry.true_start);
    NEAR(r->odometry.start.x_m, 1);
    NEAR(r->odometry.start.heading_rad, M_PI / 2);
    r = robot_of("localization_origin [1 1 0 90]");
    CU_ASSERT_FALSE(r->odometry.true_start);
    NEAR(r->odometry.start.x_m, 1);
    NEAR(r->odometry.start.y_m, 0);
    NEAR(r->odometry.start.heading_rad, 0);
    r = robot_of("gps_noise [0.5 0.01] compass_noise 2");
    NEAR(r->gps_noise_m, 0.5);
    NEAR(r->gps_drift_m, 0.01);
    NEAR(r->compass_noise_rad, M_PI / 90);
}

static void test_a_robot_that_is_moved_counts_from_its_new_place(void)
{
    struct world *w =
        load("position ( name \"red\" localization_origin [1 0 0 0] pose [3 0 0 0] )");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    struct world_pose pose = {5, 2, 0};
    CU_ASSERT_EQUAL(world_add_robot(w, "red", NULL, &pose, "blue", &fault), MU_OK);
    NEAR(w->robots[0].odometry.start.x_m, 4);
    NEAR(w->robots[0].odometry.start.y_m, 2);
    CU_ASSERT_EQUAL(w->robots[0].look.rgb, 0x0000ff);
}

static void test_battery(void)
{
    const struct world_robot *r =
        robot_of("kjoules 2 watts 30 model ( take_watts 500 fiducial_return 7\n"
                 "  ranger ( watts 5 sensor ( ) ) )");
    NEAR(r->battery_j, 2000);
    NEAR(r->battery_max_j, 2000); /* it starts full */
    NEAR(r->power_w, 35);
    NEAR(r->take_w, 500);
    CU_ASSERT_EQUAL(r->look.fiducial, 7); /* what a part bears counts for the robot */
    CU_ASSERT_EQUAL(r->sonar_count, 1);
    r = robot_of("joules 100 joules_capacity 400");
    NEAR(r->battery_j, 100);
    NEAR(r->battery_max_j, 400);
    NEAR(robot_of("joules -1")->battery_max_j, 0);
    NEAR(robot_of("")->battery_max_j, 0);
}

static void test_looks(void)
{
    const struct world *w =
        load("model ( color \"#1020fF\" fiducial_return 12 give_watts 100 )\n"
             "model ( obstacle_return 0 ranger_return -1 )\n"
             "model ( obstacle_return 0 ranger_return -1 blob_return 1 color \"grey50\" )\n"
             "model ( obstacle_return 0 color_rgba [1 0.5 0 1] )\n"
             "define box model ( color_rgba [0 1 0 1] ) box ( color \"Light Sky Blue\" )\n"
             "model ( ranger_return -1 blob_return 0 )\n");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    CU_ASSERT_EQUAL_FATAL(w->shape_count, 5); /* what nobody feels or sees is not there */
    const struct world_look *look = &w->shapes[0].look;
    CU_ASSERT_EQUAL(look->rgb, 0x1020ff);
    CU_ASSERT_EQUAL(look->fiducial, 12);
    NEAR(look->give_w, 100);
    CU_ASSERT_TRUE(look->stops && look->echoes && look->shows && !look->graspable);
    look = &w->shapes[1].look;
    CU_ASSERT_TRUE(!look->stops && !look->echoes && look->shows);
    CU_ASSERT_EQUAL(look->rgb, 0x808080);
    look = &w->shapes[2].look;
    CU_ASSERT_TRUE(!look->stops && look->echoes && look->shows);
    CU_ASSERT_EQUAL(look->rgb, 0xff8000);
    CU_ASSERT_EQUAL(w->shapes[3].look.rgb, 0x87cefa);
    look = &w->shapes[4].look;
    CU_ASSERT_TRUE(look->stops && !look->echoes && !look->shows);
}

static void test_one_fiducial_of_many_shapes(void)
{
    const struct world *w = load("model ( size [4 4 1] boundary 1 fiducial_return 3\n"
                                 "  model ( pose [1 1 0 0] fiducial_return 4 ) )");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    int bearers = 0;
    for (size_t i = 0; i < w->shape_count; i++) {
        bearers += w->shapes[i].look.fiducial == 3;
    }
    CU_ASSERT_EQUAL(bearers, 1);
    CU_ASSERT_EQUAL(w->shapes[w->shape_count - 1].look.fiducial, 4);
}

static void test_objects(void)
{
    const struct world *w =
        load("define puck model ( size [0.08 0.08 0.1] gripper_return 1 mass 0.2 friction 0.3\n"
             "  block ( points 8 point[0] [1 0] point[1] [.7071 .7071] point[2] [0 1]\n"
             "    point[3] [-.7071 .7071] point[4] [-1 0] point[5] [-.7071 -.7071]\n"
             "    point[6] [0 -1] point[7] [.7071 -.7071] ) )\n"
             "puck ( name \"first\" pose [1 2 0 45] color \"gold\" )\n"
             "puck ( )\n"
             "model ( movable 1 size [1 0.5 1] )\n"
             "model ( model ( gripper_return 1 ) )\n");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    CU_ASSERT_EQUAL(w->shape_count, 2); /* inside another model nothing moves */
    CU_ASSERT_EQUAL_FATAL(w->object_count, 3);
    const struct world_object *o = &w->objects[0];
    CU_ASSERT_STRING_EQUAL(o->name, "first");
    CU_ASSERT_EQUAL(o->shape.kind, WORLD_DISC);
    CU_ASSERT_DOUBLE_EQUAL(o->shape.radius_m, 0.04, 1e-4);
    NEAR(o->shape.pose.x_m, 1);
    NEAR(o->mass_kg, 0.2);
    NEAR(o->friction, 0.3);
    CU_ASSERT_EQUAL(o->shape.look.rgb, 0xffd700);
    CU_ASSERT_TRUE(o->shape.look.graspable);
    CU_ASSERT_STRING_EQUAL(w->objects[1].name, "puck_0");
    o = &w->objects[2];
    CU_ASSERT_STRING_EQUAL(o->name, "model_0");
    CU_ASSERT_EQUAL(o->shape.kind, WORLD_BOX);
    NEAR(o->shape.half_x_m, 0.5);
    NEAR(o->mass_kg, 10);
    NEAR(o->friction, 0.5);
    CU_ASSERT_FALSE(o->shape.look.graspable);
}

static void test_units(void)
{
    const struct world *w =
        load("unit_length cm unit_angle radians interval_sim 50 seed 7\n"
             "position ( pose [100 200 0 1.5] size [40 30] mass 3 gps_noise [50]\n"
             "  velocity_bounds [-10 50 0 0 0 0 -1 1]\n"
             "  ranger ( sensor ( range [0 500] fov 0.5 pose [10 0 0 -0.5] ) ) )");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    CU_ASSERT_EQUAL(w->step_ns, 60000000u); /* the next multiple of 20 ms */
    CU_ASSERT_EQUAL(w->seed, 7);
    const struct world_robot *r = &w->robots[0];
    NEAR(r->pose.x_m, 1);
    NEAR(r->pose.heading_rad, 1.5);
    NEAR(r->length_m, 0.4);
    NEAR(r->mass_kg, 3);
    NEAR(r->gps_noise_m, 0.5);
    NEAR(r->forward_max_m_s, 0.5);
    NEAR(r->turn_max_rad_s, 1);
    NEAR(r->sonars[0].range_max_m, 5);
    NEAR(r->sonars[0].fov_rad, 0.5);
    NEAR(r->sonars[0].pose.x_m, 0.1);
    NEAR(r->sonars[0].pose.heading_rad, -0.5);
    w = load("model ( )");
    CU_ASSERT_PTR_NOT_NULL_FATAL(w);
    CU_ASSERT_EQUAL(w->step_ns, 0);
    CU_ASSERT_EQUAL(w->seed, -1);
}

static void test_mistakes(void)
{
    static const struct {
        const char *text;
        const char *says;
    } cases[] = {
        {"ranger ( sensor ( samples 1025 ) )", "whole number from 0 to 1024"},
        {"ranger ( sensor ( samples 2.5 ) )", "whole number"},
        {"ranger ( sensor ( fov 361 ) )", "0 to 360"},
        {"ranger ( sensor ( noise [-1 0 0] ) )", "0 or more"},
        {"ranger ( sensor ( rays 99 ) )", "0 to 32"},
        {"ranger ( update_interval -1 )", "'update_interval' of 0"},
        {"ranger ( sensr ( ) )", "did you mean 'sensor'"},
        {"blobfinder ( image [0 1] )", "1 to 640"},
        {"blobfinder ( colors [ \"reed\" ] )", "found 'reed'"},
        {"blobfinder ( colors_count 3 colors [ \"red\" ] )", "0 to 1"},
        {"fiducial ( range_max 0 )", "0 <= min < max"},
        {"gripper ( paddle_size [2 0.1 0.1] )", "paddles of 0 to 1"},
        {"gripper ( paddle_state [ \"ajar\" \"up\" ] )", "paddle_state"},
        {"localization \"magic\"", "gps"},
        {"odom_error [9 9 9 9]", "shares of 0 to 2"},
        {"drive \"fly\"", "drive \"diff\""},
        {"color_rgba [2 0 0 0]", "shares of 0 to 1"},
        {"gps_noise [-1]", "0 or more"},
        {"lasr ( )", "did you mean 'laser'"},
        {"fiducial_return 1e12", "fiducial_return"},
        {"fiducial_return 1.5", "a whole number"},
        {"velocity_bounds [0 1e9 0 0 0 0 0 0]", "up to 100000"},
        {"localization_origin [1e9 0 0 0]", "within 100000 m"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[256];
        snprintf(text, sizeof text, "position (\n%s )", cases[i].text);
        CU_ASSERT_PTR_NULL(load(text));
        CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, cases[i].says));
        CU_ASSERT_EQUAL(fault.line, 2);
    }
    CU_ASSERT_PTR_NULL(load("unit_length inch"));
    CU_ASSERT_PTR_NULL(load("unit_angle radians model ( pose [0 0 0 1e308] )"));
    CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "a smaller number"));
    CU_ASSERT_PTR_NULL(load("seed -1"));
    CU_ASSERT_PTR_NULL(load("model ( name \"a\" movable 1 ) model ( name \"a\" movable 1 )"));
    CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "another name"));
}

static void test_colors(void)
{
    uint32_t rgb = 0;
    CU_ASSERT_TRUE(look_color("gray0", &rgb) && rgb == 0);
    CU_ASSERT_TRUE(look_color("Grey100", &rgb) && rgb == 0xffffff);
    CU_ASSERT_TRUE(look_color("LightBlue", &rgb) && rgb == 0xadd8e6);
    CU_ASSERT_FALSE(look_color("gray101", &rgb));
    CU_ASSERT_FALSE(look_color("#12345", &rgb));
    CU_ASSERT_FALSE(look_color("#1234567", &rgb));
    CU_ASSERT_FALSE(look_color("#12345g", &rgb));
    CU_ASSERT_FALSE(look_color("", &rgb));
    CU_ASSERT_FALSE(look_color("a colour with a name that is far too long", &rgb));
    CU_ASSERT_STRING_EQUAL(look_color_near("magneta"), "magenta");
    CU_ASSERT_PTR_NULL(look_color_near("xyzzy"));
}

static void test_limit_objects(void)
{
    static char text[(MU_OBJECTS_MAX + 1) * 5 + 64];
    for (size_t extra = 0; extra < 2; extra++) {
        size_t len = (size_t)snprintf(text, sizeof text, "define p model ( movable 1 )\n");
        for (size_t i = 0; i < MU_OBJECTS_MAX + extra; i++) {
            len += (size_t)snprintf(text + len, sizeof text - len, "p()\n");
        }
        CU_ASSERT_EQUAL(load(text) == NULL, extra == 1);
    }
    CU_ASSERT_PTR_NOT_NULL(strstr(fault.text, "more than 4096 things"));
    CU_ASSERT_EQUAL(fault.line, MU_OBJECTS_MAX + 2);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"laser", test_laser},
        {"sonar", test_sonar},
        {"robots with the same ring share it", test_robots_with_the_same_ring_share_it},
        {"camera, fiducial finder, gripper", test_camera_finder_and_gripper},
        {"odometer and errors", test_odometer_and_errors},
        {"a robot that is moved", test_a_robot_that_is_moved_counts_from_its_new_place},
        {"battery", test_battery},
        {"looks", test_looks},
        {"one fiducial of many shapes", test_one_fiducial_of_many_shapes},
        {"things that can be moved", test_objects},
        {"units", test_units},
        {"mistakes", test_mistakes},
        {"colours", test_colors},
        {"limit: things", test_limit_objects},
        CU_TEST_INFO_NULL,
    };
    return suite_run("world/devices", tests);
}
