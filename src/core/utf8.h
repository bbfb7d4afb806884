/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file utf8.h
 * Reading UTF-8 that may be broken.
 */
#ifndef MUSTER_CORE_UTF8_H
#define MUSTER_CORE_UTF8_H

#include <stddef.h>
#include <stdint.h>

/** The character in place of bytes that are no UTF-8: U+FFFD. */
#define MU_UTF8_BROKEN      0xfffdu
#define MU_UTF8_BROKEN_TEXT "\xef\xbf\xbd"

/**
 * Decodes the character at s.
 *
 * @param code  the code point; MU_UTF8_BROKEN for a byte that begins no valid character
 * @return its bytes, 1 to 4; 0 at the terminating zero
 */
size_t mu_utf8_next(const char *s, uint32_t *code);

#endif
