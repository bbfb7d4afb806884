/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file reader.h
 * Names of those who join as a further operator: operator-N.
 *
 * There are few of them, as a broker keeps each that it has ever heard.
 */
#ifndef MUSTER_DESK_READER_H
#define MUSTER_DESK_READER_H

#include "muster/directory.h"

#include <stdbool.h>

/**
 * Makes a name; one that is held by another is no reason to give up before the next.
 *
 * @param attempt  0, 1, ...: another name each
 * @param stays    it reads for long: who does so for a moment does not take its name while it is
 *                 away
 */
void reader_name(char name[MU_NAME_MAX + 1], unsigned attempt, bool stays);

/** @return whether that is a verb that only reads, somebody's or our own */
bool reader_is(const struct mu_member *m);

#endif
