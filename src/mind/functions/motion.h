/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file clips_physical.h
 * The body as rules see it.
 */
#ifndef MUSTER_AGENT_CLIPS_PHYSICAL_H
#define MUSTER_AGENT_CLIPS_PHYSICAL_H

#include "mind/mind.h"

/** time s, x mm, y mm, speed mm/s, turn rate deg/s, compass deg in (-180, 180] */
void clips_physical_position(const struct mind_percept *p, double out[6]);

/** @return the same angle in (-180, 180] */
double clips_physical_norm(double angle_deg);

#endif
