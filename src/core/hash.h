/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file hash.h
 * Hashes that are the same on every machine; for tables, not against attackers.
 */
#ifndef MUSTER_CORE_HASH_H
#define MUSTER_CORE_HASH_H

#include <stddef.h>
#include <stdint.h>

/* The FNV-1a hash of nothing. */
#define MU_HASH_EMPTY 14695981039346656037ull

/** @return the FNV-1a hash of what hash is of, and of these bytes behind it */
uint64_t mu_hash_bytes(uint64_t hash, const void *bytes, size_t count);

/** @return the FNV-1a hash of a string, 64 bits */
uint64_t mu_hash_string(const char *s);

/** @return a number with all bits mixed (the finalizer of splitmix64) */
uint64_t mu_hash_number(uint64_t x);

#endif
