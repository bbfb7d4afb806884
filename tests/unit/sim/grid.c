/* SPDX-License-Identifier: Apache-2.0 */
/* Rays and queries through the grid, compared with a test of all solids. */
#include "core/random.h"
#include "sim/geometry/geometry.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <string.h>

enum { STILL = 150, MOVING = 60, RAYS = 20000 };

static struct solid still[STILL];
static struct solid moving[MOVING];
static struct grid grid;
static struct mu_random dice;

static double between(double lo, double hi)
{
    return lo + (hi - lo) * mu_random_unit(&dice);
}

static struct solid any_solid(double side_m)
{
    double x = between(-side_m, side_m);
    double y = between(-side_m, side_m);
    double turn = mu_random_unit(&dice) < 0.3 ? M_PI / 2 : between(-M_PI, M_PI);
    double a = between(0.05, 1.2);
    double b = between(0.05, 0.4);
    return mu_random_unit(&dice) < 0.4 ? solid_disc(x, y, b)
                                       : solid_box((struct world_pose){x, y, turn}, a, b);
}

static double brute_force(int self, const double from[2], const double along[2], double range)
{
    double best = range;
    for (size_t i = 0; i < STILL; i++) {
        best = solid_ray(&still[i], from, along, best);
    }
    for (int i = 0; i < MOVING; i++) {
        best = i == self ? best : solid_ray(&moving[i], from, along, best);
    }
    return best;
}

static void scatter_moving(double side_m)
{
    for (size_t i = 0; i < MOVING; i++) { /* sizes stay, as those of robots do */
        struct solid there = any_solid(side_m);
        moving[i].x = there.x;
        moving[i].y = there.y;
        if (moving[i].kind == WORLD_BOX) {
            double turn = between(-M_PI, M_PI);
            moving[i].c = cos(turn);
            moving[i].s = sin(turn);
        }
    }
    grid_update(&grid);
}

static size_t count_wrong_rays(double side_m, size_t *hits)
{
    size_t wrong = 0;
    for (size_t i = 0; i < RAYS; i++) {
        double turn = i % 4 == 0 ? (double)(i % 16 / 4) * M_PI / 2 : between(-M_PI, M_PI);
        double x = between(-side_m, side_m);
        double y = between(-side_m, side_m);
        double from[2] = {i % 8 == 0 ? round(x) : x, i % 16 == 0 ? round(y) : y};
        double along[2] = {cos(turn), sin(turn)};
        int self = (int)mu_random_between(&dice, -1, MOVING - 1);
        self = self < 0 ? GRID_NOBODY : self;
        double range = between(0.1, 12);
        double got = grid_ray(&grid, self, from, along, range);
        double want = brute_force(self, from, along, range);
        wrong += fabs(got - want) > 1e-12;
        *hits += want < range;
    }
    return wrong;
}

static void test_rays_equal_brute_force(void)
{
    size_t hits = 0;
    for (size_t round = 0; round < 3; round++) {
        scatter_moving(9);
        CU_ASSERT_EQUAL(count_wrong_rays(11, &hits), 0);
    }
    CU_ASSERT(hits > RAYS / 2);
}

static void test_rays_reach_what_left_the_grid(void)
{
    size_t hits = 0;
    scatter_moving(30);
    CU_ASSERT(grid.moving.outside_count > MOVING / 2);
    CU_ASSERT_EQUAL(count_wrong_rays(30, &hits), 0);
    CU_ASSERT(hits > 100);
}

static void test_neighbours_are_complete(void)
{
    static uint32_t near_still[STILL];
    static uint32_t near_moving[MOVING];
    struct grid_near near = {.still = near_still, .moving = near_moving};
    for (int round = 0; round < 2; round++) {
        scatter_moving(round ? 20 : 8);
        size_t missed = 0;
        size_t twice = 0;
        for (uint32_t i = 0; i < MOVING; i++) {
            unsigned met_still[STILL] = {0};
            unsigned met_moving[MOVING] = {0};
            grid_near(&grid, i, moving[i].reach, &near);
            for (size_t k = 0; k < near.still_count; k++) {
                twice += met_still[near.still[k]]++;
            }
            for (size_t k = 0; k < near.moving_count; k++) {
                twice += met_moving[near.moving[k]]++;
                CU_ASSERT_FATAL(near.moving[k] > i);
            }
            /* Circles of the smaller half sizes touch for certain. */
            for (size_t k = 0; k < STILL; k++) {
                double apart = hypot(moving[i].x - still[k].x, moving[i].y - still[k].y);
                missed += !met_still[k] && apart < fmin(moving[i].half_x, moving[i].half_y) +
                                                       fmin(still[k].half_x, still[k].half_y);
            }
            for (size_t k = i + 1; k < MOVING; k++) {
                double apart = hypot(moving[i].x - moving[k].x, moving[i].y - moving[k].y);
                missed += !met_moving[k] && apart < fmin(moving[i].half_x, moving[i].half_y) +
                                                        fmin(moving[k].half_x, moving[k].half_y);
            }
        }
        CU_ASSERT_EQUAL(missed, 0);
        CU_ASSERT_EQUAL(twice, 0);
    }
}

static void test_from_inside_is_zero(void)
{
    struct solid box = solid_box((struct world_pose){1, 2, 0.3}, 1, 0.5);
    struct solid disc = solid_disc(-3, 0, 0.5);
    for (int k = 0; k < 8; k++) {
        double along[2] = {cos(k * M_PI / 4), sin(k * M_PI / 4)};
        CU_ASSERT_EQUAL(solid_ray(&box, (double[]){1.1, 2.1}, along, 5), 0);
        CU_ASSERT_EQUAL(solid_ray(&disc, (double[]){-3.2, 0.1}, along, 5), 0);
    }
}

