/* SPDX-License-Identifier: Apache-2.0 */
/* Sonar cones, laser, camera and fiducial finder in scenes small enough to compute by hand; what is
 * read when; noise; threads. */
#include "sim/sensors/sensors.h"
#include "suite.h"

#include "core/hash.h"
#include "core/random.h"
#include "sim/sensors/fan.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>

enum { SOLIDS = 600, TEAM = 80, STEP_MS = 100 };
enum { SONAR = 1, LASER = 2, CAMERA = 4, FIDUCIALS = 8, ALL = 15 };

#define DEG (M_PI / 180)

/* Their memory lives as long as the process: kept here, so that leak checkers see it. */
static struct scene {
    struct world world;
    struct world_robot robots[TEAM];
    struct world_sonar sonars[TEAM][MU_SONARS_MAX];
    struct solid still[SOLIDS], moving[SOLIDS];
    size_t still_count, moving_count;
    struct grid grid;
    struct sensors *sensors;
} scenes[60];
static struct scene *scene = &scenes[0];

static void clear(void)
{
    scene++;
    CU_ASSERT_FATAL(scene < scenes + sizeof scenes / sizeof scenes[0]);
    scene->world.robots = scene->robots;
}

/* The first of all: robots must be added before other things that move. */
static struct world_robot *add_robot(double x_m, double y_m, double heading_deg)
{
    struct world_robot *r = &scene->robots[scene->world.robot_count++];
    r->pose = (struct world_pose){x_m, y_m, heading_deg * DEG};
    struct solid *body = &scene->moving[scene->moving_count];
    *body = solid_box(r->pose, 0.22, 0.19);
    body->owner = (int32_t)scene->moving_count++;
    return r;
}

static struct solid *add(struct solid solid)
{
    scene->still[scene->still_count] = solid;
    return &scene->still[scene->still_count++];
}

static struct solid *add_box(double x_m, double y_m, double half_x_m, double half_y_m)
{
    return add(solid_box((struct world_pose){x_m, y_m, 0}, half_x_m, half_y_m));
}

static void place_robots(void)
{
    for (size_t i = 0; i < scene->world.robot_count; i++) {
        struct frame frame = frame_of(scene->robots[i].pose);
        scene->moving[i].x = frame.x;
        scene->moving[i].y = frame.y;
        scene->moving[i].c = frame.c;
        scene->moving[i].s = frame.s;
        sensors_place(scene->sensors, i, &frame);
    }
    grid_update(&scene->grid);
}

static void start(uint64_t seed, size_t threads)
{
    grid_init(&scene->grid, scene->still, scene->still_count, scene->moving, scene->moving_count);
    scene->sensors = sensors_open(&(struct sensors_scene){.world = &scene->world,
                                                          .grid = &scene->grid,
                                                          .seed = seed,
                                                          .step_ns = STEP_MS * 1000000ull,
                                                          .threads = threads});
    place_robots();
}

static struct mu_percept read(size_t robot, uint32_t wanted, uint64_t step)
{
    struct mu_percept percept = {0};
    uint32_t alone[TEAM] = {0};
    alone[robot] = wanted;
    sensors_read_all(scene->sensors, alone, step);
    sensors_tell(scene->sensors, robot, wanted, &percept);
    return percept;
}

static struct mu_percept look(uint32_t wanted)
{
    start(1, 1);
    struct mu_percept percept = read(0, wanted, 0);
    sensors_close(scene->sensors);
    return percept;
}

static void near_to(double got, double want)
{
    CU_ASSERT_DOUBLE_EQUAL(got, want, 1e-6);
}

/* --- sonar ------------------------------------------------------------------------------------ */

static struct world_sonar *add_sonar(struct world_robot *r, double heading_deg, uint32_t rays)
{
    struct world_sonar *ring = scene->sonars[r - scene->robots];
    struct world_sonar *sonar = &ring[r->sonar_count++];
    r->sonars = ring;
    *sonar = (struct world_sonar){
        .pose = {0, 0, heading_deg * DEG}, .range_max_m = 5, .fov_rad = 30 * DEG, .rays = rays};
    return sonar;
}

