/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file runs.h
 * The runs of this user that live now, each in a DDS domain of its own.
 *
 * A run holds a lock on a small file in $XDG_RUNTIME_DIR/muster, or in /tmp/muster-UID when
 * that names no folder; a lock ends
 * with its process, so a file that nobody locks is nobody's run.
 */
#ifndef MUSTER_DESK_RUNS_H
#define MUSTER_DESK_RUNS_H

#include "muster/result.h"

#include <stdbool.h>
#include <stdio.h>

/** Domains that a run picks from: below them is everybody's 0, above are ephemeral ports. */
enum { RUNS_DOMAIN_FIRST = 1, RUNS_DOMAIN_LAST = 99 };

/**
 * Takes a domain for the life of this process.
 *
 * @param wanted  the domain, or -1 to pick a free one
 * @param name    of the experiment, for who lists the runs
 * @param domain  out
 * @return MU_OK; MU_BUSY: another run has it, or there is none left; MU_FAULT_OS: there is no
 *         folder for the list, which is explained on standard error
 */
MU_MUST_USE mu_result runs_take(int wanted, const char *name, int *domain);

/**
 * Finds the one live run of this user.
 *
 * @param domain  out: its domain, or 0 when there is none
 * @return MU_OK; MU_EXISTS: several, which are named on standard error
 */
MU_MUST_USE mu_result runs_find(int *domain);

/** Notes where the report of this process's run is, and that it lives now: again at its end. */
void runs_note(const char *name, const char *folder);

/** @return whether the run in a domain, or the last one there, has noted its report's folder */
bool runs_folder_of(int domain, char *folder, size_t size);

/** Says on standard error that a run of this user has just ended, or how to start one. */
void runs_tell_last(const char *program);

/**
 * Lists the live runs of this user, a line each.
 *
 * @param to      NULL: nothing is printed
 * @param domain  out: that of the last one
 * @return how many there are
 */
unsigned runs_list(FILE *to, int *domain);

#endif
