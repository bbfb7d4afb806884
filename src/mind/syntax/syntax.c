/* SPDX-License-Identifier: Apache-2.0 */
#include "mind/syntax/syntax.h"

#include "core/fields.h"
#include "mind/syntax/number.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char rewrite_open[] = "=(progn";

static bool is_space(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f';
}

/* @return whether a character belongs to a word of a list of fields; most do by their number */
static bool is_of_field(char c)
{
    return (unsigned char)c > ')' || (c && !is_space(c) && c != '(' && c != ')' && c != '"');
}

/* Characters that end a word in CLIPS. */
static bool is_delimiter(char c)
{
    return c == '\0' || is_space(c) || c == '(' || c == ')' || c == '"' || c == ';';
}

/*
 * @return the place behind the string that begins at s; the end of the text: the string has no end
 */
static const char *skip_string(const char *s, int *line)
{
    for (s++; *s && *s != '"'; s++) {
        *line += *s == '\n';
        if (*s == '\\' && s[1]) {
            s++;
            *line += *s == '\n';
        }
    }
    return *s ? s + 1 : s;
}

static const char *skip_comment(const char *s)
{
    while (*s && *s != '\n') {
        s++;
    }
    return s;
}

static const char *skip_blank(const char *s, int *line)
{
    while (is_space(*s) || *s == ';') {
        if (*s == ';') {
            s = skip_comment(s);
        } else {
            *line += *s == '\n';
            s++;
        }
    }
    return s;
}

static struct syntax_form form_bad(struct syntax_form f, const char *what)
{
    f.kind = SYNTAX_FORM_BAD;
    f.what = what;
    return f;
}

/* @return the rest of a form that begins with a parenthesis */
static struct syntax_form form_list(struct syntax_form f, const char **at, int *line)
{
    const char *s = f.at;
    int depth = 0;
    while (*s) {
        if (*s == ';') {
            s = skip_comment(s);
            continue;
        }
        if (*s == '"') {
            s = skip_string(s, line);
            if (s[-1] != '"') {
                return form_bad(f, "a string without its closing quote");
            }
            continue;
        }
        *line += *s == '\n';
        depth += (*s == '(') - (*s == ')');
        s++;
        if (depth > SYNTAX_NESTING_MAX) {
            return form_bad(f, "more than 256 nested parentheses");
        }
        if (depth == 0) {
            f.len = (size_t)(s - f.at);
            *at = s;
            return f;
        }
    }
    f.len = (size_t)(s - f.at);
    *at = s;
    return form_bad(f, "a parenthesis is never closed");
}

struct syntax_form syntax_read_form(const char **at, int *line)
{
    const char *s = skip_blank(*at, line);
    struct syntax_form f = {.kind = SYNTAX_FORM_LIST, .at = s, .line = *line};
    *at = s;
    if (*s == '\0') {
        f.kind = SYNTAX_FORM_END;
        return f;
    }
    if (*s == '(') {
        return form_list(f, at, line);
    }
    if (*s == ')') {
        f.len = 1;
        *at = s + 1;
        return form_bad(f, "a ')' too many");
    }
    f.kind = SYNTAX_FORM_ATOM;
    if (*s == '"') {
        *at = skip_string(s, line);
        f.len = (size_t)(*at - s);
        bool closed = f.len > 1 && (*at)[-1] == '"';
        return closed ? f : form_bad(f, "a string without its closing quote");
    }
    while (!is_delimiter(*s)) {
        s++;
    }
    f.len = (size_t)(s - f.at);
    *at = s;
    return f;
}

const char *syntax_check(const char *text)
{
    int line = 1;
    for (;;) {
        struct syntax_form f = syntax_read_form(&text, &line);
        if (f.kind == SYNTAX_FORM_BAD) {
            return f.what;
        }
        if (f.kind == SYNTAX_FORM_END) {
            return NULL;
        }
    }
}

/* @return whether the list that opens at s is a call of this name */
static bool list_is(const char *s, const char *end, const char *name)
{
    size_t len = strlen(name);
    for (s++; s < end && is_space(*s);) {
        s++;
    }
    return (size_t)(end - s) > len && strncmp(s, name, len) == 0 && is_delimiter(s[len]);
}

/* The place of the rewriter in a rule. */
struct rewriter {
    struct mu_text *out;
    const char *end;
    int depth;
    int skip;   /* > 0: inside an expression that was opened at this depth */
    bool right; /* behind => */
    char last;  /* the character before this one */
};

/* @return the place behind the global at s; NULL: there is none */
static const char *global_end(const char *s, const char *end)
{
    if (end - s < 4 || s[0] != '?' || s[1] != '*') {
        return NULL;
    }
    const char *e = s + 2;
    while (e < end && *e != '*' && !is_delimiter(*e)) {
        e++;
    }
    return e < end && *e == '*' && e > s + 2 ? e + 1 : NULL;
}

static void rewrite_parenthesis(struct rewriter *r, const char *s)
{
    if (*s == ')') {
        r->skip = r->skip == r->depth ? 0 : r->skip;
        r->depth--;
        return;
    }
    r->depth++;
    bool expression = r->last == ':' || r->last == '=' || list_is(s, r->end, "test") ||
                      list_is(s, r->end, "declare");
    if (r->skip == 0 && expression) {
        r->skip = r->depth;
    }
}

