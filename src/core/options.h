/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file options.h
 * The command line of every program, from one table.
 *
 * A value comes from the flag, else from the environment, else from the configuration file, else
 * from the table.  The table also prints `--help` and, for programs, `--dump-options`: a line for
 * each option, tabs between name, letter, value ("": a flag), "many" if it may stand several times,
 * default, environment and help.  It remembers where each value came from.
 *
 * The configuration file is --config FILE, else $MUSTER_CONFIG, else
 * $XDG_CONFIG_HOME/muster/config, else ~/.config/muster/config.  Its lines are `name = value`,
 * with the names of the options; `#` starts a comment.  All programs share it.
 */
#ifndef MUSTER_CORE_OPTIONS_H
#define MUSTER_CORE_OPTIONS_H

#include "muster/result.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { MU_OPTION_LIST_MAX = 1024, MU_OPTION_WORDS_MAX = 512, MU_OPTION_PLACE_MAX = 271 };

enum mu_option_kind {
    MU_OPTION_FLAG,    /* bool; --name, --no-name, and yes/no elsewhere */
    MU_OPTION_STRING,  /* const char * */
    MU_OPTION_INTEGER, /* int64_t */
    MU_OPTION_REAL,    /* double, always finite */
    MU_OPTION_LIST     /* struct mu_option_list; the flag may stand several times */
};

enum mu_option_source {
    MU_OPTION_DEFAULT,
    MU_OPTION_CONFIG,
    MU_OPTION_ENVIRONMENT,
    MU_OPTION_COMMAND_LINE
};

/* Elsewhere than on the command line, a list is one line with commas; one of names there, too. */
struct mu_option_list {
    const char *items[MU_OPTION_LIST_MAX];
    size_t count;
};

struct mu_option {
    const char *name; /* without the dashes */
    char letter;      /* of its short form; 0: none */
    enum mu_option_kind kind;
    const char *unit;        /* or the kind of value, for --help: "S", "FILE" */
    const char *fallback;    /* the default, as one would type it; NULL: the target is left alone */
    const char *environment; /* "MUSTER_RATE"; NULL: none, nor in the configuration file */
    const char *help;
    void *target;
    double min, max; /* of a number, both included; both 0: any */

    enum mu_option_source source;        /* set by mu_options_parse */
    char place[MU_OPTION_PLACE_MAX + 1]; /* "MUSTER_RATE", "/home/a/config:3"; else "" */

    const char *alone; /* its value when none follows; NULL: one has to */
    bool commas;       /* of a list: one may stand between commas on the command line, too */
};

/*
 * Rows of a table: the name, what stands for the value in --help, the target, the help text; then
 * other members, if any.
 *
 *     MU_REAL("rate", "R", set.rate, "times real time", .fallback = "0", .max = 1e6),
 */
#define MU_FLAG(word, flag, ...) MU_OPTION_(FLAG, bool, word, NULL, flag, __VA_ARGS__)
#define MU_STRING(word, value, string, ...) \
    MU_OPTION_(STRING, const char *, word, value, string, __VA_ARGS__)
#define MU_INTEGER(word, value, number, ...) \
    MU_OPTION_(INTEGER, int64_t, word, value, number, __VA_ARGS__)
#define MU_REAL(word, value, number, ...) MU_OPTION_(REAL, double, word, value, number, __VA_ARGS__)
#define MU_LIST(word, value, list, ...) \
    MU_OPTION_(LIST, struct mu_option_list, word, value, list, __VA_ARGS__)

#define MU_NAMES(word, value, list, ...) MU_LIST(word, value, list, __VA_ARGS__, .commas = true)

/* The condition never chooses NULL: it refuses a target of another type. */
#define MU_OPTION_(of, type, word, value, variable, ...)                 \
    {                                                                    \
        .name = (word), .kind = MU_OPTION_##of, .unit = (value),         \
        .target = true ? &(variable) : (type *)NULL, .help = __VA_ARGS__ \
    }

/* The table of a program. */
#define MU_OPTION_TABLE(rows) .table = (rows), .count = sizeof(rows) / sizeof(rows)[0]

/* Rows that many programs have. */
#define MU_OPTION_VERBOSE(flag) MU_FLAG("verbose", flag, "log what happens", .letter = 'v')
#define MU_OPTION_QUIET(flag)   MU_FLAG("quiet", flag, "say only what goes wrong", .letter = 'q')

struct mu_options {
    const char *program; /* "muster run" */
    const char *usage;   /* the words behind it: "FILE [OPTION...]" */
    const char *about;   /* one sentence or more, for --help */
    struct mu_option *table;
    size_t count;
    bool no_words;             /* it takes nothing but options */
    const char *one, *example; /* it takes one word: what that is, and such a one; NULL: as it says
                                  itself */

    const char *words[MU_OPTION_WORDS_MAX]; /* set by mu_options_parse: words that are no options */
    size_t words_count;
};

/**
 * Reads the options of a program; argv[0] is passed over.
 *
 * `--` ends the options; a negative number is a word, not an option.  Names in the configuration
 * file that the table does not know are passed over, because they may belong to another program.
 * Call it before mu_memory_seal(): values from the configuration file are start-up memory.
 *
 * @return MU_OK; MU_DONE when --help, --version or --dump-options was asked for and printed;
 * MU_FAULT_USAGE for an unknown option, a bad value or a wrong number of words, MU_FAULT_FILE for a
 * bad configuration file, both already explained on standard error
 */
MU_MUST_USE mu_result mu_options_parse(struct mu_options *options, int argc, char **argv);

/** Prints the help text to standard output. */
void mu_options_print_help(const struct mu_options *options);

/** @return the row of that name, or NULL */
struct mu_option *mu_options_find(const struct mu_options *options, const char *name);

/* --- options_config.c ------------------------------------------------------------------------- */

enum { MU_OPTION_WHY_MAX = 128 };

/**
 * Puts a value into an option's target.  Strings are not copied.
 *
 * The source must be set before: a call adds to a list on the command line, one item or, of names,
 * those between commas; any other source gives the whole list, with commas.
 *
 * @param why  the expected value, when the answer is false
 */
bool mu_option_set(struct mu_option *option, const char *value, char why[MU_OPTION_WHY_MAX]);

/**
 * Reads the configuration file into the options that are still at their default.
 *
 * @param path  what --config said, which must exist; NULL: the usual places, which need not
 * @return MU_OK or MU_FAULT_FILE, already explained on standard error
 */
MU_MUST_USE mu_result mu_options_read_config(struct mu_options *options, const char *path);

#endif