static void test_a_sonar_hears_the_nearest_in_its_cone(void)
{
    clear();
    struct world_robot *r = add_robot(0, 0, 0);
    add_sonar(r, 0, 1);
    add_sonar(r, 0, 3);
    add_sonar(r, 0, 0); /* as 1 */
    add_sonar(r, 180, 3);
    add(solid_disc(2 * cos(15 * DEG), 2 * sin(15 * DEG), 0.25)); /* on the left edge of the cone */
    add_box(4, 0, 0.1, 8);
    struct mu_percept p = look(SONAR);
    CU_ASSERT_EQUAL_FATAL(p.sonar_count, 4);
    near_to((double)p.sonar_m[0], 3.9);
    near_to((double)p.sonar_m[1], 1.75);
    near_to((double)p.sonar_m[2], 3.9);
    CU_ASSERT_EQUAL((double)p.sonar_m[3], 5);
}

static void test_flat_incidence_loses_the_echo(void)
{
    clear();
    struct world_robot *r = add_robot(0, 0, 0);
    add_box(0, 1.1, 20, 0.1);      /* a wall along the left */
    add(solid_disc(-2, 0.4, 0.5)); /* hit at an angle whose sine is 0.8 */
    for (int k = 0; k < 2; k++) {
        add_sonar(r, 20, 1)->specular_rad = k ? 60 * DEG : 0;  /* incidence 70 degrees */
        add_sonar(r, 40, 1)->specular_rad = k ? 60 * DEG : 0;  /* 50 */
        add_sonar(r, 180, 1)->specular_rad = k ? 50 * DEG : 0; /* 53.13 */
        add_sonar(r, 180, 1)->specular_rad = k ? 54 * DEG : 0;
    }
    struct mu_percept p = look(SONAR);
    near_to((double)p.sonar_m[0], 1 / sin(20 * DEG));
    near_to((double)p.sonar_m[1], 1 / sin(40 * DEG));
    near_to((double)p.sonar_m[2], 1.7);
    CU_ASSERT_EQUAL((double)p.sonar_m[4], 5);
    near_to((double)p.sonar_m[5], 1 / sin(40 * DEG));
    CU_ASSERT_EQUAL((double)p.sonar_m[6], 5);
    near_to((double)p.sonar_m[7], 1.7);
}

/* --- laser ------------------------------------------------------------------------------------ */

static struct world_laser *give_laser(struct world_robot *r, double fov_deg, uint32_t samples)
{
    r->laser = (struct world_laser){
        .range_min_m = 0.02, .range_max_m = 8, .fov_rad = fov_deg * DEG, .samples = samples};
    return &r->laser;
}

static void test_a_laser_scans_from_right_to_left(void)
{
    clear();
    struct world_robot *r = add_robot(1, 1, 90);
    give_laser(r, 180, 5)->pose = (struct world_pose){0.5, 0, 0};
    add_box(3.1, 1, 0.1, 9); /* right of it, at 2 m */
    add_box(1, 4.6, 9, 0.1); /* ahead, at 3 m from the scanner */
    add_box(1, 3.5, 0.1, 0.2)->returns = SOLID_STOPS | SOLID_SHOWS; /* glass */
    struct mu_percept p = look(LASER);
    CU_ASSERT_EQUAL_FATAL(p.laser_count, 5);
    near_to((double)p.laser_m[0], 2);
    near_to((double)p.laser_m[1], 2 * sqrt(2));
    near_to((double)p.laser_m[2], 3);
    near_to((double)p.laser_m[3], 3 * sqrt(2));
    CU_ASSERT_EQUAL((double)p.laser_m[4], 8);
}

static void test_ranges_stay_inside_their_limits(void)
{
    clear();
    struct world_robot *r = add_robot(0, 0, 0);
    give_laser(r, 0, 1)->range_min_m = 1;
    add_box(0.5, 0, 0.1, 1);
    CU_ASSERT_EQUAL((double)look(LASER).laser_m[0], 1);

    clear();
    r = add_robot(0, 0, 0);
    give_laser(r, 90, 200)->noise = (struct world_noise){3, 0, 0};
    add(solid_disc(4, 0, 2));
    struct mu_percept p = look(LASER);
    size_t at_end = 0;
    for (size_t k = 0; k < p.laser_count; k++) {
        CU_ASSERT(p.laser_m[k] >= 0.02f && p.laser_m[k] <= 8);
        at_end += p.laser_m[k] == 8;
    }
    CU_ASSERT(at_end >= 66 && at_end < 134); /* the 60 degrees of the disc are within */
}