static void test_eyes_see_what_returns_and_is_not_their_own(void)
{
    static struct grid lane;
    struct solid here[2] = {solid_disc(-5, -5, 1), solid_disc(9, 0, 1)};
    struct solid there[3] = {solid_disc(1, 0, 0.25), solid_disc(3, 0, 0.5), solid_disc(5, 0, 0.5)};
    struct world_look glass = {.stops = true, .shows = true, .fiducial = 7, .rgb = 0x123456};
    for (int i = 0; i < 3; i++) {
        there[i].owner = i;
    }
    there[1].owner = 0; /* carried by 0 */
    solid_look(&there[2], &glass);
    grid_init(&lane, here, 2, there, 3);
    const double from[2] = {1, 0};
    const double along[2] = {1, 0};
    const struct solid *hit;
    CU_ASSERT_EQUAL(grid_ray(&lane, 0, from, along, 20), 7);
    CU_ASSERT_EQUAL(grid_ray(&lane, GRID_NOBODY, from, along, 20), 0);
    struct grid_eye eye = {.self = 0, .returns = SOLID_SHOWS};
    CU_ASSERT_EQUAL(grid_find(&lane, eye, from, along, 20, &hit), 3.5);
    CU_ASSERT_PTR_EQUAL(hit, &there[2]);
    CU_ASSERT(hit->owner == 2 && hit->look.fiducial == 7 && hit->look.rgb == 0x123456);
    eye.self = 2;
    CU_ASSERT_EQUAL(grid_find(&lane, eye, (double[]){2, 0}, along, 20, &hit), 0.5);
    CU_ASSERT_PTR_EQUAL(hit, &there[1]);
    CU_ASSERT_EQUAL(grid_find(&lane, eye, (double[]){2, 0}, along, 0.25, &hit), 0.25);
    CU_ASSERT_PTR_NULL(hit);
    eye.returns = SOLID_ECHOES;
    CU_ASSERT_EQUAL(grid_find(&lane, eye, (double[]){6, 0}, along, 20, &hit), 2);
    CU_ASSERT_PTR_EQUAL(hit, &here[1]);
    CU_ASSERT_EQUAL(hit->owner, SOLID_NOBODY);
}

static void test_normals_stand_on_the_surface(void)
{
    struct solid box = solid_box((struct world_pose){1, 2, 0.3}, 1, 0.5);
    struct solid disc = solid_disc(-3, 0, 0.5);
    for (int k = 0; k < 64; k++) {
        double turn = k * M_PI / 32 + 0.01;
        double along[2] = {-cos(turn), -sin(turn)};
        const struct solid *both[2] = {&box, &disc};
        for (int n = 0; n < 2; n++) {
            double from[2] = {both[n]->x - 4 * along[0], both[n]->y - 4 * along[1]};
            double range = solid_ray(both[n], from, along, 10);
            double at[2] = {from[0] + range * along[0], from[1] + range * along[1]};
            double normal[2];
            solid_normal(both[n], at, normal);
            CU_ASSERT_DOUBLE_EQUAL(hypot(normal[0], normal[1]), 1, 1e-12);
            double out[2] = {at[0] + 1e-6 * normal[0], at[1] + 1e-6 * normal[1]};
            double back[2] = {-normal[0], -normal[1]};
            CU_ASSERT_DOUBLE_EQUAL(solid_ray(both[n], out, back, 1), 1e-6, 1e-9);
        }
    }
}

static void test_limit_cells(void)
{
    static struct grid wide;
    struct solid corners[2] = {solid_disc(-9e4, -9e4, 1), solid_disc(9e4, 9e4, 1)};
    grid_init(&wide, corners, 2, moving, 1);
    CU_ASSERT(wide.nx * wide.ny <= GRID_CELLS_MAX);
    double along[2] = {sqrt(0.5), sqrt(0.5)};
    double range = grid_ray(&wide, 0, (double[]){0, 0}, along, 1e9);
    CU_ASSERT_DOUBLE_EQUAL(range, 9e4 * sqrt(2) - 1, 1e-6);
    static struct grid empty;
    grid_init(&empty, NULL, 0, NULL, 0);
    CU_ASSERT_EQUAL(grid_ray(&empty, GRID_NOBODY, (double[]){0.1, 0.1}, along, 5), 5);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"rays equal brute force", test_rays_equal_brute_force},
        {"rays reach what left the grid", test_rays_reach_what_left_the_grid},
        {"neighbours are complete", test_neighbours_are_complete},
        {"from inside a solid: 0", test_from_inside_is_zero},
        {"eyes see what returns and is not their own",
         test_eyes_see_what_returns_and_is_not_their_own},
        {"normals stand on the surface", test_normals_stand_on_the_surface},
        {"limit: cells", test_limit_cells},
        CU_TEST_INFO_NULL,
    };
    mu_random_seed(&dice, 1, "grid");
    for (size_t i = 0; i < STILL; i++) {
        still[i] = any_solid(9);
    }
    for (size_t i = 0; i < MOVING; i++) {
        moving[i] = any_solid(9);
        moving[i].owner = (int32_t)i;
    }
    grid_init(&grid, still, STILL, moving, MOVING);
    return suite_run("sim/grid", tests);
}
