/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file run.h
 * One run of an experiment: what it is made of while it lives.
 */
#ifndef MUSTER_RUN_RUN_H
#define MUSTER_RUN_RUN_H

#include "bus/bus.h"
#include "bus/traffic.h"
#include "experiment/experiment.h"
#include "muster/agent.h"
#include "report/report.h"
#include "run/supervise.h"
#include "runtime/probes.h"
#include "wire.h"
#include "world/model/world.h"

#include <limits.h>

struct run_options {
    const char *file;
    const char *local;    /* LOCAL_ENVIRONMENT of all its processes; NULL: as it is */
    int64_t seed, domain; /* < 0: the file's; the first free one */
    double duration_s;    /* < 0: the file's */
    double rate, limit_s;
    bool free, quiet, json, no_spread, no_diary, programs;
    bool watch; /* the live page is opened beside it */
    const char *out, *record, *inputs, *root;
    const char *const *set;
    size_t set_count;
    const uint64_t *seeds; /* of a series */
    size_t seeds_count;    /* 0: it is one run */
    int64_t jobs;          /* of a series: runs at once; 0: one for each processor */
};

/* A child, by what it is. */
enum run_kind {
    RUN_BROKER,
    RUN_SIMULATOR,
    RUN_RESOLVER,
    RUN_HOST,
    RUN_CREW,
    RUN_MONITOR,
    RUN_PAGE
};

struct run_part {
    enum run_kind kind;
    unsigned index; /* among the brokers, resolvers, hosts, crews or monitors */
};

/* What happened to what the experiment named: so many things are told of. */
enum { RUN_UNDONE_MAX = 64 };

enum { RUN_TOTALS_MAX = 2 * MU_ROBOTS_MAX }; /* of robots, and of agents without a body */

struct run_observer;
struct run_inputs;
struct chaos;

/* The role of a program of the user's: the recording names it, and does not have it. */
#define RUN_CONTROLLER "controller"

struct run_file {
    const char *role; /* experiment, world, rules, policy, library, controller */
    const char *path;
    const char *name; /* in the recording: where it is from here; of the library, in that */
    uint64_t hash;    /* of what it has in it: mu_hash_bytes */
};

struct run {
    struct run_options options;
    struct experiment *experiment;
    struct world *world;
    int domain;
    char folder[PATH_MAX];  /* of the report */
    struct run_file *files; /* that it is made of */
    size_t files_count;
    struct supervise children;
    bool hurries;                                /* as fast as the machine can */
    struct run_part *parts;                      /* what each of them is */
    bool begun;                                  /* it was told to go */
    bool monitors_late[EXPERIMENT_MONITORS_MAX]; /* so slow that they were ended after the run */
    mu_process *process;
    mu_agent *observer;
    struct run_observer *console;          /* of the observer */
    struct run_inputs *inputs;             /* of a recording; NULL: there are none */
    struct chaos *chaos;                   /* NULL: the experiment has none */
    struct traffic *traffic;               /* NULL: no packets are struck */
    const char *struck[TRAFFIC_PARTS_MAX]; /* children whose packets may be, from 1 on */
    unsigned struck_count;
    struct bus_reader status, broker_status;
    struct bus_writer command;
    char simulator[MU_PROCESS_MAX + 1]; /* known once it has said something */
    muster_RunState state;
    uint64_t time_ns, wall_ns, skipped;
    char waits_for[1024], hash[MU_FIELD_MAX + 2];
    muster_RobotTotals
        totals[RUN_TOTALS_MAX]; /* robot: a name of the world or of an agent, or NULL */
    uint32_t totals_count;
    struct world_pose *objects; /* where they are at the end, in the world's order */
    size_t objects_count;       /* 0: the run has not ended */
    muster_BrokerStatus mail[EXPERIMENT_BROKERS_MAX];
    struct report_mail mail_before[EXPERIMENT_BROKERS_MAX]; /* of lives that chaos ended */
    bool registered, name_refused;
    const char *undone[RUN_UNDONE_MAX]; /* what the experiment named and did not happen */
    size_t undone_count;
    bool command_refused; /* by the trust policy, before the run has begun */
    bool command_unknown; /* no agent fits what a command of the observer is for */
    uint64_t directives_sent, directives_kept; /* receipts say: the broker has them */
    uint64_t pages_sent, pages_answered;       /* of the robots' groups and services */
    uint64_t patience_ns;                      /* for all to be there, from its begin on */
    uint64_t began_wall_ns, progress_wall_ns, round_wall_ns;
    uint64_t silent_ns; /* since the simulator was heard of last */
};

