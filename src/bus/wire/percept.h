/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file percept.h
 * Percepts on the wire: the one place that knows both structs, made of muster/sensors.h.
 */
#ifndef MUSTER_BUS_WIRE_PERCEPT_H
#define MUSTER_BUS_WIRE_PERCEPT_H

#include "muster/percept.h"
#include "wire.h"

/** Fills in all but the robot's name.  The lists stay from's: nothing is written through to. */
void percept_pack(muster_Percept *to, const struct mu_percept *from);

/** Fills in all but step and time_ns.  Texts and lists stay from's. */
void percept_unpack(struct mu_percept *to, const muster_Percept *from);

/** @return whether every number is finite and no list is too long */
bool percept_ok(const muster_Percept *p);

#endif
