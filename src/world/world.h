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
#include <stdint.h>

/* The sensors that cost something: each is read only if a controller asks for it. */
enum world_sensor { WORLD_SONAR, WORLD_LASER, WORLD_CAMERA, WORLD_FIDUCIALS, WORLD_SENSORS };

struct world_pose {
    double x_m, y_m, heading_rad;
};

/* How a thing looks to bodies and sensors: Stage's "returns". */
struct world_look {
    uint32_t rgb;     /* 0xRRGGBB */
    bool stops;       /* bodies bump into it (obstacle_return) */
    bool echoes;      /* sonar and laser see it (ranger_return not below 0) */
    bool shows;       /* the camera sees it (blob_return) */
    bool graspable;   /* a gripper can take it (gripper_return) */
    int32_t fiducial; /* that the fiducial finder reads; 0: it bears none */
    double give_w;    /* power that it charges robots with; 0: none */
};

/* A convex piece of solid matter: a box (half sizes) or a disc. */
enum world_shape_kind { WORLD_BOX, WORLD_DISC };

struct world_shape {
    enum world_shape_kind kind;
    struct world_pose pose;    /* of its centre */
    double half_x_m, half_y_m; /* box */
    double radius_m;           /* disc */
    struct world_look look;
};

/* A thing that can be pushed, and taken by a gripper if it is graspable: one convex shape. */
struct world_object {
    char name[MU_NAME_MAX + 1];
    struct world_shape shape; /* where it starts */
    double mass_kg, friction; /* against the floor, as a share of its weight */
};

/* How readings of a range are falsified: normal, with these standard deviations; 0: exact. */
struct world_noise {
    double constant_m, per_m, angle_rad;
};

struct world_sonar {
    struct world_pose pose; /* in the robot's frame */
    double range_min_m, range_max_m;
    double fov_rad;
    uint32_t rays;       /* over the cone, the nearest echo counts; 1: its middle alone */
    double specular_rad; /* beyond this angle of incidence an echo is lost; 0: none is */
    struct world_noise noise;
};

/* A scanner of one beam per sample, from right to left over its field of view. */
struct world_laser {
    struct world_pose pose;
    double range_min_m, range_max_m;
    double fov_rad;
    uint32_t samples; /* 0: the robot has none; at most MU_BEAMS_MAX */
    struct world_noise noise;
};

/* A camera that finds blobs of colour: Stage's blobfinder. */
struct world_camera {
    struct world_pose pose;
    double range_m, fov_rad;
    uint32_t columns, rows;         /* of its picture; 0 columns: the robot has none */
    uint32_t colors[MU_COLORS_MAX]; /* that it looks for, 0xRRGGBB */
    size_t color_count;             /* 0: all */
};

/* Reads numbers off things that bear one: Stage's fiducial. */
struct world_fiducial_finder {
    struct world_pose pose;
    double range_min_m, range_max_m; /* range_max_m 0: the robot has none */
    double range_id_m;               /* up to here the number is read, beyond it is 0 */
    double fov_rad;
};

/*
 * Two paddles with two break beams between them, at the front of its case: Stage's gripper.
 * Open, the paddles' outer sides are in line with the case's.
 */
struct world_gripper {
    struct world_pose pose;   /* of its case's middle, without the paddles */
    double length_m, width_m; /* of the case; length_m 0: the robot has none */
    double paddle_length_m, paddle_width_m;
    bool starts_closed, starts_lifted;
};

/* What the odometer makes of the wheels: a systematic error for each robot, and slip. */
struct world_odometry {
    double forward_error, side_error,
        turn_error;          /* shares: the gains are drawn within half of them */
    struct world_pose start; /* that it reads at the start */
    bool true_start;         /* it starts with the true pose */
};

