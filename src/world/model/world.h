/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file world.h
 * A world as its file describes it: what stands in it, and the bodies of its robots.
 *
 * Data only: nothing here moves.  The simulator builds its bodies from it, the report draws it.
 * All memory is taken at start-up; a loaded world lives as long as its process.
 * Lengths are metres, angles radians counter-clockwise, 0 along +x.
 */
#ifndef MUSTER_WORLD_MODEL_WORLD_H
#define MUSTER_WORLD_MODEL_WORLD_H

#include "core/fault.h"
#include "muster/limits.h"
#include "muster/percept.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct world_pose {
    double x_m, y_m, heading_rad;
};

/* How a thing looks to bodies and sensors: Stage's "returns". */
struct world_look {
    uint32_t rgb;       /* 0xRRGGBB */
    bool stops;         /* bodies bump into it (obstacle_return) */
    bool echoes;        /* sonar and laser see it (ranger_return not below 0) */
    bool shows;         /* the camera sees it (blob_return) */
    bool graspable;     /* a gripper can take it (gripper_return) */
    double reflectance; /* that a laser's intensity shows (ranger_return, or laser_return) */
    int32_t fiducial;   /* that the fiducial finder reads; 0: it bears none */
    double give_w;      /* power that it charges robots with; 0: none */
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

/* The errors of an odometer: a systematic one for each robot, and slip. */
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
    bool reads_odometer; /* its position comes from the odometer (localization "odom") */
    struct world_odometry odometry;
    double gps_noise_m,
        gps_drift_m; /* of the absolute position; the drift per square root of 1 s */
    double compass_noise_rad;
    double battery_j, battery_max_j;  /* at the start, and full; battery_max_j 0: it has none */
    double power_w, take_w;           /* its consumption, and the power it can be charged with */
    const struct world_sonar *sonars; /* the world's: robots with the same ring share it */
    size_t sonar_count;               /* at most MU_SONARS_MAX */
    struct world_laser laser;
    struct world_camera camera;
    struct world_fiducial_finder finder;
    struct world_gripper gripper;
    uint64_t period_ns[MU_SENSOR_COUNT]; /* how often it reads; 0: every control step */
};

/* Where a robot or a thing comes from. */
struct world_origin {
    struct mu_fault_place at;
    const char *type;
    const struct worldfile_entity *entity; /* the model of the file; NULL: the file has none */
    bool misplaced;                        /* where it stands could not be read */
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
    struct world_origin *origins; /* of the robots, in their order */
    struct world_origin *object_origins;
    struct world_ring *rings;  /* of sonars, each once; the latest first */
    double fixed_m[4];         /* around all that is no robot: least x, least y, most x, most y */
    uint64_t step_ns;          /* that the file asks for; 0: it does not */
    int64_t seed;              /* likewise; < 0: it does not */
    struct world_file *source; /* the parsed file, with the definitions for world_add_robot */
};

/**
 * @param clear_m  free room around it
 * @return whether a robot stands inside the world, clear of things and of all other robots
 */
bool world_robot_fits(const struct world *world, const char *name, double clear_m);

/**
 * Looks for robots and things that overlap a wall or one another, or stand outside (libccd).
 *
 * Things that do not stop bodies overlap nothing.
 *
 * @param listener  hears of everything that stands wrong; NULL: the first mistake ends the work
 * @return MU_OK or MU_FAULT_FILE
 */
MU_MUST_USE mu_result world_check_places(const struct world *world,
                                         const struct mu_fault_listener *listener,
                                         struct mu_fault *fault);

/** @return the pose, given in a frame, in the frame's own frame; heading in (-pi, pi] */
struct world_pose world_pose_in(struct world_pose frame, struct world_pose pose);

/** @return a pose of the frame's own frame as it is seen from the frame */
struct world_pose world_pose_from(struct world_pose frame, struct world_pose pose);

/** @return the robot of a name; NULL: there is none */
struct world_robot *world_find_robot(const struct world *world, const char *name);

/** @return whether a thing that can be moved bears the name */
bool world_has_object(const struct world *world, const char *name);

/** @return whether a robot or a thing bears the name */
bool world_name_taken(const struct world *world, const char *name);

/** @return the box around a robot's outline and its gripper */
struct world_shape placement_room(const struct world_robot *robot);

#define PLACEMENT_NOBODY SIZE_MAX

/** @return whether nothing that stops bodies overlaps a shape; but for one robot, which may */
bool placement_is_free(const struct world *world, const struct world_shape *shape, size_t robot);

/* Numbers of the longest outline: x and y of a box's corners. */
enum { OUTLINE_NUMBERS_MAX = 8 };

/**
 * Writes x and y of the corners of a shape that stands at a pose, counter-clockwise from the front
 * left one; of a disc those of its centre.
 *
 * @return how many numbers that are
 */
size_t outline_write(const struct world_shape *shape, const struct world_pose *pose,
                     float corners_m[OUTLINE_NUMBERS_MAX]);

/** @return whether nothing stops at it and nothing echoes: a mark on the floor */
bool outline_is_flat(const struct world_shape *shape);

#endif
