/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file hash.h
 * Hashes that are the same on every machine; for tables, not against attackers.
 */
#ifndef MUSTER_CORE_HASH_H
#define MUSTER_CORE_HASH_H

#include <stdint.h>

/** @return the FNV-1a hash of a string, 64 bits */
uint64_t mu_hash_string(const char *s);

/** @return a number with all bits mixed (the finalizer of splitmix64) */
uint64_t mu_hash_number(uint64_t x);

#endif
