/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file brokers.h
 * Brokers in a test's own process, and what it asks each of them.
 */
#ifndef MUSTER_TESTS_BROKERS_H
#define MUSTER_TESTS_BROKERS_H

#include "broker/control/parts.h"

#include <string.h>

/** Nothing closes a broker: the last ones are kept here, so that leak checkers see them. */
static inline struct broker *broker_kept(const struct broker_options *options)
{
    static struct broker *all[256];
    static unsigned count;
    return all[count++ % 256] = broker_open(options);
}

/** The index-th line of the white pages in order of name.  @return false past the last */
static inline bool broker_member(const struct broker *b, uint32_t index, muster_Member *out)
{
    bool there = index < b->registry.live;
    if (there) {
        registry_line(&b->registry, b->registry.order[index], b->name, out);
    }
    return there;
}

/** @return whether the white pages have that name; its line is in out */
static inline bool broker_knows(const struct broker *b, const char *name, muster_Member *out)
{
    for (uint32_t i = 0; broker_member(b, i, out); i++) {
        if (strcmp(out->name, name) == 0) {
            return true;
        }
    }
    return false;
}

#endif
