/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file experiment.h
 * An experiment file: YAML that names a world, robots, what the observer commands, what to expect.
 */
#ifndef MUSTER_EXPERIMENT_H
#define MUSTER_EXPERIMENT_H

#include "core/fault.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    EXPERIMENT_COMMANDS_MAX = 1024,
    EXPERIMENT_EXPECTATIONS_MAX = 64,
    EXPERIMENT_GLOBALS_MAX = 64,
    EXPERIMENT_ARGS_MAX = 64,
    EXPERIMENT_GROUPS_MAX = 64, /* of a robot, and so with services */
    EXPERIMENT_OVERRIDES_MAX = 64,
    EXPERIMENT_PROCESSES_MAX = 64, /* that many robots of one entry are divided among */
    EXPERIMENT_RESOLVERS_MAX = 16,
    EXPERIMENT_HOSTS_MAX = 32,
    EXPERIMENT_MONITORS_MAX = 16,
    EXPERIMENT_BROKERS_MAX = 4,  /* as many as one host can have */
    EXPERIMENT_THREADS_MAX = 64, /* as many as the simulator takes */
    EXPERIMENT_CHAOS_MAX = 64,
    EXPERIMENT_SEQUENCE_MAX = 16, /* events of one */
    EXPERIMENT_EVENTS_MAX = 64,   /* different ones, of all expectations */
    EXPERIMENT_DURATION_MAX_S = 1000000,
    EXPERIMENT_BYTES_MAX = 1 << 20 /* of the file */
};

/* When a process of the run dies: the run ends, or the process is started again. */
enum experiment_on_crash { EXPERIMENT_STOP, EXPERIMENT_RESTART };

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

/* A place in the file. */
struct experiment_mark {
    int line, column;
};

/* A program of the user's that controls agents. */
struct experiment_controller {
    char *program; /* absolute path; in the file, relative to it; NULL: rules control them */
    char **args;
    unsigned args_count;
};

/* A robot, or an agent without a body. */
struct experiment_robot {
    char *name;
    char *body;  /* a kind that the world defines; NULL: the robot stands in the world file */
    char *color; /* of its track; NULL: the body's, or the robot's name if that is a colour */
    struct experiment_pose *pose; /* NULL: the world file's, or a random place */
    char *place;                  /* "random": a free one, by the seed; NULL: none of that */
    unsigned count, processes;    /* as written; loaded, each robot stands for itself */
    char *rules; /* absolute path; in the file, relative to it; NULL: it has a controller */
    struct experiment_controller controller;
    char *host;                   /* one of hosts, in which it begins; NULL: a process of its own */
    char *broker;                 /* one of brokers, in free running; NULL: the first */
    struct mu_fault broker_fault; /* what is wrong with it in lock step, and where */
    enum experiment_on_crash on_crash; /* the experiment's unless it says otherwise, */
    double checkpoint_s;               /* so with this */
    struct experiment_global *globals;
    unsigned globals_count;
    char **groups; /* that it is in from the start */
    unsigned groups_count;
    char **services; /* that it offers from the start: "mapper role=scout" */
    unsigned services_count;
    bool standby;                /* of an agent: it does not run before it is told to */
    struct experiment_mark mark; /* where the file has it */
};

/* The agents of one process, which follow each other in the list. */
struct experiment_crew {
    const char *name;
    unsigned robot, count; /* the first of them, and how many */
    unsigned first;        /* the number behind its name */
    bool numbered;         /* names are NAME_0, NAME_1, ...; else it is one robot, NAME */
};

/* A program that looks at the run while it lives, and is no part of it. */
struct experiment_monitor {
    char *name;    /* of the agent, and of its log; "monitor" unless it says otherwise */
    char *rules;   /* absolute path; in the file, relative to it */
    char *program; /* or, likewise: one of the user's own */
    struct experiment_mark mark; /* of it in the file */
};

/* What the observer commands, and when. */
struct experiment_command {
    double at;      /* s of simulated time */
    char **targets; /* all, robots, special, group:NAME, or names of this experiment's robots; of a
                       launch, hosts */
    unsigned targets_count;
    char *line;   /* a CLIPS line, */
    char *move;   /* or: the host that they are to move to, */
    char *launch; /* or: the name of a new agent, which begins there, */
    char *rules;  /* with these rules */
};

