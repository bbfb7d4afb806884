/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Fans of beams against single rays and against a test of all solids; vector units against one
 * another; completeness of a query.
 */
#include "sim/sensors/fan.h"
#include "core/hash.h"
#include "core/random.h"
#include "sim/geometry/geometry.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>

enum { STILL = 160, MOVING = 60, BEAMS = 361, SCENES = 40, RAYS = 27 };

static struct solid still[STILL];
static struct solid moving[MOVING];
static struct grid grid;
static struct gather gather;
static struct gather_list list;
static struct mu_random dice;

static double between(double lo, double hi)
{
    return lo + (hi - lo) * mu_random_unit(&dice);
}

static struct solid any_solid(double side_m, double large_m)
{
    double x = between(-side_m, side_m);
    double y = between(-side_m, side_m);
    double turn = mu_random_unit(&dice) < 0.3 ? M_PI / 2 : between(-M_PI, M_PI);
    double a = between(0.02, large_m);
    double b = between(0.02, 0.4);
    struct solid solid = mu_random_unit(&dice) < 0.4
                             ? solid_disc(x, y, b)
                             : solid_box((struct world_pose){x, y, turn}, a, b);
    solid.returns = (uint32_t)mu_random_between(&dice, 0, SOLID_ALL);
    return solid;
}

static void scatter_moving(double side_m)
{
    for (int i = 0; i < MOVING; i++) {
        struct solid there = any_solid(side_m, 1);
        moving[i].x = there.x;
        moving[i].y = there.y;
        moving[i].returns = there.returns;
        moving[i].owner = i % 7 == 3 ? i - 1 : i; /* some are carried by another one */
    }
    grid_update(&grid);
    gather_update(&gather);
}

struct scene {
    struct fan_table table;
    struct fan_eye eye;
    int32_t self;
};

/* Tables are kept, as their memory cannot be released. */
static struct fan_table tables[8];

static struct scene any_scene(double side_m)
{
    struct scene scene = {.table = tables[mu_random_between(&dice, 0, 7)]};
    double heading = mu_random_unit(&dice) < 0.2 ? M_PI / 2 : between(-M_PI, M_PI);
    double c = cos(heading);
    double s = sin(heading);
    double x = between(-side_m, side_m);
    double y = between(-side_m, side_m);
    double range = between(0.5, 9);
    scene.eye = (struct fan_eye){x, y, c, s, range, 1u << mu_random_between(&dice, 0, 2)};
    scene.self = (int32_t)mu_random_between(&dice, 0, MOVING - 1);
    return scene;
}

static void collect(const struct scene *scene)
{
    struct gather_circle circle = {scene->eye.x, scene->eye.y, scene->eye.range_m};
    gather_near(&gather, &circle, scene->self, &list);
}

static void along_of(const struct scene *scene, uint32_t beam, double along[2])
{
    double bx = scene->table.along_x[beam];
    double by = scene->table.along_y[beam];
    along[0] = scene->eye.c * bx - scene->eye.s * by;
    along[1] = scene->eye.s * bx + scene->eye.c * by;
}

static double brute_force(const struct scene *scene, const double along[2])
{
    const double from[2] = {scene->eye.x, scene->eye.y};
    double best = scene->eye.range_m;
    for (int i = 0; i < STILL + MOVING; i++) {
        const struct solid *solid = i < STILL ? &still[i] : &moving[i - STILL];
        bool own = solid->owner == scene->self;
        if ((solid->returns & scene->eye.returns) && !own) {
            best = solid_ray(solid, from, along, best);
        }
    }
    return best;
}

static double ranges[BEAMS + FAN_PAD];
static int64_t hits[BEAMS + FAN_PAD];

static size_t met;

