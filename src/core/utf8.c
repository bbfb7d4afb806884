/* SPDX-License-Identifier: Apache-2.0 */
#include "core/utf8.h"

#include <stdbool.h>

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
