/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file checkpoint.h
 * Agents on disk: a file for each, NAME.capsule, which is replaced as a whole.  It outlives the
 * process, and not a loss of power.  NAME.gone says that an agent with which the process began is
 * not to come back: it was disposed of, or has moved on.
 */
#ifndef MUSTER_AGENT_CHECKPOINT_H
#define MUSTER_AGENT_CHECKPOINT_H

#include "agent/migration.h"
#include "agent/options.h"
#include "runtime/answer.h"

#include <stdbool.h>
#include <stdint.h>

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
    const struct checkpoint_options *set;
    struct saved *saved; /* of each robot */
    struct mu_text text; /* TRIP_CAPSULE_MAX: what is being written or read */
};

/** Takes the memory for a crew's checkpoints, if there are to be any. */
void checkpoint_reserve(struct group_process *g);

/** Writes an agent's file.  @return false: that failed, and was logged, once until it succeeds */
bool checkpoint_write(struct robot *r, enum mu_state state);

/** Writes what is due. */
void checkpoint_round(struct group_process *g);

/**
 * Forgets who is not here any more, once the others have heard of that: the file goes.  Of one that
 * the command line names a mark stays, so that it does not begin anew here.
 */
void checkpoint_forget(struct group_process *g);

/** The same at once for one of them: its place is another's now. */
void checkpoint_leave(struct robot *r);

/** It came back from its file, which goes if it is not here any more. */
void checkpoint_own(struct robot *r);

/** @return whether such a mark is there */
bool checkpoint_is_gone(const struct group_process *g, const char *name);

/** @return whether an agent of that name has a file */
bool checkpoint_is_there(const struct group_process *g, const char *name);

/**
 * Reads an agent's file into the crew's text; good until the next file is written or read.
 *
 * @param head  out
 * @param p     out: its passport
 * @return the capsule behind it; NULL: there is none, or not a whole one
 */
const char *checkpoint_read(struct group_process *g, const char *name, struct checkpoint_head *head,
                            struct snapshot_header *p);

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
uint32_t checkpoint_each(struct group_process *g,
                         bool (*take)(struct group_process *g, const char *name,
                                      const struct checkpoint_head *head, const char *text));

#endif
