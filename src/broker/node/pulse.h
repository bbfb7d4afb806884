/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file pulse.h
 * When a broker says that it is there: every 300 ms, and every second while all of its processes
 * speak to it.
 *
 * A Beacon wakes every process at once, and every one acknowledges it: mail that is under way then
 * waits for all of them.  Who has sent an Up since the last look has heard of the broker, and DDS
 * takes every packet of the broker's for a sign of its life.
 */
#ifndef MUSTER_BROKER_PULSE_H
#define MUSTER_BROKER_PULSE_H

#include <stdbool.h>
#include <stdint.h>

struct pulse {
    uint64_t told_ns;   /* when a Beacon went out last; 0: the next one is due */
    uint64_t looked_ns; /* when it was asked last whether one is due */
};

/** @return whether it is time to ask pulse_beats() */
bool pulse_looks(const struct pulse *p, uint64_t now_ns);

/**
 * Looks whether a Beacon is to go out, and notes that it does.
 *
 * @param spoke_ns  all processes have spoken at that time or later; 0: one never has, or there is
 *                  none
 */
bool pulse_beats(struct pulse *p, uint64_t spoke_ns, uint64_t now_ns);

#endif
