/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file console_edit.h
 * A line editor on the terminal: history, completion, and a prompt that stays below what is printed
 * meanwhile.  The only file that sees libedit, which allocates on its own.
 */
#ifndef MUSTER_CTL_CONSOLE_EDIT_H
#define MUSTER_CTL_CONSOLE_EDIT_H

#include <stdbool.h>

/* What the editor asks of its console. */
struct console_edit_hooks {
    void *self;
    /** @return the prompt, valid until the next call; escape sequences stand between \1 and \1 */
    const char *(*prompt)(void *self);
    /** Waits until something is typed.  @return false: interrupted, or there is no more to do */
    bool (*wait)(void *self);
    /** @return the words for completion, as complete.c has them, up to date if that was possible */
    const char *(*words)(void *self);
};

struct console_edit;

/**
 * Begins with the history of earlier consoles of this user.
 *
 * @param hooks  stay the caller's, and must outlive the editor
 * @return NULL: the terminal cannot be edited on
 */
struct console_edit *console_edit_open(const struct console_edit_hooks *hooks);

/** Ends, and keeps the history. */
void console_edit_close(struct console_edit *e);

/** @return a line with its end, valid until the next call; NULL: the end of input, or no line */
const char *console_edit_line(struct console_edit *e);

/** Shows prompt and line again, after something was printed. */
void console_edit_refresh(struct console_edit *e);

#endif
