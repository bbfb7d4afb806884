/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

#include <string.h>

/* Two hosts may have started a broker in the same nanosecond: one must be the earlier one. */
static enum beacon_news namesake_hear(const muster_Beacon *own, const muster_Beacon *beacon)
{
    if (beacon->incarnation != own->incarnation) {
        return beacon->incarnation < own->incarnation ? BEACON_EARLIER : BEACON_LATER;
    }
    int host = strcmp(beacon->host, own->host);
    if (host == 0 && beacon->pid == own->pid) {
        return BEACON_NOTHING; /* our own */
    }
    bool earlier = host < 0 || (host == 0 && beacon->pid < own->pid);
    return earlier ? BEACON_EARLIER : BEACON_LATER;
}

enum beacon_news beacon_table_hear(struct beacon_table *b, const muster_Beacon *beacon)
{
    if (strcmp(beacon->broker, b->own.broker) == 0) {
        return namesake_hear(&b->own, beacon);
    }
    enum beacons_news news = beacons_note(&b->others, beacon);
    if (news == BEACONS_FULL && !b->overflows) {
        b->overflows = true;
        return BEACON_FULL;
    }
    return news == BEACONS_MET ? BEACON_MET : BEACON_NOTHING;
}