/* A wall ahead at 4 m, read over many steps. */
static void measure(const struct world_noise *noise, double *mean, double *deviation)
{
    clear();
    struct world_robot *r = add_robot(0, 0, 0);
    give_laser(r, 0, 50)->noise = *noise;
    add_box(4.1, 0, 0.1, 4);
    start(3, 1);
    double sum = 0;
    double square = 0;
    for (uint64_t step = 0; step < 200; step++) {
        struct mu_percept p = read(0, LASER, step);
        for (size_t k = 0; k < 50; k++) {
            double off = (double)p.laser_m[k] - 4;
            sum += off;
            square += off * off;
        }
    }
    *mean = sum / 10000;
    *deviation = sqrt(square / 10000);
}

static void test_noise_has_the_deviation_that_the_world_says(void)
{
    double mean;
    double deviation;
    measure(&(struct world_noise){0.05, 0, 0}, &mean, &deviation);
    CU_ASSERT_DOUBLE_EQUAL(mean, 0, 5 * 0.05 / 100);
    CU_ASSERT_DOUBLE_EQUAL(deviation, 0.05, 5 * 0.05 / sqrt(20000));
    measure(&(struct world_noise){0, 0.02, 0}, &mean, &deviation);
    CU_ASSERT_DOUBLE_EQUAL(deviation, 0.08, 5 * 0.08 / sqrt(20000));
    /* Turned by a, the wall is 4 / cos(a) off: 2 a a more, on average. */
    measure(&(struct world_noise){0, 0, 0.1}, &mean, &deviation);
    CU_ASSERT_DOUBLE_EQUAL(mean, 2 * 0.01, 0.002);
    measure(&(struct world_noise){0, 0, 0}, &mean, &deviation);
    CU_ASSERT(deviation < 1e-6);
}

static void test_a_fan_without_width_looks_ahead(void)
{
    static const double fov_deg[] = {0, 1e-320, 1e-300, 1e-12};
    for (size_t i = 0; i < sizeof fov_deg / sizeof fov_deg[0]; i++) {
        clear();
        give_laser(add_robot(0, 0, 0), fov_deg[i], MU_BEAMS_MAX);
        add_box(3, 0, 0.1, 0.001);
        struct mu_percept p = look(MU_SENSE_LASER);
        CU_ASSERT_EQUAL_FATAL(p.laser_count, MU_BEAMS_MAX);
        near_to((double)p.laser_m[0], 2.9);
        near_to((double)p.laser_m[MU_BEAMS_MAX - 1], 2.9);
    }
}

static void expect_intensities(const struct mu_percept *p)
{
    static const float wanted[] = {2.5f, 0, 0.5f};
    CU_ASSERT_EQUAL_FATAL(p->laser_intensity_count, 3);
    for (size_t k = 0; k < 3; k++) {
        CU_ASSERT_EQUAL(p->laser_intensity[k], wanted[k]);
    }
}

static void test_intensity_is_the_reflectance_of_what_a_beam_meets(void)
{
    for (size_t i = 0; i < 2; i++) {
        clear();
        give_laser(add_robot(0, 0, 0), 180, 3)->noise.angle_rad = i == 0 ? 0 : 1e-9;
        add_box(0, -2, 0.5, 0.1)->look.reflectance = 2.5;
        add_box(0, 2, 0.5, 0.1)->look.reflectance = 0.5;
        add_box(0, 3, 0.5, 0.1)->look.reflectance = 7; /* behind the other */
        struct mu_percept p = look(MU_SENSE_LASER | MU_SENSE_LASER_INTENSITY);
        expect_intensities(&p);
        near_to((double)p.laser_m[0], 1.9);
    }
}