/* @return how many beams differ from single rays */
static size_t beams_wrong(const struct scene *scene)
{
    size_t wrong = 0;
    const double from[2] = {scene->eye.x, scene->eye.y};
    struct grid_eye eye = {scene->self, scene->eye.returns};
    for (uint32_t k = 0; k < scene->table.count; k++) {
        double along[2];
        const struct solid *hit;
        along_of(scene, k, along);
        double range = grid_find(&grid, eye, from, along, scene->eye.range_m, &hit);
        bool same = fabs(range - ranges[k]) < 1e-9;
        same = same && fabs(brute_force(scene, along) - ranges[k]) < 1e-9;
        if (range < scene->eye.range_m - 1e-9) {
            const struct solid *met_solid = gather_solid(&gather, hits[k]);
            /* where two solids overlap, both may be hit */
            same = same && hits[k] != FAN_NOTHING &&
                   fabs(solid_ray(met_solid, from, along, 99) - range) < 1e-9;
            met++;
        } else {
            same = same && (hits[k] == FAN_NOTHING || ranges[k] > scene->eye.range_m - 1e-9);
        }
        wrong += !same;
    }
    return wrong;
}

static void test_fans_equal_single_rays(void)
{
    size_t wrong = 0;
    for (size_t n = 0; fan_name(n); n++) {
        CU_ASSERT_TRUE_FATAL(fan_choose(fan_name(n)));
        CU_ASSERT_STRING_EQUAL(fan_kernel()->name, fan_name(n));
        met = 0;
        for (int round = 0; round < SCENES; round++) {
            scatter_moving(round % 4 == 3 ? 20 : 9);
            for (int k = 0; k < 5; k++) {
                struct scene scene = any_scene(round % 4 == 3 ? 16 : 10);
                collect(&scene);
                fan_kernel()->sweep(&scene.table, &scene.eye, &list.solids, ranges, hits);
                wrong += beams_wrong(&scene);
            }
        }
        CU_ASSERT(met > 5000);
    }
    CU_ASSERT_EQUAL(wrong, 0);
}

/* @return a hash of all ranges and hits of the same scenes */
static uint64_t bits_of_scenes(const char *name, uint64_t seed)
{
    uint64_t hash = MU_HASH_EMPTY;
    CU_ASSERT_TRUE_FATAL(fan_choose(name));
    mu_random_seed(&dice, seed, "bits");
    for (int round = 0; round < SCENES; round++) {
        scatter_moving(9);
        struct scene scene = any_scene(10);
        collect(&scene);
        hash = mu_hash_bytes(hash, list.solids.id, list.solids.count * sizeof *list.solids.id);
        for (int asked = 0; asked < 2; asked++) {
            fan_kernel()->sweep(&scene.table, &scene.eye, &list.solids, ranges,
                                asked ? hits : NULL);
            hash = mu_hash_bytes(hash, ranges, scene.table.count * sizeof ranges[0]);
        }
        hash = mu_hash_bytes(hash, hits, scene.table.count * sizeof hits[0]);
    }
    return hash;
}

static void test_every_vector_unit_gives_the_same_bits(void)
{
    for (uint64_t seed = 1; seed < 6; seed++) {
        uint64_t first = bits_of_scenes("portable", seed);
        CU_ASSERT_NOT_EQUAL(first, bits_of_scenes("portable", seed + 100));
        for (size_t n = 0; fan_name(n); n++) {
            CU_ASSERT_EQUAL(bits_of_scenes(fan_name(n), seed), first);
        }
    }
}

/* --- rays with any start ---------------------------------------------------------------------- */

static void any_rays(struct fan_rays *rays, const struct scene *scene)
{
    rays->count = (size_t)mu_random_between(&dice, 1, RAYS);
    rays->returns = scene->eye.returns;
    for (size_t k = 0; k < RAYS + FAN_PAD; k++) {
        double turn = mu_random_unit(&dice) < 0.2 ? M_PI / 2 : between(-M_PI, M_PI);
        rays->from_x[k] = scene->eye.x + between(-0.3, 0.3);
        rays->from_y[k] = scene->eye.y + between(-0.3, 0.3);
        rays->along_x[k] = cos(turn);
        rays->along_y[k] = sin(turn);
        rays->range_m[k] = between(0, scene->eye.range_m);
    }
}

