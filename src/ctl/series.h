/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file series.h
 * One experiment with many seeds: `muster run FILE --seeds 1..30`.
 *
 * Each run is a `muster run` of its own, with a report of its own; as many live at once as asked.
 */
#ifndef MUSTER_CTL_SERIES_H
#define MUSTER_CTL_SERIES_H

#include "ctl/run.h"

enum { SERIES_RUNS_MAX = 1000 };

/**
 * Reads seeds: "1..30", "4", "1,3,10..12".
 *
 * @param seeds  room for SERIES_RUNS_MAX
 * @return how many; 0: the text is something else, has a seed twice, or more than fit
 */
size_t series_seeds(const char *text, uint64_t seeds[SERIES_RUNS_MAX]);

/**
 * Runs the series: a progress line on standard error, at the end a table and a page.
 *
 * @param options  of the command line; seeds are set
 * @return the highest exit code of its runs; 130 when a signal ended it
 */
int series_run(const struct run_options *options, const struct experiment *experiment);

#endif