/* What must be true, or the run fails (exit code 1). */
struct experiment_expectation {
    char *near_robot; /* this one */
    char *near_mate;  /* is near that one */
    double within_m;
    double from_s, to_s;         /* the whole run unless it says otherwise; objects: from_s alone */
    double share;                /* of the time, 0 to 1; 1 unless it says otherwise */
    char *inside;                /* or: "arena": no robot outside the world */
    char *objects;               /* or: things of that name, or * behind how their names begin, */
    struct experiment_place *at; /* within_m of there at the end, */
    unsigned count;              /* so many of them at least; 0: all */
    double stall_max_s;          /* or: > 0: no robot stalled longer than this in a row */
    char *statistic;             /* or: a number of summary.json, by its name there, */
    double at_least, at_most;    /* is within these; infinite: not bounded on that side */
    char **sequence;             /* or: conditions that come true one after the other, */
    unsigned sequence_count;
    double within_s; /* the last so soon after the first; 0: whenever */
    char *never;     /* or: a condition that never comes true */
};

enum experiment_chaos_kind {
    CHAOS_NONE,
    /* in the world: */
    CHAOS_PUSH,
    CHAOS_PLACE,
    CHAOS_BLOCK,
    /* to processes: */
    CHAOS_KILL,
    CHAOS_RESTART,
    CHAOS_STOP,
    CHAOS_CONTINUE,
    /* to what they say to each other: */
    CHAOS_CUT,
    CHAOS_LOSE,
    CHAOS_DELAY,
};

/* What goes wrong on purpose, once. */
struct experiment_chaos {
    double at;  /* s of simulated time */
    char *when; /* or: when this comes true first; NULL: at that time */
    enum experiment_chaos_kind kind;
    char *who, *whom;               /* a body or a part of the run; of what is between two, both */
    struct experiment_place *force; /* N; in the world's frame */
    double torque_nm;
    struct experiment_pose *pose;    /* where it is put */
    char *sensor;                    /* a word of muster/sensors.h, or all */
    double share;                    /* of the packets that are lost */
    double by_ms;                    /* that each is late */
    double for_s;                    /* after that it is undone; 0: it is not.  Simulated time */
    double wall_s;                   /* or: after so much of the clock on the wall */
    struct experiment_mark mark;     /* of it in the file, */
    struct experiment_mark for_mark; /* and of its `for`, or of all of it */
    char text[160];                  /* what it does, for people */
};

/* What the run's broker is told. */
struct experiment_broker {
    double delivery_interval_ms; /* 0: it delivers at once */
    bool store;                  /* it has one, in the run's folder: mail can outlive its death */
};

/* What the run's simulator is told. */
struct experiment_simulator {
    bool none;        /* there is none, and no world: the run has a clock and agents */
    uint64_t threads; /* that read the sensors; 0: as it does by itself */
};

struct experiment {
    char *name;   /* the file's name without folder and ending, unless it says otherwise;
                     letters, digits, _ . -, so that a folder may bear it */
    char *world;  /* absolute path; in the file, relative to it; without a simulator WORLD_NONE */
    char *policy; /* likewise: which agents may direct which; NULL: the broker's default */
    uint64_t seed;
    double duration; /* s of simulated time */
    double step_ms;  /* control step; 100 unless it says otherwise */
    enum experiment_on_crash on_crash;
    double checkpoint_s;    /* robots that may be started again are written down so often: 1 unless
                               it says otherwise; at most a step: after each; 0: never */
    unsigned restarts;      /* of one process at most; 5 unless it says otherwise */
    double return_within_s; /* wall time that a lock step waits for one; 20, likewise */
    char **brokers;         /* their names; none: main */
    unsigned brokers_count;
    char **hosts; /* processes that robots may move to */
    unsigned hosts_count;
    char **resolvers; /* schemes of addresses that need a resolver: role, near */
    unsigned resolvers_count;
    struct experiment_broker broker;
    struct experiment_simulator simulator;
    struct experiment_robot *robots; /* and, behind them, the agents without a body */
    unsigned robots_count;
    struct experiment_robot *agents; /* those; no names are the same */
    unsigned agents_count;
    struct experiment_crew *crews; /* in the order of both */
    unsigned crews_count;
    struct experiment_monitor *monitors;
    unsigned monitors_count;
    struct experiment_command *observer;
    unsigned observer_count;
    struct experiment_expectation *expect;
    unsigned expect_count;
    struct experiment_chaos *chaos;
    unsigned chaos_count;
    bool free;           /* it runs free unless the command line says otherwise */
    const char **events; /* conditions of all sequences and nevers, each once */
    unsigned events_count;
    struct experiment_mark *event_marks; /* where the file has each first */
    char *file;                          /* its path, for faults */
    char folder[256];                    /* of the file: what relative paths start from */
};