struct world_robot {
    char name[MU_NAME_MAX + 1];
    char color[32]; /* a CSS colour, or Stage's name of one */
    struct world_look look;
    struct world_pose pose;        /* of its centre of rotation, where it starts */
    double length_m, width_m;      /* its outline: an oriented box */
    double origin_x_m, origin_y_m; /* the outline's centre in the robot's frame */
    double mass_kg;
    double forward_max_m_s, reverse_max_m_s; /* both >= 0 */
    double turn_max_rad_s;
    double forward_accel_m_s2, turn_accel_rad_s2;
    bool reads_odometer; /* its position is what the odometer says (localization "odom") */
    struct world_odometry odometry;
    double gps_noise_m,
        gps_drift_m; /* of the absolute position; the drift per square root of 1 s */
    double compass_noise_rad;
    double battery_j, battery_max_j;  /* at the start, and full; battery_max_j 0: it has none */
    double power_w, take_w;           /* what it uses at all times, and can be charged with */
    const struct world_sonar *sonars; /* the world's: robots with the same ring share it */
    size_t sonar_count;               /* at most MU_SONARS_MAX */
    struct world_laser laser;
    struct world_camera camera;
    struct world_fiducial_finder finder;
    struct world_gripper gripper;
    uint64_t period_ns[WORLD_SENSORS]; /* how often it reads; 0: every control step */
};

struct world {
    char file[256];
    double min_x_m, min_y_m, max_x_m, max_y_m; /* a box around everything */
    struct world_shape *shapes;                /* that never move */
    size_t shape_count;
    struct world_object *objects; /* that can be moved; room for MU_OBJECTS_MAX */
    size_t object_count;
    struct world_robot *robots; /* as in the file, then as added; room for MU_ROBOTS_MAX */
    size_t robot_count;
    uint64_t step_ns;          /* that the file asks for; 0: it does not */
    int64_t seed;              /* likewise; < 0: it does not */
    struct world_file *source; /* the parsed file: what its names define, for world_add_robot */
};

struct world_options {
    bool quiet;                               /* no warnings */
    uint64_t seed;                            /* of random places, where the file has none */
    const struct mu_fault_listener *listener; /* NULL: loading ends at the first mistake */
};

/**
 * Loads a world file in Stage's grammar (define, include, nested models, # comments) and units.
 *
 * Properties that muster does not support are named once each, as warnings on standard error.
 * A listener is told of them instead, and of every mistake; then the world is good for nothing.
 *
 * @return MU_OK, or MU_FAULT_FILE with file, line, column and what was expected (of the last
 *         mistake, where there is a listener)
 */
MU_MUST_USE mu_result world_open(struct world *world, const char *path,
                                 const struct world_options *options, struct mu_fault *fault);

/** Reads a file into a world that is open already: its memory is used again. */
MU_MUST_USE mu_result world_read(struct world *world, const char *path,
                                 const struct world_options *options, struct mu_fault *fault);

/** world_open with seed 1 and without a listener. */
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

/** Likewise, as `muster sim --place` has it: "NAME BODY X Y DEG COLOR", - for what is not said. */
MU_MUST_USE mu_result world_add_placed(struct world *world, const char *text,
                                       struct mu_fault *fault);

/**
 * @param clear_m  that it wants around it
 * @return whether a robot stands inside the world, clear of what stands there and of all other
 *         robots
 */
bool world_robot_fits(const struct world *world, const char *name, double clear_m);

/**
 * Looks for robots and things that overlap a wall or one another, or stand outside (libccd).
 *
 * What does not stop bodies is in nobody's way.
 *
 * @return MU_OK or MU_FAULT_FILE
 */
MU_MUST_USE mu_result world_check_places(const struct world *world, struct mu_fault *fault);

/** The same, telling a listener of everything that stands wrong.  @return MU_FAULT_FILE then */
MU_MUST_USE mu_result world_check_all_places(const struct world *world,
                                             const struct mu_fault_listener *listener,
                                             struct mu_fault *fault);

#endif
