/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text.h"

#include "muster/result.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

struct mu_text mu_text_in(char *buffer, size_t size)
{
    MU_ASSERT(size >= 1);
    buffer[0] = '\0';
    return (struct mu_text){.at = buffer, .size = size};
}

void mu_text_init(struct mu_text *t, char *buffer, size_t size)
{
    *t = mu_text_in(buffer, size);
}

void mu_text_clear(struct mu_text *t)
{
    mu_text_init(t, t->at, t->size);
}

void mu_text_add_cut(struct mu_text *t, const char *s, size_t len)
{
    size_t room = t->size - t->len - 1;
    MU_ASSERT(len > room);
    mu_text_add_bytes(t, s, room);
    t->cut = true;
}

void mu_text_add_number(struct mu_text *t, long long number)
{
    char digits[24];
    size_t at = sizeof digits;
    unsigned long long left = (unsigned long long)number;
    left = number < 0 ? 0 - left : left;
    do {
        digits[--at] = (char)('0' + left % 10);
        left /= 10;
    } while (left > 0);
    mu_text_add(t, number < 0 ? "-" : "");
    mu_text_add_bytes(t, digits + at, sizeof digits - at);
}

/* Control characters, and those of the second set, which in UTF-8 are two bytes. */
static bool is_control(const char *s, size_t len)
{
    const unsigned char *c = (const unsigned char *)s;
    return c[0] < ' ' || c[0] == 0x7f || (c[0] == 0xc2 && len > 1 && c[1] >= 0x80 && c[1] < 0xa0);
}

void mu_text_add_plain(struct mu_text *t, const char *s, size_t len)
{
    size_t begins = 0;
    for (size_t i = 0; i < len; i++) {
        if (is_control(s + i, len - i)) {
            mu_text_add_bytes(t, s + begins, i - begins);
            mu_text_add_bytes(t, "?", 1);
            i += s[i] == '\xc2';
            begins = i + 1;
        }
    }
    mu_text_add_bytes(t, s + begins, len - begins);
}

void mu_text_format(struct mu_text *t, const char *format, ...)
{
    size_t room = t->size - t->len;
    va_list args;
    va_start(args, format);
    int len = vsnprintf(t->at + t->len, room, format, args);
    va_end(args);
    if (len < 0 || (size_t)len >= room) {
        t->cut = true;
        t->len = t->size - 1;
        return;
    }
    t->len += (size_t)len;
}

bool mu_text_copy(char *to, size_t size, const char *from)
{
    struct mu_text t = mu_text_in(to, size);
    mu_text_add(&t, from);
    return !t.cut;
}

/* A longer word is cut: each of its bytes may take four when it is shown. */
enum { SHOWN_BYTES = 24 };

const char *mu_text_show(char shown[MU_TEXT_SHOWN], const char *word)
{
    struct mu_text t = mu_text_in(shown, MU_TEXT_SHOWN);
    for (size_t i = 0; word[i]; i++) {
        unsigned char c = (unsigned char)word[i];
        if (i == SHOWN_BYTES) {
            mu_text_add(&t, "...");
            break;
        }
        if (c < ' ' || c > '~') {
            mu_text_format(&t, "\\x%02x", c);
        } else {
            mu_text_add_bytes(&t, word + i, 1);
        }
    }
    return shown;
}

/* Unicode 15, table 3-6: the lead byte's bits, and the smallest code that may need this length. */
static const struct {
    unsigned char mask, lead;
    uint32_t code_min;
} utf8_forms[] = {{0x80, 0x00, 0}, {0xe0, 0xc0, 0x80}, {0xf0, 0xe0, 0x800}, {0xf8, 0xf0, 0x10000}};

static bool utf8_code_valid(uint32_t code, uint32_t code_min)
{
    bool surrogate = code >= 0xd800 && code <= 0xdfff;
    return code >= code_min && code <= 0x10ffff && !surrogate;
}

size_t mu_utf8_next(const char *s, uint32_t *code)
{
    const unsigned char *byte = (const unsigned char *)s;
    if (byte[0] == '\0') {
        *code = 0;
        return 0;
    }
    for (size_t form = 0; form < sizeof utf8_forms / sizeof utf8_forms[0]; form++) {
        if ((byte[0] & utf8_forms[form].mask) != utf8_forms[form].lead) {
            continue;
        }
        uint32_t value = byte[0] & (unsigned char)~utf8_forms[form].mask;
        size_t at = 1;
        while (at <= form && (byte[at] & 0xc0) == 0x80) {
            value = value << 6 | (byte[at] & 0x3fu);
            at++;
        }
        if (at == form + 1 && utf8_code_valid(value, utf8_forms[form].code_min)) {
            *code = value;
            return at;
        }
    }
    *code = MU_UTF8_BROKEN;
    return 1;
}
