/* SPDX-License-Identifier: Apache-2.0 */
#include "core/fields.h"

#include <string.h>

static const char blanks[] = " \t\r\n";

/* Symbols of CLIPS: printable, without delimiters, not like a variable or a number. */
static bool is_symbol(const char *s)
{
    if (s[0] == '\0' || strchr("?$<+-.0123456789", s[0])) {
        return false;
    }
    for (const char *c = s; *c; c++) {
        if ((unsigned char)*c <= ' ' || *c == 127 || strchr("\"();&|~<", *c)) {
            return false;
        }
    }
    return true;
}

void mu_fields_quote(struct mu_text *t, const char *s)
{
    mu_text_add(t, "\"");
    for (const char *c = s; *c; c++) {
        if (*c == '"' || *c == '\\') {
            mu_text_add(t, "\\");
        }
        mu_text_add_bytes(t, c, 1);
    }
    mu_text_add(t, "\"");
}

void mu_fields_add_string(struct mu_text *t, const char *s)
{
    mu_text_add(t, " ");
    mu_fields_quote(t, s);
}

void mu_fields_add(struct mu_text *t, const char *s)
{
    if (!is_symbol(s)) {
        mu_fields_add_string(t, s);
        return;
    }
    mu_text_add(t, " ");
    mu_text_add(t, s);
}

bool mu_fields_next(const char **content, struct mu_text *out)
{
    const char *c = *content + strspn(*content, blanks);
    mu_text_clear(out);
    if (*c == '"') {
        for (c++; *c && *c != '"'; c++) {
            c += *c == '\\' && c[1];
            mu_text_add_bytes(out, c, 1);
        }
        if (*c++ != '"') {
            return false;
        }
    } else {
        size_t len = strcspn(c, " \t\r\n\"()");
        mu_text_add_bytes(out, c, len);
        c += len;
        if (len == 0) {
            return false;
        }
    }
    *content = c;
    return !out->cut;
}

bool mu_fields_end(const char *content)
{
    return content[strspn(content, blanks)] == '\0';
}
