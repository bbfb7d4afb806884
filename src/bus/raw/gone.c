/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/raw/raw.h"

#include <string.h>

/* Where in the bytes: encapsulation (CDR, little-endian), what, three bytes of padding, the length
 * of the key, the key. */
enum { WHAT_AT = 4, LENGTH_AT = 8 };

size_t gone_write(uint8_t *to, enum gone_what what, const void *key, size_t key_size)
{
    memset(to, 0, GONE_HEAD_BYTES);
    to[1] = 1;
    to[WHAT_AT] = (uint8_t)what;
    for (size_t i = 0; i < 4; i++) {
        to[LENGTH_AT + i] = (uint8_t)(key_size >> (8 * i));
    }
    memcpy(to + GONE_HEAD_BYTES, key, key_size);
    return GONE_HEAD_BYTES + key_size;
}

enum gone_what gone_read(const void *bytes, size_t size, const void **key, size_t *key_size)
{
    const uint8_t *at = bytes;
    if (size < GONE_HEAD_BYTES || at[0] != 0 || at[1] != 1) {
        return GONE_NOT;
    }
    bool known = at[WHAT_AT] == GONE_DISPOSED || at[WHAT_AT] == GONE_UNREGISTERED;
    size_t length = 0;
    for (size_t i = 4; i > 0; i--) {
        length = length << 8 | at[LENGTH_AT + i - 1];
    }
    *key = at + GONE_HEAD_BYTES;
    *key_size = length;
    return known && length <= size - GONE_HEAD_BYTES ? (enum gone_what)at[WHAT_AT] : GONE_NOT;
}
