/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file disk_bundle.h
 * Mails on disk: those of one transaction lie in few rows.
 *
 * A row for each mail costs more than all else that the store does for it.  So mails whose numbers
 * follow each other are a bundle: one text, a JSON list, that is written once, and beside it a
 * short row that says which of them are still waited for.  The bundle goes with the last of
 * them.  The view `mails` shows one line a mail all the same.
 */
#ifndef MUSTER_BROKER_DISK_BUNDLE_H
#define MUSTER_BROKER_DISK_BUNDLE_H

#include "broker/node/disk_parts.h"

/** Makes the tables, and a view that shows a line a mail; for sqlite3_exec. */
extern const char disk_bundle_tables[];

/** Gives the lines of that view in order of number. */
extern const char disk_bundle_select[];

/** Moves the mails of a store of version 2 from their rows into bundles. */
extern const char disk_bundle_upgrade[];

/** Takes the memory for the bundle that is put together.  At start-up. */
void disk_bundle_init(struct disk_bundle *in_hand);

/** A transaction begins: nothing is in hand. */
void disk_bundle_begin(struct disk *d);

/** Takes a new mail into the bundle in hand, and writes that when it is full.  @return whether
 *  nothing failed */
bool disk_bundle_put(struct disk *d, const struct journal_entry *e);

/** Writes what is in hand; before the transaction ends.  @return whether nothing failed */
bool disk_bundle_end(struct disk *d);

/** The mails e->row to e->last_row are not waited for.  @return whether nothing failed */
bool disk_bundle_drop(struct disk *d, const struct journal_entry *e);

#endif
