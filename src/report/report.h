/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file report.h
 * What a run leaves in its folder: summary.json, tracks.svg, bearing.svg, report.html, made from
 * the run.csv that the simulator wrote there, from events.csv, if the experiment expects events,
 * and from what the processes said at the end; and summary.json read back.
 */
#ifndef MUSTER_REPORT_H
#define MUSTER_REPORT_H

#include "core/fault.h"
#include "experiment/experiment.h"
#include "world/model/world.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct report_robot {
    const char *name;
    uint32_t rgb; /* its own colour */
    uint64_t mail_sent, mail_received, rule_firings;
};

/* A thing that can be moved. */
struct report_object {
    const char *name;
    struct world_pose pose; /* at the end */
};

/* A process that died and was started again. */
struct report_restarts {
    const char *name;
    uint32_t count;
};

struct report_mail {
    uint64_t sent, delivered, waiting, expired, refused, lost, duplicated;
};

/* A monitor of the run. */
struct report_monitor {
    const char *name;            /* what it said is in NAME.log */
    const char *rules, *program; /* one of them; the other is NULL */
    const char *fate;            /* how it ended; NULL: with the run */
};

/* What became of a piece of chaos, in the order of the experiment. */
struct report_chaos {
    bool done;
    double at_s;        /* simulated, when it was done */
    const char *reason; /* why not; "": its time, or its condition, has not come */
};

/* A file that a run is made of. */
struct report_source {
    const char *name; /* its part in the run, then where it is: "rules/experiments/red.clp" */
    uint64_t hash;    /* of its bytes */
};

struct report_input {
    const struct experiment *experiment;
    const struct world *world; /* its outline is drawn */
    uint64_t seed;
    const char *hash;               /* or "none" */
    double sim_time_s, wall_time_s; /* from the first to the last step */
    bool broke_off;                 /* it did not come to its end; what there is, is here */
    const char *command;            /* how to run it again */
    const char *file;               /* the experiment's, as the command names it */
    bool free;                      /* without a lock step */
    const struct report_source *files;
    size_t files_count;
    const char *const *overrides; /* of --set, "key=value" */
    size_t overrides_count;
    const struct report_robot *robots; /* in the order of run.csv */
    size_t robots_count;
    const struct report_robot *agents; /* without a body, in the order of the experiment */
    size_t agents_count;
    const struct report_object *objects;
    size_t objects_count;
    struct report_mail mail;
    bool mail_unknown; /* the brokers' counters are not known */
    const struct report_restarts *restarts;
    size_t restarts_count;
    const struct report_monitor *monitors;
    size_t monitors_count;
    const char *const *undone; /* what the experiment named and did not happen, a sentence each */
    size_t undone_count;
    const struct report_chaos *chaos; /* of each piece; NULL: the experiment has none */
    uint64_t packets_struck;          /* lost or late by it */
    const char *versions;             /* of what the run is made of */
    const char *arithmetic, *architecture, *processor; /* with and on which it was computed */
};

/* What one robot did, from run.csv. */
struct report_robot_result {
    double distance_m, stalled_s, mean_speed_m_s;
    double longest_stall_s;
    uint32_t stalls; /* times that it became stalled */
    double final_x_m, final_y_m, final_heading_rad;
};

struct report_result {
    struct report_robot_result robots[MU_ROBOTS_MAX];
    /* Of the 0.5 m cells of floor that a robot can reach, how many a robot's centre crossed. */
    double explored_fraction;
    const char *most_efficient; /* by mu_stats_efficiency; NULL: no robot moved */
    double efficiency_m_s;      /* of that one */
    /* Each expectation: what it says, what was measured, and whether it was met.  One whose time
     * begins after the end of a run that was cut short on purpose is not judged: met is true, and
     * summary.json leaves it out. */
    bool judged[EXPERIMENT_EXPECTATIONS_MAX];
    bool met[EXPERIMENT_EXPECTATIONS_MAX];
    char texts[EXPERIMENT_EXPECTATIONS_MAX][256];
    char measured[EXPERIMENT_EXPECTATIONS_MAX][160];
    bool all_met;
};

/**
 * Takes a run's folder for the life of this process, and makes it and its parents.  An empty folder
 * is used as it is; an earlier report of that name is moved to the first free one of .1, .2, ...
 *
 * @param or_beside when a live run has the folder, take the first free one of .1, .2, ... instead
 * @param taken     filled with the folder that is ours
 * @return MU_OK, or MU_FAULT_OS with the reason: a live run has the folder, something there is no
 *         report, or the system refuses
 */
MU_MUST_USE mu_result report_folder(const char *wanted, bool or_beside, char *taken, size_t size,
                                    struct mu_fault *fault);

/** @return whether a live run has the folder */
bool report_folder_lives(const char *folder);

/** Says that the report is complete; the folder may be moved away from now on. */
void report_folder_release(const char *folder);

/**
 * Reads folder/run.csv and writes the rest beside it, each file under a temporary name first.
 * Takes start-up memory: call it before mu_memory_seal(), or in a process without a seal.
 *
 * @return MU_OK; MU_FAULT_FILE when run.csv is broken, with its line; MU_FAULT_OS when a file
 *         cannot be read or written (disk full, no permission), with its path
 */
MU_MUST_USE mu_result report_write(const char *folder, const struct report_input *input,
                                   struct report_result *result, struct mu_fault *fault);

/* --- summary.json read back ---------------------------------------------------------------------
 */

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
    const char *arithmetic, *architecture, *processor;
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
    struct report_robot agents[MU_ROBOTS_MAX];
    size_t agents_count;
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
