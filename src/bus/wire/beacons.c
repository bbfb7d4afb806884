/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/wire/beacons.h"

#include "core/text.h"

#include <string.h>

struct beacons_broker *beacons_find(struct beacons *b, const char *name)
{
    for (uint32_t i = 0; i < b->count; i++) {
        if (strcmp(b->at[i].name, name) == 0) {
            return &b->at[i];
        }
    }
    return NULL;
}

static struct beacons_broker *broker_add(struct beacons *b)
{
    if (b->count < MU_BROKERS_MAX) {
        return &b->at[b->count++];
    }
    for (uint32_t i = 0; i < b->count; i++) {
        if (!b->at[i].there) {
            return &b->at[i];
        }
    }
    return NULL;
}

enum beacons_news beacons_note(struct beacons *b, const muster_Beacon *beacon)
{
    struct beacons_broker *known = beacons_find(b, beacon->broker);
    bool is_there = known && known->there;
    bool is_same = is_there && known->incarnation == beacon->incarnation;
    /* A second broker of a name takes no agents until it is sure of it, and then it is not there
     * any more: it does not hide the first. */
    if (is_there && !is_same && !beacon->takes_agents) {
        return BEACONS_KNOWN;
    }
    known = known ? known : broker_add(b);
    if (!known) {
        return BEACONS_FULL;
    }
    *known = (struct beacons_broker){.incarnation = beacon->incarnation,
                                     .index = beacon->index,
                                     .agents = beacon->agents,
                                     .there = true,
                                     .takes_agents = beacon->takes_agents};
    mu_text_copy(known->name, sizeof known->name, beacon->broker);
    mu_text_copy(known->host, sizeof known->host, beacon->host);
    return is_same ? BEACONS_KNOWN : BEACONS_MET;
}

bool beacons_lose(struct beacons *b, const char *name)
{
    struct beacons_broker *known = beacons_find(b, name);
    bool was_there = known && known->there;
    if (was_there) {
        known->there = false;
    }
    return was_there;
}