static void test_intensity_is_read_for_those_who_ask(void)
{
    clear();
    struct world_robot *r = add_robot(0, 0, 0);
    give_laser(r, 180, 3);
    r->period_ns[MU_SENSOR_LASER] = 10 * STEP_MS * 1000000ull;
    add_box(0, -2, 0.5, 0.1)->look.reflectance = 2.5;
    add_box(0, 2, 0.5, 0.1)->look.reflectance = 0.5;
    start(1, 1);
    struct mu_percept p = read(0, MU_SENSE_LASER, 0);
    CU_ASSERT(p.laser_count == 3 && p.laser_intensity_count == 0);
    p = read(0, MU_SENSE_LASER | MU_SENSE_LASER_INTENSITY,
             1); /* between two readings of the laser */
    expect_intensities(&p);
    p = read(0, MU_SENSE_LASER_INTENSITY, 2);
    CU_ASSERT(p.laser_count == 0 && p.laser_intensity_count == 0);
    sensors_close(scene->sensors);
}

/* --- camera ----------------------------------------------------------------------------------- */

static struct world_camera *give_camera(struct world_robot *r, double fov_deg, uint32_t columns)
{
    r->camera = (struct world_camera){
        .range_m = 10, .fov_rad = fov_deg * DEG, .columns = columns, .rows = 60};
    return &r->camera;
}

static struct solid *paint(struct solid *solid, uint32_t rgb)
{
    solid->look.rgb = rgb;
    return solid;
}

static void test_blobs_are_nearest_first_with_bearing_width_and_range(void)
{
    clear();
    give_camera(add_robot(0, 0, 0), 60, 600);
    paint(add(solid_disc(4, 1, 0.2)), 0xff0000);
    paint(add(solid_disc(2, -0.5, 0.1)), 0x00ff00);
    paint(add_box(8, 0, 0.1, 20), 0x0000ff); /* a wall behind, cut by the discs */
    struct mu_percept p = look(CAMERA);
    CU_ASSERT_EQUAL_FATAL(p.blob_count, 5);
    double step = 0.1 * DEG;
    CU_ASSERT_EQUAL(p.blobs[0].rgb, 0x00ff00);
    CU_ASSERT_DOUBLE_EQUAL(p.blobs[0].bearing_rad, atan2(-0.5, 2), step);
    CU_ASSERT_DOUBLE_EQUAL(p.blobs[0].width_rad, 2 * asin(0.1 / hypot(0.5, 2)), 1.01 * step);
    CU_ASSERT_DOUBLE_EQUAL(p.blobs[0].range_m, hypot(0.5, 2) - 0.1, 1e-3);
    CU_ASSERT_EQUAL(p.blobs[1].rgb, 0xff0000);
    CU_ASSERT_DOUBLE_EQUAL(p.blobs[1].range_m, hypot(4, 1) - 0.2, 1e-3);
    double all = 0;
    for (size_t k = 0; k < 5; k++) {
        CU_ASSERT(k == 0 || p.blobs[k].range_m >= p.blobs[k - 1].range_m);
        CU_ASSERT(k < 2 || p.blobs[k].rgb == 0x0000ff);
        all += p.blobs[k].width_rad;
    }
    near_to(all, 60 * DEG);
}

static void test_a_camera_sees_what_shows_and_looks_for_its_colours(void)
{
    clear();
    struct world_robot *r = add_robot(0, 0, 0);
    struct world_camera *camera = give_camera(r, 60, 120);
    camera->colors[0] = 0x112233;
    camera->color_count = 1;
    paint(add(solid_disc(5, 0, 0.5)), 0x112233);
    paint(add(solid_disc(3, 0, 0.2)), 0x445566)->returns = SOLID_STOPS | SOLID_ECHOES; /* air */
    paint(add(solid_disc(3, -0.15, 0.05)), 0x445566); /* hides a part, and is no blob */
    struct mu_percept p = look(CAMERA);
    CU_ASSERT_EQUAL_FATAL(p.blob_count, 2);
    CU_ASSERT(p.blobs[0].rgb == 0x112233 && p.blobs[1].rgb == 0x112233);
}

static void test_parts_of_one_owner_and_colour_are_one_blob(void)
{
    clear();
    give_camera(add_robot(0, 0, 0), 60, 120);
    add_robot(3, 0.19, 0);
    add_robot(3.05, -0.20, 0); /* beside it, of the same colour, but another */
    paint(add_box(6, 1, 0.1, 1), 0xabcdef);
    paint(add_box(6.05, -1, 0.1, 1), 0xabcdef);
    struct mu_percept p = look(CAMERA);
    CU_ASSERT_EQUAL_FATAL(p.blob_count, 4);
    CU_ASSERT(p.blobs[0].rgb == 0 && p.blobs[1].rgb == 0);
    CU_ASSERT(p.blobs[2].rgb == 0xabcdef &&
              p.blobs[3].rgb == 0xabcdef); /* left and right of them */
}

