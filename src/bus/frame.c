/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/frame.h"

#include <string.h>

/* DDS's own headers want a word that C11 does not have. */
#define asm __asm__
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

/* What stands before the CDR, in bytes: that it is CDR and in which byte order, and how many bytes
 * fill its last four up. */
enum { PAYLOAD_AT = 4, ENCODING_AT = 5, FILLED_AT = 7 };
enum { CDR_BIG_ENDIAN, CDR_LITTLE_ENDIAN };
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
static const char ENCODING = CDR_LITTLE_ENDIAN;
#else
static const char ENCODING = CDR_BIG_ENDIAN;
#endif

size_t frame_put(struct cdr_room *room, const void *sample, const uint32_t *ops)
{
    size_t end = cdr_put(room, FRAME_HEAD, sample, ops);
    uint32_t size = (uint32_t)(end + FRAME_HEAD - 1) / FRAME_HEAD * FRAME_HEAD;
    memset(room->at + end, 0, size - end);
    memset(room->at, 0, FRAME_HEAD);
    memcpy(room->at, &size, sizeof size);
    room->at[ENCODING_AT] = ENCODING;
    room->at[FILLED_AT] = (char)((size - end) % 4);
    return end;
}

/* --- by DDS ----------------------------------------------------------------------------------- */

/* A sample of no type of DDS's, which asks it for its bytes when it is written. */
struct payload {
    struct ddsi_serdata base;
    const char *bytes;
    size_t size; /* a multiple of 4 */
};

static uint32_t payload_size(const struct ddsi_serdata *base)
{
    return (uint32_t)((const struct payload *)base)->size;
}

static struct ddsi_serdata *payload_bytes(const struct ddsi_serdata *base, size_t at, size_t size,
                                          ddsrt_iovec_t *bytes)
{
    struct payload *p = (struct payload *)(uintptr_t)base;
    bytes->iov_base = (void *)(uintptr_t)(p->bytes + at);
    bytes->iov_len = size;
    return &p->base;
}

static void payload_bytes_done(struct ddsi_serdata *base, const ddsrt_iovec_t *bytes)
{
    (void)base;
    (void)bytes;
}

static void payload_free(struct ddsi_serdata *base)
{
    (void)base; /* it is the caller's */
}

static const struct ddsi_serdata_ops payload_ops = {.get_size = payload_size,
                                                    .to_ser_ref = payload_bytes,
                                                    .to_ser_unref = payload_bytes_done,
                                                    .free = payload_free};
static const struct ddsi_sertype_ops type_ops = {.version = ddsi_sertype_v0};
static const struct ddsi_sertype type = {.ops = &type_ops, .serdata_ops = &payload_ops};

dds_return_t frame_write(dds_entity_t writer, const char *frame, size_t end, dds_time_t source_ns)
{
    struct payload payload = {.bytes = frame + PAYLOAD_AT, .size = (end - PAYLOAD_AT + 3) / 4 * 4};
    ddsi_serdata_init(&payload.base, &type, SDK_DATA);
    payload.base.timestamp.v = source_ns;
    return dds_forwardcdr(writer, &payload.base);
}