/** Lets absolute paths in experiment files start from a folder, for files that were recorded; the
 * text stays the caller's.  "": from where they say */
void experiment_root(const char *folder);

/* Robots' numbers of summary.json, as statistics name them. */
enum experiment_statistic {
    STATISTIC_DISTANCE,
    STATISTIC_STALLS,
    STATISTIC_STALLED,
    STATISTIC_MEAN_SPEED,
    STATISTIC_MAIL_SENT,
    STATISTIC_MAIL_RECEIVED,
    STATISTIC_RULE_FIRINGS,
    STATISTIC_FINAL_X,
    STATISTIC_FINAL_Y,
    STATISTIC_FINAL_HEADING,
    /* of the run: */
    STATISTIC_SIM_TIME,
    STATISTIC_WALL_TIME,
    STATISTIC_REAL_TIME_FACTOR,
    STATISTIC_EXPLORED,
    STATISTIC_SENT,
    STATISTIC_DELIVERED,
    STATISTIC_WAITING,
    STATISTIC_EXPIRED,
    STATISTIC_REFUSED,
    STATISTIC_LOST,
    STATISTIC_DUPLICATED,
    STATISTICS
};

enum { EXPERIMENT_NO_ROBOT = -1, EXPERIMENT_ALL_ROBOTS = -2 };

/**
 * Finds a statistic by its name in summary.json: explored_fraction, red.distance_m,
 * robots.distance_m (the mean over all).
 *
 * @param robot  filled with whose it is: an index, or one of the two above
 * @return STATISTICS when there is none of that name
 */
enum experiment_statistic experiment_statistic_find(const struct experiment *e, const char *name,
                                                    int *robot);

/** @return the number of an event, by the text of its condition; EXPERIMENT_EVENTS_MAX: none */
unsigned experiment_event_find(const struct experiment *e, const char *text);

/** @return whether a robot, or a thing of that name, can be in a condition or be pushed: robots
 * are known before the world is, and what is no robot may be a thing.  As condition_names. */
int experiment_body_find(const void *experiment, const char *name);

/* The process of a scheme's resolver has the name of its agent. */
#define EXPERIMENT_RESOLVER "resolver."

/** @return whether a part is the process of a resolver of the experiment */
bool experiment_is_resolver(const struct experiment *e, const char *part);

/** @return the index of an agent without a body, or -1.  As condition_names. */
int experiment_agent_find(const void *experiment, const char *name);

/** @return how many robots and agents without a body there are */
static inline unsigned experiment_members(const struct experiment *e)
{
    return e->robots_count + e->agents_count;
}

/** @return the index among all of the agent in whose name a part's process runs, below robots_count
 * for one with a body; -1: the part is none */
int experiment_robot_find(const struct experiment *e, const char *name);

/**
 * Loads and checks an experiment.  Lives as long as the process.
 *
 * @param set        overrides as "key=value", e.g. "duration=30" or "robots.red.rules=x.clp"; what
 *                   may be set: name world seed duration step_ms on-crash checkpoint restarts
 *                   return-within policy simulator.threads, and of each robot robots.NAME.body,
 *                   .color, .rules, .on-crash, .checkpoint and .globals.G; paths as in the file
 * @return MU_OK; MU_FAULT_FILE with file, line, column and what was expected; MU_FAULT_USAGE when
 *         an override is wrong (fault->file is "--set key=value")
 */
MU_MUST_USE mu_result experiment_load(struct experiment **out, const char *path,
                                      const char *const *set, size_t set_count,
                                      struct mu_fault *fault);

#endif
