/* SPDX-License-Identifier: Apache-2.0 */
/* The map that a process's robots share. */
#include "agent/robot.h"
#include "muster/memory.h"
#include "world/world_load.h"

#include <string.h>

/* Half a Pioneer, for a robot that does not stand in the world's file. */
static const double map_half_m = 0.19;

/* That much a robot wants to have beside it. */
static const double map_beside_m = 0.06;

mu_result robot_map_open(struct crew *c)
{
    struct mu_fault fault;
    if (!c->set->world) {
        return MU_OK;
    }
    struct distance_map *map = mu_startup_alloc(sizeof *map);
    c->world = mu_startup_alloc(sizeof *c->world);
    mu_result loaded = world_load(c->world, c->set->world, true, &fault);
    if (loaded != MU_OK) {
        mu_fault_print(&fault);
        return loaded;
    }
    distance_map_make(map, c->world);
    c->planner = planner_make(map);
    return MU_OK;
}

double robot_map_half_m(const struct robot *r)
{
    const struct world *world = r->crew->world;
    for (size_t i = 0; world && i < world->robot_count; i++) {
        if (strcmp(world->robots[i].name, r->name) == 0) {
            return world->robots[i].width_m / 2 + map_beside_m;
        }
    }
    return map_half_m + map_beside_m;
}
