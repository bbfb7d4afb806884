/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/choice.h"

#include <string.h>

void choice_follow(struct beacons *c, const char *name, uint64_t incarnation)
{
    struct beacons_broker *b = beacons_find(c, name);
    if (b) {
        b->incarnation = incarnation;
    }
}

static bool is_better(const struct beacons_broker *a, const struct beacons_broker *b,
                      const char *host)
{
    if (a->takes_agents != b->takes_agents) {
        return a->takes_agents;
    }
    bool near_a = strcmp(a->host, host) == 0;
    bool near_b = strcmp(b->host, host) == 0;
    if (near_a != near_b) {
        return near_a;
    }
    return a->index != b->index ? a->index < b->index : strcmp(a->name, b->name) < 0;
}

const struct beacons_broker *choice_best(const struct beacons *c, const char *host,
                                         const char *wanted)
{
    const struct beacons_broker *best = NULL;
    for (uint32_t i = 0; i < c->count; i++) {
        const struct beacons_broker *b = &c->at[i];
        bool is_sure = b->takes_agents || b->agents > 0; /* a full one refuses in words */
        bool will_do = b->there && is_sure && (!wanted || strcmp(b->name, wanted) == 0);
        if (will_do && (!best || is_better(b, best, host))) {
            best = b;
        }
    }
    return best;
}

bool choice_is_final(const struct beacons_broker *b, const char *host, const char *wanted)
{
    return wanted || (b->takes_agents && b->index == 0 && strcmp(b->host, host) == 0);
}
