/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file words.h
 * Words of the command line: joined, checked, shown.
 */
#ifndef MUSTER_CTL_WORDS_H
#define MUSTER_CTL_WORDS_H

#include <stdbool.h>
#include <stddef.h>

#include "core/text.h"

/** Joins words with spaces.  @return whether they fitted */
bool words_join(char *text, size_t size, const char *const *words, size_t count);

/** @return whether all of it is UTF-8 */
bool words_are_utf8(const char *text);

/** @return whether it is a name; if not, standard error says what one is */
bool words_name_check(const char *program, const char *what, const char *name);

/** The same for that of an agent that is made, or of a host. */
bool words_place_check(const char *program, const char *name);

/** The same for a group. */
bool words_group_check(const char *program, const char *name);

/** The same for a query of the yellow pages. */
bool words_query_check(const char *program, const char *query);

#endif
