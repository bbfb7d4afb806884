/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file world.h
 * A world as its file describes it: what stands in it, and the bodies of its robots.
 *
 * Data only: nothing here moves.  The simulator builds its bodies from it, the report draws it.
 * All memory is taken at start-up; a loaded world lives as long as its process.
 * Lengths are metres, angles radians counter-clockwise, 0 along +x.
 */
#ifndef MUSTER_WORLD_WORLD_H
#define MUSTER_WORLD_WORLD_H

#include "core/fault.h"
#include "muster/limits.h"

#include <stdbool.h>
#include <stddef.h>

struct world_pose {
    double x_m, y_m, heading_rad;
};

/* A convex piece of solid matter: a box (half sizes) or a disc. */
enum world_shape_kind { WORLD_BOX, WORLD_DISC };

struct world_shape {
    enum world_shape_kind kind;
    struct world_pose pose;    /* of its centre */
    double half_x_m, half_y_m; /* box */
    double radius_m;           /* disc */
};

struct world_sonar {
    struct world_pose pose; /* in the robot's frame */
    double range_min_m, range_max_m;
    double fov_rad;
};

struct world_robot {
    char name[MU_NAME_MAX + 1];
    char color[32];                /* a CSS colour, or Stage's name of one */
    struct world_pose pose;        /* of its centre of rotation, where it starts */
    double length_m, width_m;      /* its outline: an oriented box */
    double origin_x_m, origin_y_m; /* the outline's centre in the robot's frame */
    double mass_kg;
    double forward_max_m_s, reverse_max_m_s; /* both >= 0 */
    double turn_max_rad_s;
    double forward_accel_m_s2, turn_accel_rad_s2;
    struct world_sonar sonars[MU_SONARS_MAX];
    size_t sonar_count;
};

struct world {
    char file[256];
    double min_x_m, min_y_m, max_x_m, max_y_m; /* a box around everything */
    struct world_shape *shapes;                /* static and solid: stop robots and sonar alike */
    size_t shape_count;
    struct world_robot *robots; /* as in the file, then as added; room for MU_ROBOTS_MAX */
    size_t robot_count;
    struct world_file *source; /* the parsed file: what its names define, for world_add_robot */
};

/**
 * Loads a world file in Stage's grammar (define, include, nested models, # comments) and units.
 *
 * Properties that muster does not support are named once each, as warnings on standard error
 * (quiet: not at all).
 *
 * @return MU_OK, or MU_FAULT_FILE with file, line, column and what was expected
 */
MU_MUST_USE mu_result world_load(struct world *world, const char *path, bool quiet,
                                 struct mu_fault *fault);

/**
 * Adds a robot of a kind that the world file defines, or moves the robot of that name.
 *
 * @param body   a name from a `define` of the world file, derived from Stage's `position`;
 *               NULL: the robot must stand in the world file already
 * @param pose   where it starts; NULL: where the world file has it
 * @return MU_OK; MU_FAULT_FILE when the body is unknown, the name is taken by something else, or
 *         there is no room (fault->text says which; file is the world's)
 */
MU_MUST_USE mu_result world_add_robot(struct world *world, const char *name, const char *body,
                                      const struct world_pose *pose, const char *color,
                                      struct mu_fault *fault);

/**
 * Looks for robots that overlap a wall or one another, or stand outside (libccd).
 *
 * @return MU_OK or MU_FAULT_FILE
 */
MU_MUST_USE mu_result world_check_places(const struct world *world, struct mu_fault *fault);

#endif
