/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/cdr.h"

#include "muster/result.h"

#include <dds/dds.h>
#include <string.h>

/* DDS's own headers want a word that C11 does not have. */
#define asm __asm__
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

static size_t aligned(size_t at, size_t to)
{
    return (at + to - 1) & ~(to - 1);
}

/* The type of a member: one of those that the topics with sockets have. */
static int type_of(uint32_t op)
{
    return DDS_OP_TYPE(op);
}

static int element_of(uint32_t op)
{
    return DDS_OP_SUBTYPE(op);
}

/* @return the bytes of an element that is a number */
static size_t number_size(uint32_t op)
{
    MU_ASSERT(element_of(op) == DDS_OP_VAL_4BY || element_of(op) == DDS_OP_VAL_8BY);
    return element_of(op) == DDS_OP_VAL_4BY ? 4 : 8;
}

/* --- writing ---------------------------------------------------------------------------------- */

/* The numbers of a struct between two members of other types take less room than that: so much is
 * there before each. */
enum { NUMBERS_MOST = 512 };

/* Makes room for so many bytes, and the numbers behind them. */
static inline void room_make(struct cdr_room *room, size_t at, size_t bytes)
{
    if (at + bytes + NUMBERS_MOST > room->size) {
        room->size = 2 * (at + bytes + NUMBERS_MOST);
        room->at = dds_realloc(room->at, room->size);
    }
}

/* @return the next place for a member of that size; what it skips is zero */
static inline size_t pad(const struct cdr_room *room, size_t at, size_t to)
{
    memset(room->at + at, 0, 8);
    return aligned(at, to);
}

static inline size_t four_put(const struct cdr_room *room, size_t at, const void *from)
{
    at = pad(room, at, 4);
    memcpy(room->at + at, from, 4);
    return at + 4;
}

static inline size_t eight_put(const struct cdr_room *room, size_t at, const void *from)
{
    at = pad(room, at, 8);
    memcpy(room->at + at, from, 8);
    return at + 8;
}

static inline size_t text_put(struct cdr_room *room, size_t at, const char *text)
{
    uint32_t len = text && text[0] ? (uint32_t)strlen(text) + 1 : 1;
    at = four_put(room, at, &len);
    room_make(room, at, len);
    if (len > 1) {
        memcpy(room->at + at, text, len);
    } else {
        room->at[at] = '\0';
    }
    return at + len;
}

static size_t struct_put(struct cdr_room *room, size_t at, const char *from, const uint32_t *ops);

static size_t structs_put(struct cdr_room *room, size_t at, const dds_sequence_t *from,
                          const uint32_t *ops)
{
    const char *element = (const char *)from->_buffer;
    at = four_put(room, at, &from->_length);
    for (uint32_t i = 0; i < from->_length; i++, element += ops[2]) {
        at = struct_put(room, at, element, ops + DDS_OP_ADR_JSR(ops[3]));
    }
    return at;
}

static size_t numbers_put(struct cdr_room *room, size_t at, const dds_sequence_t *from, uint32_t op)
{
    at = four_put(room, at, &from->_length);
    if (from->_length > 0) {
        size_t each = number_size(op), bytes = each * from->_length;
        at = pad(room, at, each);
        room_make(room, at, bytes);
        memcpy(room->at + at, from->_buffer, bytes);
        at += bytes;
    }
    return at;
}

/* A member has its type and its place.  A third word is an enum's greatest value, or where the
 * table of a struct is; a sequence of structs has their size before that. */
static size_t struct_put(struct cdr_room *room, size_t at, const char *from, const uint32_t *ops)
{
    room_make(room, at, 0);
    while (*ops != DDS_OP_RTS) {
        const void *member = from + ops[1];
        switch (type_of(*ops)) {
        case DDS_OP_VAL_STR:
            at = text_put(room, at, *(char *const *)member);
            ops += 2;
            break;
        case DDS_OP_VAL_8BY:
            at = eight_put(room, at, member);
            ops += 2;
            break;
        case DDS_OP_VAL_4BY:
            at = four_put(room, at, member);
            ops += 2;
            break;
        case DDS_OP_VAL_ENU:
            at = four_put(room, at, member);
            ops += 3;
            break;
        case DDS_OP_VAL_BLN:
            room->at[at++] = *(const bool *)member;
            ops += 2;
            break;
        case DDS_OP_VAL_SEQ:
            if (element_of(*ops) == DDS_OP_VAL_STU) {
                at = structs_put(room, at, member, ops);
                ops += 4;
            } else {
                at = numbers_put(room, at, member, *ops);
                ops += 2;
            }
            room_make(room, at, 0);
            break;
        case DDS_OP_VAL_EXT:
            at = struct_put(room, at, member, ops + DDS_OP_ADR_JSR(ops[2]));
            ops += 3;
            break;
        default: MU_ASSERT(!"a type that no topic has");
        }
    }
    return at;
}

size_t cdr_put(struct cdr_room *room, size_t at, const void *sample, const uint32_t *ops)
{
    return struct_put(room, at, sample, ops);
}

/* --- reading ---------------------------------------------------------------------------------- */

struct reading {
    const char *from;
    size_t at, size;
};

/* @return where so many bytes stand, which are read then; NULL: there are none */
static const char *take(struct reading *r, size_t to, size_t bytes)
{
    size_t begin = aligned(r->at, to);
    if (begin > r->size || bytes > r->size - begin) {
        return NULL;
    }
    r->at = begin + bytes;
    return r->from + begin;
}

static bool four_take(struct reading *r, void *to)
{
    const char *from = take(r, 4, 4);
    if (from) {
        memcpy(to, from, 4);
    }
    return from;
}

