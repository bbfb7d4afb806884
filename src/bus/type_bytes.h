/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file type_bytes.h
 * A type as bytes, for recordings of topics that we were not compiled with, and a topic of such
 * bytes again.
 *
 * The bytes are what DDS programs tell one another of a type (DDS-XTypes 1.3, 7.6.3.2): the length
 * of its TypeInformation in four bytes, little-endian; the TypeInformation; the TypeMapping with
 * the objects of all types in it.  Both are CDR of the second version, little-endian.
 */
#ifndef MUSTER_BUS_TYPE_BYTES_H
#define MUSTER_BUS_TYPE_BYTES_H

#include "muster/result.h"

#include <dds/dds.h>

/* Room for a type's name among types, with its zero: 14 bytes as hexadecimal digits. */
enum { TYPE_HASH_MAX = 2 * 14 + 1 };

/**
 * Writes a type.
 *
 * @param hash  out: two types of one name have different ones
 * @return how many bytes it has; 0: it does not describe itself, or they are more than size
 */
size_t type_bytes_write(const dds_topic_descriptor_t *d, void *to, size_t size,
                        char hash[TYPE_HASH_MAX]);

/**
 * Makes a topic of a type that DDS has put together from what programs say of it.
 *
 * Cyclone DDS 0.10.2 takes every key of such a type for a short one, and writes those with texts
 * past the end of 16 bytes: here all are taken for long.
 *
 * @return the topic, or below 0
 */
dds_entity_t type_topic(dds_entity_t participant, const dds_topic_descriptor_t *d,
                        const char *name);

/**
 * Makes a topic of such bytes.  Nothing in them is believed: a child of this process reads them
 * first, and each object must have the hash that it is known by.
 *
 * @param type  what the type must be called
 * @return MU_OK; MU_MALFORMED: they are no such type; MU_FAULT_DDS
 */
MU_MUST_USE mu_result type_bytes_topic(dds_entity_t participant, const void *bytes, size_t size,
                                       const char *name, const char *type, dds_entity_t *topic);

#endif