/* @return the range of one ray, by a test of all solids */
static double range_alone(const struct fan_rays *rays, size_t k, int32_t self, double best)
{
    const double from[2] = {rays->from_x[k], rays->from_y[k]};
    const double along[2] = {rays->along_x[k], rays->along_y[k]};
    for (int i = 0; i < STILL + MOVING; i++) {
        const struct solid *solid = i < STILL ? &still[i] : &moving[i - STILL];
        if ((solid->returns & rays->returns) && solid->owner != self) {
            best = solid_ray(solid, from, along, best);
        }
    }
    return best;
}

/* Compares batches with single rays, and counts rays and hits.  @return how many rays differ */
static size_t rays_wrong(struct fan_rays *rays, size_t *cast, size_t *hit)
{
    static double limit_m[RAYS];
    struct scene scene = any_scene(10);
    size_t wrong = 0;
    any_rays(rays, &scene);
    memcpy(limit_m, rays->range_m, sizeof limit_m);
    struct gather_circle circle = {scene.eye.x, scene.eye.y, scene.eye.range_m + 0.5};
    if (!gather_cast(&gather, &circle, scene.self, rays, list.found)) {
        return memcmp(limit_m, rays->range_m, sizeof limit_m) != 0;
    }
    for (size_t k = 0; k < rays->count; k++) {
        double alone = range_alone(rays, k, scene.self, limit_m[k]);
        wrong += rays->range_m[k] != alone; /* to the last bit */
        *hit += alone < limit_m[k];
    }
    *cast += rays->count;
    return wrong;
}

static void test_rays_at_once_equal_rays_alone(void)
{
    struct fan_rays rays;
    fan_rays_init(&rays, RAYS + FAN_PAD);
    for (size_t n = 0; fan_name(n); n++) {
        size_t wrong = 0;
        size_t cast = 0;
        size_t hit = 0;
        CU_ASSERT_TRUE_FATAL(fan_choose(fan_name(n)));
        for (int round = 0; round < 400; round++) {
            scatter_moving(round % 4 == 3 ? 20 : 9);
            wrong += rays_wrong(&rays, &cast, &hit);
        }
        CU_ASSERT_EQUAL(wrong, 0);
        CU_ASSERT(cast > 800 && hit > 200);
    }
}

static void test_too_much_that_is_near_is_refused(void)
{
    struct fan_rays rays;
    fan_rays_init(&rays, 1);
    rays.count = 1;
    rays.range_m[0] = 100;
    rays.along_x[0] = 1;
    CU_ASSERT_TRUE_FATAL(fan_choose("portable"));
    CU_ASSERT(fan_kernel()->crowd < STILL + MOVING);
    struct gather_circle circle = {0, 0, 0.1};
    CU_ASSERT_TRUE(gather_cast(&gather, &circle, GRID_NOBODY, &rays, list.found));
    circle.reach_m = 100;
    rays.range_m[0] = 100;
    CU_ASSERT_FALSE(gather_cast(&gather, &circle, GRID_NOBODY, &rays, list.found));
    CU_ASSERT_EQUAL(rays.range_m[0], 100);
}

static void test_unknown_vector_units_are_refused(void)
{
    const char *before = fan_kernel()->name;
    CU_ASSERT_FALSE(fan_choose("abacus"));
    CU_ASSERT_STRING_EQUAL(fan_kernel()->name, before);
}

/* @return the distance of a solid from a point */
static double apart(const struct solid *solid, double x, double y)
{
    double gx = x - solid->x;
    double gy = y - solid->y;
    double lx = fabs(solid->c * gx + solid->s * gy) - solid->half_x;
    double ly = fabs(solid->c * gy - solid->s * gx) - solid->half_y;
    double box = hypot(fmax(lx, 0), fmax(ly, 0));
    return solid->kind == WORLD_DISC ? fmax(0, hypot(gx, gy) - solid->half_x) : box;
}

