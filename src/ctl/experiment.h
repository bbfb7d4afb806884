/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file experiment.h
 * An experiment file: YAML that names a world, robots, what the observer commands, what to expect.
 */
#ifndef MUSTER_CTL_EXPERIMENT_H
#define MUSTER_CTL_EXPERIMENT_H

#include "core/fault.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    EXPERIMENT_COMMANDS_MAX = 1024,
    EXPERIMENT_EXPECTATIONS_MAX = 64,
    EXPERIMENT_GLOBALS_MAX = 64,
    EXPERIMENT_GROUPS_MAX = 64, /* of a robot, and so with services */
    EXPERIMENT_OVERRIDES_MAX = 64,
    EXPERIMENT_PROCESSES_MAX = 64, /* that many robots of one entry are divided among */
    EXPERIMENT_RESOLVERS_MAX = 16,
    EXPERIMENT_HOSTS_MAX = 32,
    EXPERIMENT_BROKERS_MAX = 4,    /* as many as one host can have */
    EXPERIMENT_BYTES_MAX = 1 << 20 /* of the file */
};

struct experiment_pose {
    double x_m, y_m, heading_deg;
};

struct experiment_place {
    double x_m, y_m;
};

struct experiment_global {
    char *name;  /* without ?* and * */
    char *value; /* a CLIPS field */
};

struct experiment_robot {
    char *name;
    char *body;  /* a kind that the world defines; NULL: the robot stands in the world file */
    char *color; /* of its track; NULL: the body's, or the robot's name if that is a colour */
    struct experiment_pose *pose; /* NULL: the world file's, or a random place */
    char *place;                  /* "random": a free one, by the seed; NULL: none of that */
    unsigned count, processes;    /* as written; loaded, each robot stands for itself */
    char *rules;                  /* absolute path; in the file, relative to it */
    char *host;                   /* one of hosts, in which it begins; NULL: a process of its own */
    char *broker;                 /* one of brokers, in free running; NULL: the first */
    struct mu_fault broker_fault; /* what is wrong with it in lock step, and where */
    struct experiment_global *globals;
    unsigned globals_count;
    char **groups; /* that it is in from the start */
    unsigned groups_count;
    char **services; /* that it offers from the start: "mapper role=scout" */
    unsigned services_count;
};

/* The robots of one process, which follow each other in the list. */
struct experiment_crew {
    const char *name;
    unsigned robot, count; /* the first of them, and how many */
    unsigned first;        /* the number behind its name */
    bool numbered;         /* names are NAME_0, NAME_1, ...; else it is one robot, NAME */
};

/* What the observer commands, and when. */
struct experiment_command {
    double at;      /* s of simulated time */
    char **targets; /* all, robots, special, group:NAME, or names of this experiment's robots */
    unsigned targets_count;
    char *line; /* a CLIPS line, */
    char *move; /* or: the host that they are to move to */
};

/* What must be true, or the run fails (exit code 1). */
struct experiment_expectation {
    char *near_robot; /* who */
    char *near_mate;  /* whom */
    double within_m;
    double from_s, to_s;         /* the whole run unless it says otherwise; objects: from_s alone */
    double share;                /* of the time, 0 to 1; 1 unless it says otherwise */
    char *inside;                /* or: "arena": no robot outside the world */
    char *objects;               /* or: things of that name, or * behind how their names begin, */
    struct experiment_place *at; /* within_m of there at the end, */
    unsigned count;              /* so many of them at least; 0: all */
    double stall_max_s;          /* or: > 0: no robot stalled longer than this in a row */
};

/* A process of the run that dies ends the run. */
enum experiment_on_crash { EXPERIMENT_STOP };

/* What the run's broker is told. */
struct experiment_broker {
    double delivery_interval_ms; /* 0: it delivers at once */
};

struct experiment {
    char *name;   /* the file's name without folder and ending, unless it says otherwise;
                     letters, digits, _ . -, so that a folder may bear it */
    char *world;  /* absolute path; in the file, relative to it */
    char *policy; /* likewise: who may direct whom; NULL: the broker's default */
    uint64_t seed;
    double duration; /* s of simulated time */
    double step_ms;  /* control step; 100 unless it says otherwise */
    enum experiment_on_crash on_crash;
    char **brokers; /* their names; none: main */
    unsigned brokers_count;
    char **hosts; /* processes that robots may move to */
    unsigned hosts_count;
    char **resolvers; /* schemes of addresses that somebody is to resolve: role, near */
    unsigned resolvers_count;
    struct experiment_broker broker;
    struct experiment_robot *robots;
    unsigned robots_count;
    struct experiment_crew *crews; /* in the robots' order */
    unsigned crews_count;
    struct experiment_command *observer;
    unsigned observer_count;
    struct experiment_expectation *expect;
    unsigned expect_count;
    char folder[256]; /* of the file: what relative paths start from */
};

/**
 * Loads and checks an experiment.  Lives as long as the process.
 *
 * @param set        overrides as "key=value", e.g. "duration=30" or "robots.red.rules=x.clp"; what
 *                   may be set: name world seed duration step_ms on-crash policy, and of each robot
 * NAME robots.NAME.body, .color, .rules and .globals.G; paths as in the file
 * @return MU_OK; MU_FAULT_FILE with file, line, column and what was expected; MU_FAULT_USAGE when
 *         an override is wrong (fault->file is "--set key=value")
 */
MU_MUST_USE mu_result experiment_load(struct experiment **out, const char *path,
                                      const char *const *set, size_t set_count,
                                      struct mu_fault *fault);

#endif
