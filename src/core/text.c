/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text.h"

#include "muster/result.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void mu_text_init(struct mu_text *t, char *buffer, size_t size)
{
    MU_ASSERT(size >= 1);
    *t = (struct mu_text){.at = buffer, .size = size};
    buffer[0] = '\0';
}

void mu_text_clear(struct mu_text *t)
{
    mu_text_init(t, t->at, t->size);
}

void mu_text_add_bytes(struct mu_text *t, const char *s, size_t len)
{
    size_t room = t->size - t->len - 1;
    if (len > room) {
        len = room;
        t->cut = true;
    }
    memcpy(t->at + t->len, s, len);
    t->len += len;
    t->at[t->len] = '\0';
}

void mu_text_add(struct mu_text *t, const char *s)
{
    mu_text_add_bytes(t, s, strlen(s));
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
    struct mu_text t;
    mu_text_init(&t, to, size);
    mu_text_add(&t, from);
    return !t.cut;
}

/* A longer word is cut: each of its bytes may take four when it is shown. */
enum { SHOWN_BYTES = 24 };

const char *mu_text_show(char shown[MU_TEXT_SHOWN], const char *word)
{
    struct mu_text t;
    mu_text_init(&t, shown, MU_TEXT_SHOWN);
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
