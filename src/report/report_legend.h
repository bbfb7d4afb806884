/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file report_legend.h
 * What both pictures of a report share: the list of robots and the marks of start and end.
 */
#ifndef MUSTER_REPORT_LEGEND_H
#define MUSTER_REPORT_LEGEND_H

#include "report/report_data.h"

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
