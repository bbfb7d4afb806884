/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file recorder.h
 * Writes run.csv: a row for each robot and control step; and placements.csv beside it, a row for
 * each time that a robot was put somewhere, if one was.
 */
#ifndef MUSTER_SIM_RECORDER_H
#define MUSTER_SIM_RECORDER_H

#include "muster/result.h"
#include "sim/engine/engine.h"

struct recorder; /* one in a process */

/** Creates the file and writes its head.  @return MU_OK or MU_FAULT_OS, said on standard error */
MU_MUST_USE mu_result recorder_open(struct recorder **out, const char *path);

/** Adds a row.  A full disk shows at the close. */
void recorder_add(struct recorder *r, uint64_t time_ns, const char *robot,
                  const struct engine_percept *percept);

/** @return MU_OK, or MU_FAULT_OS when the file is not whole, said on standard error */
MU_MUST_USE mu_result recorder_close(struct recorder *r);

#endif