static bool eight_take(struct reading *r, void *to)
{
    const char *from = take(r, 8, 8);
    if (from) {
        memcpy(to, from, 8);
    }
    return from;
}

static bool truth_take(struct reading *r, bool *to)
{
    const char *from = take(r, 1, 1);
    if (!from || (unsigned char)*from > 1) {
        return false;
    }
    *to = *from;
    return true;
}

static bool word_take(struct reading *r, uint32_t *to, uint32_t greatest)
{
    return four_take(r, to) && *to <= greatest;
}

static bool text_take(struct reading *r, char **to)
{
    uint32_t len;
    const char *text = four_take(r, &len) ? take(r, 1, len) : NULL;
    if (!text || len == 0 || text[len - 1] != '\0') {
        return false;
    }
    if (!*to || (len > 1 && strlen(*to) + 1 < len)) {
        *to = dds_realloc(*to, len);
    }
    if (len > 1) {
        memcpy(*to, text, len);
    } else {
        **to = '\0';
    }
    return true;
}

/* As DDS does it: what a sequence had before it keeps, for the next one to use. */
static bool sequence_room(dds_sequence_t *to, uint32_t count, size_t each)
{
    if (count > SIZE_MAX / each) {
        return false;
    }
    if (to->_length > to->_maximum) {
        to->_maximum = to->_length;
    }
    if (count > to->_maximum && (to->_release || to->_maximum == 0)) {
        to->_buffer = dds_realloc(to->_buffer, count * each);
        memset(to->_buffer + to->_maximum * each, 0, (count - to->_maximum) * each);
        to->_maximum = count;
        to->_release = true;
    }
    return count <= to->_maximum;
}

static bool struct_take(struct reading *r, char *to, const uint32_t *ops);

static bool structs_take(struct reading *r, dds_sequence_t *to, uint32_t count, const uint32_t *ops)
{
    enum { LEAST = 24 }; /* bytes of the shortest struct, an Ack: so memory is bound by what came */
    if (count > (r->size - r->at) / LEAST || !sequence_room(to, count, ops[2])) {
        return false;
    }
    char *element = (char *)to->_buffer;
    for (uint32_t i = 0; i < count; i++, element += ops[2]) {
        if (!struct_take(r, element, ops + DDS_OP_ADR_JSR(ops[3]))) {
            return false;
        }
    }
    return true;
}

static bool numbers_take(struct reading *r, dds_sequence_t *to, uint32_t count, uint32_t op)
{
    size_t each = number_size(op);
    const char *from = count <= r->size / each ? take(r, each, each * count) : NULL;
    if (!from || !sequence_room(to, count, each)) {
        return false;
    }
    memcpy(to->_buffer, from, each * count);
    return true;
}

static inline bool sequence_take(struct reading *r, dds_sequence_t *to, const uint32_t *ops)
{
    uint32_t count;
    if (!four_take(r, &count)) {
        return false;
    }
    bool is_structs = element_of(*ops) == DDS_OP_VAL_STU;
    bool whole = count == 0 ||
                 (is_structs ? structs_take(r, to, count, ops) : numbers_take(r, to, count, *ops));
    to->_length = whole ? count : 0;
    return whole;
}

static bool struct_take(struct reading *r, char *to, const uint32_t *ops)
{
    bool whole = true;
    while (whole && *ops != DDS_OP_RTS) {
        void *member = to + ops[1];
        switch (type_of(*ops)) {
        case DDS_OP_VAL_STR:
            whole = text_take(r, member);
            ops += 2;
            break;
        case DDS_OP_VAL_8BY:
            whole = eight_take(r, member);
            ops += 2;
            break;
        case DDS_OP_VAL_4BY:
            whole = four_take(r, member);
            ops += 2;
            break;
        case DDS_OP_VAL_ENU:
            whole = word_take(r, member, ops[2]);
            ops += 3;
            break;
        case DDS_OP_VAL_BLN:
            whole = truth_take(r, member);
            ops += 2;
            break;
        case DDS_OP_VAL_SEQ:
            whole = sequence_take(r, member, ops);
            ops += element_of(*ops) == DDS_OP_VAL_STU ? 4 : 2;
            break;
        case DDS_OP_VAL_EXT:
            whole = struct_take(r, member, ops + DDS_OP_ADR_JSR(ops[2]));
            ops += 3;
            break;
        default: MU_ASSERT(!"a type that no topic has");
        }
    }
    return whole;
}

bool cdr_take(void *sample, const char *from, size_t size, const uint32_t *ops)
{
    struct reading r = {.from = from, .size = size};
    return struct_take(&r, sample, ops);
}

/* --- frames ----------------------------------------------------------------------------------- */

size_t cdr_frame(struct cdr_room *room, const void *sample, const uint32_t *ops)
{
    size_t end = cdr_put(room, CDR_FRAME_HEAD, sample, ops);
    uint32_t size = (uint32_t)(end + CDR_FRAME_HEAD - 1) / CDR_FRAME_HEAD * CDR_FRAME_HEAD;
    /* CDR, big-endian (0) or little-endian (1), and how many bytes fill its last four up. */
    char encoding[] = {0, __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, 0, (char)((size - end) % 4)};
    memset(room->at + end, 0, size - end);
    memcpy(room->at, &size, sizeof size);
    memcpy(room->at + sizeof size, encoding, sizeof encoding);
    return end;
}

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

dds_return_t cdr_frame_write(dds_entity_t writer, const char *frame, size_t end,
                             dds_time_t source_ns)
{
    const size_t at = sizeof(uint32_t);
    struct payload payload = {.bytes = frame + at, .size = (end - at + 3) / 4 * 4};
    ddsi_serdata_init(&payload.base, &type, SDK_DATA);
    payload.base.timestamp.v = source_ns;
    return dds_forwardcdr(writer, &payload.base);
}
