/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file fields.h
 * The fields of a mail's content, as CLIPS prints them.
 */
#ifndef MUSTER_CORE_FIELDS_H
#define MUSTER_CORE_FIELDS_H

#include "core/text.h"

/** Adds a space and a field: a symbol, or else a string. */
void mu_fields_add(struct mu_text *t, const char *s);

/** Adds a string, quoted. */
void mu_fields_quote(struct mu_text *t, const char *s);

/** Adds a space and a string. */
void mu_fields_add_string(struct mu_text *t, const char *s);

/** Reads one field, a symbol or a string, and moves on.  @return false: none, or no field */
bool mu_fields_next(const char **content, struct mu_text *out);

/** @return whether nothing but space is left */
bool mu_fields_end(const char *content);

#endif
