/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file sensors.h
 * All sensors of all robots that cast rays.  A sensor is read only if it is wanted and due.
 *
 * Readings of robots are independent, so that any number of threads gives the same bits.
 */
#ifndef MUSTER_SIM_SENSORS_H
#define MUSTER_SIM_SENSORS_H

#include "muster/percept.h"
#include "sim/geometry/geometry.h"

/* The scene, which must outlive the sensors. */
struct sensors_scene {
    const struct world *world;
    const struct grid *grid; /* updated by the caller; its moving solids begin with the robots */
    uint64_t seed, step_ns;
    size_t threads; /* 0 or 1: only the caller's */
};

/** Takes all memory, and starts the threads. */
struct sensors *sensors_open(const struct sensors_scene *scene);

/** Ends the threads. */
void sensors_close(struct sensors *s);

/** Sets the present frame of a robot. */
void sensors_place(struct sensors *s, size_t robot, const struct frame *frame);

/**
 * Reads all sensors that are wanted and due.  The others keep their last reading.
 *
 * @param wanted  for each robot, bits of enum mu_sense
 * @param step    control steps since the start
 */
void sensors_read_all(struct sensors *s, const uint32_t wanted[], uint64_t step);

/** Drops all readings: each sensor is read again when it is next wanted. */
void sensors_forget(struct sensors *s);

/**
 * Sets the wanted lists of a percept, valid until the next reading.  Other members do not change.
 */
void sensors_tell(const struct sensors *s, size_t robot, uint32_t wanted, struct mu_percept *out);

#endif
