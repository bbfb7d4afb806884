/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file traffic.h
 * Packets that are lost or late on purpose, between the processes of a run on one host.
 *
 * The starter of processes makes a table in shared memory, and tells each child in its environment
 * where the table is and which part of the run it is.  Every UDP packet that Cyclone sends to a
 * port of another part goes by the table: a library that these children load before others
 * (LD_PRELOAD, src/faults) stands before the system's sendmsg(). No other process has it.  Such a
 * run uses DDS alone, no sockets (local.h).
 */
#ifndef MUSTER_BUS_TRAFFIC_H
#define MUSTER_BUS_TRAFFIC_H

#include "muster/result.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Parts that can be told apart; 0 stands for all others. */
enum { TRAFFIC_PARTS_MAX = 128 };

#define TRAFFIC_ENVIRONMENT "MUSTER_TRAFFIC"

enum { TRAFFIC_PORTS = 65536 };

struct traffic_rule {
    _Atomic uint32_t lost_ppm, late_us;
};

struct traffic {
    uint64_t seed;
    _Atomic uint64_t struck;
    _Atomic uint8_t parts[TRAFFIC_PORTS]; /* whose each port is */
    struct traffic_rule rules[TRAFFIC_PARTS_MAX][TRAFFIC_PARTS_MAX];
};

/* Where src/faults is, seen from the folder of our programs. */
#define TRAFFIC_LIBRARY "../lib/muster/libmuster-faults.so"

/**
 * Makes the table, which the children of this process share.
 *
 * @param seed     of the chance by which packets are lost
 * @param library  src/faults, which the children load before others; it outlives them
 * @return MU_OK or MU_FAULT_OS
 */
MU_MUST_USE mu_result traffic_make(struct traffic **out, uint64_t seed, const char *library);

/** Says which part the next child is; 1 to TRAFFIC_PARTS_MAX - 1, or 0. */
void traffic_child(unsigned part);

/**
 * Sets what becomes of packets between two parts, both ways.
 *
 * @param share  of them that are lost, 0 to 1
 * @param by_ms  that each is late, 0 to 10000
 */
void traffic_set(struct traffic *t, unsigned one, unsigned other, double share, double by_ms);

/** @return how many packets have been lost so, or late, in all processes together */
uint64_t traffic_struck(const struct traffic *t);

#endif
