/* SPDX-License-Identifier: Apache-2.0 */
#include "mcap/mcap_bytes.h"

#include <string.h>

static void number_put(uint8_t *to, uint64_t value, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++) {
        to[i] = (uint8_t)(value >> (8 * i));
    }
}

void mcap_out_bytes(struct mcap_out *o, const void *bytes, size_t count)
{
    if (o->full || count > o->size - o->len) {
        o->full = true;
        return;
    }
    if (count > 0) {
        memcpy(o->at + o->len, bytes, count);
    }
    o->len += count;
}

void mcap_out_number(struct mcap_out *o, uint64_t value, size_t bytes)
{
    uint8_t little_endian[8];
    number_put(little_endian, value, bytes);
    mcap_out_bytes(o, little_endian, bytes);
}

void mcap_out_text(struct mcap_out *o, const char *text)
{
    size_t len = strlen(text);
    mcap_out_number(o, len, 4);
    mcap_out_bytes(o, text, len);
}

size_t mcap_out_begin(struct mcap_out *o, size_t bytes)
{
    mcap_out_number(o, 0, bytes);
    return o->len;
}

void mcap_out_end(struct mcap_out *o, size_t begun, size_t bytes)
{
    if (!o->full) {
        number_put(o->at + begun - bytes, o->len - begun, bytes);
    }
}

size_t mcap_out_record(struct mcap_out *o, enum mcap_op op)
{
    mcap_out_number(o, op, 1);
    return mcap_out_begin(o, 8);
}

void mcap_out_record_end(struct mcap_out *o, size_t begun)
{
    mcap_out_end(o, begun, 8);
}

const uint8_t *mcap_in_bytes(struct mcap_in *in, uint64_t count)
{
    if (in->cut || count > in->left) {
        in->cut = true;
        return NULL;
    }
    const uint8_t *bytes = in->at;
    in->at += count;
    in->left -= (size_t)count;
    return bytes;
}

uint64_t mcap_in_number(struct mcap_in *in, size_t bytes)
{
    const uint8_t *at = mcap_in_bytes(in, bytes);
    uint64_t value = 0;
    for (size_t i = bytes; at && i > 0; i--) {
        value = value << 8 | at[i - 1];
    }
    return value;
}

struct mcap_in mcap_in_part(struct mcap_in *in, size_t bytes)
{
    uint64_t length = mcap_in_number(in, bytes);
    const uint8_t *at = mcap_in_bytes(in, length);
    return (struct mcap_in){.at = at, .left = at ? (size_t)length : 0, .cut = !at};
}
