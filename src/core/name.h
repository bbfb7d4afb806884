/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file name.h
 * Names of agents: [A-Za-z_][A-Za-z0-9_.-]{0,30}.
 */
#ifndef MUSTER_CORE_NAME_H
#define MUSTER_CORE_NAME_H

#include <stdbool.h>

/** @return whether this is a name that an agent may bear, a reserved one or not */
bool mu_name_valid(const char *name);

/**
 * @return whether a robot or host may not bear it: all, robots, special, observer, operator,
 * broker, broker.*
 */
bool mu_name_reserved(const char *name);

/** @return whether a program may bear it; if not, said so.  @param whose  "a robot" */
bool mu_name_check(const char *program, const char *whose, const char *name);

/** @return whether a group may be named so: a name, but not all, robots, special, broker, which
 *  stand for others where receivers are named */
bool mu_name_of_group(const char *name);

/** @return whether it is a further name of the operator, for command lines that live beside each
 *  other: operator-N */
bool mu_name_of_operator(const char *name);

/** @return the name of the broker's part that version 0.1 called so, for one version; else the same
 */
const char *mu_name_now(const char *name);

/** @return what version 0.1 called a part of the broker that has another name now, or NULL */
const char *mu_name_was(const char *name);

#endif
