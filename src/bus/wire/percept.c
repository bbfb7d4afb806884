/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/wire/percept.h"

#include <math.h>

/* Records are handed over as they are: both structs have the same fields in the same places. */
#define SAME(ours, wires, member) \
    _Static_assert(offsetof(struct ours, member) == offsetof(wires, member), #member);
#define SAME_BLOB(type, member, ...)     SAME(mu_blob, muster_Blob, member)
#define SAME_FIDUCIAL(type, member, ...) SAME(mu_fiducial, muster_Fiducial, member)
MU_BLOB(SAME_BLOB)
MU_FIDUCIAL(SAME_FIDUCIAL)

#define COPY(type, member, ...) to->member = from->member;

#define PACK(id, senses, type, list, count, ...)                     \
    _Static_assert(sizeof(type) == sizeof *to->list._buffer, #list); \
    to->list._buffer = (void *)(uintptr_t)from->list;                \
    to->list._length = to->list._maximum = (uint32_t)from->count;

void percept_pack(muster_Percept *to, const struct mu_percept *from)
{
    MU_READINGS(COPY)
    MU_CHANNELS(PACK)
}

#define UNPACK(id, senses, type, list, count, ...) \
    to->list = (const type *)from->list._buffer;   \
    to->count = from->list._length;

void percept_unpack(struct mu_percept *to, const muster_Percept *from)
{
    to->robot = from->robot;
    MU_READINGS(COPY)
    MU_CHANNELS(UNPACK)
}

static bool float_ok(const float *at)
{
    return isfinite(*at);
}

/* A whole number or a flag is finite as a double, too. */
#define FINITE(type, member, ...) &&isfinite((double)at->member)

static bool blob_ok(const muster_Blob *at)
{
    return true MU_BLOB(FINITE);
}

static bool fiducial_ok(const muster_Fiducial *at)
{
    return true MU_FIDUCIAL(FINITE);
}

static bool body_ok(const muster_Percept *at)
{
    return true MU_READINGS(FINITE);
}

#define ELEMENT_OK(x) \
    _Generic((x), float * : float_ok, muster_Blob * : blob_ok, muster_Fiducial * : fiducial_ok)(x)
#define LIST_OK(id, senses, type, list, count, most, ...)  \
    ok = ok && p->list._length <= (most);                  \
    for (uint32_t i = 0; ok && i < p->list._length; i++) { \
        ok = ELEMENT_OK(&p->list._buffer[i]);              \
    }

bool percept_ok(const muster_Percept *p)
{
    bool ok = body_ok(p);
    MU_CHANNELS(LIST_OK)
    return ok;
}
