/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file checkpoint.h
 * Agents on disk: a file for each, NAME.capsule, which is replaced as a whole.  It outlives the
 * process, and not a loss of power.  NAME.gone says that an agent with which the process began is
 * not to come back: it was disposed of, or has moved on.
 */
#ifndef MUSTER_AGENT_CHECKPOINT_H
#define MUSTER_AGENT_CHECKPOINT_H

#include "agent/trip.h"
#include "core/options.h"
#include "runtime/answer.h"

#include <stdbool.h>
#include <stdint.h>

/* What the command line says of them. */
struct checkpoint_settings {
    double every_s;     /* 0: never */
    const char *folder; /* of the files */
    bool restore;       /* agents that have a file there come back */
};

/* These options, for a program's table of options. */
#define CHECKPOINT_OPTIONS(set)                                                                   \
    {.name = "checkpoint",                                                                        \
     .kind = MU_OPTION_REAL,                                                                      \
     .unit = "S",                                                                                 \
     .fallback = "0",                                                                             \
     .help = "write each agent to the folder every S seconds, when it comes, and when its state " \
             "changes; 0: never",                                                                 \
     .target = &(set).every_s,                                                                    \
     .max = 1e6},                                                                                 \
        {.name = "folder",                                                                        \
         .kind = MU_OPTION_STRING,                                                                \
         .unit = "DIR",                                                                           \
         .help = "where checkpoints are",                                                         \
         .target = &(set).folder},                                                                \
    {                                                                                             \
        .name = "restore", .kind = MU_OPTION_FLAG,                                                \
        .help = "bring back the agents that have a checkpoint there", .target = &(set).restore    \
    }

/* What a file says before the passport. */
struct checkpoint_head {
    int64_t step;         /* the last that the agent lived through; -1: none */
    struct answer answer; /* to that one; it may not have gone out */
};

/* The file of an agent. */
struct saved {
    char name[MU_NAME_MAX + 1]; /* "": there is none */
    bool failing;               /* the last time it was not written, and that was said */
    bool tried;                 /* it was written, or that failed, */
    enum mu_state state;        /* in this state, */
    uint64_t written_ns;        /* then, on the crew's clock */
};

struct checkpoints {
    const struct checkpoint_settings *set;
    struct saved *saved; /* of each robot */
    struct mu_text text; /* TRIP_CAPSULE_MAX: what is being written or read */
};

/** @return MU_OK, or MU_FAULT_USAGE: a folder is missing, and it has said so */
MU_MUST_USE mu_result checkpoint_settings_check(const struct checkpoint_settings *set,
                                                const char *program);

/** Takes the memory for a crew's checkpoints, if there are to be any. */
void checkpoint_reserve(struct crew *c);

/** Writes an agent's file.  @return false: that failed, and was logged, once until it succeeds */
bool checkpoint_write(struct robot *r, enum mu_state state);

/** Writes what is due. */
void checkpoint_round(struct crew *c);

/**
 * Forgets who is not here any more, once the others have heard of that: the file goes.  Of one that
 * the command line names a mark stays, so that it does not begin anew here.
 */
void checkpoint_forget(struct crew *c);

/** The same at once for one of them: its place is another's now. */
void checkpoint_leave(struct robot *r);

/** It came back from its file, which goes if it is not here any more. */
void checkpoint_own(struct robot *r);

/** @return whether such a mark is there */
bool checkpoint_is_gone(const struct crew *c, const char *name);

/** @return whether an agent of that name has a file */
bool checkpoint_is_there(const struct crew *c, const char *name);

/**
 * Reads an agent's file into the crew's text; good until the next file is written or read.
 *
 * @param head  out
 * @param p     out: its passport
 * @return the capsule behind it; NULL: there is none, or not a whole one
 */
const char *checkpoint_read(struct crew *c, const char *name, struct checkpoint_head *head,
                            struct passport *p);

/** Reads what stands before the passport and moves behind it.  @return false: it is no checkpoint
 */
bool checkpoint_head_read(const char **text, struct checkpoint_head *out);

/**
 * The agents that have a file, in the order of the folder, until take says no more.
 *
 * @param take  is given a name, what stands before its passport, and passport and capsule; "":
 *              there is no whole one; @return whether that agent comes back
 * @return how many come back
 */
uint32_t checkpoint_each(struct crew *c,
                         bool (*take)(struct crew *c, const char *name,
                                      const struct checkpoint_head *head, const char *text));

#endif
