/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file summary.h
 * A summary.json, read back: what of a run is in no other file of its report.
 */
#ifndef MUSTER_CTL_SUMMARY_H
#define MUSTER_CTL_SUMMARY_H

#include "report/report.h"

enum {
    SUMMARY_LIST_MAX = 64, /* overrides, things undone */
    SUMMARY_FILES_MAX = 512,
    SUMMARY_TEXT_MAX = 2048,
    SUMMARY_BYTES_MAX = 4 << 20,
    SUMMARY_TIME_MAX_S = 1000000000 /* no run is longer */
};

struct summary {
    bool there; /* the rest is what it says */
    bool broke_off, mail_unknown;
    uint64_t seed, packets_struck;
    bool free;
    double sim_time_s, wall_time_s, duration_s; /* duration_s: as it was wanted; 0: not said */
    char file[SUMMARY_TEXT_MAX];                /* the experiment's; "": not said */
    char hash[80], command[SUMMARY_TEXT_MAX], made_with[256];
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
    struct report_object *objects; /* OBJECTS_MAX */
    size_t objects_count;
};

/**
 * Reads folder/summary.json; takes memory at start-up.
 *
 * @return MU_OK, also when there is none; MU_FAULT_FILE with the place and what was expected
 */
MU_MUST_USE mu_result summary_read(struct summary **out, const char *folder,
                                   struct mu_fault *fault);

#endif
