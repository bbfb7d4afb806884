/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file address.h
 * The receivers of a mail: a name, names joined by commas, a word for many agents, group:G, or
 * another SCHEME:REST, which a program resolves.
 */
#ifndef MUSTER_CORE_ADDRESS_H
#define MUSTER_CORE_ADDRESS_H

#include "muster/limits.h"

#include <stdbool.h>

enum mu_address_kind {
    MU_ADDRESS_NAMES,
    MU_ADDRESS_ALL,
    MU_ADDRESS_ROBOTS,
    MU_ADDRESS_SPECIAL,
    MU_ADDRESS_GROUP,
    MU_ADDRESS_SCHEME, /* any other word before a colon */
};

enum mu_address_kind mu_address_kind(const char *dst);

/** @return whether dst is one of the words, SCHEME:REST, or a list of valid names */
bool mu_address_valid(const char *dst);

/** @return the text behind the colon of a group or another scheme */
const char *mu_address_rest(const char *dst);

/** Takes the next name from a list.  @return false at the end, or at an invalid name */
bool mu_address_next(const char **list, char name[MU_NAME_MAX + 1]);

/* The schemes that muster-resolver knows, and an experiment may ask for; all of them, for the
 * braces of an array. */
#define MU_SCHEME_ROLE "role"
#define MU_SCHEME_TASK "task"
#define MU_SCHEME_NEAR "near"
#define MU_SCHEMES     MU_SCHEME_ROLE, MU_SCHEME_TASK, MU_SCHEME_NEAR

#endif
