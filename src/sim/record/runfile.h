/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file runfile.h
 * Writes run.mcap: what was needed for the run, the Scene, the Frame of each step, how it ended.
 *
 * docs/recording.md says what is in it.  Messages are sorted by simulated time.  A step copies its
 * bytes into memory; once a second or a megabyte these go to the system, which writes them when it
 * likes.  A full disk ends the recording, not the run.
 */
#ifndef MUSTER_SIM_RUNFILE_H
#define MUSTER_SIM_RUNFILE_H

#include "core/options.h"
#include "sim/session/session.h"

struct runfile; /* one in a process */

struct runfile_options {
    const char *path;
    const struct world *world;           /* by hand its files are attached as "world/..." */
    const struct mu_option_list *files;  /* "NAME=PATH": attached as NAME */
    const struct mu_option_list *notes;  /* "KEY=VALUE": of the table "run" */
    const struct mu_option_list *places; /* of robots: noted by hand */
    bool without_percepts;
    const char *command; /* that began it; by hand; NULL: `muster run`, which tells the rest */
    bool free;
    uint64_t seed;
    double duration_s;
};

/**
 * Creates the file, with all that is known before the run.
 *
 * @return MU_OK; MU_FAULT_OS: it cannot be created, said on standard error.  A file that cannot be
 *         attached is said there, too, and is not in it.
 */
MU_MUST_USE mu_result runfile_open(struct runfile **out, const struct runfile_options *options);

/** Has the session tell it what happens. */
void runfile_listen(struct runfile *f, struct session *s);

/** @return MU_OK, or MU_FAULT_OS when the file is not whole, said on standard error */
MU_MUST_USE mu_result runfile_close(struct runfile *f);

#endif
