/* SPDX-License-Identifier: Apache-2.0 */
#include "core/json_read.h"

#include "core/json.h"
#include "core/text.h"
#include "core/utf8.h"

#include <stdlib.h>
#include <string.h>

struct reader {
    const char *file, *text, *at;
    mu_json_take *take;
    void *self;
    struct mu_fault *fault;
    unsigned depth;
    struct mu_text path, string;
    char path_bytes[MU_JSON_PATH_MAX], string_bytes[MU_JSON_TEXT_MAX];
};

static mu_result expected(struct reader *r, const char *what)
{
    int line = 1;
    const char *begin = r->text;
    for (const char *c = r->text; c < r->at; c++) {
        if (*c == '\n') {
            line++;
            begin = c + 1;
        }
    }
    return mu_fault_at(r->fault, r->file, line, (int)(r->at - begin) + 1, "expected %s", what);
}

static void blank_skip(struct reader *r)
{
    r->at += strspn(r->at, " \t\r\n");
}

static bool char_take(struct reader *r, char wanted)
{
    blank_skip(r);
    bool there = *r->at == wanted;
    r->at += there;
    return there;
}

/* --- strings ---------------------------------------------------------------------------------- */

static void code_add(struct mu_text *to, uint32_t code)
{
    char bytes[5] = "";
    if (code < 0x80) {
        bytes[0] = (char)code;
    } else if (code < 0x800) {
        bytes[0] = (char)(0xc0 | code >> 6);
        bytes[1] = (char)(0x80 | (code & 0x3f));
    } else if (code < 0x10000) {
        bytes[0] = (char)(0xe0 | code >> 12);
        bytes[1] = (char)(0x80 | (code >> 6 & 0x3f));
        bytes[2] = (char)(0x80 | (code & 0x3f));
    } else {
        bytes[0] = (char)(0xf0 | code >> 18);
        bytes[1] = (char)(0x80 | (code >> 12 & 0x3f));
        bytes[2] = (char)(0x80 | (code >> 6 & 0x3f));
        bytes[3] = (char)(0x80 | (code & 0x3f));
    }
    mu_text_add(to, code == 0 ? MU_UTF8_BROKEN_TEXT : bytes);
}

/* The four digits behind \u.  @return false: there are none */
static bool unit_read(struct reader *r, uint32_t *unit)
{
    *unit = 0;
    for (int i = 0; i < 4; i++, r->at++) {
        const char *digits = "0123456789abcdef";
        char c = *r->at >= 'A' && *r->at <= 'F' ? (char)(*r->at + 32) : *r->at;
        const char *digit = c ? strchr(digits, c) : NULL;
        if (!digit) {
            return false;
        }
        *unit = *unit * 16 + (uint32_t)(digit - digits);
    }
    return true;
}

/* Two units may make one character (RFC 8259, 7); one that is alone stands for none. */
static mu_result unicode_read(struct reader *r, struct mu_text *to)
{
    uint32_t code, low;
    if (!unit_read(r, &code)) {
        return expected(r, "four hexadecimal digits");
    }
    if (code >= 0xd800 && code < 0xdc00 && r->at[0] == '\\' && r->at[1] == 'u') {
        r->at += 2;
        if (!unit_read(r, &low)) {
            return expected(r, "four hexadecimal digits");
        }
        bool pair = low >= 0xdc00 && low < 0xe000;
        code = pair ? 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00) : MU_UTF8_BROKEN;
    }
    code_add(to, code >= 0xd800 && code < 0xe000 ? MU_UTF8_BROKEN : code);
    return MU_OK;
}

static mu_result escape_read(struct reader *r, struct mu_text *to)
{
    static const char names[] = "\"\\/bfnrt";
    static const char meant[] = "\"\\/\b\f\n\r\t";
    char c = *r->at;
    if (c == 'u') {
        r->at++;
        return unicode_read(r, to);
    }
    const char *name = c ? strchr(names, c) : NULL;
    if (!name) {
        return expected(r, "one of \\\" \\\\ \\/ \\b \\f \\n \\r \\t \\u");
    }
    r->at++;
    mu_text_add_bytes(to, &meant[name - names], 1);
    return MU_OK;
}

