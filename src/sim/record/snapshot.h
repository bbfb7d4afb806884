/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file snapshot.h
 * The state of all bodies as a file.
 */
#ifndef MUSTER_SIM_SNAPSHOT_H
#define MUSTER_SIM_SNAPSHOT_H

#include "sim/engine/engine.h"

/**
 * Makes a file of these bytes below a folder.  Who may speak to the simulator may not for that
 * write where he likes: nothing that is there is replaced, and neither ".." nor a link leads out.
 *
 * @param folder  an open one
 * @param path    from there on
 * @return MU_OK, or MU_FAULT_OS: errno says why, EXDEV that it leads out; no file is left
 */
MU_MUST_USE mu_result snapshot_write(int folder, const char *path, const unsigned char *bytes,
                                     size_t count);

/**
 * Lets an engine go on from a file.  Takes start-up memory.
 *
 * @return MU_OK, or MU_FAULT_FILE, explained on standard error
 */
MU_MUST_USE mu_result snapshot_restore(struct engine *e, const char *path);

#endif
