/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file version.h
 * The version: that of these headers, and that of the library that runs.
 */
#ifndef MUSTER_VERSION_H
#define MUSTER_VERSION_H

#pragma GCC visibility push(default)
#ifdef __cplusplus
extern "C" {
#endif

/* Of these headers.  The numbers are for #if. */
#define MU_VERSION       "0.2.0"
#define MU_VERSION_MAJOR 0
#define MU_VERSION_MINOR 2
#define MU_VERSION_PATCH 0

/** @return the version of the library that runs, as MU_VERSION; never NULL */
const char *mu_version(void);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
