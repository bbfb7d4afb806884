/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file compare.h
 * Runs side by side: what their summary.json say, by group, as means with intervals.
 *
 * A statistic is a number of summary.json by its name there: explored_fraction, mail.sent, of a
 * robot red.distance_m, red.final.x_m.  robots.distance_m is the mean over a run's robots, and
 * expectations.met the share of them that is met.
 *
 * Runs are of one group if they ran the same but for the seed: files, duration, lock step and what
 * --set said.  A group's name says in what it differs from the others of its experiment.
 */
#ifndef MUSTER_REPORT_COMPARE_H
#define MUSTER_REPORT_COMPARE_H

#include "core/fault.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum {
    COMPARE_RUNS_MAX = 1024,
    COMPARE_GROUPS_MAX = 64,
    COMPARE_STATISTICS_MAX = 64,
    COMPARE_NAME_MAX = 128, /* bytes of a name, with the zero; so of a group */
    COMPARE_FILE_MAX = 16 << 20
};

/* What several runs say of one number: its mean, how far the runs differ, and how sure the mean is.
 * All zero: nothing has been added. */
struct interval {
    size_t count;
    double mean, least, most;
    double squares; /* sum of the squared distances from the mean */
};

void interval_add(struct interval *i, double value);

/** @return the standard deviation of the values, as of a sample (n - 1); 0 for fewer than two */
double interval_deviation(const struct interval *i);

/**
 * Half the width of the interval that has the mean of all possible runs in it 95 times of 100, if
 * the values are normally distributed (Student's t).
 *
 * @return NaN for fewer than two values, of which nothing can be said
 */
double interval_half_width(const struct interval *i);

/** @return t with so much probability between -t and t, for degrees of freedom from 1 on */
double interval_student(double probability, size_t freedom);

/* Something that was run: a file, the duration. */
struct compare_part {
    const char *text; /* "follower.clp 1a2b3c4", "60 s" */
    uint64_t hash;
};

struct compare_run {
    const char *folder;
    char experiment[COMPARE_NAME_MAX], hash[80], arithmetic[COMPARE_NAME_MAX];
    char value[COMPARE_NAME_MAX]; /* of the key that runs are grouped by; "": they are by none */
    const struct compare_part *parts;
    unsigned parts_count;
    uint64_t content; /* hash of experiment, value and parts, in whatever order these came */
    const struct compare_group *group; /* NULL before compare_close */
    uint64_t seed;
    bool broke_off;
    unsigned expected, met;                /* expectations */
    double values[COMPARE_STATISTICS_MAX]; /* NaN: this run has none of that name */
};

struct compare_group {
    char name[COMPARE_NAME_MAX];
    const struct compare_run *first;
    unsigned runs, as_expected; /* all expectations of so many are met */
    struct interval statistics[COMPARE_STATISTICS_MAX];
};

struct compare {
    const char *by; /* the key of --set whose values make groups: others of --set make none.  NULL:
                       all that was run makes them */
    char statistics[COMPARE_STATISTICS_MAX][COMPARE_NAME_MAX];
    unsigned statistics_count;
    struct compare_run *runs; /* runs_max */
    unsigned runs_count, runs_max;
    struct compare_group groups[COMPARE_GROUPS_MAX]; /* numbers in order, or as they came */
    unsigned groups_count;
};

/**
 * Begins a comparison; takes memory at start-up.
 *
 * @param statistics  names; count 0: those that say most about any team
 * @return MU_OK; MU_FAULT_USAGE: too many names, or one that is too long, explained
 */
MU_MUST_USE mu_result compare_open(struct compare **out, unsigned runs_max, const char *by,
                                   const char *const *statistics, size_t count);

/**
 * Reads folder/summary.json; the folder's name must live as long as the comparison.
 *
 * @return MU_OK; MU_DUPLICATE: the same run was added before, and this one is left out; MU_FULL:
 *         no room for another run or group; MU_FAULT_FILE with the place
 */
MU_MUST_USE mu_result compare_add(struct compare *c, const char *folder, struct mu_fault *fault);

/** @return a run with another arithmetic than the first one's; NULL: all have the same */
const struct compare_run *compare_other_arithmetic(const struct compare *c);

/** Makes the groups, when all runs are there.  @return MU_OK; MU_FULL: more groups than fit */
MU_MUST_USE mu_result compare_close(struct compare *c);

/** @return whether some run has that statistic */
bool compare_has(const struct compare *c, unsigned statistic);

/** Writes a statistic's name for people: "robots: distance (m)". */
void compare_label(char label[COMPARE_NAME_MAX + 16], const char *statistic);

/** Prints a table, or an object for each statistic of each group. */
void compare_print(const struct compare *c, FILE *to, bool json);

/**
 * Writes a page with a plot for each statistic.
 *
 * @return MU_OK; MU_FAULT_OS: it cannot be written
 */
MU_MUST_USE mu_result compare_page(const struct compare *c, const char *path,
                                   struct mu_fault *fault);

#endif
