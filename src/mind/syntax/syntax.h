/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file clips_text.h
 * CLIPS source as text: forms, fields, and the one thing that muster adds to the dialect.
 *
 * Pure: no CLIPS environment, nothing is evaluated here.
 */
#ifndef MUSTER_AGENT_CLIPS_TEXT_H
#define MUSTER_AGENT_CLIPS_TEXT_H

#include "core/text.h"

#include <stdbool.h>
#include <stddef.h>

/* A deeper nesting could end the stack in the recursive parser of CLIPS. */
enum { CLIPS_NESTING_MAX = 256 };

enum clips_form_kind { CLIPS_FORM_END, CLIPS_FORM_LIST, CLIPS_FORM_ATOM, CLIPS_FORM_BAD };

/* One top-level form of a text: "(...)", or a word or string outside parentheses. */
struct clips_form {
    enum clips_form_kind kind;
    const char *at;
    size_t len;
    int line;         /* where it begins, from the line that the caller passed */
    const char *what; /* of a bad one: what is wrong with it */
};

/**
 * Reads the next form and moves on.
 *
 * @param at    where to read; moved behind the form
 * @param line  line number there; kept up to date
 */
struct clips_form clips_text_form(const char **at, int *line);

/** @return NULL, or what is wrong with a text that is to be parsed: its parentheses, its depth. */
const char *clips_text_check(const char *text);

/**
 * Copies a form, writing each global in a pattern, which CLIPS 6.30 refuses, as a call that it
 * accepts: (message mate-pos ?*mate*) becomes (message mate-pos =(progn ?*mate*)).  Lines stay.
 */
void clips_text_rewrite(struct mu_text *out, const char *form, size_t len);

/** Undoes clips_text_rewrite in place, in anything that CLIPS printed. */
void clips_text_as_written(char *text);

enum clips_field_kind {
    CLIPS_FIELD_END,
    CLIPS_FIELD_SYMBOL,
    CLIPS_FIELD_STRING,
    CLIPS_FIELD_INSTANCE, /* [name] */
    CLIPS_FIELD_INTEGER,
    CLIPS_FIELD_FLOAT,
    CLIPS_FIELD_BAD
};

/* One field of a mail's content. */
struct clips_field {
    enum clips_field_kind kind;
    const char *at; /* the text of a symbol, string (still escaped) or instance name */
    size_t len;
    long long integer;
    double real;
};

/** Reads the next field of a mail's content and moves on.  Nothing is evaluated. */
struct clips_field clips_text_field(const char **at);

/** Copies len bytes without the backslashes that escape; to has room for len + 1. */
void clips_text_unescape(char *to, const char *from, size_t len);

/** Adds a string in quotes, with quotes and backslashes in it escaped. */
void clips_text_add_quoted(struct mu_text *out, const char *s);

/** Adds a number so that it reads back as the same FLOAT: 17 digits, never without a point. */
void clips_text_add_float(struct mu_text *out, double x);

/** Adds a symbol; one that would not read back as that one symbol is added as a string. */
void clips_text_add_symbol(struct mu_text *out, const char *s);

#endif
