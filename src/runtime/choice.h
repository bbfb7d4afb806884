/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file choice.h
 * The choice of one of the brokers that a process has heard of.  Pure.
 */
#ifndef MUSTER_RUNTIME_CHOICE_H
#define MUSTER_RUNTIME_CHOICE_H

#include "bus/wire/beacons.h"

/** Another life of a broker was heard before its heartbeat. */
void choice_follow(struct beacons *c, const char *name, uint64_t incarnation);

/**
 * Chooses among those that are there and take agents.
 *
 * @param host    of this process: its brokers come first, then the lower index, then the name
 * @param wanted  only this one will do; NULL: any
 * @return NULL: there is none
 */
const struct beacons_broker *choice_best(const struct beacons *c, const char *host,
                                         const char *wanted);

/** @return whether no broker that is heard of later could be better */
bool choice_is_final(const struct beacons_broker *b, const char *host, const char *wanted);

#endif
