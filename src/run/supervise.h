/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file supervise.h
 * The processes of a run: started, listened to, and never left behind.
 *
 * A child dies with its parent however that ends: the kernel kills it (PR_SET_PDEATHSIG).
 */
#ifndef MUSTER_RUN_SUPERVISE_H
#define MUSTER_RUN_SUPERVISE_H

#include "muster/limits.h"
#include "muster/result.h"

#include <sched.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

enum {
    SUPERVISE_CHILDREN_MAX = MU_ROBOTS_MAX + 80,
    SUPERVISE_WORDS_MAX = 1024,
    SUPERVISE_FATE_MAX = 96,
    SUPERVISE_LINE_MAX = 4 * MU_ROBOTS_MAX + 640, /* words of a command line */
    SUPERVISE_LINE_BYTES = 1024 * 1024
};

struct child {
    char name[MU_PROCESS_MAX + 1]; /* broker, broker.NAME, simulator, or the robot's */
    pid_t pid;
    int output;     /* both of its outputs, read end; -1: closed */
    int log;        /* what it says goes there; -1: to standard error */
    int ready;      /* read end of where it says that it is ready; -1: it has, or never will */
    bool wide;      /* it may use all processors */
    bool may_leave; /* its end with exit code 0 is none that matters */
    uint32_t restarts;
    uint64_t restart_ns; /* when it is to be started again; 0: it has not died */
    bool returned;       /* it was started again, and not all agents in it were seen yet */
    bool excused;        /* its end, however it came, is none that matters */
    bool struck;         /* its end is meant: chaos.c */
    bool ended;
    uint64_t ended_ns;               /* when that was seen */
    int status;                      /* of waitpid */
    char words[SUPERVISE_WORDS_MAX]; /* the last that it said */
    uint32_t words_len;
};

/* What was found when it was last looked who uses the processors. */
struct supervise_haste {
    bool batch;         /* the children are */
    uint64_t looked_ns; /* 0: never */
    uint64_t busy_ns;   /* of the processors that the children may use, and */
    uint64_t own_ns;    /* of us and the children */
};

struct supervise {
    struct child *children; /* SUPERVISE_CHILDREN_MAX */
    uint32_t count;
    bool quiet;           /* do not pass on what children say */
    bool spread;          /* each child stays on one processor, they take turns */
    cpu_set_t processors; /* that we may use */
    struct supervise_haste haste;
};

/** A signal asked the run to end. */
extern volatile sig_atomic_t run_signal;

/** Lets SIGINT, SIGTERM and SIGHUP set run_signal. */
void supervise_signals_note(void);

/** Begins the words of a command line, in the memory of the one before. */
void supervise_words(const char *program);

/** Adds a word. */
void supervise_word(const char *format, ...) __attribute__((format(printf, 1, 2)));

/** @return the words, with NULL behind the last, until the next line is begun */
const char *const *supervise_words_end(void);

/**
 * Takes memory at start-up.
 *
 * @param spread  keep each child, with all its threads, on one processor.  Children that wait for
 *                one another all the time then wake their threads without a word to another
 *                processor, which costs more than what the thread does.
 */
void supervise_init(struct supervise *s, bool quiet, bool spread);

/** Starts a program that stands beside ours, in the place of a child of that name that has ended.
 * @return MU_OK; MU_FULL; MU_FAULT_OS, explained */
MU_MUST_USE mu_result supervise_start(struct supervise *s, const char *name, const char *program,
                                      const char *const *argv);

/** The same for a program whose threads work side by side: it may use all processors. */
MU_MUST_USE mu_result supervise_start_wide(struct supervise *s, const char *name,
                                           const char *program, const char *const *argv);

/**
 * The same for a program that stands beside the run: what it says goes into a file alone.  It may
 * say when it is ready, with a byte to the descriptor that MUSTER_READY names.
 *
 * @param log  the file's path; one that is there is overwritten
 */
MU_MUST_USE mu_result supervise_start_aside(struct supervise *s, const char *name,
                                            const char *program, const char *const *argv,
                                            const char *log);

/** @return whether a child that stands beside has said that it is ready, or never will: it has
 * ended, or closed the descriptor */
bool supervise_is_ready(const struct child *child);

/**
 * Starts a child that has ended anew, with the same name.
 *
 * @return MU_OK; MU_FAULT_OS, explained
 */
MU_MUST_USE mu_result supervise_start_again(struct supervise *s, struct child *child,
                                            const char *program, const char *const *argv);

/** Reads what children say and notes which have ended; never blocks. */
void supervise_look(struct supervise *s);

/**
 * Looks, five times a second, at who uses the processors, and makes the children of a run that
 * hurries what is better there.
 *
 * The kernel wakes the reader of a socket on the writer's processor, where it pushes the writer
 * aside: a simulator that has the next Sense to write then waits while the other processor sleeps.
 * Batch processes (SCHED_BATCH, sched(7)) let the writer finish, and four robots run at 1.3 times
 * the speed.  But neither do they push aside a process that is no child: beside one that computes,
 * they had a sixth of their speed.  So they are batch while they are by themselves.
 */
void supervise_hurry(struct supervise *s);

/** @return whether a child has ended and may not */
bool supervise_has_died(const struct child *child);

/** @return the child of that name, or NULL */
struct child *supervise_find(struct supervise *s, const char *name);

/** Sends a signal to a child that lives. */
void supervise_signal(struct child *child, int number);

/** Waits for at most patience_ms until a child has ended; NULL: all of them. */
void supervise_await(struct supervise *s, const struct child *one, int patience_ms);

/** Asks one child to end, waits for at most patience_ms, then kills it. */
void supervise_stop(struct supervise *s, struct child *child, int patience_ms);

/** Ends all that still live, together. */
void supervise_stop_all(struct supervise *s, int patience_ms);

/** Writes how a child that has ended did so: "ended with exit code 1". */
void supervise_fate(const struct child *child, char *text, size_t size);

/** Says on standard error how a child ended, with its last words. */
void supervise_explain(const struct child *child);

#endif
