/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file bus_arrivals.h
 * How many samples lie in the readers, and the thread that sleeps until there is one.
 *
 * Threads of DDS count; the thread that has the bus takes, and reads the sockets (local.h).
 */
#ifndef MUSTER_BUS_BUS_ARRIVALS_H
#define MUSTER_BUS_BUS_ARRIVALS_H

#include "bus/bus.h"
#include "bus/local.h"

/** @return MU_OK; MU_FAULT_OS: no descriptor is left */
MU_MUST_USE mu_result bus_arrivals_open(struct bus *bus);

void bus_arrivals_close(struct bus *bus);

/** Reads and writes what sockets have or take.  Waits for that, or a listener, for at most so long.
 */
void bus_arrivals_poll(struct bus *bus, int64_t timeout_ns);

/** Listener of a reader, whose argument it is: DDS has matched or missed a writer. */
void bus_arrivals_meet(dds_entity_t entity, dds_subscription_matched_status_t status, void *reader);

/** Listener of a reader, whose argument it is; runs in a thread of DDS, once for each sample. */
void bus_arrivals_note(int32_t entity, void *reader);

/** @return whether the reader is worth a look; arrived: how many samples it has had until now */
bool bus_arrivals_are_news(struct bus_reader *r, uint64_t *arrived);

/** The reader is empty but for what has come since it had had so many. */
void bus_arrivals_taken(struct bus_reader *r, uint64_t arrived);

#endif
