/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file senses.h
 * All sensors of all robots that cost something, read when somebody asks and it is time.
 *
 * Robots do not disturb one another here, so any number of threads gives the same bits.
 */
#ifndef MUSTER_SIM_SENSES_H
#define MUSTER_SIM_SENSES_H

#include "sim/engine/engine.h"
#include "sim/geometry/frame.h"
#include "sim/geometry/grid.h"

/* Where it all is; must outlive the senses. */
struct senses_scene {
    const struct world *world;
    const struct grid *grid; /* brought up to date by the caller; robots move first, by number */
    uint64_t seed, step_ns;
    size_t threads; /* 0 or 1: the caller's alone */
};

/** Takes all memory, and starts the threads. */
struct senses *senses_open(const struct senses_scene *scene);

/** Ends the threads. */
void senses_close(struct senses *s);

/** Says where a robot is now. */
void senses_place(struct senses *s, size_t robot, const struct frame *frame);

/**
 * Reads what is wanted and due.  Between two readings of a sensor the last one stands.
 *
 * @param wanted  for each robot the bits 1 << enum world_sensor
 * @param step    control steps since the start
 */
void senses_read_all(struct senses *s, const uint32_t wanted[], uint64_t step);

/** senses_read_all for one robot. */
void senses_read(struct senses *s, size_t robot, uint32_t wanted, uint64_t step);

/** Forgets all readings: each sensor is read anew when it is wanted next. */
void senses_forget(struct senses *s);

/** Fills in the readings that are wanted; the others are empty. */
void senses_tell(const struct senses *s, size_t robot, uint32_t wanted, struct engine_percept *out);

#endif
