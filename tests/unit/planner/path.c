/* SPDX-License-Identifier: Apache-2.0 */
/* Ways over the map of a world: round walls, clear of them, and none where there is none. */
#include "planner/planner.h"
#include "suite.h"
#include "world_text.h"

#include <math.h>

enum { PLANNERS = 16 };

static const double half_m = 0.25;
static struct planner *planners[PLANNERS]; /* memory for the life of the process */
static struct distance_map maps[PLANNERS];
static size_t made;

/* A floor of 10 x 10 m and what else is said; the map that goes with it is the last. */
static struct planner *floor_with(const char *text)
{
    char all[2048];
    snprintf(all, sizeof all, "model ( name \"floor\" size [10 10 1] boundary 1 )\n%s", text);
    const struct world *world = load(all);
    CU_ASSERT_PTR_NOT_NULL_FATAL(world);
    distance_map_make(&maps[made], world);
    planners[made] = planner_make(&maps[made]);
    return planners[made++];
}

static mu_result go(struct planner *p, double x0, double y0, double x1, double y1, struct path *out)
{
    return planner_search(p, (double[]){x0, y0}, (double[]){x1, y1}, half_m, out);
}

/* How near a way comes to something, looked at every centimetre. */
static double least_room(const struct distance_map *map, double x, double y, const struct path *way)
{
    double least = INFINITY;
    for (size_t i = 0; i < way->count; i++) {
        double dx = way->points_m[i][0] - x;
        double dy = way->points_m[i][1] - y;
        int parts = (int)(hypot(dx, dy) / 0.01) + 1;
        for (int k = 0; k <= parts; k++) {
            int cell = distance_map_cell(map, x + dx * k / parts, y + dy * k / parts);
            least = fmin(least, cell < 0 ? 0 : (double)map->room_m[cell]);
        }
        x += dx;
        y += dy;
    }
    return least;
}

static void test_straight_on(void)
{
    struct path way;
    CU_ASSERT_EQUAL(go(floor_with(""), -3, -3, 3.03, 2.51, &way), MU_OK);
    CU_ASSERT_EQUAL_FATAL(way.count, 1);
    CU_ASSERT_EQUAL(way.points_m[0][0], 3.03);
    CU_ASSERT_EQUAL(way.points_m[0][1], 2.51);
    CU_ASSERT_EQUAL(go(planners[made - 1], 1, 1, 1.01, 1.01, &way), MU_OK);
    CU_ASSERT_EQUAL_FATAL(way.count, 1);
    CU_ASSERT_EQUAL(way.points_m[0][0], 1.01);
}

static void test_round_a_wall(void)
{
    struct path way;
    struct planner *p = floor_with("model ( name \"wall\" size [6 0.2 1] pose [-2 0 0 0] )");
    CU_ASSERT_EQUAL(go(p, -3, -2, -3, 2, &way), MU_OK);
    CU_ASSERT(way.count >= 2);
    double most_x = -5;
    for (size_t i = 0; i < way.count; i++) {
        most_x = fmax(most_x, way.points_m[i][0]);
    }
    CU_ASSERT(most_x > 1.25); /* the wall ends at 1 */
    CU_ASSERT(least_room(&maps[made - 1], -3, -2, &way) >= half_m - 1e-6);
    CU_ASSERT_EQUAL(way.points_m[way.count - 1][0], -3);
    CU_ASSERT_EQUAL(way.points_m[way.count - 1][1], 2);
}

/* Of a narrow door and a wide one that is a little farther, the wide one; of the narrow one alone,
 * that; and of one that is narrower than the body, none. */
