/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file forks.h
 * Whether this process is a child, by fork, of the one that asked before: getpid() is a system
 * call.
 */
#ifndef MUSTER_CORE_FORKS_H
#define MUSTER_CORE_FORKS_H

#include <stdint.h>

/** @return a number that is another one in each child */
uint32_t mu_forks(void);

#endif
