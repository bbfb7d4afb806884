/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file remake.h
 * What a run's processes would have left beside its recording, made of the recording: run.csv,
 * events.csv, and what the run had come to where the recording ends.
 */
#ifndef MUSTER_CLI_REMAKE_H
#define MUSTER_CLI_REMAKE_H

#include "run/run.h"
#include "story/story.h"

/** Writes folder/run.csv anew.  @return MU_OK, or MU_FAULT_OS with the path */
MU_MUST_USE mu_result remake_csv(struct recording *recording, const char *folder,
                                 struct mu_fault *fault);

/** Writes folder/placements.csv anew, or takes it away when no robot was placed.  @return likewise
 */
MU_MUST_USE mu_result remake_placements(struct recording *recording, const char *folder,
                                        struct mu_fault *fault);

/**
 * Writes folder/events.csv anew, if the experiment has events.
 *
 * @param r  with its experiment and its world
 * @return MU_OK; MU_FAULT_FILE: an event is about what the recording does not have; MU_FAULT_OS
 */
MU_MUST_USE mu_result remake_events(struct recording *recording, const struct run *r,
                                    struct mu_fault *fault);

/** Fills time, hash, totals and things of a run with how they are in the last Frame. */
void remake_end(struct recording *recording, struct run *r);

#endif