static void test_limit_blobs(void)
{
    clear();
    give_camera(add_robot(0, 0, 0), 180, 640);
    for (int k = 0; k < MU_BLOBS_MAX + 8; k++) { /* each next one nearer, and free to be seen */
        double turn = (k - 20) * 4 * DEG;
        double far = 9 - 0.1 * k;
        paint(add(solid_disc(far * cos(turn), far * sin(turn), 0.05)), 0x100u + (uint32_t)k);
    }
    struct mu_percept p = look(CAMERA);
    CU_ASSERT_EQUAL_FATAL(p.blob_count, MU_BLOBS_MAX);
    for (uint32_t k = 0; k < MU_BLOBS_MAX; k++) {
        CU_ASSERT_EQUAL(p.blobs[k].rgb, 0x100u + MU_BLOBS_MAX + 7 - k);
    }
}

/* --- fiducials -------------------------------------------------------------------------------- */

static struct world_fiducial_finder *give_finder(struct world_robot *r)
{
    r->finder = (struct world_fiducial_finder){
        .range_min_m = 0.2, .range_max_m = 8, .range_id_m = 5, .fov_rad = M_PI};
    return &r->finder;
}

static struct solid *number(struct solid *solid, int32_t fiducial)
{
    solid->look.fiducial = fiducial;
    return solid;
}

static void test_fiducials_are_read_near_and_seen_far(void)
{
    clear();
    give_finder(add_robot(1, 1, 90))->pose = (struct world_pose){0.2, 0, 0};
    add_robot(2, 3.2, 150);
    number(&scene->moving[1], 7);
    number(add(solid_disc(1, 7.2, 0.3)), 8); /* too far to be read */
    number(add(solid_disc(1, 9.4, 0.3)), 9); /* too far to be seen */
    number(add(solid_disc(1, 0, 0.3)), 10);  /* behind */
    add(solid_disc(0, 2, 0.3));              /* bears none */
    number(&scene->moving[0], 11);           /* itself */
    struct mu_percept p = look(FIDUCIALS);
    CU_ASSERT_EQUAL_FATAL(p.fiducial_count, 2);
    CU_ASSERT_EQUAL(p.fiducials[0].number, 7);
    near_to(p.fiducials[0].range_m, sqrt(5));
    near_to(p.fiducials[0].bearing_rad, -atan2(1, 2));
    near_to(p.fiducials[0].heading_rad, 60 * DEG);
    CU_ASSERT_EQUAL(p.fiducials[1].number, 0);
    near_to(p.fiducials[1].range_m, 6);
    near_to(p.fiducials[1].bearing_rad, 0);
}

static void test_what_stands_before_hides_a_fiducial(void)
{
    clear();
    give_finder(add_robot(0, 0, 0));
    number(add(solid_disc(4, 0, 0.3)), 1);
    number(add(solid_disc(3, 3, 0.3)), 2);
    add(solid_disc(2, 0.1, 0.05))->returns = SOLID_STOPS; /* beside the ray */
    CU_ASSERT_EQUAL(look(FIDUCIALS).fiducial_count, 2);

    clear();
    give_finder(add_robot(0, 0, 0));
    number(add(solid_disc(4, 0, 0.3)), 1);
    number(add(solid_disc(3, 3, 0.3)), 2);
    add(solid_disc(2, 0.04, 0.05))->returns = SOLID_STOPS;
    struct mu_percept p = look(FIDUCIALS);
    CU_ASSERT_EQUAL_FATAL(p.fiducial_count, 1);
    CU_ASSERT_EQUAL(p.fiducials[0].number, 2);
}

