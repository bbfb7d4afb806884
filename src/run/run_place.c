/* SPDX-License-Identifier: Apache-2.0 */
/* Where the robots of an experiment stand: the same world as the simulator's, and random places. */
#include "core/random.h"
#include "muster/memory.h"
#include "run/run.h"
#include "world/world_load.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PLACE_TRIES = 10000 };

/* Around a robot with a random place, so that it can begin to move. */
static const double PLACE_CLEAR_M = 0.1;

/* The world knows no place in a file of what an experiment has put there; the experiment does. */
static mu_result place_fault(const struct run *r, const struct experiment_robot *robot,
                             struct mu_fault *fault)
{
    struct mu_fault world = *fault;
    return world.line > 0 ? MU_FAULT_FILE
                          : mu_fault_at(fault, r->experiment->file, robot->mark.line,
                                        robot->mark.column, "%s (%s)", world.text, world.file);
}

static mu_result place_add(struct run *r, const struct experiment_robot *robot,
                           struct mu_fault *fault)
{
    struct world_pose pose = {0};
    if (robot->pose) {
        pose = (struct world_pose){robot->pose->x_m, robot->pose->y_m,
                                   robot->pose->heading_deg * M_PI / 180.0};
    }
    mu_result added = world_add_robot(r->world, robot->name, robot->body,
                                      robot->pose ? &pose : NULL, robot->color, fault);
    return added == MU_FAULT_FILE ? place_fault(r, robot, fault) : added;
}

static double place_between(struct mu_random *random, double from, double to)
{
    return from + mu_random_unit(random) * (to - from);
}

/* Draws until the robot stands clear of all that is there already. */
static mu_result place_draw(struct run *r, struct experiment_robot *robot, struct mu_random *random,
                            struct mu_fault *fault)
{
    struct world *w = r->world;
    double x0_m = w->min_x_m;
    double x1_m = w->max_x_m;
    double y0_m = w->min_y_m;
    double y1_m = w->max_y_m;
    robot->pose = mu_startup_alloc(sizeof *robot->pose);
    for (int i = 0; i < PLACE_TRIES; i++) {
        robot->pose->x_m = place_between(random, x0_m, x1_m);
        robot->pose->y_m = place_between(random, y0_m, y1_m);
        robot->pose->heading_deg = place_between(random, -180, 180);
        MU_TRY(place_add(r, robot, fault));
        if (world_robot_fits(w, robot->name, PLACE_CLEAR_M)) {
            return MU_OK;
        }
    }
    (void)mu_fault_at(fault, w->file, 0, 0, "no free place for robot '%s' in %d tries", robot->name,
                      PLACE_TRIES);
    return place_fault(r, robot, fault);
}

/* Looks at all of them together, when they are there. */
static mu_result places_check(const struct run *r, struct mu_fault *fault)
{
    const struct experiment *e = r->experiment;
    char begins[MU_NAME_MAX + sizeof "robot '' at "];
    mu_result checked = world_check_places(r->world, NULL, fault);
    for (unsigned i = 0; i < e->robots_count && checked == MU_FAULT_FILE; i++) {
        snprintf(begins, sizeof begins, "robot '%s' at ", e->robots[i].name);
        if (strncmp(fault->text, begins, strlen(begins)) == 0) {
            fault->line = e->robots[i].pose ? 0 : fault->line; /* the experiment has put it there */
            return place_fault(r, &e->robots[i], fault);
        }
    }
    return checked;
}

mu_result run_place(struct run *r, struct mu_fault *fault)
{
    const struct experiment *e = r->experiment;
    struct mu_random random;
    r->world = mu_startup_alloc(sizeof *r->world);
    struct world_options options = {.quiet = true, .seed = e->seed};
    MU_TRY(world_open(r->world, e->world, &options, fault));
    r->objects = mu_startup_array(r->world->object_count, sizeof *r->objects);
    for (unsigned i = 0; i < e->robots_count; i++) {
        if (!e->robots[i].place) {
            MU_TRY(place_add(r, &e->robots[i], fault));
        }
    }
    mu_random_seed(&random, e->seed, "places");
    for (unsigned i = 0; i < e->robots_count; i++) {
        if (e->robots[i].place) {
            MU_TRY(place_draw(r, &e->robots[i], &random, fault));
        }
    }
    return places_check(r, fault);
}
