/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file local_parcels.h
 * The parcels of a Delivery as bytes.  In a step with many receivers each mail is written and read
 * many times, and DDS takes five times as long for it.  So DDS has one parcel alone, the last, and
 * all that stands around the parcels; the others are put before it, in the same CDR.
 */
#ifndef MUSTER_BUS_LOCAL_PARCELS_H
#define MUSTER_BUS_LOCAL_PARCELS_H

#include "bus/bus.h"
#include "wire.h"

/** @return whether it is worth it */
static inline bool local_parcels_are_several(const muster_Delivery *d)
{
    return d->parcels._length > 1;
}

/** Writes a Delivery with several parcels behind a head of LOCAL_HEAD bytes, with room for as much
 * behind it.  @return where it ends, 0: DDS cannot; frame: where it begins, in a room of the
 * bus's */
size_t local_parcels_write(struct bus *bus, const muster_Delivery *d, char **frame);

/** Reads all parcels but the last, behind the place of the first one; others: how many.
 * @return what is left for DDS, in the room; body: there are no others; NULL: malformed */
char *local_parcels_take(struct local_room *room, muster_Delivery *d, char *body, uint32_t *size,
                         uint32_t *others);

/** Puts the parcel that DDS has read behind the others. */
void local_parcels_join(muster_Delivery *d, uint32_t others);

#endif
