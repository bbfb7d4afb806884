/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file told.h
 * What the server of the page tells one of its viewers.
 */
#ifndef MUSTER_TESTS_TOLD_H
#define MUSTER_TESTS_TOLD_H

#include "suite.h"
#include "web/web.h"

#include <string.h>

/** @return all that a viewer was told of its own since it was looked at last, as it is sent; good
 *          until the next call */
static inline const char *told(struct viewer *v)
{
    static const struct board nothing;
    static char got[64 * 1024];
    size_t len = 0, more;
    while ((more = stream_read(&v->stream, &nothing, got + len, sizeof got - len - 1)) > 0) {
        len += more;
    }
    got[len] = '\0';
    return got;
}

/** Fails the test when the text has no such part. */
static inline void has(const char *text, const char *part)
{
    if (!strstr(text, part)) {
        READS(text, part);
    }
}

#endif
