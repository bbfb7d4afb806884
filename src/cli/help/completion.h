/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file completion.h
 * What completion_verb is made of: options of verbs, what each shell sources, words that live.
 */
#ifndef MUSTER_CLI_HELP_COMPLETION_H
#define MUSTER_CLI_HELP_COMPLETION_H

#include "cli/help/help.h"

#include <stdbool.h>
#include <stdint.h>

/* --- completion_options.c --------------------------------------------------------------------- */

struct completion_option {
    const char *name, *letter; /* letter "": it has none */
    const char *unit, *kind;   /* of its value; both "": it is a flag */
    bool is_many;              /* it may stand several times */
    const char *help;
};

enum { COMPLETION_OPTIONS_MAX = 64 };

/**
 * Reads the options of a verb, as its program prints them.
 *
 * @param options  COMPLETION_OPTIONS_MAX of them; valid until the next call
 * @return how many there are; 0: the program fails, which is said
 */
size_t completion_options(const struct verb *verb, struct completion_option *options);

/** Prints a text with a backslash before some characters.  @param as  a single quote is this */
void completion_quote(const char *text, const char *quoted, const char *as);

/* --- completion_bash.c, completion_zsh.c, completion_fish.c ------------------------------------
 */

/** Prints what the shell sources.  @return false: the options of a verb cannot be had, said so */
bool completion_bash_print(void);
bool completion_zsh_print(void);
bool completion_fish_print(void);

/* --- completion_live.c ------------------------------------------------------------------------ */

struct completion_live {
    int64_t domain; /* < 0: the one live run's, else 0 */
    double wait_s;  /* for a broker */
};

/** Prints the words of a kind, with a tab and what they are.  @return MU_EXIT_USAGE: there is no
 * such kind; else the exit code, explained */
int completion_live(const char *kind, const struct completion_live *options);

#endif