enum { RUN_CHILD_MAX = sizeof "broker." + MU_NAME_MAX };

/** @return how many brokers the run has */
unsigned run_brokers(const struct run *r);

/** @return the name of the index-th */
const char *run_broker(const struct run *r, unsigned index);

/** Writes the name of its process among the children: RUN_CHILD_MAX bytes. */
void run_child_name(const struct run *r, unsigned index, char *name);

/**
 * Loads the world and puts the robots into it, in run_place.c: its mistakes are found before
 * anything starts.  Robots with a random place get their pose.
 */
MU_MUST_USE mu_result run_place(struct run *r, struct mu_fault *fault);

/* A file that a run is made of. */
enum { RUN_FILES_MAX = 512 };

/** Finds the files that a run is made of, in run_files.c; takes memory at start-up. */
void run_files_find(struct run *r);

/** @return a robot's name as the world has it, which lives as long; NULL: it has none of that name.
 * Robots with a random place may stand elsewhere in the simulator's list than in ours. */
char *run_robot_name(const struct run *r, const char *name);

/** Takes where the world's objects are, if these are they. */
void run_objects_take(struct run *r, const muster_ObjectPlace *places, size_t count);

/** Tells the simulator to begin, or to go on where it holds.  @param seq  higher each time */
MU_MUST_USE mu_result run_go_send(struct run *r, uint64_t seq);

/** Writes the command that does the run again, without the words that change nothing in it. */
void run_command_write(const struct run *r, char *buffer, size_t size);

/** Takes the robots of a process that is started once more out of standby, as soon as they are
 * there.  @param due_s  simulated time before which the word does not come; < 0: at once */
void run_wake(struct run *r, const char *child, double due_s);

/** @return whether a child that is started again goes on from its checkpoint, in run.c */
bool run_remembers(const struct run *r, const struct child *child);

/** Says on standard error that something that the experiment named did not happen, and keeps it for
 * the report. */
