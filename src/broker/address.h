/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file address.h
 * Whom a mail is for: a name, names joined by commas, a word that stands for many, group:G, or
 * another SCHEME:REST that a program resolves.
 */
#ifndef MUSTER_BROKER_ADDRESS_H
#define MUSTER_BROKER_ADDRESS_H

#include "muster/limits.h"

#include <stdbool.h>

enum address_kind {
    ADDRESS_NAMES,
    ADDRESS_ALL,
    ADDRESS_ROBOTS,
    ADDRESS_SPECIAL,
    ADDRESS_GROUP,
    ADDRESS_SCHEME, /* any other word before a colon */
};

enum address_kind address_kind(const char *dst);

/** @return whether dst is one of the words, SCHEME:REST, or a list of valid names */
bool address_valid(const char *dst);

/** @return what stands behind the colon of a group or another scheme */
const char *address_rest(const char *dst);

/** Takes the next name from a list.  @return false at the end, or at what is no valid name */
bool address_next(const char **list, char name[MU_NAME_MAX + 1]);

#endif
