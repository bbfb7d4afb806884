/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/choice.h"

#include "core/text.h"

#include <string.h>

const struct choice_broker *choice_find(const struct choice *c, const char *name)
{
    for (uint32_t i = 0; i < c->count; i++) {
        if (strcmp(c->brokers[i].name, name) == 0) {
            return &c->brokers[i];
        }
    }
    return NULL;
}

static struct choice_broker *broker_of(struct choice *c, const char *name)
{
    const struct choice_broker *b = choice_find(c, name);
    return b ? &c->brokers[b - c->brokers] : NULL;
}

static struct choice_broker *broker_add(struct choice *c)
{
    if (c->count < MU_BROKERS_MAX) {
        return &c->brokers[c->count++];
    }
    for (uint32_t i = 0; i < c->count; i++) {
        if (!c->brokers[i].there) {
            return &c->brokers[i];
        }
    }
    return NULL;
}

void choice_note(struct choice *c, const muster_Beacon *beacon)
{
    struct choice_broker *b = broker_of(c, beacon->broker);
    /* A second broker of a name takes no agents until it is sure of it, and then it is not there
     * any more: it does not hide the first. */
    if (b && b->there && b->incarnation != beacon->incarnation && !beacon->takes_agents) {
        return;
    }
    b = b ? b : broker_add(c);
    if (!b) {
        return;
    }
    *b = (struct choice_broker){.incarnation = beacon->incarnation,
                                .index = beacon->index,
                                .there = true,
                                .takes_agents = beacon->takes_agents};
    mu_text_copy(b->name, sizeof b->name, beacon->broker);
    mu_text_copy(b->host, sizeof b->host, beacon->host);
}

void choice_lose(struct choice *c, const char *name)
{
    struct choice_broker *b = broker_of(c, name);
    if (b) {
        b->there = false;
    }
}

static bool is_better(const struct choice_broker *a, const struct choice_broker *b,
                      const char *host)
{
    bool near_a = strcmp(a->host, host) == 0;
    bool near_b = strcmp(b->host, host) == 0;
    if (near_a != near_b) {
        return near_a;
    }
    return a->index != b->index ? a->index < b->index : strcmp(a->name, b->name) < 0;
}

const struct choice_broker *choice_best(const struct choice *c, const char *host,
                                        const char *wanted)
{
    const struct choice_broker *best = NULL;
    for (uint32_t i = 0; i < c->count; i++) {
        const struct choice_broker *b = &c->brokers[i];
        bool will_do = b->there && b->takes_agents && (!wanted || strcmp(b->name, wanted) == 0);
        if (will_do && (!best || is_better(b, best, host))) {
            best = b;
        }
    }
    return best;
}

bool choice_is_final(const struct choice_broker *b, const char *host, const char *wanted)
{
    return wanted || (b->index == 0 && strcmp(b->host, host) == 0);
}
