/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file text.h
 * Text that is put together in a buffer of fixed size.
 */
#ifndef MUSTER_CORE_TEXT_H
#define MUSTER_CORE_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Bytes of a word as it is shown, with the zero. */
enum { MU_TEXT_SHOWN = 128 };

struct mu_text {
    char *at;    /* always zero-terminated */
    size_t len;  /* bytes, without the zero */
    size_t size; /* bytes of the buffer */
    bool cut;    /* something did not fit */
};

/** Makes an empty text in the caller's buffer; size >= 1. */
struct mu_text mu_text_in(char *buffer, size_t size);
void mu_text_init(struct mu_text *t, char *buffer, size_t size);

/** Empties it. */
void mu_text_clear(struct mu_text *t);

/** Adds as much as fits of len bytes, which must not all fit. */
void mu_text_add_cut(struct mu_text *t, const char *s, size_t len);

/** Adds len bytes of a string, or as many as fit. */
static inline void mu_text_add_bytes(struct mu_text *t, const char *s, size_t len)
{
    if (len < t->size - t->len) {
        memcpy(t->at + t->len, s, len);
        t->len += len;
        t->at[t->len] = '\0';
    } else {
        mu_text_add_cut(t, s, len);
    }
}

/** Adds a string, or as much of it as fits. */
static inline void mu_text_add(struct mu_text *t, const char *s)
{
    mu_text_add_bytes(t, s, strlen(s)); /* of a constant it is known */
}

/** Adds len bytes of a stranger's text, for a terminal: "?" stands for each control character. */
void mu_text_add_plain(struct mu_text *t, const char *s, size_t len);

/** Adds a whole number, or as much of it as fits: a tenth of the time of mu_text_format. */
void mu_text_add_number(struct mu_text *t, long long number);

/** Adds formatted text; all of it or, cut, as much as fits. */
void mu_text_format(struct mu_text *t, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/** Copies a string into a buffer of size bytes.  @return whether all of it fitted */
bool mu_text_copy(char *to, size_t size, const char *from);

/** Makes typed text fit for one line of a terminal: short, and printable. */
const char *mu_text_show(char shown[MU_TEXT_SHOWN], const char *word);

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
