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

/* Where a number begins, from a place on; the length when none does. */
static inline size_t garble_find_number(const char *text, size_t len, size_t from)
{
    for (size_t i = from > 0 ? from : 1; i < len; i++) {
        if (strchr("-.0123456789", text[i]) && strchr(" [", text[i - 1])) {
            return i;
        }
    }
    return len;
}

/**
 * Copies a sample with one number replaced by another one, of those that formulas like least.
 *
 * @param to  16 bytes more than the sample has
 * @return the length of what came out, without its zero
 */
static inline size_t garble_number(struct mu_random *r, char *to, const char *sample, size_t len)
{
    static const char *const numbers[] = {
        "0",   "-1",  "1e-9", "1e-300", "0.001", "0.05", "0.5",   "3",
        "100", "360", "1024", "65536",  "99999", "1e9",  "1e308", "-1e308",
    };
    size_t at = (size_t)mu_random_between(r, 0, (int64_t)len - 1);
    at = garble_find_number(sample, len, at);
    size_t end = at;
    while (end < len && strchr("-+.0123456789e", sample[end])) {
        end++;
    }
    const char *number = at < len ? numbers[mu_random_between(r, 0, 15)] : "";
    memcpy(to, sample, at);
    memcpy(to + at, number, strlen(number));
    memcpy(to + at + strlen(number), sample + end, len - end);
    len = at + strlen(number) + len - end;
    to[len] = '\0';
    return len;
}

#endif
