/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts: some computed by hand, and thousands of random pairs against libccd. */
#include "core/random.h"
#include "sim/geometry/geometry.h"
#include "suite.h"

#include <ccd/ccd.h>
#include <ccd/vec3.h>
#include <CUnit/Basic.h>
#include <math.h>

/* libccd approximates round shapes in steps: it may miss a shallower overlap. */
#define CCD_ROUND_M 5e-3

#define NEAR(a, b) CU_ASSERT_DOUBLE_EQUAL(a, b, 1e-12)

static void support(const void *object, const ccd_vec3_t *d, ccd_vec3_t *point)
{
    const struct solid *s = object;
    double dx = d->v[0];
    double dy = d->v[1];
    double len = hypot(dx, dy);
    double x = s->c * dx + s->s * dy < 0 ? -s->half_x : s->half_x;
    double y = s->c * dy - s->s * dx < 0 ? -s->half_y : s->half_y;
    double px = s->c * x - s->s * y;
    double py = s->s * x + s->c * y;
    if (s->kind == WORLD_DISC) {
        px = len > 1e-12 ? s->half_x * dx / len : 0;
        py = len > 1e-12 ? s->half_x * dy / len : 0;
    }
    ccdVec3Set(point, s->x + px, s->y + py, d->v[2] < 0 ? -0.5 : 0.5);
}

static void center(const void *object, ccd_vec3_t *at)
{
    const struct solid *s = object;
    ccdVec3Set(at, s->x, s->y, 0);
}

static bool ccd_overlaps(const struct solid *a, const struct solid *b)
{
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = support;
    ccd.support2 = support;
    ccd.center1 = center;
    ccd.center2 = center;
    ccd.max_iterations = 100;
    return ccdGJKIntersect(a, b, &ccd) != 0;
}

static void test_side_by_side(void)
{
    struct solid a = solid_box((struct world_pose){0, 0, 0}, 1, 1);
    struct solid b = solid_box((struct world_pose){1.9, 0.5, 0}, 1, 1);
    struct narrow_contact c;
    narrow_collide(&a, &b, &c);
    CU_ASSERT_EQUAL_FATAL(c.count, 2);
    NEAR(c.normal_x, -1); /* from b to a */
    NEAR(c.normal_y, 0);
    NEAR(c.points[0].depth, 0.1);
    NEAR(c.points[1].depth, 0.1);
    NEAR(fmin(c.points[0].y, c.points[1].y), -0.5);
    NEAR(fmax(c.points[0].y, c.points[1].y), 1);
}

static void test_corner_in_side(void)
{
    struct solid a = solid_box((struct world_pose){0, 0, 0}, 1, 1);
    struct solid b = solid_box((struct world_pose){0, 0.95 + sqrt(2), M_PI / 4}, 1, 1);
    struct narrow_contact c;
    narrow_collide(&a, &b, &c);
    CU_ASSERT_EQUAL_FATAL(c.count, 1);
    NEAR(c.normal_y, -1);
    NEAR(c.points[0].depth, 0.05);
    NEAR(c.points[0].y, 0.95);
}

static void test_discs_and_boxes(void)
{
    struct solid box = solid_box((struct world_pose){0, 0, M_PI / 2}, 2, 1);
    struct solid disc = solid_disc(1.4, 0, 0.5);
    struct solid other = solid_disc(1.4, 0.8, 0.5);
    struct narrow_contact c;
    narrow_collide(&box, &disc, &c);
    CU_ASSERT_EQUAL_FATAL(c.count, 1);
    NEAR(c.normal_x, -1);
    NEAR(c.points[0].depth, 0.1);
    NEAR(c.points[0].x, 1);
    narrow_collide(&disc, &box, &c);
    CU_ASSERT_EQUAL_FATAL(c.count, 1);
    NEAR(c.normal_x, 1);
    narrow_collide(&disc, &other, &c);
    CU_ASSERT_EQUAL_FATAL(c.count, 1);
    NEAR(c.normal_y, -1);
    NEAR(c.points[0].depth, 0.2);
    NEAR(c.points[0].y, 0.4);
    struct solid inside = solid_disc(0.7, 0.1, 0.2); /* its middle is inside the box */
    narrow_collide(&box, &inside, &c);
    CU_ASSERT_EQUAL_FATAL(c.count, 1);
    NEAR(c.normal_x, -1);
    NEAR(c.points[0].depth, 0.5);
    narrow_collide(&disc, &disc,
                   &c); /* one on top of the other: any direction will do, but no NaN */
    NEAR(hypot(c.normal_x, c.normal_y), 1);
}

static struct solid any_solid(struct mu_random *dice)
{
    struct world_pose pose;
    pose.x_m = mu_random_unit(dice) * 2;
    pose.y_m = mu_random_unit(dice) * 2;
    pose.heading_rad = mu_random_unit(dice) * 2 * M_PI;
    double a = 0.05 + mu_random_unit(dice) * 0.6;
    double b = 0.05 + mu_random_unit(dice) * 0.6;
    return mu_random_unit(dice) < 0.3 ? solid_disc(pose.x_m, pose.y_m, a) : solid_box(pose, a, b);
}

static void test_any_pair_as_libccd(void)
{
    struct mu_random dice;
    mu_random_seed(&dice, 1, "narrow");
    size_t unequal = 0;
    size_t touching = 0;
    size_t not_apart = 0;
    size_t too_far = 0;
    for (size_t i = 0; i < 100000; i++) {
        struct solid a = any_solid(&dice);
        struct solid b = any_solid(&dice);
        struct narrow_contact c;
        narrow_collide(&a, &b, &c);
        unequal += (c.count > 0) != ccd_overlaps(&a, &b);
        if (c.count == 0) {
            continue;
        }
        touching++;
        double depth = 0;
        for (size_t k = 0; k < c.count; k++) {
            depth = fmax(depth, c.points[k].depth);
        }
        /*
         * Moved by the depth along the normal they are apart; moved by a little less they are not.
         */
        struct solid moved = a;
        moved.x += c.normal_x * (depth + 1e-6);
        moved.y += c.normal_y * (depth + 1e-6);
        not_apart += ccd_overlaps(&moved, &b);
        double less = a.kind == WORLD_BOX && b.kind == WORLD_BOX ? 1e-4 : CCD_ROUND_M;
        moved.x = a.x + c.normal_x * (depth - less);
        moved.y = a.y + c.normal_y * (depth - less);
        too_far += depth > less && !ccd_overlaps(&moved, &b);
    }
    CU_ASSERT_EQUAL(unequal, 0);
    CU_ASSERT_EQUAL(not_apart, 0);
    CU_ASSERT_EQUAL(too_far, 0);
    CU_ASSERT(touching > 20000);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"side by side", test_side_by_side},
        {"a corner in a side", test_corner_in_side},
        {"discs and boxes", test_discs_and_boxes},
        {"any pair, as libccd", test_any_pair_as_libccd},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/narrow", tests);
}