void run_undone_note(struct run *r, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** Keeps what a broker has counted, because it is about to die. */
void run_mail_keep(struct run *r, const char *child);

/** @return what all brokers have counted, in all of their lives */
struct report_mail run_mail_of(const struct run *r);

/** @return the number of a child among those whose packets may be struck; 0: it is none of them */
unsigned run_struck_find(const struct run *r, const char *child);

/** Says which part of the run is started next, before its process is. */
void run_struck_next(const struct run *r, const char *child);

/**
 * Reads the experiment and all that it names, and makes the folder of the report, unless the
 * options ask for a series.
 *
 * @return MU_OK, or a fault, explained
 */
MU_MUST_USE mu_result run_prepare(struct run *r);

/** Lives through a run that is prepared, and reports it.  @return the exit code */
int run_live(struct run *r);

/** Starts brokers, simulator, resolvers and robots, in run_start.c.  @return MU_OK, or a fault,
 *  explained */
MU_MUST_USE mu_result run_start(struct run *r);

/** @return what a child is; it may have died */
struct run_part run_part_of(const struct run *r, const struct child *child);

/** @return whether the simulator has said that the run is over, well or not */
static inline bool run_is_over(const struct run *r)
{
    return r->state == muster_RUN_DONE || r->state == muster_RUN_FAULT;
}

/** @return whether the run starts the monitors of its experiment: a run that is done again has what
 * they said from the recording; in run_monitors.c */
bool run_monitors_start(const struct run *r);

/** @return whether every monitor sees the run, and has its name if it is to have one */
bool run_monitors_ready(const struct run *r);

/** Writes the names of monitors that do not see the run yet, for people. */
void run_monitors_missing(const struct run *r, char *text, size_t size);

/** Says of monitors that have died while the run lives that they are no more. */
void run_monitors_look(struct run *r);

/** Lets them see the end of the run, and end by themselves. */
void run_monitors_await(struct run *r);

/** Says, once the run is over, what became of them, for the report.  @return how many there are */
size_t run_monitors_fates(struct run *r, const struct report_monitor **out);

/** Starts a child that has ended anew, robots from their checkpoints if there are to be any.
 * @return MU_OK; MU_REFUSED: a part that does not come back; or a fault, explained */
MU_MUST_USE mu_result run_start_again(struct run *r, struct child *child);

/* The folder of capsules and stores, in the report's. */
#define RUN_CHECKPOINTS "checkpoints"

/** @return the robots or agents of a controller, if a child is one; else NULL */
const struct experiment_crew *run_controller(const struct run *r, const struct child *child);

/** @return the hash of what a file has in it; that of nothing: it cannot be read */
uint64_t run_file_hash(const char *path);

/** @return whether anything of the run may be started again when it dies, in run.c */
bool run_restarts_any(const struct run *r);

/** @return whether a child is started again by itself when it dies */
bool run_restarts(const struct run *r, const struct child *child);

/** @return whether its brokers are: in lock step the mail of a step is theirs alone */
bool run_restarts_brokers(const struct run *r);

/**
 * Starts again what has died, is to be started again, and has waited long enough.
 *
 * @return a child that has died and is not started again, or NULL: for as long as the word that the
 * run is over may still come, what has ended may have ended with it
 */
const struct child *run_restart_look(struct run *r);

/** @return whether a robot enters its groups and services itself: it is with another broker than
 * the observer, which lock step does not allow */
bool run_pages_own(const struct run *r, const struct experiment_robot *robot);

/**
 * Enters the other robots' groups and services, in run_orders.c: as many as can be under way, the
 * next time more.  The lock step sees them as they are when it begins.
 *
 * @return whether the broker has answered for all of them
 */
bool run_pages_tell(struct run *r);

/** @return whether a mail to the observer was an answer to that; a refusal ends the run */
bool run_pages_take(struct run *r, const struct mu_mail *mail);

/** Sends everything that the observer will ever command, before the first step.  @return as
 * mu_agent_send; MU_FAULT_FILE: what is wrong with a launched agent's rules is said */
MU_MUST_USE mu_result run_commands_send(struct run *r);

/** Makes the observer's console, in run_observer.c. */
void run_observer_open(struct run *r);

/** A directive to the observer: a line of its console. */
void run_observer_directive(struct run *r, const struct mu_mail *mail);

/** @return whether a mail to the observer was an answer to such a line */
bool run_observer_take(struct run *r, const struct mu_mail *mail);

/** Takes what came of a glance of the observer's: for probes_hear.  @param self  the run */
void run_observer_glance(void *self, uint64_t number, enum probe_end end, const char *text);

/** @return how many of the mails first_seq to last_seq are of such lines */
uint64_t run_observer_receipt(struct run *r, uint64_t first_seq, uint64_t last_seq,
                              enum mu_outcome outcome);

/** Looks whether lines have all their answers, or have waited too long. */
void run_observer_look(struct run *r);

/** Prints the summary of a folder on one line. */
void run_summary_print(const char *folder);

/** Fills what a report is made of with what the run itself has: all but mail, chaos, restarts and
 * monitors, and how it was made.  Takes memory at start-up. */
void run_report_input(const struct run *r, struct report_input *input);

/** Writes a report and says on standard output what came out.  @return the exit code */
int run_report_write(const struct run *r, const struct report_input *input);

/** Writes the report and says on standard output what came out.  @return the exit code */
int run_report(struct run *r);

/* --- series.c --------------------------------------------------------------------------------- */

/*
 * One experiment with many seeds: `muster run FILE --seeds 1..30`.
 *
 * Each run is a `muster run` of its own, with a report of its own; as many live at once as asked.
 */

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