static void test_doors(void)
{
    struct path way;
    const char *two = "model ( name \"a\" size [2 0.2 1] pose [-4 0 0 0] )"
                      "model ( name \"b\" size [2 0.2 1] pose [-1.3 0 0 0] )"
                      "model ( name \"c\" size [3 0.2 1] pose [3.5 0 0 0] )";
    CU_ASSERT_EQUAL(go(floor_with(two), -1.6, -2, -1.6, 2, &way), MU_OK);
    CU_ASSERT(least_room(&maps[made - 1], -1.6, -2, &way) > 0.4);
    const char *one = "model ( name \"a\" size [2 0.2 1] pose [-4 0 0 0] )"
                      "model ( name \"b\" size [7.3 0.2 1] pose [1.35 0 0 0] )";
    CU_ASSERT_EQUAL(go(floor_with(one), -1.6, -2, -1.6, 2, &way), MU_OK);
    const char *slit = "model ( name \"a\" size [2 0.2 1] pose [-4 0 0 0] )"
                       "model ( name \"b\" size [7.6 0.2 1] pose [1.2 0 0 0] )";
    CU_ASSERT_EQUAL(go(floor_with(slit), -1.6, -2, -1.6, 2, &way), MU_ABSENT);
    CU_ASSERT_EQUAL(way.count, 0);
}

static void test_ends(void)
{
    struct path way;
    struct planner *p = floor_with("model ( name \"block\" size [2 2 1] pose [0 0 0 0] )");
    CU_ASSERT_EQUAL(go(p, -3, 0, 0, 0, &way), MU_ABSENT); /* inside */
    CU_ASSERT_EQUAL(go(p, -3, 0, 9, 0, &way), MU_ABSENT); /* outside */
    CU_ASSERT_EQUAL(go(p, 1e9, -1e300, 3, 0, &way), MU_ABSENT);
    CU_ASSERT_EQUAL(go(p, -1.1, 0, 3, 0, &way), MU_OK);  /* at the block's side */
    CU_ASSERT_EQUAL(go(p, -3, 0, 1.15, 0, &way), MU_OK); /* an end that is a bit too near */
    const double *end = way.points_m[way.count - 1];
    CU_ASSERT(hypot(end[0] - 1.15, end[1]) <= 0.25 && end[0] >= 1.2);
}

/* A comb of walls: the way has more corners than a route can have, and goes on from its end. */
/* It stands at the end of its way already: that is a way, of one point. */
static void test_beside_a_wall(void)
{
    struct path way;
    CU_ASSERT_EQUAL(go(floor_with(""), 4.7, 1, 4.85, 1, &way), MU_OK);
    CU_ASSERT_EQUAL_FATAL(way.count, 1);
    CU_ASSERT(fabs(way.points_m[0][0] - 4.7) < 0.11);
    CU_ASSERT_EQUAL(go(planners[made - 1], 4.7, 1, 4.99, 4.99, &way), MU_ABSENT);
}

static void test_many_corners(void)
{
    char text[2048] = "";
    size_t len = 0;
    for (int i = 0; i < 9; i++) {
        len += (size_t)snprintf(text + len, sizeof text - len,
                                "model ( name \"w%d\" size [0.1 9 1] pose [%d %g 0 0] )\n", i,
                                i - 4, i % 2 ? 0.5 : -0.5);
    }
    struct path way;
    struct path again;
    struct planner *p = floor_with(text);
    CU_ASSERT_EQUAL(go(p, -4.5, -4.5, 4.5, -4.5, &way), MU_OK);
    CU_ASSERT(way.count >= 18 && way.looked > 1000);
    CU_ASSERT(least_room(&maps[made - 1], -4.5, -4.5, &way) >= half_m - 1e-6);
    CU_ASSERT_EQUAL(go(p, -4.5, -4.5, 4.5, -4.5, &again), MU_OK);
    CU_ASSERT_EQUAL(again.count, way.count);
    CU_ASSERT_EQUAL(memcmp(way.points_m, again.points_m, way.count * sizeof way.points_m[0]), 0);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"straight on", test_straight_on},
        {"round a wall", test_round_a_wall},
        {"doors", test_doors},
        {"ends of a way", test_ends},
        {"many corners", test_many_corners},
        {"beside a wall", test_beside_a_wall},
        CU_TEST_INFO_NULL,
    };
    return suite_run("agent: ways", tests);
}
