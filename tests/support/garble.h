/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file garble.h
 * Texts cut off, or with some bytes written over, taken out and put in: what a parser must survive.
 */
#ifndef MUSTER_TESTS_GARBLE_H
#define MUSTER_TESTS_GARBLE_H

#include "core/random.h"

#include <stddef.h>
#include <string.h>

/**
 * Copies a sample with 1 to 8 wounds.
 *
 * @param size  bytes of to; twice the sample's are enough
 * @return the length of what came out, without its zero
 */
static inline size_t garble(struct mu_random *r, char *to, size_t size, const char *sample,
                            size_t len)
{
    /* The characters that mean something in one of our files or another. */
    static const char marks[] = "()[]{}\"'#;,:=.-+*?$&|~<>\\%/_e0195 \t\n\r";
    memcpy(to, sample, len);
    for (int64_t wounds = mu_random_between(r, 1, 8); wounds > 0 && len > 1; wounds--) {
        size_t at = (size_t)mu_random_between(r, 0, (int64_t)len - 1);
        char mark = mu_random_between(r, 0, 1) ? (char)mu_random_between(r, 1, 255)
                                               : marks[mu_random_between(r, 0, sizeof marks - 2)];
        switch (mu_random_between(r, 0, 15)) {
        case 0: /* cut off */ len = at; break;
        case 1:
        case 2: /* taken out */
            memmove(to + at, to + at + 1, len - at - 1);
            len--;
            break;
        case 3:
        case 4: /* put in */
            if (len + 1 < size) {
                memmove(to + at + 1, to + at, len - at);
                to[at] = mark;
                len++;
            }
            break;
        case 5: /* said twice */
            if (2 * (len - at) + at < size) {
                memcpy(to + len, to + at, len - at);
                len += len - at;
            }
            break;
        default: to[at] = mark; break;
        }
    }
    to[len] = '\0';
    return len;
}

#endif
