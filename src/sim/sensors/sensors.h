/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file sensors.h
 * All sensors of all robots that cost something, read when somebody asks and it is time.
 *
 * Robots do not disturb one another here, so any number of threads gives the same bits.
 */
#ifndef MUSTER_SIM_SENSORS_H
#define MUSTER_SIM_SENSORS_H

#include "muster/percept.h"
#include "sim/geometry/geometry.h"

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
 * @param wanted  for each robot the bits of enum mu_sense
 * @param step    control steps since the start
 */
void sensors_read_all(struct sensors *s, const uint32_t wanted[], uint64_t step);

/** Forgets all readings: each sensor is read anew when it is wanted next. */
void sensors_forget(struct sensors *s);

/** Points to the lists that are wanted, good until the next step; the others stay as they are. */
void sensors_tell(const struct sensors *s, size_t robot, uint32_t wanted, struct mu_percept *out);

#endif