static void test_a_mark_for_finders_alone_is_read(void)
{
    clear();
    give_finder(add_robot(0, 0, 0));
    number(add_box(2, 0, 0.5, 0.5), 1)->returns = 0;
    number(add_box(4, 0, 0.5, 0.5), 2); /* the mark hides nothing */
    number(add_box(0, 3, 0.5, 0.5), 3)->returns = 0;
    add_box(0, 2, 0.1, 0.1); /* hides the mark behind it */
    struct solid *lifted = number(&scene->moving[scene->moving_count++], 4);
    *lifted = solid_disc(1, 1, 0.1);
    lifted->look.fiducial = 4;
    lifted->away = true; /* nobody sees what hangs in a gripper */
    struct mu_percept p = look(FIDUCIALS);
    CU_ASSERT_EQUAL_FATAL(p.fiducial_count, 2);
    CU_ASSERT_EQUAL(p.fiducials[0].number, 1);
    near_to(p.fiducials[0].range_m, 2);
    CU_ASSERT_EQUAL(p.fiducials[1].number, 2);
}

static void test_a_round_bearer_has_a_heading(void)
{
    clear();
    give_finder(add_robot(0, 0, 30));
    struct world_shape shape = {
        .kind = WORLD_DISC, .pose = {3, 1, 100 * DEG}, .radius_m = 0.3, .look.fiducial = 6};
    add(solid_of_shape(&shape));
    struct mu_percept p = look(FIDUCIALS);
    CU_ASSERT_EQUAL_FATAL(p.fiducial_count, 1);
    near_to(p.fiducials[0].heading_rad, 70 * DEG);
}

static void test_limit_fiducials(void)
{
    clear();
    give_finder(add_robot(0, 0, 0));
    for (int k = 0; k < MU_FIDUCIALS_MAX + 8; k++) {
        double turn = (k - 20) * 4 * DEG;
        double far = 4.9 - 0.05 * k;
        number(add(solid_disc(far * cos(turn), far * sin(turn), 0.05)), 1 + k);
    }
    struct mu_percept p = look(FIDUCIALS);
    CU_ASSERT_EQUAL_FATAL(p.fiducial_count, MU_FIDUCIALS_MAX);
    for (int k = 0; k < MU_FIDUCIALS_MAX; k++) {
        CU_ASSERT_EQUAL(p.fiducials[k].number, MU_FIDUCIALS_MAX + 8 - k);
    }
}

/* --- all of them ------------------------------------------------------------------------------ */

static void give_all(struct world_robot *r)
{
    add_sonar(r, 0, 3)->noise = (struct world_noise){0.01, 0.01, 0.01};
    add_sonar(r, 90, 3)->specular_rad = 60 * DEG;
    give_laser(r, 180, 90)->noise = (struct world_noise){0.01, 0, 0};
    give_camera(r, 60, 80);
    give_finder(r);
}

static void test_a_robot_does_not_see_what_it_carries(void)
{
    clear();
    give_all(add_robot(0, 0, 0));
    struct solid *thing = &scene->moving[scene->moving_count++];
    *thing = solid_disc(0.5, 0, 0.2);
    thing->owner = 1;
    thing->look.fiducial = 5;
    start(1, 1);
    struct mu_percept p = read(0, ALL, 0);
    CU_ASSERT(p.sonar_m[0] < 1 && p.laser_m[45] < 1);
    CU_ASSERT(p.blob_count == 1 && p.fiducial_count == 1);
    thing->owner = 0;
    p = read(0, ALL, 1);
    CU_ASSERT(p.sonar_m[0] == 5 && p.laser_m[45] == 8);
    CU_ASSERT(p.blob_count == 0 && p.fiducial_count == 0);
}

static void test_what_nobody_wants_is_empty(void)
{
    clear();
    give_all(add_robot(0, 0, 0));
    add_robot(2, 0, 0); /* has no sensors */
    number(&scene->moving[1], 3);
    start(1, 1);
    for (uint32_t wanted = 0; wanted <= ALL; wanted++) {
        struct mu_percept p = read(0, wanted, wanted);
        CU_ASSERT_EQUAL(p.sonar_count, wanted & SONAR ? 2 : 0);
        CU_ASSERT_EQUAL(p.laser_count, wanted & LASER ? 90 : 0);
        CU_ASSERT_EQUAL(p.blob_count, wanted & CAMERA ? 1 : 0);
        CU_ASSERT_EQUAL(p.fiducial_count, wanted & FIDUCIALS ? 1 : 0);
        p = read(1, wanted, wanted);
        CU_ASSERT(p.sonar_count + p.laser_count + p.blob_count + p.fiducial_count == 0);
    }
}

