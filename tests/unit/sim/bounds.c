/* SPDX-License-Identifier: Apache-2.0 */
/* The bounds of a world: whether it is closed, and where it ends. */
#include "sim/engine/engine_core.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <stdlib.h>

enum { WALLS = 4 };

static struct bounds bounds;

/* Four walls around 10 m by 6 m; the wall on the right ends `gap` metres short. */
static uint32_t returns = SOLID_ALL; /* of the wall on the right */

static void measure(double gap, double body_m, size_t count)
{
    struct solid walls[WALLS] = {
        solid_box((struct world_pose){0, 3.1, 0}, 5.2, 0.1),
        solid_box((struct world_pose){0, -3.1, M_PI}, 5.2, 0.1),
        solid_box((struct world_pose){-5.1, 0, M_PI / 2}, 3.2, 0.1),
        solid_box((struct world_pose){5.1, -gap / 2, 0}, 0.1, 3 - gap / 2),
    };
    walls[3].returns = returns;
    bounds_measure(&bounds, walls, count, body_m);
}

static void test_four_walls_close_a_world(void)
{
    measure(0, 0.1, WALLS);
    CU_ASSERT_TRUE(bounds.closed);
    CU_ASSERT_TRUE(bounds_holds(&bounds, 5.1, -3.1));
    CU_ASSERT_FALSE(bounds_holds(&bounds, 5.21, 0));
    CU_ASSERT_FALSE(bounds_holds(&bounds, 0, -3.21));
    CU_ASSERT_FALSE(bounds_holds(&bounds, (double)NAN, 0));
    CU_ASSERT_FALSE(bounds_holds(&bounds, 0, (double)INFINITY));
    measure(0.3, 0.38, WALLS); /* no way out for wider bodies */
    CU_ASSERT_TRUE(bounds.closed);
}

static void test_a_way_out_opens_it(void)
{
    measure(0.5, 0.38, WALLS);
    CU_ASSERT_FALSE(bounds.closed);
    CU_ASSERT_TRUE(bounds_holds(&bounds, 900, 900));
    CU_ASSERT_FALSE(bounds_holds(&bounds, 1e9, 0));
    for (size_t count = 0; count < WALLS; count++) {
        measure(0, 0.38, count);
        CU_ASSERT_FALSE(bounds.closed && count != 1); /* one wall alone is a closed box */
    }
}

static void test_a_wall_that_stops_nobody_is_a_way_out(void)
{
    returns = SOLID_ECHOES | SOLID_SHOWS;
    measure(0, 0.1, WALLS);
    CU_ASSERT_FALSE(bounds.closed);
    CU_ASSERT_TRUE(bounds_holds(&bounds, 6, 0));
    returns = SOLID_ALL;
}

static void test_who_starts_outside_opens_it(void)
{
    measure(0, 0.1, WALLS);
    bounds_include(&bounds, 4, 2);
    CU_ASSERT_TRUE(bounds.closed);
    bounds_include(&bounds, 7, 2);
    CU_ASSERT_FALSE(bounds.closed);
    CU_ASSERT_TRUE(bounds_holds(&bounds, 7, 2));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"four walls close a world", test_four_walls_close_a_world},
        {"a way out opens it", test_a_way_out_opens_it},
        {"a wall that stops nobody is a way out", test_a_wall_that_stops_nobody_is_a_way_out},
        {"who starts outside opens it", test_who_starts_outside_opens_it},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/bounds", tests);
}
