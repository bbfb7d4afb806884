/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file paths.h
 * Where muster's own files are, run from the build tree or installed.
 */
#ifndef MUSTER_CORE_PATHS_H
#define MUSTER_CORE_PATHS_H

#include "muster/result.h"

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

struct mu_text;

/** Finds a program that stands beside the running one.  @return whether it fitted */
bool mu_path_program(char *path, size_t size, const char *program);

/**
 * Finds the folder of the shared rules: $MUSTER_RULES, else the installed, else the source tree's.
 *
 * @return whether there is one with muster.clp in it
 */
bool mu_path_rules(char *path, size_t size);

/** The same for a program that does nothing without.  @return MU_OK; MU_FAULT_FILE, said so */
MU_MUST_USE mu_result mu_path_rules_need(char *path, size_t size, const char *program);

/**
 * Finds one of muster's own folders, such as "experiments": the installed, else the source tree's.
 *
 * @param file  that must be in it
 * @return whether there is one
 */
bool mu_path_own(char *path, size_t size, const char *folder, const char *file);

/**
 * Finds an experiment of muster's own by its name, with or without ".yaml": the installed one, else
 * the source tree's.
 *
 * @return whether there is one; false too for a path, and for a file that is in the current folder
 */
bool mu_path_experiment(char *path, size_t size, const char *name);

/** Makes a path that starts at a folder unless it is absolute.  @return whether it fitted */
bool mu_path_join(char *path, size_t size, const char *folder, const char *file);

/**
 * Takes "." and "NAME/.." out of an absolute path, in place, as it reads: no link is followed, no
 * file is looked at.  Other paths stay as they are.
 */
void mu_path_plain(char *path);

/**
 * Writes the name that a file has for others: below the current folder as from there, else as from
 * the root, which is called _.  It begins with "/" and never leads up, out of the folder that it is
 * unpacked in.
 */
void mu_path_portable(struct mu_text *name, const char *path);

/**
 * Makes the folders above a path that are missing.
 *
 * @return whether they are there; false: errno says why not, and the path ends with that folder
 */
bool mu_path_make_folders(char *path, mode_t mode);

#endif