static void test_between_its_readings_the_last_one_stands(void)
{
    clear();
    struct world_robot *r = add_robot(0, 0, 0);
    give_laser(r, 0, 1);
    add_sonar(r, 0, 1)->range_max_m = 20;
    r->laser.range_max_m = 20;
    r->period_ns[MU_SENSOR_LASER] = 250000000; /* of steps of 100 ms: at 0, 3, 5, 8, 10 */
    add_box(10.1, 0, 0.1, 1);
    start(1, 1);
    double laser_x = 0;
    for (uint64_t step = 0; step < 12; step++) {
        r->pose.x_m = 0.1 * (double)step;
        place_robots();
        bool due = step == 0 || step == 3 || step == 5 || step == 8 || step == 10;
        laser_x = due ? r->pose.x_m : laser_x;
        struct mu_percept p = read(0, ALL, step);
        near_to((double)p.sonar_m[0], 10 - r->pose.x_m);
        near_to((double)p.laser_m[0], 10 - laser_x);
    }
}

static void test_what_was_forgotten_is_read_anew(void)
{
    clear();
    struct world_robot *r = add_robot(0, 0, 0);
    give_laser(r, 0, 1)->range_max_m = 20;
    r->period_ns[MU_SENSOR_LASER] = 300000000; /* of steps of 100 ms: at 0, 3, 6 */
    add_box(10.1, 0, 0.1, 1);
    start(1, 1);
    static const double wanted_m[] = {10, 10, 9.8, 9.7, 9.7}; /* forgotten before step 2 */
    for (uint64_t step = 0; step < 5; step++) {
        r->pose.x_m = 0.1 * (double)step;
        place_robots();
        if (step == 2) {
            sensors_forget(scene->sensors);
        }
        near_to((double)read(0, ALL, step).laser_m[0], wanted_m[step]);
    }
    sensors_close(scene->sensors);
}

static uint64_t bits_of(const struct mu_percept *p)
{
    uint64_t hash = mu_hash_bytes(MU_HASH_EMPTY, p->sonar_m, p->sonar_count * sizeof(float));
    hash = mu_hash_bytes(hash, p->laser_m, p->laser_count * sizeof(float));
    for (size_t k = 0; k < p->blob_count; k++) {
        hash = mu_hash_bytes(hash, &p->blobs[k].rgb, sizeof p->blobs[k].rgb);
        hash = mu_hash_bytes(hash, &p->blobs[k].bearing_rad, 3 * sizeof(double));
    }
    for (size_t k = 0; k < p->fiducial_count; k++) {
        hash = mu_hash_bytes(hash, &p->fiducials[k].number, sizeof p->fiducials[k].number);
        hash = mu_hash_bytes(hash, &p->fiducials[k].bearing_rad, 3 * sizeof(double));
    }
    return hash;
}

/* A crowd with all sensors, moved about.  threads 0: each robot is read on its own. */
static uint64_t bits_of_a_crowd(size_t threads, const char *kernel, const uint32_t wanted[TEAM])
{
    struct mu_random dice;
    mu_random_seed(&dice, 5, "crowd");
    CU_ASSERT_TRUE_FATAL(fan_choose(kernel));
    clear();
    for (int i = 0; i < TEAM; i++) {
        double x = 12 * mu_random_unit(&dice);
        double y = 12 * mu_random_unit(&dice);
        give_all(add_robot(x, y, 360 * mu_random_unit(&dice)));
        number(paint(&scene->moving[i], (uint32_t)i % 5), i % 3);
    }
    for (int k = 0; k < 60; k++) {
        double x = 12 * mu_random_unit(&dice);
        double y = 12 * mu_random_unit(&dice);
        paint(add(solid_disc(x, y, 0.1 + 0.3 * mu_random_unit(&dice))), (uint32_t)k % 4);
    }
    start(9, threads);
    uint64_t hash = 0;
    for (uint64_t step = 0; step < 5; step++) {
        for (size_t i = 0; i < TEAM; i++) {
            scene->robots[i].pose.x_m += 0.1 * mu_random_unit(&dice);
        }
        place_robots();
        for (size_t i = 0; threads == 0 && i < TEAM; i++) {
            read(i, wanted[i], step);
        }
        if (threads > 0) {
            sensors_read_all(scene->sensors, wanted, step);
        }
        for (size_t i = 0; i < TEAM; i++) {
            struct mu_percept p = {0};
            sensors_tell(scene->sensors, i, wanted[i], &p);
            uint64_t bits = bits_of(&p);
            hash = mu_hash_bytes(hash, &bits, sizeof bits);
        }
    }
    sensors_close(scene->sensors);
    return hash;
}

