/* SPDX-License-Identifier: Apache-2.0 */
/*
 * (format), as the engine has it, with an end to everything: the engine prints into a buffer that
 * has 200 bytes more than the directive, whatever the directive wants.
 */
#include "mind/engine/value.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    FORMAT_FIRST_ARGUMENT = 3, /* behind the logical name and the text */
    FORMAT_FIELD_MAX = 1024,   /* width and precision */
    FORMAT_NUMBER_MAX = 400 + FORMAT_FIELD_MAX,
    FORMAT_RESULT_MAX = 1 << 20, /* bytes */
    FORMAT_ROOM_FIRST = 256
};

/* What stands between a percent sign and the letter behind it. */
struct format_directive {
    const char *at;
    int len;   /* with the percent sign and the letter */
    char type; /* the letter; '\0': there is none, and it stands for itself */
    bool left, zeros;
    int width, precision; /* precision < 0: not said */
};

struct format_text {
    void *env;
    char *at;
    size_t len, room;
    bool full;
};

/* --- the result ------------------------------------------------------------------------------- */

static void format_add(struct format_text *t, const char *bytes, size_t len)
{
    if (len > FORMAT_RESULT_MAX - t->len) {
        t->full = true;
        return;
    }
    if (t->len + len > t->room || t->room == 0) {
        size_t room = t->room > 0 ? t->room : FORMAT_ROOM_FIRST;
        while (room < t->len + len) {
            room *= 2;
        }
        char *more = gm2(t->env, room + 1);
        if (t->room > 0) {
            memcpy(more, t->at, t->len);
            rm(t->env, t->at, t->room + 1);
        }
        t->at = more;
        t->room = room;
    }
    if (len > 0) {
        memcpy(t->at + t->len, bytes, len);
        t->len += len;
    }
}

static void format_pad(struct format_text *t, char with, size_t count)
{
    char bytes[FORMAT_FIELD_MAX];
    memset(bytes, with, count);
    format_add(t, bytes, count);
}

/* Adds what a directive has made of its argument, as wide as it wants. */
static void format_add_field(struct format_text *t, const struct format_directive *d,
                             const char *bytes, size_t len, bool zeros)
{
    size_t width = (size_t)d->width, missing = len < width ? width - len : 0;
    if (d->left) {
        format_add(t, bytes, len);
        format_pad(t, ' ', missing);
        return;
    }
    size_t sign = zeros && len > 0 && bytes[0] == '-';
    format_add(t, bytes, sign);
    format_pad(t, zeros ? '0' : ' ', missing);
    format_add(t, bytes + sign, len - sign);
}

/* --- directives ------------------------------------------------------------------------------- */

/* Reads a count.  One that is too large is one more than may be. */
static int format_count(const char **at)
{
    int count = 0;
    for (; **at >= '0' && **at <= '9'; (*at)++) {
        count = count > FORMAT_FIELD_MAX ? count : count * 10 + (**at - '0');
    }
    return count > FORMAT_FIELD_MAX ? FORMAT_FIELD_MAX + 1 : count;
}

/* Reads the directive whose percent sign is at at. */
static struct format_directive format_read(const char *at)
{
    struct format_directive d = {.at = at, .precision = -1};
    const char *s = at + 1;
    for (; *s == '-' || *s == '0'; s++) {
        d.left = d.left || *s == '-';
        d.zeros = d.zeros || *s == '0';
    }
    d.width = format_count(&s);
    if (*s == '.') {
        s++;
        d.precision = format_count(&s);
    }
    if (*s && (*s != '%' || s == at + 1)) {
        d.type = *s++;
    }
    d.len = (int)(s - at);
    return d;
}

/* @return whether it wants no argument, and adds what it stands for to t, which may be NULL */
static bool format_is_plain(struct format_text *t, const struct format_directive *d)
{
    static const char letters[] = "nrtv%", meant[] = "\n\r\t\v%";
    const char *letter = d->len == 2 && d->type ? strchr(letters, d->type) : NULL;
    if (!letter && d->type) {
        return false;
    }
    if (t && letter) {
        format_add(t, &meant[letter - letters], 1);
    } else if (t) {
        format_add(t, d->at, (size_t)d->len);
    }
    return true;
}

static void format_refuse_directive(void *env, const struct format_directive *d)
{
    char bytes[128];
    snprintf(bytes, sizeof bytes, "Invalid format flag \"%.*s\" specified in format function.\n",
             d->len < 64 ? d->len : 64, d->at);
    PrintErrorID(env, "IOFUN", 3, FALSE);
    EnvPrintRouter(env, WERROR, bytes);
    SetEvaluationError(env, TRUE);
}

/* Looks at all directives before the first is carried out. */
static bool format_check(void *env, const char *text)
{
    int wanted = FORMAT_FIRST_ARGUMENT - 1;
    for (const char *at = strchr(text, '%'); at; at = strchr(at, '%')) {
        struct format_directive d = format_read(at);
        at += d.len;
        if (format_is_plain(NULL, &d)) {
            continue;
        }
        if (!strchr("doxucsefg", d.type)) {
            format_refuse_directive(env, &d);
            return false;
        }
        if (d.width > FORMAT_FIELD_MAX || d.precision > FORMAT_FIELD_MAX) {
            clips_value_refuse(env, "format", "a width and a precision of at most 1024");
            return false;
        }
        wanted++;
    }
    if (EnvRtnArgCount(env) != wanted) {
        ExpectedCountError(env, "format", EXACTLY, wanted);
        SetEvaluationError(env, TRUE);
        return false;
    }
    return true;
}

/* --- arguments -------------------------------------------------------------------------------- */

