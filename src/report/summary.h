/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file summary.h
 * Reads a summary.json back, as report_json.c writes it.
 */
#ifndef MUSTER_REPORT_SUMMARY_H
#define MUSTER_REPORT_SUMMARY_H

#include "report/report.h"

enum {
    SUMMARY_LIST_MAX = 64, /* overrides, things undone */
    SUMMARY_FILES_MAX = 512,
    SUMMARY_BYTES_MAX = 4 << 20,
    SUMMARY_TIME_MAX_S = 1000000000 /* no run is longer */
};

/* Texts live until summary_close; "" or 0 stands for a value that the file lacks. */
struct summary {
    struct json_t *document; /* NULL: no summary is open */
    bool broke_off, free, mail_unknown;
    uint64_t seed, packets_struck;
    double sim_time_s, wall_time_s, duration_s; /* duration_s: as the user asked */
    const char *experiment, *file, *hash, *command, *made_with;
    unsigned expected, met; /* expectations */
    const char *overrides[SUMMARY_LIST_MAX], *undone[SUMMARY_LIST_MAX];
    size_t overrides_count, undone_count;
    struct report_source files[SUMMARY_FILES_MAX];
    size_t files_count;
    struct report_mail mail;
    struct report_restarts restarts[MU_ROBOTS_MAX];
    size_t restarts_count;
    struct report_chaos chaos[EXPERIMENT_CHAOS_MAX];
    struct report_monitor monitors[EXPERIMENT_MONITORS_MAX];
    size_t monitors_count;
    struct report_robot robots[MU_ROBOTS_MAX];
    size_t robots_count;
    struct report_object objects[MU_OBJECTS_MAX];
    size_t objects_count;
};

/**
 * Reads folder/summary.json.
 *
 * @param s  filled in each case: with "" and 0 when there is no summary
 * @return MU_OK; MU_ABSENT: there is no such file; MU_FAULT_FILE with the place and the expected
 *         text
 */
MU_MUST_USE mu_result summary_read(struct summary *s, const char *folder, struct mu_fault *fault);

void summary_close(struct summary *s);

/** @return the number of a name as compare.h describes it, such as red.final.x_m; NaN: none */
double summary_statistic(const struct summary *s, const char *name);

#endif
