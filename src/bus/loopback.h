/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file loopback.h
 * Keeps Cyclone's sockets off every interface but one.
 *
 * Told to use 127.0.0.1 alone, Cyclone DDS 0.10 still binds its UDP sockets to 0.0.0.0, and parses
 * what reaches them from outside.  While a domain is created, our own bind() gives such sockets the
 * loopback address instead.  At any other time, and in other threads, bind() is the system's.
 */
#ifndef MUSTER_BUS_LOOPBACK_H
#define MUSTER_BUS_LOOPBACK_H

#include <stdint.h>

/** From now on, in this thread, UDP sockets bound to any address are bound to this one (host
 * order). */
void loopback_begin(uint32_t address);

void loopback_end(void);

#endif