static void test_collections_are_complete_and_say_each_once(void)
{
    for (int round = 0; round < 60; round++) {
        bool far = round % 3 == 2; /* both the scanner and the solids are outside the tiles */
        scatter_moving(far ? 60 : 9);
        struct scene scene = any_scene(far ? 60 : 10);
        scene.eye.range_m = between(0.1, far ? 40 : 8);
        collect(&scene);
        unsigned seen[STILL + MOVING] = {0};
        for (size_t k = 0; k < list.solids.count; k++) {
            seen[list.solids.id[k]]++;
        }
        for (int i = 0; i < STILL + MOVING; i++) {
            const struct solid *solid = i < STILL ? &still[i] : &moving[i - STILL];
            double far_m = apart(solid, scene.eye.x, scene.eye.y);
            if (solid->owner == scene.self || far_m > scene.eye.range_m * 1.5) {
                CU_ASSERT_EQUAL(seen[i], 0);
            } else {
                CU_ASSERT_EQUAL(seen[i], far_m <= scene.eye.range_m ? 1u : seen[i] & 1);
            }
        }
    }
}

static void test_nothing_near_and_a_scanner_inside(void)
{
    static double few[16];
    static int64_t which[16];
    struct gather_solids none = {0};
    struct fan_table table;
    fan_table_init(&table, -1, 0.2, 11);
    struct fan_eye eye = {.c = 1, .range_m = 3, .returns = SOLID_ECHOES};
    fan_kernel()->sweep(&table, &eye, &none, few, which);
    for (int k = 0; k < 11; k++) {
        CU_ASSERT(few[k] == 3 && which[k] == FAN_NOTHING);
    }
    eye.x = still[0].x;
    eye.y = still[0].y;
    eye.returns = still[0].returns = SOLID_ALL;
    gather_init(&gather, still, STILL, moving, MOVING);
    gather_near(&gather, &(struct gather_circle){eye.x, eye.y, 3}, GRID_NOBODY, &list);
    fan_kernel()->sweep(&table, &eye, &list.solids, few, which);
    for (int k = 0; k < 11; k++) {
        CU_ASSERT(few[k] == 0 && which[k] != FAN_NOTHING);
    }
}

static void tables_prepare(void)
{
    const double fov_deg[8] = {180, 360, 1, 60, 270, 359, 90, 10};
    for (int k = 0; k < 8; k++) {
        uint32_t count = k == 2 ? BEAMS : (uint32_t)(5 + 51 * k);
        count = count > BEAMS ? BEAMS : count;
        double fov = fov_deg[k] * M_PI / 180;
        fan_table_init(&tables[k], -fov / 2, fov / (count - 1), count);
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"fans equal single rays", test_fans_equal_single_rays},
        {"every vector unit gives the same bits", test_every_vector_unit_gives_the_same_bits},
        {"rays at once equal rays alone", test_rays_at_once_equal_rays_alone},
        {"too much that is near is refused", test_too_much_that_is_near_is_refused},
        {"unknown vector units are refused", test_unknown_vector_units_are_refused},
        {"collections are complete and say each once",
         test_collections_are_complete_and_say_each_once},
        {"nothing near, and a scanner inside", test_nothing_near_and_a_scanner_inside},
        CU_TEST_INFO_NULL,
    };
    mu_random_seed(&dice, 1, "fan");
    for (size_t i = 0; i < STILL; i++) {
        still[i] = any_solid(9, i < 10 ? 9 : 1.2);
    }
    for (size_t i = 0; i < MOVING; i++) {
        moving[i] = any_solid(9, 1);
    }
    grid_init(&grid, still, STILL, moving, MOVING);
    gather_init(&gather, still, STILL, moving, MOVING);
    gather_list_init(&list, &gather);
    tables_prepare();
    return suite_run("sim/fan", tests);
}