/* @return the place behind the copied text */
static const char *rewrite_next(struct rewriter *r, const char *s)
{
    int lines = 0;
    const char *e = s + 1;
    if (*s == ';') {
        e = skip_comment(s);
    } else if (*s == '"') {
        e = skip_string(s, &lines);
    } else if (!r->right && r->skip == 0 && r->depth > 1 && global_end(s, r->end)) {
        e = global_end(s, r->end);
        mu_text_add(r->out, rewrite_open);
        mu_text_add(r->out, " ");
        mu_text_add_bytes(r->out, s, (size_t)(e - s));
        mu_text_add(r->out, ")");
        r->last = ')';
        return e;
    } else if (*s == '(' || *s == ')') {
        rewrite_parenthesis(r, s);
    } else if (r->depth == 1 && s[0] == '=' && s[1] == '>') {
        r->right = true;
    }
    if (e > r->end) {
        e = r->end;
    }
    mu_text_add_bytes(r->out, s, (size_t)(e - s));
    r->last = e[-1];
    return e;
}

void syntax_rewrite(struct mu_text *out, const char *form, size_t len)
{
    if (!list_is(form, form + len, "defrule")) {
        mu_text_add_bytes(out, form, len);
        return;
    }
    struct rewriter r = {.out = out, .end = form + len};
    while (form < r.end) {
        form = rewrite_next(&r, form);
    }
}

void syntax_as_written(char *text)
{
    char *to = text;
    const char *from = text, *open;
    int lines = 0;
    while ((open = strstr(from, rewrite_open))) {
        /* the pretty printer may have broken the line behind progn */
        const char *global = skip_blank(open + sizeof rewrite_open - 1, &lines);
        const char *e = global_end(global, global + strlen(global));
        bool ours = e && *e == ')';
        size_t before = (size_t)(ours ? open - from : open + 1 - from);
        memmove(to, from, before);
        to += before;
        from += before;
        if (ours) {
            memmove(to, global, (size_t)(e - global));
            to += e - global;
            from = e + 1;
        }
    }
    memmove(to, from, strlen(from) + 1);
}

/* Fills in a number if the word is one as CLIPS writes them: 12, -3, 1.5, .5, 1e3. */
static bool field_number(struct syntax_field *f)
{
    char word[64];
    if (f->len >= sizeof word || f->at[0] > '9' || f->at[0] < '+') {
        return false; /* no number begins so */
    }
    if (memchr(f->at, '.', f->len) && number_read(f->at, f->len, &f->real)) {
        f->kind = SYNTAX_FIELD_FLOAT;
        return true;
    }
    memcpy(word, f->at, f->len);
    word[f->len] = '\0';
    if (strspn(word, "+-0123456789.eE") != f->len || !strpbrk(word, "0123456789")) {
        return false;
    }
    char *end;
    if (!strpbrk(word, ".eE")) {
        errno = 0;
        f->integer = strtoll(word, &end, 10);
        f->kind = SYNTAX_FIELD_INTEGER;
        if (*end == '\0' && errno == 0) {
            return true;
        }
    }
    f->real = strtod(word, &end);
    f->kind = SYNTAX_FIELD_FLOAT;
    return *end == '\0' && isfinite(f->real);
}

static struct syntax_field field_string(const char **at)
{
    int lines = 0;
    struct syntax_field f = {.kind = SYNTAX_FIELD_STRING, .at = *at + 1};
    const char *e = skip_string(*at, &lines);
    bool closed = e - *at > 1 && e[-1] == '"';
    if (!closed) {
        return (struct syntax_field){.kind = SYNTAX_FIELD_BAD};
    }
    f.len = (size_t)(e - f.at) - 1;
    *at = e;
    return f;
}

struct syntax_field syntax_read_field(const char **at)
{
    while (is_space(**at)) {
        (*at)++;
    }
    struct syntax_field f = {.kind = SYNTAX_FIELD_SYMBOL, .at = *at};
    if (**at == '\0') {
        f.kind = SYNTAX_FIELD_END;
        return f;
    }
    if (**at == '(' || **at == ')') {
        f.kind = SYNTAX_FIELD_BAD;
        return f;
    }
    if (**at == '"') {
        return field_string(at);
    }
    const char *end = f.at;
    while (is_of_field(*end)) {
        end++;
    }
    f.len = (size_t)(end - f.at);
    *at = end;
    if (f.len > 2 && f.at[0] == '[' && f.at[f.len - 1] == ']') {
        f.kind = SYNTAX_FIELD_INSTANCE;
        f.at++;
        f.len -= 2;
    } else if (!field_number(&f)) {
        f.kind = SYNTAX_FIELD_SYMBOL;
    }
    return f;
}

void syntax_unescape(char *to, const char *from, size_t len)
{
    for (size_t i = 0; i < len; i++) {
        if (from[i] == '\\' && i + 1 < len) {
            i++;
        }
        *to++ = from[i];
    }
    *to = '\0';
}

void syntax_add_quoted(struct mu_text *out, const char *s)
{
    mu_fields_quote(out, s);
}

void syntax_add_float(struct mu_text *out, double x)
{
    char digits[NUMBER_MAX];
    bool whole = number_print(digits, x);
    mu_text_add(out, digits);
    mu_text_add(out, whole ? ".0" : "");
}

void syntax_add_symbol(struct mu_text *out, const char *s)
{
    static const char unsafe[] = " \t\r\n\f\"()&|~;";
    const char *rest = s;
    struct syntax_field f = syntax_read_field(&rest);
    bool plain = f.kind == SYNTAX_FIELD_SYMBOL && *rest == '\0' && !strpbrk(s, unsafe) &&
                 *s != '<' && *s != '?' && strncmp(s, "$?", 2) != 0;
    if (plain) {
        mu_text_add(out, s);
    } else {
        syntax_add_quoted(out, s);
    }
}