/* Behind the opening quote. */
static mu_result string_read(struct reader *r, struct mu_text *to)
{
    while (*r->at != '"') {
        if ((unsigned char)*r->at < 0x20) {
            return expected(r, "the end of a string");
        }
        if (*r->at == '\\') {
            r->at++;
            MU_TRY(escape_read(r, to));
            continue;
        }
        size_t len = strcspn(r->at, "\"\\");
        for (size_t i = 0; i < len; i++) {
            len = (unsigned char)r->at[i] < 0x20 ? i : len;
        }
        mu_text_add_bytes(to, r->at, len);
        r->at += len;
    }
    r->at++;
    return MU_OK;
}

/* --- values ----------------------------------------------------------------------------------- */

static mu_result value_read(struct reader *r);

static void value_tell(struct reader *r, enum mu_json_kind kind, double number, const char *text)
{
    struct mu_json_value value = {kind, number, text};
    r->take(r->self, r->path.at, &value);
}

static bool word_take(struct reader *r, const char *word)
{
    size_t len = strlen(word);
    bool there = strncmp(r->at, word, len) == 0;
    r->at += there ? len : 0;
    return there;
}

/* strtod reads more than JSON has: hexadecimal numbers, infinities. */
static mu_result number_read(struct reader *r)
{
    size_t len = strspn(r->at, "+-.0123456789eE");
    char *end;
    double number = len > 0 && r->at[0] != '+' && r->at[0] != '.' ? strtod(r->at, &end) : 0;
    if (len == 0 || r->at[0] == '+' || r->at[0] == '.' || end != r->at + len) {
        return expected(r, "a value");
    }
    r->at = end;
    value_tell(r, MU_JSON_NUMBER, number, "");
    return MU_OK;
}

static mu_result scalar_read(struct reader *r)
{
    if (char_take(r, '"')) {
        mu_text_clear(&r->string);
        MU_TRY(string_read(r, &r->string));
        value_tell(r, MU_JSON_STRING, 0, r->string.at);
    } else if (word_take(r, "true")) {
        value_tell(r, MU_JSON_BOOL, 1, "");
    } else if (word_take(r, "false")) {
        value_tell(r, MU_JSON_BOOL, 0, "");
    } else if (word_take(r, "null")) {
        value_tell(r, MU_JSON_NULL, 0, "");
    } else {
        return number_read(r);
    }
    return MU_OK;
}

/* One member of an object, or one item of a list, with its name behind the path. */
static mu_result member_read(struct reader *r, bool object, size_t index)
{
    size_t len = r->path.len;
    mu_text_add(&r->path, len > 0 ? "." : "");
    if (!object) {
        mu_text_format(&r->path, "%zu", index);
    } else if (!char_take(r, '"')) {
        return expected(r, "a name in quotes");
    } else {
        MU_TRY(string_read(r, &r->path));
    }
    if (object && !char_take(r, ':')) {
        return expected(r, "':'");
    }
    MU_TRY(value_read(r));
    r->path.len = len;
    r->path.at[len] = '\0';
    r->path.cut = false;
    return MU_OK;
}

static mu_result members_read(struct reader *r, bool object)
{
    char end = object ? '}' : ']';
    if (r->depth == MU_JSON_DEPTH_MAX) {
        return expected(r, "no more than 16 objects and lists in each other");
    }
    r->depth++;
    bool more = !char_take(r, end);
    for (size_t i = 0; more; i++) {
        MU_TRY(member_read(r, object, i));
        more = char_take(r, ',');
        if (!more && !char_take(r, end)) {
            return expected(r, object ? "',' or '}'" : "',' or ']'");
        }
    }
    r->depth--;
    return MU_OK;
}

static mu_result value_read(struct reader *r)
{
    if (char_take(r, '{')) {
        return members_read(r, true);
    }
    return char_take(r, '[') ? members_read(r, false) : scalar_read(r);
}

mu_result mu_json_read(const char *file, const char *text, mu_json_take *take, void *self,
                       struct mu_fault *fault)
{
    struct reader r = {
        .file = file, .text = text, .at = text, .take = take, .self = self, .fault = fault};
    mu_text_init(&r.path, r.path_bytes, sizeof r.path_bytes);
    mu_text_init(&r.string, r.string_bytes, sizeof r.string_bytes);
    MU_TRY(value_read(&r));
    blank_skip(&r);
    return *r.at ? expected(&r, "the end of the file") : MU_OK;
}
