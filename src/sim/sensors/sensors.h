/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file sensors.h
 * All sensors of all robots that cost something, read when somebody asks and it is time.
 *
 * Robots do not disturb one another here, so any number of threads gives the same bits.
 */
#ifndef MUSTER_SIM_SENSORS_H
#define MUSTER_SIM_SENSORS_H

#include "sim/geometry/geometry.h"

struct engine_blob {
    uint32_t rgb;
    double bearing_rad, width_rad, range_m; /* of its middle; from the camera */
};

struct engine_fiducial {
    int32_t number;              /* 0: too far to read */
    double bearing_rad, range_m; /* from the finder */
    double heading_rad;          /* of the thing that bears it, seen from the finder */
};

/* Bits of engine_percept.gripper. */
enum engine_gripper {
    ENGINE_GRIPPER_THERE = 1,
    ENGINE_GRIPPER_CLOSED = 2,
    ENGINE_GRIPPER_LIFTED = 4,
    ENGINE_GRIPPER_OUTER_BEAM = 8, /* something breaks the beam at the tips */
    ENGINE_GRIPPER_INNER_BEAM = 16,
    ENGINE_GRIPPER_HOLDS = 32
};

/* Sectors of the bumper: bit k is hit between (2k-1) and (2k+1) eighths of pi from ahead. */
enum { ENGINE_BUMPERS = 8 };

/* What a robot feels and sees.  What it points to is the sensors', good until the next step. */
struct engine_percept {
    struct world_pose pose;         /* as it is; heading in (-pi, pi] */
    struct world_pose position;     /* as its GPS or its odometer has it, by its localization */
    double gps_x_m, gps_y_m;        /* with noise and drift */
    double compass_rad;             /* with noise */
    struct world_pose odometer;     /* as its wheels have it */
    double forward_m_s, turn_rad_s; /* as it really moves, in its own frame */
    bool stalled;                   /* its wheels have been held up for 0.3 s */
    bool placed;                    /* it did not drive here: somebody put it here */
    bool fault;                     /* it was flung out of the numbers and put back */
    uint32_t bumpers;               /* sectors that touch something */
    uint32_t gripper;               /* enum engine_gripper */
    double battery_share;           /* of full; < 0: it has none */
    size_t sonar_count, laser_count, blob_count, fiducial_count;
    const float *sonar_m, *laser_m;
    const struct engine_blob *blobs;         /* nearest first */
    const struct engine_fiducial *fiducials; /* nearest first */
};

/* Where it all is; must outlive the sensors. */
struct sensors_scene {
    const struct world *world;
    const struct grid *grid; /* brought up to date by the caller; robots move first, by number */
    uint64_t seed, step_ns;
    size_t threads; /* 0 or 1: the caller's alone */
};

/** Takes all memory, and starts the threads. */
struct sensors *sensors_open(const struct sensors_scene *scene);

/** Ends the threads. */
void sensors_close(struct sensors *s);

/** Says where a robot is now. */
void sensors_place(struct sensors *s, size_t robot, const struct frame *frame);

/**
 * Reads what is wanted and due.  Between two readings of a sensor the last one stands.
 *
 * @param wanted  for each robot the bits 1 << enum world_sensor
 * @param step    control steps since the start
 */
void sensors_read_all(struct sensors *s, const uint32_t wanted[], uint64_t step);

/** Forgets all readings: each sensor is read anew when it is wanted next. */
void sensors_forget(struct sensors *s);

/** Fills in the readings that are wanted; the others are empty. */
void sensors_tell(const struct sensors *s, size_t robot, uint32_t wanted,
                  struct engine_percept *out);

#endif
