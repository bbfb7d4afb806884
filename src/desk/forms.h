/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file forms.h
 * Finds the forms in lines that a person types or pastes: an open parenthesis goes on in the next
 * line.
 *
 * A form is what stands between a parenthesis and the one that closes it, a string, or a word.
 * Comments between forms are passed over.  Pure.
 */
#ifndef MUSTER_DESK_FORMS_H
#define MUSTER_DESK_FORMS_H

#include "muster/limits.h"

#include <stdbool.h>
#include <stddef.h>

enum forms_found {
    FORMS_MORE,  /* the text is over, and perhaps a form is open */
    FORMS_READY, /* text has a form */
    FORMS_LONG,  /* one was longer than MU_CONTENT_MAX, and is left out; text has its beginning */
    FORMS_EXTRA  /* a parenthesis is closed that was not open; it is left out */
};

struct forms {
    char text[MU_CONTENT_MAX + 1]; /* of the form, zero-terminated when it is ready */
    size_t len;                    /* bytes of the form so far, also of what did not fit */
    unsigned depth;                /* of open parentheses */
    bool string, escaped, comment; /* inside of one; behind a backslash */
    bool done;                     /* text was handed out */
};

void forms_clear(struct forms *f);

/**
 * Goes on to the end of the next form.
 *
 * @param at  the text that comes next, zero-terminated, a line's end in it; moved on
 */
enum forms_found forms_next(struct forms *f, const char **at);

/** @return whether a form is begun and not ended */
bool forms_are_open(const struct forms *f);

#endif
