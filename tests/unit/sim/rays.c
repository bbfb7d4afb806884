/* SPDX-License-Identifier: Apache-2.0 */
/* A million rays through the grid, compared with ODE's rays, which use no grid. */
#include "core/random.h"
#include "sim/geometry/geometry.h"
#include "suite.h"

#include <math.h>
#include <ode/ode.h>

enum { STILL = 40, MOVING = 20, SCENES = 20, RAYS = 50000 };

#define SIDE_M  8.0
#define RANGE_M 8.0
#define CLOSE_M 1e-9

static struct solid still[STILL];
static struct solid moving[MOVING];
static struct mu_random dice;
static dSpaceID space;
static dGeomID beam;

static double between(double lo, double hi)
{
    return lo + (hi - lo) * mu_random_unit(&dice);
}

static struct solid any_solid(void)
{
    double x = between(-SIDE_M, SIDE_M);
    double y = between(-SIDE_M, SIDE_M);
    double turn = mu_random_unit(&dice) < 0.3 ? M_PI / 2 : between(-M_PI, M_PI);
    double half_x = between(0.05, 1.0);
    double half_y = between(0.05, 0.5);
    return mu_random_unit(&dice) < 0.4 ? solid_disc(x, y, half_y)
                                       : solid_box((struct world_pose){x, y, turn}, half_x, half_y);
}

/* Adds the same shape, 2 m high, to ODE: an upright cylinder or a box. */
static void geom_add(const struct solid *solid)
{
    bool disc = solid->kind == WORLD_DISC;
    dGeomID geom = disc ? dCreateCylinder(space, solid->half_x, 2)
                        : dCreateBox(space, 2 * solid->half_x, 2 * solid->half_y, 2);
    dMatrix3 turn = {solid->c, -solid->s, 0, 0, solid->s, solid->c, 0, 0, 0, 0, 1, 0};
    dGeomSetPosition(geom, solid->x, solid->y, 0);
    dGeomSetRotation(geom, turn);
}

static void scene_make(struct grid *grid)
{
    for (size_t i = 0; i < STILL; i++) {
        still[i] = any_solid();
        geom_add(&still[i]);
    }
    for (size_t i = 0; i < MOVING; i++) {
        moving[i] = any_solid();
        geom_add(&moving[i]);
    }
    grid_init(grid, still, STILL, moving, MOVING);
}

static void take_nearest(void *best, dGeomID a, dGeomID b)
{
    dContactGeom contact;
    if (dCollide(a, b, 1, &contact, sizeof contact) > 0 && contact.depth < *(double *)best) {
        *(double *)best = contact.depth;
    }
}

static double ode_ray(const double from[2], const double along[2], double range_m)
{
    double best = range_m;
    dGeomRaySetLength(beam, range_m);
    dGeomRaySet(beam, from[0], from[1], 0, along[0], along[1], 0);
    dSpaceCollide2(beam, (dGeomID)space, &best, take_nearest);
    return best;
}

static bool in_free_space(const struct grid *grid, const double from[2])
{
    return grid_ray(grid, GRID_NOBODY, from, (double[2]){1, 0}, 1e-3) > 0;
}

static void test_a_million_rays_as_ode(void)
{
    int different = 0;
    int hits = 0;
    mu_random_seed(&dice, 1, "rays");
    for (int scene = 0; scene < SCENES; scene++) {
        struct grid grid;
        space = dSimpleSpaceCreate(NULL);
        scene_make(&grid);
        for (int ray = 0; ray < RAYS;) {
            double from[2] = {between(-SIDE_M, SIDE_M), between(-SIDE_M, SIDE_M)};
            double turn = between(-M_PI, M_PI);
            double along[2] = {cos(turn), sin(turn)};
            if (!in_free_space(&grid, from)) {
                continue;
            }
            double ours = grid_ray(&grid, GRID_NOBODY, from, along, RANGE_M);
            different += !(fabs(ours - ode_ray(from, along, RANGE_M)) <= CLOSE_M);
            hits += ours < RANGE_M;
            ray++;
        }
        dSpaceDestroy(space);
    }
    CU_ASSERT_EQUAL(different, 0);
    CU_ASSERT(hits > SCENES * RAYS / 2);
}

int main(void)
{
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    beam = dCreateRay(NULL, RANGE_M);
    CU_TestInfo tests[] = {{"a million rays as ODE's", test_a_million_rays_as_ode},
                           CU_TEST_INFO_NULL};
    int code = suite_run("rays", tests);
    dGeomDestroy(beam);
    dCloseODE();
    return code;
}
