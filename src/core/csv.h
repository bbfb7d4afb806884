/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file csv.h
 * Rows of run.csv, placements.csv and events.csv, which the simulator writes during a run and
 * `muster report` writes from a recording.
 */
#ifndef MUSTER_CORE_CSV_H
#define MUSTER_CORE_CSV_H

#include "muster/percept.h"

#include <stdio.h>

#define MU_CSV_PLACEMENTS_HEAD "time_s,robot\n"
#define MU_CSV_EVENTS_HEAD     "time_s,event\n"

/** Writes the first line of run.csv: the readings of MU_READINGS that have a column. */
void mu_csv_head(FILE *file);

/** Writes a row of run.csv: numbers have six decimals, and zero has no sign. */
void mu_csv_row(FILE *file, uint64_t time_ns, const char *robot, const struct mu_percept *body);

/** Writes a row of placements.csv, which names time and robot as run.csv does. */
void mu_csv_placement(FILE *file, uint64_t time_ns, const char *robot);

/** Writes a row of events.csv: when a condition came true. */
void mu_csv_event(FILE *file, uint64_t time_ns, const char *condition);

#endif