static bool format_add_word(struct format_text *t, const struct format_directive *d, int index)
{
    DATA_OBJECT value;
    if (!EnvArgTypeCheck(t->env, "format", index, SYMBOL_OR_STRING, &value)) {
        return false;
    }
    const char *word = ValueToString(value.value);
    size_t len = d->precision < 0 ? strlen(word) : strnlen(word, (size_t)d->precision);
    format_add_field(t, d, word, len, false);
    return true;
}

static bool format_add_letter(struct format_text *t, const struct format_directive *d, int index)
{
    DATA_OBJECT value;
    EnvRtnUnknown(t->env, index, &value);
    bool word = value.type == STRING || value.type == SYMBOL;
    if (!word && value.type != INTEGER) {
        ExpectedTypeError1(t->env, "format", index, "symbol, string, or integer");
        return false;
    }
    char letter = word ? ValueToString(value.value)[0] : (char)ValueToLong(value.value);
    format_add_field(t, d, &letter, letter != '\0', false);
    return true;
}

/* A number without its fraction; one that is too large for that is the same on every machine. */
static long long format_whole(const DATA_OBJECT *value)
{
    if (value->type == INTEGER) {
        return ValueToLong(value->value);
    }
    double number = ValueToDouble(value->value);
    return number >= -0x1p63 && number < 0x1p63 ? (long long)number : INT64_MIN;
}

/* @return the bytes printed */
static int format_print_whole(char *bytes, const struct format_directive *d, long long number)
{
    unsigned long long bits = (unsigned long long)number;
    switch (d->type) {
    case 'o': return snprintf(bytes, FORMAT_NUMBER_MAX, "%.*llo", d->precision, bits);
    case 'x': return snprintf(bytes, FORMAT_NUMBER_MAX, "%.*llx", d->precision, bits);
    case 'u': return snprintf(bytes, FORMAT_NUMBER_MAX, "%.*llu", d->precision, bits);
    default: return snprintf(bytes, FORMAT_NUMBER_MAX, "%.*lld", d->precision, number);
    }
}

static int format_print_real(char *bytes, const struct format_directive *d, double number)
{
    switch (d->type) {
    case 'e': return snprintf(bytes, FORMAT_NUMBER_MAX, "%.*e", d->precision, number);
    case 'g': return snprintf(bytes, FORMAT_NUMBER_MAX, "%.*g", d->precision, number);
    default: return snprintf(bytes, FORMAT_NUMBER_MAX, "%.*f", d->precision, number);
    }
}

static bool format_add_number(struct format_text *t, const struct format_directive *d, int index)
{
    char bytes[FORMAT_NUMBER_MAX];
    DATA_OBJECT value;
    if (!EnvArgTypeCheck(t->env, "format", index, INTEGER_OR_FLOAT, &value)) {
        return false;
    }
    bool whole = strchr("doxu", d->type);
    double real = clips_value_of(value.type, value.value);
    int len = whole ? format_print_whole(bytes, d, format_whole(&value))
                    : format_print_real(bytes, d, real);
    MU_ASSERT(len >= 0 && len < FORMAT_NUMBER_MAX);
    bool zeros = d->zeros && (whole ? d->precision < 0 : isfinite(real));
    format_add_field(t, d, bytes, (size_t)len, zeros);
    return true;
}

static bool format_add_argument(struct format_text *t, const struct format_directive *d, int index)
{
    switch (d->type) {
    case 's': return format_add_word(t, d, index);
    case 'c': return format_add_letter(t, d, index);
    default: return format_add_number(t, d, index);
    }
}

/* --- the function ----------------------------------------------------------------------------- */

/* @return false: it ended in an error */
static bool format_print(struct format_text *t, const char *text)
{
    int index = FORMAT_FIRST_ARGUMENT;
    while (*text && !t->full) {
        if (*text != '%') {
            size_t len = strcspn(text, "%");
            format_add(t, text, len);
            text += len;
            continue;
        }
        struct format_directive d = format_read(text);
        text += d.len;
        if (!format_is_plain(t, &d) && !format_add_argument(t, &d, index++)) {
            return false;
        }
    }
    if (t->full) {
        clips_value_refuse(t->env, "format", "a result of at most 1048576 bytes");
    }
    return !t->full;
}

/* The text of the second argument, or NULL: the call ended in an error. */
static const char *format_begin(void *env, const char **where)
{
    DATA_OBJECT text;
    *where = GetLogicalName(env, 1, "stdout");
    if (!*where) {
        IllegalLogicalNameMessage(env, "format");
        SetHaltExecution(env, TRUE);
        SetEvaluationError(env, TRUE);
        return NULL;
    }
    if (strcmp(*where, "nil") != 0 && !QueryRouters(env, *where)) {
        UnrecognizedRouterMessage(env, *where);
        return NULL;
    }
    bool known = EnvArgTypeCheck(env, "format", 2, STRING, &text);
    return known && format_check(env, ValueToString(text.value)) ? ValueToString(text.value) : NULL;
}

void *clips_format_call(void *env)
{
    const char *where, *text;
    struct format_text t = {.env = env};
    void *result = EnvAddSymbol(env, "");
    text = EnvArgCountCheck(env, "format", AT_LEAST, 2) < 0 ? NULL : format_begin(env, &where);
    if (text && format_print(&t, text) && t.len > 0) {
        t.at[t.len] = '\0';
        result = EnvAddSymbol(env, t.at);
        if (strcmp(where, "nil") != 0) {
            EnvPrintRouter(env, where, t.at);
        }
    }
    if (t.room > 0) {
        rm(env, t.at, t.room + 1);
    }
    return result;
}
