/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file depot.h
 * Capsules of agents that are on their way, and the words about them.
 *
 * A capsule is kept from the moment at which its source hands it in until the agent lives at
 * another process, or has set out anew, or stayed.  As long as nobody bears the name, whoever
 * restores agents may ask for it.  docs/mobility.md has the order of events.
 *
 * In lock step the depot holds the step while a capsule is under way, and seats the agent itself.
 * So it does with agents that are new (clones, and those that are launched): of them it keeps
 * nothing once they live.
 */
#ifndef MUSTER_BROKER_DEPOT_H
#define MUSTER_BROKER_DEPOT_H

#include "broker/names/registry.h"

struct broker;

enum { DEPOT_WORDS = 4 * MU_CAPSULES_MAX };

enum depot_phase {
    DEPOT_FREE,
    DEPOT_STEP, /* it came in a step that has not ended */
    DEPOT_SENT, /* its host has it, or is about to, and has said nothing */
    DEPOT_KEPT  /* nothing is awaited of anybody */
};

struct depot_capsule {
    enum depot_phase phase;
    char name[MU_NAME_MAX + 1];
    uint32_t agent;     /* of that name; MU_NONE: it is new */
    uint32_t asker;     /* who wants the journey: the agent itself, or who asks for a new one */
    muster_State state; /* that it has there */
    uint64_t epoch;
    char home[MU_PROCESS_MAX + 1]; /* the process that it set out from, dead or alive */
    uint32_t source, target;       /* places; MU_NONE: not known, or no more */
    uint32_t host;                 /* the agent that it wants to go to */
    bool in_step;                  /* it came with the answer to a step */
    bool seated;                   /* a lock step has given its name to the target, and said so */
    bool holds;                    /* the step waits for it */
    uint64_t until_ns;             /* the host's word on it is awaited for so long */
    bool unsaved;                  /* the disk is to be told that it is there, or that it is free */
    size_t len;
    char *text; /* MU_CAPSULE_MAX; passport and capsule */
};

/* What a process is to be told. */
struct depot_word {
    uint32_t place;
    char process[MU_PROCESS_MAX + 1]; /* whose place that is */
    muster_TripWord word;
    char name[MU_NAME_MAX + 1]; /* of the agent */
    uint32_t asker;             /* of a new one; MU_NONE: of another, or to its host */
    uint32_t host, at;          /* at: the place where it lives */
    uint64_t epoch;
    uint32_t capsule; /* of arrive */
    char reason[MU_FIELD_MAX + 1];
};

struct depot {
    struct depot_capsule capsules[MU_CAPSULES_MAX];
    uint32_t count, holding;              /* capsules; those that the step waits for */
    struct depot_word words[DEPOT_WORDS]; /* in order */
    uint32_t words_count;
    uint32_t open;                                 /* the word that courier_next has in hand */
    uint64_t kept, taken, refused, lost, restored; /* counters */
};

void depot_init(struct depot *d);

/** Takes a word of a process.  @param in_step  it came with the process's answer to a step */
void depot_hear(struct broker *b, uint32_t place, const muster_Trip *trip, bool in_step);

/** A step has taken effect.  @return whether its end has to wait for agents on their way */
bool depot_step_ended(struct broker *b);

/** The lock step is over: who is on its way stays. */
void depot_lockstep_over(struct broker *b);

/** A process is no more; what it was to be told waits, for it may have been slow only. */
void depot_gone(struct broker *b, uint32_t place);

/** An agent was seated, or said something of itself: its capsule may be of no use any more.  That
 * of one whom a lock step has seated is kept until it has answered a step. */
void depot_review(struct broker *b, uint32_t agent);

/** An agent has answered a step, or acknowledged mail, from this process: if it has come there, it
 * lives there, and what it was before is of no use any more. */
void depot_answered(struct broker *b, uint32_t agent, uint32_t place);

/** @return whether what a process says of an agent is of before it was taken from there, or of
 *          after it will have been seated there: neither is a claim on the name.  A registration
 *          says nothing of the step that it was written in, so that one of a lock step may be of
 *          any life that a name has had in it */
bool depot_overrules(const struct broker *b, uint32_t agent, uint32_t place,
                     const struct presence *is);

/** @return whether a copy of an agent is kept here */
bool depot_keeps(const struct broker *b, uint32_t agent);

/** @return whether a later copy of an agent that nobody has is kept here */
bool depot_has_later(const struct broker *b, uint32_t agent, uint64_t epoch);

/** Gives up hosts that are silent. */
void depot_tick(struct broker *b);

/** @return when depot_tick is needed next, or UINT64_MAX */
uint64_t depot_deadline_ns(const struct broker *b);

/**
 * Gives the first word for a process.
 *
 * @param out  filled with pointers into the broker, valid until the next call into it
 * @return false: there is none
 */
bool depot_next(struct broker *b, uint32_t place, muster_Trip *out);

/** The word that was given last is out. */
void depot_sent(struct broker *b);

/** Takes in a capsule of an earlier life.  @return false: there is no room, or it is malformed */
bool depot_restore(struct broker *b, uint32_t agent, uint64_t epoch, const char *text);

#endif
