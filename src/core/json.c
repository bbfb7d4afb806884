/* SPDX-License-Identifier: Apache-2.0 */
#include "core/json.h"

#include "core/text.h"
#include "muster/result.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void json_put_bytes(struct mu_json *j, const char *s, size_t len)
{
    if (j->file) {
        fwrite(s, 1, len, j->file);
    } else {
        mu_text_add_bytes(j->text, s, len);
    }
}

static void json_put(struct mu_json *j, const char *s)
{
    json_put_bytes(j, s, strlen(s));
}

static void json_break(struct mu_json *j)
{
    if (j->form == MU_JSON_LINE) {
        return;
    }
    json_put(j, "\n");
    for (unsigned i = 0; i < j->depth; i++) {
        json_put(j, "  ");
    }
}

/* The escapes that RFC 8259 names; DEL is escaped for the sake of terminals. */
static void json_put_quoted(struct mu_json *j, const char *s)
{
    static const char named[] = "\"\\\b\f\n\r\t";
    static const char letters[] = "\"\\bfnrt";
    json_put(j, "\"");
    uint32_t code;
    for (size_t len; (len = mu_utf8_next(s, &code)) > 0; s += len) {
        const char *name = code < 0x80 ? strchr(named, (int)code) : NULL;
        if (name) {
            json_put_bytes(j, "\\", 1);
            json_put_bytes(j, &letters[name - named], 1);
        } else if (code < 0x20 || code == 0x7f) {
            char escape[8];
            snprintf(escape, sizeof escape, "\\u%04x", (unsigned)code);
            json_put(j, escape);
        } else if (code == MU_UTF8_BROKEN) {
            json_put(j, MU_UTF8_BROKEN_TEXT);
        } else {
            json_put_bytes(j, s, len);
        }
    }
    json_put(j, "\"");
}

static void json_lead_in(struct mu_json *j, const char *key)
{
    if (j->depth > 0) {
        if (!j->empty[j->depth - 1]) {
            json_put(j, j->form == MU_JSON_LINE ? ", " : ",");
        }
        j->empty[j->depth - 1] = false;
        json_break(j);
    }
    if (key) {
        json_put_quoted(j, key);
        json_put(j, ": ");
    }
}

static void json_put_value(struct mu_json *j, const char *key, const char *value)
{
    json_lead_in(j, key);
    json_put(j, value);
}

static void json_open(struct mu_json *j, const char *key, const char *open, char close)
{
    MU_ASSERT(j->depth < MU_JSON_DEPTH_MAX);
    json_put_value(j, key, open);
    j->close[j->depth] = close;
    j->empty[j->depth] = true;
    j->depth++;
}

void mu_json_to_file(struct mu_json *j, FILE *file, enum mu_json_form form)
{
    *j = (struct mu_json){.file = file, .form = form};
}

void mu_json_to_text(struct mu_json *j, struct mu_text *text, enum mu_json_form form)
{
    *j = (struct mu_json){.text = text, .form = form};
}

void mu_json_object(struct mu_json *j, const char *key)
{
    json_open(j, key, "{", '}');
}

struct mu_json mu_json_line(FILE *file)
{
    struct mu_json j = {.file = file, .form = MU_JSON_LINE};
    mu_json_object(&j, NULL);
    return j;
}

void mu_json_list(struct mu_json *j, const char *key)
{
    json_open(j, key, "[", ']');
}

void mu_json_end(struct mu_json *j)
{
    MU_ASSERT(j->depth > 0);
    j->depth--;
    if (!j->empty[j->depth]) {
        json_break(j);
    }
    json_put_bytes(j, &j->close[j->depth], 1);
    if (j->depth == 0) {
        json_put(j, "\n");
    }
}

void mu_json_string(struct mu_json *j, const char *key, const char *value)
{
    json_lead_in(j, key);
    if (value) {
        json_put_quoted(j, value);
    } else {
        json_put(j, "null");
    }
}

void mu_json_bool(struct mu_json *j, const char *key, bool value)
{
    json_put_value(j, key, value ? "true" : "false");
}

void mu_json_int(struct mu_json *j, const char *key, int64_t value)
{
    char number[MU_JSON_NUMBER_MAX];
    snprintf(number, sizeof number, "%" PRId64, value);
    json_put_value(j, key, number);
}

void mu_json_uint(struct mu_json *j, const char *key, uint64_t value)
{
    char number[MU_JSON_NUMBER_MAX];
    snprintf(number, sizeof number, "%" PRIu64, value);
    json_put_value(j, key, number);
}

void mu_json_number(char number[MU_JSON_NUMBER_MAX], double value)
{
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(number, MU_JSON_NUMBER_MAX, "%.*g", digits, value);
        double back = strtod(number, NULL);
        if (!(back < value) && !(back > value)) {
            return;
        }
    }
}

void mu_json_real(struct mu_json *j, const char *key, double value)
{
    if (!isfinite(value)) {
        json_put_value(j, key, "null");
        return;
    }
    char number[MU_JSON_NUMBER_MAX];
    mu_json_number(number, value);
    json_put_value(j, key, number);
}
