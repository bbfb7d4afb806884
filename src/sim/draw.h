/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file draw.h
 * Random numbers without a state: each is a function of who draws it, for what, and when.
 *
 * So a sensor that nobody reads, or another order of threads, changes no other sensor's noise.
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

/** @return the key of all that one robot draws for one use at one time */
uint64_t draw_key(uint64_t seed, uint64_t robot, enum draw_use use, uint64_t tick);

/** @return 64 random bits, others for each index */
uint64_t draw_bits(uint64_t key, uint64_t index);

/** @return evenly spread in (0, 1), both ends excluded */
double draw_unit(uint64_t bits);

/** @return a number from the normal distribution, mean 0, deviation 1 (Box and Muller, 1958) */
double draw_normal(uint64_t bits);

#endif
