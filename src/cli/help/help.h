/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file help.h
 * What helps a person to type: the table of verbs, help, completion of command lines.
 */
#ifndef MUSTER_CLI_HELP_HELP_H
#define MUSTER_CLI_HELP_HELP_H

#include <stdbool.h>
#include <stddef.h>

/* --- verbs.c ---------------------------------------------------------------------------------- */

/*
 * A verb as help and completion show it.
 *
 * Its words are completed by their kinds, one for each place, with spaces between; the last kind
 * goes on behind its place if it ends with "...".  A kind is "-" (nothing is known), words with "|"
 * between them, or one of
 *
 *     agent target host broker group service run     names that live
 *     experiment rules world recording file folder   files, and names of muster's own
 */
struct verb {
    const char *name;
    const char *group; /* heading in help; verbs of one group stand together */
    const char *usage, *help;
    const char *words;
};

extern const struct verb verbs[];
extern const size_t verbs_count;

bool verbs_have(const char *word);

/** Says that there is no such verb, and which one may be meant.  @return the exit code */
int verbs_miss(const char *word);

/** Prints all verbs in their groups. */
void verbs_print(void);

/** Prints the table of exit codes: number, word, meaning, with tabs between. */
void verbs_exits(void);

/** Prints the table for programs: a line for each verb, tabs between name, group, usage, help. */
void verbs_dump(void);

/* --- live.c ----------------------------------------------------------------------------------- */

/** Prints what lives here, and what to try; at once if nothing lives.  @return the exit code */
int live_print(void);

/* --- errors.c --------------------------------------------------------------------------------- */

/** @return whether the words ask for errors as JSON */
bool errors_are_json(int count, char **words);

/** Prints an error as an object on standard error.  @param message  "": what the code means */
void errors_print(int code, const char *message);

/**
 * Lets a child go on as this process, and prints what it says when it fails as an object.
 *
 * @param code  out, in the parent: the child's exit code
 * @return true in the child, false in the parent when the child has ended
 */
bool errors_catch(int *code);

/* --- completion.c ----------------------------------------------------------------------------- */

/** muster completion: what a shell sources; or the words of a kind, a line each. */
int completion_verb(int argc, char **argv);

/* --- doctor.c --------------------------------------------------------------------------------- */

/** muster doctor: what may keep muster from running on this machine, and the cure. */
int doctor_verb(int argc, char **argv);

/* --- new.c ------------------------------------------------------------------------------------ */

/** muster new: an experiment and a rule file to change. */
int new_verb(int argc, char **argv);

#endif
