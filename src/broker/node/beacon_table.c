/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

#include "core/text.h"

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

static struct beacon_other *other_find(struct beacon_table *b, const char *name)
{
    for (uint32_t i = 0; i < b->count; i++) {
        if (strcmp(b->others[i].name, name) == 0) {
            return &b->others[i];
        }
    }
    return NULL;
}

/* A silent one makes room. */
static struct beacon_other *other_add(struct beacon_table *b, const char *name)
{
    struct beacon_other *other = NULL;
    if (b->count < MU_BROKERS_MAX) {
        other = &b->others[b->count++];
    }
    for (uint32_t i = 0; i < b->count && !other; i++) {
        other = b->others[i].there ? NULL : &b->others[i];
    }
    if (other) {
        *other = (struct beacon_other){0};
        mu_text_copy(other->name, sizeof other->name, name);
    }
    return other;
}

enum beacon_news beacon_table_hear(struct beacon_table *b, const muster_Beacon *beacon)
{
    if (strcmp(beacon->broker, b->name) == 0) {
        return namesake_hear(b, beacon);
    }
    struct beacon_other *other = other_find(b, beacon->broker);
    /* A second one of its name, which is not sure of it yet: the first goes on. */
    if (other && other->there && other->incarnation != beacon->incarnation &&
        !beacon->takes_agents) {
        return BEACON_NOTHING;
    }
    other = other ? other : other_add(b, beacon->broker);
    if (!other) {
        b->refused++;
        return BEACON_NOTHING;
    }
    bool known = other->there && other->incarnation == beacon->incarnation;
    other->there = true;
    other->incarnation = beacon->incarnation;
    return known ? BEACON_NOTHING : BEACON_MET;
}

bool beacon_table_lose(struct beacon_table *b, const char *name)
{
    struct beacon_other *other = other_find(b, name);
    bool was_there = other && other->there;
    if (was_there) {
        other->there = false;
    }
    return was_there;
}
