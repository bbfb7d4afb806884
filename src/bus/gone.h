/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file gone.h
 * That an instance was disposed or has no writers any more, as a message of a recording.
 *
 * It is a small message of its own type, on a channel beside that of the topic's samples, so that
 * whoever decodes a topic by its definition finds nothing but samples there.
 */
#ifndef MUSTER_BUS_GONE_H
#define MUSTER_BUS_GONE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum gone_what {
    GONE_NOT,          /* it lives */
    GONE_DISPOSED,     /* a writer took it back */
    GONE_UNREGISTERED, /* no writer has it any more */
};

/* Behind the name of a topic: the name of the channel of what has gone. */
#define GONE_SUFFIX      "/gone"
#define GONE_SCHEMA_NAME "muster/msg/Gone"
#define GONE_SCHEMA      "uint8 DISPOSED=1\nuint8 UNREGISTERED=2\nuint8 what\nuint8[] key\n"

enum { GONE_HEAD_BYTES = 12 };

/**
 * Writes such a message in CDR.
 *
 * @param key  of the instance, as DDS serialises it, with its encapsulation
 * @param to   GONE_HEAD_BYTES more than the key has
 * @return how many bytes it has
 */
size_t gone_write(uint8_t *to, enum gone_what what, const void *key, size_t key_size);

/**
 * Reads such a message.
 *
 * @param key  out: points into the bytes
 * @return GONE_NOT: it is none
 */
enum gone_what gone_read(const void *bytes, size_t size, const void **key, size_t *key_size);

#endif
