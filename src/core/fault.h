/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file fault.h
 * A mistake in a file that a person wrote: its place, and the text that was expected.
 */
#ifndef MUSTER_CORE_FAULT_H
#define MUSTER_CORE_FAULT_H

#include "muster/result.h"

#include <stdbool.h>
#include <stdio.h>

enum {
    MU_FAULT_FILE_MAX = 255,
    MU_FAULT_TEXT_MAX = 511,
    MU_FAULT_MISTAKES_MAX = 100 /* that a listener is told of */
};

/* A place in a file that outlives it. */
struct mu_fault_place {
    const char *file;
    int line, column;
};

struct mu_fault {
    char file[MU_FAULT_FILE_MAX + 1];
    int line;   /* from 1; 0: not known */
    int column; /* from 1; 0: not known */
    char text[MU_FAULT_TEXT_MAX + 1];
};

/* A listener hears of every mistake in a file, not only of the first. */
struct mu_fault_listener {
    /* mistake: false when it is a warning */
    void (*tell)(void *self, const struct mu_fault *fault, bool mistake);
    void *self;
};

/**
 * Fills a fault.  A long text is cut; a control character becomes a question mark.
 *
 * @return MU_FAULT_FILE, so that `return mu_fault_at(...)` reads well
 */
mu_result mu_fault_at(struct mu_fault *fault, const char *file, int line, int column,
                      const char *format, ...) __attribute__((format(printf, 5, 6)));

/** Fills a fault with "cannot WHAT: ", and why by errno.  @return MU_FAULT_OS */
mu_result mu_fault_os(struct mu_fault *fault, const char *file, const char *what);

/** Prints "file:line:column: text" to standard error, without the numbers that are not known. */
void mu_fault_print(const struct mu_fault *fault);

/** mu_fault_print to another file, with a word before the text: "", or "warning: ". */
void mu_fault_print_to(FILE *to, const struct mu_fault *fault, const char *word);

#endif
