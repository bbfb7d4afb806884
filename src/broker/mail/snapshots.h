/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file snapshots.h
 * Snapshots of agents that are on their way, and the words about them.
 */
#ifndef MUSTER_BROKER_SNAPSHOTS_H
#define MUSTER_BROKER_SNAPSHOTS_H

#include "broker/directory/directory.h"

/* --- snapshots.c ----------------------------------------------------------------------------- */

/*
 * Snapshots of agents that are on their way, and the words about them.
 *
 * A snapshot is kept from the moment at which its source hands it in until the agent lives at
 * another process, or has set out anew, or stayed.  As long as no agent has the name, a host that
 * restores agents may ask for it.  docs/mobility.md has the order of events.
 *
 * Inside a run by steps the snapshot store holds the step while a snapshot is under way, and seats
 * the agent itself. So it does with agents that are new (clones, and those that are launched): of
 * them it keeps nothing once they live.
 */

enum { SNAPSHOT_WORDS = 4 * MU_CAPSULES_MAX };

enum snapshot_phase {
    SNAPSHOT_FREE,
    SNAPSHOT_STEP,  /* it came in a step that has not ended */
    SNAPSHOT_SENT,  /* its host has it, or is about to, and has said nothing */
    SNAPSHOT_HOLDS, /* likewise, and the step waits for its word */
    SNAPSHOT_KEPT   /* nothing is awaited */
};

struct snapshot {
    enum snapshot_phase phase;
    char name[MU_NAME_MAX + 1];
    uint32_t agent; /* of that name; MU_NONE: it is new */
    uint32_t
        asker; /* the agent that wants the journey: itself, or the one that asks for a new one */
    muster_State state; /* that it has there */
    uint64_t epoch;
    char home[MU_PROCESS_MAX + 1]; /* the process that it set out from, dead or alive */
    uint32_t source, target;       /* processes; MU_NONE: not known, or no more */
    uint32_t host;                 /* the agent that it wants to go to */
    bool in_step;                  /* it came with the answer to a step */
    bool seated;                   /* a step has given its name to the target, and said so */
    uint64_t until_ns;             /* the host's word on it is awaited for so long */
    bool unsaved;                  /* the disk is to be told that it is there, or that it is free */
};

/* What a process is to be told. */
struct snapshot_word {
    uint32_t place;
    char process[MU_PROCESS_MAX + 1]; /* whose that is */
    muster_TripWord word;
    char name[MU_NAME_MAX + 1]; /* of the agent */
    uint32_t asker;             /* of a new one; MU_NONE: of another, or to its host */
    uint32_t host, at;          /* at: the process where it lives */
    uint64_t epoch;
    uint32_t snapshot; /* of arrive */
    char reason[MU_FIELD_MAX + 1];
};

struct snapshots {
    struct snapshot snapshots[MU_CAPSULES_MAX];
    char (*texts)[MU_CAPSULE_MAX];              /* of each: snapshot header and snapshot */
    uint32_t count, holding;                    /* snapshots; those that the step waits for */
    bool unsaved;                               /* one of the places is */
    struct snapshot_word words[SNAPSHOT_WORDS]; /* in order */
    uint32_t words_count;
    uint32_t open;                                 /* the word that broker_next has in hand */
    uint64_t kept, taken, refused, lost, restored; /* counters */
};

/** Goes through the places for snapshots, the free ones, too, while there is any snapshot. */
#define SNAPSHOTS_EACH(c, d)                                \
    for (__typeof__(&(d)->snapshots[0]) c = (d)->snapshots; \
         (d)->count > 0 && (c) < (d)->snapshots + MU_CAPSULES_MAX; (c)++)

/** A process is no more; what it was to be told waits, for it may have been slow only. */
void snapshots_process_gone(struct broker *b, uint32_t place);

/** An agent was seated, or said something of itself: its snapshot may be of no use any more.  That
 * of one that a step has seated is kept until it has answered a step. */
void snapshots_review(struct broker *b, uint32_t agent);

/** An agent has answered a step, or acknowledged mail, from this process: if it has come there, it
 * lives there, and what it was before is of no use any more. */
void snapshots_heard(struct broker *b, uint32_t agent, uint32_t place);

/** @return whether what a process says of an agent is of before it was taken from there, or of
 *          after it will have been seated there: neither is a claim on the name.  A registration
 *          says nothing of the step that it was written in, so that one of a run may be of
 *          any life that a name has had in it */
bool snapshots_overrule(const struct broker *b, uint32_t agent, uint32_t place,
                        const struct presence *is);

/** @return the epoch of the copy of an agent that is kept here, or 0: none is */
uint64_t snapshots_epoch(struct broker *b, uint32_t agent);

/** @return when transfer_tick is needed next, or UINT64_MAX */
uint64_t snapshots_deadline_ns(const struct broker *b);

/**
 * Gives the first word for a process.
 *
 * @param out  filled with pointers into the broker, valid until the next call into it
 * @return false: there is none
 */
bool snapshots_next(struct broker *b, uint32_t place, muster_Trip *out);

/** The word that was given last is out. */
void snapshots_sent(struct broker *b);

/** Takes in a snapshot of an earlier life.  @return false: there is no room, or it is malformed */
bool snapshots_restore(struct broker *b, uint32_t agent, uint64_t epoch, const char *text);

/** A host has said something of a snapshot that it was handed. */
struct snapshot *snapshots_answered_by(struct broker *b, uint32_t place, const muster_Trip *trip);

void snapshots_drop(struct broker *b, struct snapshot *c);

struct snapshot *snapshots_add(struct broker *b, uint32_t agent, const char *name, uint64_t epoch,
                               const char *text);

/** It stays where it is, which the source hears; the snapshot is kept until the source has said
 * that it goes on.  No process takes back a new agent. */
void snapshots_refuse(struct broker *b, struct snapshot *c, const char *reason);

void snapshots_send(struct broker *b, struct snapshot *c);

/** It is to drop the copy that it has made, or was to make for the asker of a new one. */
void snapshots_refuse_copy(struct broker *b, uint32_t place, uint32_t asker, const char *name,
                           uint64_t epoch, const char *reason);

void snapshots_tell(struct broker *b, const struct snapshot *c, uint32_t place, muster_TripWord say,
                    const char *reason);

#endif
