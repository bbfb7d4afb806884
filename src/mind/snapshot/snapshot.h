/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file snapshot.h
 * A mind as text, and back.
 */
#ifndef MUSTER_MIND_SNAPSHOT_H
#define MUSTER_MIND_SNAPSHOT_H

#include "mind/load/load.h"

/** As mind_save. */
MU_MUST_USE mu_result snapshot_save(struct mind *m, struct mu_text *out, struct mu_fault *fault);

/** @return MU_OK: the text is a whole snapshot of this version */
MU_MUST_USE mu_result snapshot_check(const char *text, size_t len, struct mu_fault *fault);

/**
 * Restores a fresh mind from a checked snapshot: as mind_restore.
 * @param name  out: the agent's
 */
MU_MUST_USE mu_result snapshot_load(struct mind *m, const char *text, struct mu_fault *fault,
                                    char name[MU_NAME_MAX + 1]);

#endif
