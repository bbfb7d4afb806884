/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file loopback.h
 * Keeps Cyclone's sockets off every device but loopback.
 *
 * Told to use 127.0.0.1 alone, Cyclone DDS 0.10 still binds its UDP sockets to 0.0.0.0, and parses
 * what reaches them from outside.  As soon as a domain has its sockets, they are bound to the
 * device lo (socket(7), SO_BINDTODEVICE; since Linux 5.7 that needs no rights).
 */
#ifndef MUSTER_BUS_LOOPBACK_H
#define MUSTER_BUS_LOOPBACK_H

#include <stdbool.h>
#include <stdint.h>

enum { LOOPBACK_FDS_MAX = 65536 };

/* The UDP sockets of a process. */
struct loopback {
    uint64_t bits[LOOPBACK_FDS_MAX / 64];
};

/** Notes the sockets that there are: they are not Cyclone's. */
void loopback_note(struct loopback *before);

/**
 * Binds those to the device lo that have come since, and looks whether they are.
 *
 * @return false: one listens elsewhere, which is explained on standard error
 */
bool loopback_hold(const struct loopback *before);

#endif
