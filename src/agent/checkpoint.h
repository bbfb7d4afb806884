/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file checkpoint.h
 * Agents on disk: a file for each, NAME.capsule, which is replaced as a whole.
 *
 * A file outlives the process, but not a loss of power.  NAME.gone marks an agent with which the
 * process began and which is not to come back: it was disposed of, or has moved on.
 */
#ifndef MUSTER_AGENT_CHECKPOINT_H
#define MUSTER_AGENT_CHECKPOINT_H

#include "agent/migration.h"
#include "agent/options.h"
#include "runtime/answer.h"

#include <stdbool.h>
#include <stdint.h>

/* The part of a file before the snapshot's header. */
struct checkpoint_head {
    int64_t step;         /* the last one that the agent took part in; -1: none */
    struct answer answer; /* to that step; it may not have gone out */
};

/* The file of an agent. */
struct saved {
    char name[MU_NAME_MAX + 1]; /* "": there is none */
    bool native;                /* the command line names the agent, and it began here */
    bool failing;               /* the last attempt failed, which was logged */
    bool tried;                 /* an attempt was made, ... */
    enum mu_state state;        /* ... in this state, ... */
    uint64_t written_ns;        /* ... at this time of the group process */
};

struct checkpoints {
    const struct checkpoint_options *set;
    struct saved *saved; /* one for each robot */
    struct mu_text text; /* MIGRATION_SNAPSHOT_MAX bytes: the file being written or read */
};

/** Takes the memory for the checkpoints of a group process, if its options ask for them. */
void checkpoint_reserve(struct group_process *g);

/**
 * Writes an agent's file.
 *
 * @return false: that failed, and was logged; later failures are not, until one attempt succeeds
 */
bool checkpoint_write(struct robot *r, enum mu_state state);

/** Writes the files that are due. */
void checkpoint_round(struct group_process *g);

/**
 * Removes the files of agents that have gone.
 *
 * Call it after the others have heard of that.  An agent that the command line names leaves a mark,
 * so that it does not begin anew here.
 */
void checkpoint_forget(struct group_process *g);

/** Does the same for one agent whose place another one takes. */
void checkpoint_leave(struct robot *r);

/** Sets whether the command line names the agent; such an agent leaves a mark when it goes. */
void checkpoint_set_native(struct robot *r, bool native);

/** Notes that an agent came back from its file, which goes with it. */
void checkpoint_own(struct robot *r);

/** @return whether the mark of a gone agent is there */
bool checkpoint_is_gone(const struct group_process *g, const char *name);

/** @return whether an agent of that name has a file */
bool checkpoint_is_there(const struct group_process *g, const char *name);

/**
 * Reads an agent's file into the text of the group process.
 *
 * The result is valid until the next file is written or read.
 *
 * @param head  out: the part before the header
 * @param p     out: the header of the snapshot
 * @return the snapshot of the mind; NULL: there is no whole one
 */
const char *checkpoint_read(struct group_process *g, const char *name, struct checkpoint_head *head,
                            struct snapshot_header *p);

/**
 * Visits the agents that have a file, in the folder's order.
 *
 * @param take  gets a name, the part before the header, and header and snapshot ("": the file is
 * not whole); @return whether that agent comes back
 * @return how many come back
 */
uint32_t checkpoint_each(struct group_process *g,
                         bool (*take)(struct group_process *g, const char *name,
                                      const struct checkpoint_head *head, const char *text));

#endif
