/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file bus_arrivals.h
 * How many samples lie in the readers, and the thread that sleeps until there is one.
 *
 * Threads of DDS count, under the lock of the bus; the thread that has the bus takes.
 */
#ifndef MUSTER_BUS_BUS_ARRIVALS_H
#define MUSTER_BUS_BUS_ARRIVALS_H

#include "bus/bus.h"

void bus_arrivals_init(struct bus *bus);

/** Listener of a reader, whose argument it is; runs in a thread of DDS, once for each sample. */
void bus_arrivals_note(int32_t entity, void *reader);

/** @return whether the reader is worth a look; arrived: how many samples it has had until now */
bool bus_arrivals_are_news(struct bus_reader *r, uint64_t *arrived);

/** The reader is empty but for what has come since it had had so many. */
void bus_arrivals_taken(struct bus_reader *r, uint64_t arrived);

#endif
