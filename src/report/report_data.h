/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file report_data.h
 * A report while it is made: what run.csv says, and the parts that write it down.
 */
#ifndef MUSTER_REPORT_DATA_H
#define MUSTER_REPORT_DATA_H

#include "core/palette.h"
#include "report/drawing/drawing.h"
#include "report/report.h"

#include <limits.h>
#include <stdio.h>

enum { REPORT_PATH_MAX = PATH_MAX + 32, REPORT_NO_SAMPLE = -1 };

/* Points that the pictures are drawn from; a longer run is thinned out evenly. */
enum { REPORT_SAMPLES_MAX = 1 << 18 };

/* One row of run.csv. */
struct report_row {
    size_t robot; /* in report_input */
    double time_s, x_m, y_m, heading_rad;
    bool stalled;
    bool placed; /* it was put there */
};

struct report_sample {
    float time_s, x_m, y_m, heading_rad;
    bool lifted;  /* it was put elsewhere since the sample before */
    int32_t next; /* of the same robot, or REPORT_NO_SAMPLE */
};

struct report_track {
    int32_t first, last;
};

struct report_data {
    const struct report_input *input;
    struct report_result *result;
    size_t rows_count;
    double start_s, end_s;         /* of the rows */
    struct report_sample *samples; /* by time, all robots' */
    size_t samples_count;
    size_t stride;                /* every how many steps there is a sample */
    struct report_track *tracks;  /* of each robot */
    struct palette_color *colors; /* of each robot */
    struct report_events *events;
};

/* --- report_read.c: run.csv, row by row ------------------------------------------------------- */

struct report_reader {
    FILE *file, *placements; /* NULL: no robot was placed */
    char path[REPORT_PATH_MAX];
    char placement[64]; /* the next of them: time, robot */
    const struct report_input *input;
    int line;
    size_t robot;  /* of the last row */
    double time_s; /* of the last row */
};

/** Opens folder/run.csv, and placements.csv if it is there, and checks the first line.  @param
 * rows_max  no more rows than this */
MU_MUST_USE mu_result report_reader_open(struct report_reader *r, const char *folder,
                                         const struct report_input *input, size_t *rows_max,
                                         struct mu_fault *fault);

/** @return MU_OK, MU_DONE at the end, or MU_FAULT_FILE with the line and what was expected */
MU_MUST_USE mu_result report_reader_next(struct report_reader *r, struct report_row *row,
                                         struct mu_fault *fault);

void report_reader_close(struct report_reader *r);

/* --- report_stats.c: what the rows amount to -------------------------------------------------- */

/** Reads run.csv and fills data and result.  @return as report_write */
MU_MUST_USE mu_result report_stats(struct report_data *data, const char *folder,
                                   struct mu_fault *fault);

/* --- report_expect.c: what was expected of the run -------------------------------------------- */

struct report_expect;

struct report_expect *report_expect_open(const struct report_input *input);

/** Takes one row; when its time is a new one, the step before is over. */
void report_expect_row(struct report_expect *x, const struct report_row *row);

/** Judges every expectation; the robots' results and the events must be complete. */
void report_expect_close(struct report_expect *x, struct report_data *data);

/* What came true when: times of the experiment's events, from events.csv. */
enum { REPORT_EVENTS_MAX = 1 << 18 };

struct report_events {
    struct report_event {
        float time_s;
        uint16_t event;      /* its number in the experiment */
    } at[REPORT_EVENTS_MAX]; /* by time */
    size_t count;
    size_t left_out; /* that came later */
};

/** Reads folder/events.csv, if the experiment has events.  @return as report_write */
MU_MUST_USE mu_result report_events_read(struct report_data *data, const char *folder,
                                         struct mu_fault *fault);

/** @return the number of the next occurrence of an event, from `from` on; count: there is none */
size_t report_events_next(const struct report_events *events, unsigned event, size_t from);

/** @return a statistic of experiment_statistic_find, as summary.json has it */
double report_statistic(const struct report_data *data, enum experiment_statistic statistic,
                        int robot);

/* --- what is written; errors stay with the FILE ----------------------------------------------- */

void report_write_json(FILE *file, const struct report_data *data);
void report_write_tracks(FILE *file, const struct report_data *data);
void report_write_bearing(FILE *file, const struct report_data *data);

/** What the observer commanded, what went wrong on purpose and what was expected, over time. */
void report_write_timeline(FILE *file, const struct report_data *data);

/** @param folder  for links to files that are there */
void report_write_html(FILE *file, const struct report_data *data, const char *folder);

/* --- report_legend.c: the list of robots, and the marks of start and end, in both pictures
 * -------- */

enum { REPORT_LEGEND_ROW = 20, REPORT_LEGEND_MAX = 24 };

/** Lists the robots by colour; beyond REPORT_LEGEND_MAX it says how many more there are. */
void report_legend(FILE *file, const struct report_data *data, double x_px, double y_px);

/** @return the pixels that the longest name needs */
double report_legend_width(const struct report_data *data);

/** @return the pixels that the list and some more rows need */
double report_legend_height(const struct report_data *data, unsigned more_rows);

/** Explains the marks.  mark_s: between two dots; 0: there are none */
void report_legend_marks(FILE *file, double x_px, double y_px, double mark_s);

/* Marks in the colour of the group that they stand in. */
void report_legend_start(FILE *file, const double at[2]);
void report_legend_end(FILE *file, const double at[2]);

#endif
