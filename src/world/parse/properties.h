/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file properties.h
 * The words of world files: one table of what each property means, and to what it belongs.
 */
#ifndef MUSTER_WORLD_PROPERTIES_H
#define MUSTER_WORLD_PROPERTIES_H

#include "world/read/builder.h"

/** @return whether a property is read there, or passed over because it concerns no robot */
bool properties_known(const char *key, enum builder_kind kind);

/** @return whether a property is read there */
bool properties_read_there(const char *key, int kinds);

/** @return the property that was meant; NULL: none is near, or Stage has this very word */
const char *properties_near(const char *key, enum builder_kind kind);

/** Prints the table as Markdown to standard output. */
void properties_print(void);

#endif
