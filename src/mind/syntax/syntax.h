/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file syntax.h
 * CLIPS source as text: forms, fields, and the one thing that muster adds to the dialect.
 *
 * Pure: no CLIPS environment, nothing is evaluated here.
 */
#ifndef MUSTER_AGENT_CLIPS_TEXT_H
#define MUSTER_AGENT_CLIPS_TEXT_H

#include "core/text.h"

#include <stddef.h>

/* A deeper nesting could exhaust the stack in the recursive parser of CLIPS. */
enum { SYNTAX_NESTING_MAX = 256 };

enum syntax_form_kind { SYNTAX_FORM_END, SYNTAX_FORM_LIST, SYNTAX_FORM_ATOM, SYNTAX_FORM_BAD };

/* One top-level form of a text: "(...)", or a word or string outside parentheses. */
struct syntax_form {
    enum syntax_form_kind kind;
    const char *at;
    size_t len;
    int line;         /* where it begins, from the line that the caller passed */
    const char *what; /* the mistake of a bad form */
};

/**
 * Reads the next form and moves on.
 *
 * @param at    where to read; moved behind the form
 * @param line  line number there; kept up to date
 */
struct syntax_form syntax_read_form(const char **at, int *line);

/** @return NULL, or what is wrong with a text that is to be parsed: its parentheses, its depth. */
const char *syntax_check(const char *text);

/**
 * Copies a form, writing each global in a pattern, which CLIPS 6.30 refuses, as a call that it
 * accepts: (message mate-pos ?*mate*) becomes (message mate-pos =(progn ?*mate*)).  Lines stay.
 */
void syntax_rewrite(struct mu_text *out, const char *form, size_t len);

/** Undoes syntax_rewrite in place, in anything that CLIPS printed. */
void syntax_as_written(char *text);

enum syntax_field_kind {
    SYNTAX_FIELD_END,
    SYNTAX_FIELD_SYMBOL,
    SYNTAX_FIELD_STRING,
    SYNTAX_FIELD_INSTANCE, /* [name] */
    SYNTAX_FIELD_INTEGER,
    SYNTAX_FIELD_FLOAT,
    SYNTAX_FIELD_BAD
};

/* One field of a mail's content. */
struct syntax_field {
    enum syntax_field_kind kind;
    const char *at; /* the text of a symbol, string (still escaped) or instance name */
    size_t len;
    long long integer;
    double real;
};

/** Reads the next field of a mail's content and moves on.  Nothing is evaluated. */
struct syntax_field syntax_read_field(const char **at);

/** Copies len bytes without the backslashes that escape; to has room for len + 1. */
void syntax_unescape(char *to, const char *from, size_t len);

/** Adds a string in quotes, with quotes and backslashes in it escaped. */
void syntax_add_quoted(struct mu_text *out, const char *s);

/** Adds a number so that it reads back as the same FLOAT: 17 digits, never without a point. */
void syntax_add_float(struct mu_text *out, double x);

/** Adds a symbol; one that would not read back as that one symbol is added as a string. */
void syntax_add_symbol(struct mu_text *out, const char *s);

#endif
