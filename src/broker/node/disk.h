/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file disk.h
 * The broker's store: one SQLite file, which a person can read with the sqlite3 shell while no
 * broker has it open.
 *
 * What is written is the journal's business (journal.h); here it becomes rows.  A commit survives
 * the death of the process, and the loss of power when it was begun as LEVEL_SYNCED.  No data of a
 * user is ever deleted: a file that is not ours, or damaged, is refused and left as it is.
 */
#ifndef MUSTER_BROKER_DISK_H
#define MUSTER_BROKER_DISK_H

#include "broker/mail/journal.h"
#include "muster/result.h"

struct disk;

/** Makes the default path, in $XDG_STATE_HOME/muster or ~/.local/state/muster.
 *  @return false: there is no home, or the path is too long */
bool disk_default_path(char *path, size_t size, int domain, const char *broker);

/**
 * Opens a store, or makes it with the folders above it.  At start-up.
 *
 * @param wall_ns  nanoseconds since 1970
 * @return MU_OK; MU_FAULT_FILE: not a store, of another version, or damaged; MU_FAULT_OS: it cannot
 *         be made, read or written, or another broker has it; both explained on standard error
 */
MU_MUST_USE mu_result disk_open(struct disk **out, const char *path, uint64_t wall_ns);

/** @return a number above all that earlier brokers on this store had, and the time if it can be */
uint64_t disk_incarnation(const struct disk *d);

/** @return a number far above all that boxes of earlier brokers on this store have counted */
uint64_t disk_number_base(const struct disk *d);

/** Gives all that is stored to journal_restore.  @return how much of it was not taken, or a fault
 *          that is explained on standard error: the file is damaged */
MU_MUST_USE mu_result disk_load(struct disk *d, struct broker *b, uint64_t *refused);

/** Writes everything that the journal has, and tells it how that went.  @return whether it went */
bool disk_commit(struct disk *d, struct broker *b, muster_Level level, uint64_t now_ns);

/** Tidies up when nothing was written for a while; call now and then. */
void disk_rest(struct disk *d, uint64_t now_ns);

void disk_close(struct disk *d);

#endif