static void test_threads_and_vector_units_give_the_same_bits(void)
{
    uint32_t wanted[TEAM];
    for (uint32_t i = 0; i < TEAM; i++) {
        wanted[i] = i % 3 ? ALL : i % 16;
    }
    uint64_t first = bits_of_a_crowd(0, "portable", wanted);
    for (size_t n = 0; fan_name(n); n++) {
        CU_ASSERT_EQUAL(bits_of_a_crowd(1, fan_name(n), wanted), first);
        CU_ASSERT_EQUAL(bits_of_a_crowd(2, fan_name(n), wanted), first);
        CU_ASSERT_EQUAL(bits_of_a_crowd(5, fan_name(n), wanted), first);
    }
    wanted[0] ^= LASER;
    CU_ASSERT_NOT_EQUAL(bits_of_a_crowd(2, "portable", wanted), first);
}

static void test_reading_one_sensor_changes_no_other(void)
{
    float laser[2][90];
    for (int all = 0; all < 2; all++) {
        clear();
        for (int i = 0; i < 4; i++) {
            give_all(add_robot(2 * i, 0.3 * i, 40 * i));
        }
        start(2, 1);
        for (uint64_t step = 0; step < 4; step++) {
            for (size_t i = 0; i < 4; i++) {
                if (all || i == 2) {
                    (void)read(i, all ? ALL : LASER, step);
                }
            }
        }
        struct mu_percept p = read(2, LASER, 4);
        memcpy(laser[all], p.laser_m, sizeof laser[all]);
    }
    CU_ASSERT_EQUAL(memcmp(laser[0], laser[1], sizeof laser[0]), 0);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a sonar hears the nearest in its cone", test_a_sonar_hears_the_nearest_in_its_cone},
        {"flat incidence loses the echo", test_flat_incidence_loses_the_echo},
        {"a laser scans from right to left", test_a_laser_scans_from_right_to_left},
        {"a fan without width looks ahead", test_a_fan_without_width_looks_ahead},
        {"intensity is the reflectance of what a beam meets",
         test_intensity_is_the_reflectance_of_what_a_beam_meets},
        {"intensity is read for those who ask", test_intensity_is_read_for_those_who_ask},
        {"ranges stay inside their limits", test_ranges_stay_inside_their_limits},
        {"noise has the deviation that the world says",
         test_noise_has_the_deviation_that_the_world_says},
        {"blobs: nearest first; bearing, width, range",
         test_blobs_are_nearest_first_with_bearing_width_and_range},
        {"a camera sees what shows and looks for its colours",
         test_a_camera_sees_what_shows_and_looks_for_its_colours},
        {"parts of one owner and colour are one blob",
         test_parts_of_one_owner_and_colour_are_one_blob},
        {"limit: blobs", test_limit_blobs},
        {"fiducials are read near and seen far", test_fiducials_are_read_near_and_seen_far},
        {"what stands before hides a fiducial", test_what_stands_before_hides_a_fiducial},
        {"a mark for finders alone is read", test_a_mark_for_finders_alone_is_read},
        {"a round bearer has a heading", test_a_round_bearer_has_a_heading},
        {"limit: fiducials", test_limit_fiducials},
        {"a robot does not see what it carries", test_a_robot_does_not_see_what_it_carries},
        {"what nobody wants is empty", test_what_nobody_wants_is_empty},
        {"between its readings the last one stands", test_between_its_readings_the_last_one_stands},
        {"what was forgotten is read anew", test_what_was_forgotten_is_read_anew},
        {"threads and vector units give the same bits",
         test_threads_and_vector_units_give_the_same_bits},
        {"reading one sensor changes no other", test_reading_one_sensor_changes_no_other},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/sensors", tests);
}
