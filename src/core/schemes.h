/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file schemes.h
 * The schemes of addresses that muster-resolver knows, and an experiment may ask for.
 */
#ifndef MUSTER_CORE_SCHEMES_H
#define MUSTER_CORE_SCHEMES_H

#define MU_SCHEME_ROLE "role"
#define MU_SCHEME_TASK "task"
#define MU_SCHEME_NEAR "near"

/** All of them, for the braces of an array. */
#define MU_SCHEMES MU_SCHEME_ROLE, MU_SCHEME_TASK, MU_SCHEME_NEAR

#endif
