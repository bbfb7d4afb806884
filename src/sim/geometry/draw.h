/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file draw.h
 * Noise that is drawn from its place: who, which sensor, when, which beam.
 *
 * There is no state, so that reading one sensor never changes another, whichever thread reads it,
 * and a run that goes on from a snapshot draws what it would have drawn.  Nothing here asks the
 * mathematics library, whose last bits differ between machines.
 */
#ifndef MUSTER_SIM_DRAW_H
#define MUSTER_SIM_DRAW_H

#include <stdint.h>

/* What is drawn for; a new one goes to the end, or old runs change. */
enum draw_use {
    DRAW_SONAR,
    DRAW_LASER,
    DRAW_LASER_ANGLE,
    DRAW_CAMERA,
    DRAW_FIDUCIALS,
    DRAW_GPS,
    DRAW_GPS_DRIFT,
    DRAW_COMPASS,
    DRAW_ODOMETER
};

/** @return the key of all that one sensor draws at one time, for draw_bits */
uint64_t draw_key(uint64_t seed, uint64_t robot, enum draw_use use, uint64_t tick);

/** @return 64 bits that have nothing in common with those of another key or index */
uint64_t draw_bits(uint64_t key, uint64_t index);

/** @return evenly spread in (0, 1), both ends excluded */
double draw_unit(uint64_t bits);

/** @return a normal deviate, mean 0 and standard deviation 1 */
double draw_normal(uint64_t bits);

#endif
