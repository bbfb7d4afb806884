/* SPDX-License-Identifier: Apache-2.0 */
#include "world/model/world.h"

#include <string.h>

struct world_robot *world_find_robot(const struct world *world, const char *name)
{
    for (size_t i = 0; i < world->robot_count; i++) {
        if (strcmp(world->robots[i].name, name) == 0) {
            return &world->robots[i];
        }
    }
    return NULL;
}

bool world_has_object(const struct world *world, const char *name)
{
    for (size_t i = 0; i < world->object_count; i++) {
        if (strcmp(world->objects[i].name, name) == 0) {
            return true;
        }
    }
    return false;
}

bool world_name_taken(const struct world *world, const char *name)
{
    return world_has_object(world, name) || world_find_robot(world, name);
}
