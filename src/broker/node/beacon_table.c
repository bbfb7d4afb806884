/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

#include <string.h>

/* Two hosts may have started a broker in the same nanosecond: one must be the earlier one. */
static enum beacon_news namesake_hear(const struct beacon_table *b, const muster_Beacon *beacon)
{
    if (beacon->incarnation != b->incarnation) {
        return beacon->incarnation < b->incarnation ? BEACON_EARLIER : BEACON_LATER;
    }
    int host = strcmp(beacon->host, b->host);
    if (host == 0 && beacon->pid == b->pid) {
        return BEACON_NOTHING; /* our own */
    }
    bool earlier = host < 0 || (host == 0 && beacon->pid < b->pid);
    return earlier ? BEACON_EARLIER : BEACON_LATER;
}

enum beacon_news beacon_table_hear(struct beacon_table *b, const muster_Beacon *beacon)
{
    if (strcmp(beacon->broker, b->name) == 0) {
        return namesake_hear(b, beacon);
    }
    return beacons_note(&b->others, beacon) == BEACONS_MET ? BEACON_MET : BEACON_NOTHING;
}
