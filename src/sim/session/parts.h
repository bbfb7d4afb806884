/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file parts.h
 * What the files of a session share.
 */
#ifndef MUSTER_SIM_SESSION_PARTS_H
#define MUSTER_SIM_SESSION_PARTS_H

#include "core/table.h"
#include "sim/session/session.h"

/* The command timeout, in control steps. */
enum { SESSION_QUIET_STEPS = 10 };

/* An agent of the run. */
struct session_agent {
    char name[MU_NAME_MAX + 1];
    bool controlled;      /* false: its body has no controller and is an obstacle */
    int32_t body;         /* index of its robot; -1: none */
    int32_t process;      /* index of the process that it lives in; -1: none */
    int32_t next_process; /* from the next step on; -1: the same */
    uint32_t slot;        /* of a robot: the place of its entry in that process's registration */
    char heir[MU_PROCESS_MAX + 1]; /* another process that says it has the name; "": none */
    uint32_t heir_slot;
    muster_State state; /* in its last act */
    int32_t totals;     /* index of what it amounts to; -1: it came while the run went on */
    unsigned char digest[RUN_HASH_BYTES]; /* of what it did in its last step, ... */
    int64_t acted;                        /* ... which is the one before this */
};

/*
 * All agents: first those of robots in the order of the world, then those without a body in order
 * of name, so that their order of arrival does not show.
 */
struct session_agents {
    struct session_agent *at; /* [0, count) */
    uint32_t robots, count;
    struct session_agent *coming; /* MU_CAPSULES_MAX: they begin with the next step */
    uint32_t coming_count;
    struct mu_table robot_names;
};

/* The body of an agent, and what it was told to do. */
struct session_robot {
    char goal[MU_FIELD_MAX + 1]; /* in its last act */
    bool drives;                 /* the last answer has set a speed */
    double forward_m_s, turn_rad_s;
    double command_forward_m_s, command_turn_rad_s; /* the last command to its motors */
    int32_t paddles, lift; /* orders to its gripper in the last answer, as in Act */
    uint32_t senses;       /* requested by its agent: bits of enum mu_sense */
    uint32_t off;          /* bits of enum mu_sense: those that an order has switched off */
    uint32_t quiet_steps;  /* since its agent has set a speed */
    struct engine_sample sensed;
};

/* What a process is in the run. */
enum member_state {
    MEMBER_REFUSES,    /* no state: the event is refused */
    MEMBER_JOINING,    /* it has had no step yet */
    MEMBER_ACTIVE,     /* it takes part */
    MEMBER_CONTESTED,  /* another process claims its place, and it may be dead */
    MEMBER_LOST,       /* the network reports it as gone; it may come back */
    MEMBER_SUPERSEDED, /* it is gone, and its successor takes its place */
    MEMBER_RELEASED,   /* its agents are free for its successor */
    MEMBER_LEFT_OUT,   /* it is gone, and steps go on without it */
    MEMBER_STATES
};

enum member_event {
    MEMBER_HEARTBEAT, /* its registration has come */
    MEMBER_LOSS,      /* its liveliness or its registration has ended */
    MEMBER_CLAIM,     /* another process has registered an agent or a host of its name */
    MEMBER_ANSWER,    /* it has answered the step */
    MEMBER_OWN_EVENTS,
    MEMBER_JOINS = MEMBER_OWN_EVENTS, /* it gets its first step */
    MEMBER_CLAIM_ENDS,                /* the process that claimed its place is gone */
    MEMBER_LEAVES_OUT,                /* steps go on without it */
    MEMBER_RELEASES,                  /* recovery takes its agents from it */
    MEMBER_EVENTS
};

/* Whether it sees all bodies, and has none. */
enum member_sight {
    MEMBER_HAS_BODIES, /* it does not */
    MEMBER_WATCHES,
    MEMBER_ONLOOKS /* it does, and the run does not need it: all its agents are special */
};

enum {                     /* what a process needs before it joins */
       MEMBER_GREETED = 1, /* an empty Sense has gone to it */
       MEMBER_HEARD = 2,   /* a sample of it has come */
       MEMBER_READY = 4,   /* it reports that it has found all its partners */
       MEMBER_JOINED = 7
};

struct session_process {
    char name[MU_PROCESS_MAX + 1];
    char broker[MU_NAME_MAX + 1]; /* of its agents */
    struct bus_writer sense;
    enum member_state state;
    enum member_sight sight;
    unsigned joined; /* MEMBER_GREETED ... */
    /* Its name as a host, or "": agents may move to it, and it belongs to the run even without any.
     */
    char host[MU_NAME_MAX + 1];
    char claimer[MU_PROCESS_MAX + 1]; /* the process that claims its place */
    uint32_t refused;                 /* events that its state does not allow */
    int64_t answered;                 /* the last step that it has answered */
    uint64_t answered_wall_ns;
    muster_Sense sample; /* what it is sent; its robots lie in percepts of the session */
    bool sample_pending; /* the network has refused it, and it goes out again */
};

/* What the run is doing. */
enum phase {
    PHASE_REFUSES,   /* no phase: the event is refused */
    PHASE_GATHERING, /* a process is missing */
    PHASE_READY,     /* all processes are there; RUN_GO is missing */
    PHASE_CALLED,    /* RUN_GO has come; a process may be missing */
    PHASE_RUNNING,
    PHASE_SETTLING,        /* an agent departs: the next step waits for the broker */
    PHASE_PAUSED,          /* an order has paused it until RUN_GO */
    PHASE_PAUSED_SETTLING, /* likewise, and then it settles */
    PHASE_HELD,            /* it waits for the successor of a process */
    PHASE_HELD_SETTLING,   /* likewise, and then it settles */
    PHASE_ENDING,
    PHASE_DONE,
    PHASE_FAULT,
    PHASES
};

enum phase_event {
    PHASE_GO,        /* RUN_GO: begin, or go on */
    PHASE_END,       /* RUN_END, a signal, or the end of its duration */
    PHASE_DEPARTURE, /* an answer of the step says that an agent departs */
    PHASE_OWN_EVENTS,
    PHASE_COMPLETE = PHASE_OWN_EVENTS,
    PHASE_INCOMPLETE,
    PHASE_SETTLED, /* the broker has said where agents have gone */
    PHASE_PAUSES,
    PHASE_HOLDS,
    PHASE_RESUMES, /* from a pause or a hold */
    PHASE_FINISHES,
    PHASE_FAILS,
    PHASE_EVENTS
};

/* What an agent amounts to in a run. */
struct session_totals {
    muster_RobotTotals told;
    bool returned; /* it was restored: another process was handed the earlier mail */
};

/* status.c's own */
struct session_status {
    struct bus_writer writer;
    muster_RobotTotals *totals; /* as they are told: robots that are controlled, and agents */
    muster_ObjectPlace *places; /* of the objects */
    uint64_t told_wall_ns;
};

/* The readers for which a Frame is made: bits. */
enum { SESSION_FOR_EVERY = 1, SESSION_FOR_LATEST = 2, SESSION_FOR_RECORDING = 4 };

/* observe.c's own, but for the tallies: docs/observing.md */
struct session_observe {
    struct bus_writer scenes, every, latest;
    bool end_recorded;
    muster_Scene *scene;
    struct frame_builder *frame;
    unsigned wanted;         /* SESSION_FOR_... of this step; 0: no Frame is made */
    uint64_t latest_wall_ns; /* when the last Frame went into "latest" */
    uint64_t lost;           /* Frames that the network did not take */
    struct tally *tallies;   /* of each robot */
};

struct session {
    struct session_options options;
    const struct world *world;
    struct engine *engine;
    struct run_hash *hash;
    struct bus *bus;
    struct order_queue *orders;    /* that are due in this step, or later */
    char name[MU_PROCESS_MAX + 1]; /* also its partition */
    struct bus_writer roster, answers;
    struct bus_reader registrations, ups, deliveries, commands;
    struct session_agents agents;
    struct session_robot *robots;
    size_t robot_count;
    struct session_totals *totals; /* of each robot, then of each agent that the options name */
    size_t totals_count;
    uint32_t *wanted; /* of each robot: the sensors that this step reads, enum mu_sense */
    struct mu_table process_names;
    struct session_process *processes; /* MU_PROCESSES_MAX */
    uint32_t process_count;
    muster_Percept *percepts; /* one for each robot, in order of process */
    /* For watchers: the pose of every robot, in the order of the world, in even and odd steps. */
    muster_Percept *bodies[2];
    enum phase phase;
    uint32_t refused; /* events that the phase does not allow */
    int64_t step;
    int64_t mail_step; /* the last step whose Delivery is in */
    /* Digests of mail from outside, of even and odd steps: the broker may be a step ahead. */
    unsigned char outside[2][RUN_HASH_BYTES];
    uint32_t answers_missing;
    int64_t sent_step;       /* the last step that went out */
    int64_t recorded;        /* the first step that is not yet in the hash and the tracks */
    unsigned char *snapshot; /* room for one */
    int64_t pace_step;       /* the step and the wall time since which the rate holds */
    uint64_t pace_wall_ns;
    uint64_t first_step_wall_ns, last_step_wall_ns;
    uint64_t skipped;
    bool roster_due;         /* the network has refused the roster, and it goes out again */
    uint32_t roster_readers; /* in free running: matched when it was told last */
    struct session_status status;
    struct session_observe observe;
    char waits_for[1024];
    char hash_text[RUN_HASH_TEXT];
};

/* --- roster.c: the processes of a run --------------------------------------------------------- */

/** @return the index of the process of that name, or -1 */
int32_t roster_process(const struct session *s, const char *name);

/** Takes a registration: what a process controls, watches or hosts, or that it has gone. */
void roster_register(struct session *s, const muster_Registration *r, enum bus_life life);

/** Takes a registration while a lock step runs: losses, returns, claims and, in a hold, successors.
 */
void roster_hear(struct session *s, const muster_Registration *r, enum bus_life life);

/** Greets new processes.  @return whether all processes are there; waits_for names the missing */
bool roster_is_complete(struct session *s);

/** Tells the broker the processes of the lock step, or that it has ended. */
MU_MUST_USE mu_result roster_tell(struct session *s, bool lockstep);

/** Lays the percepts out so that each process's robots stand together. */
void roster_lay_out(struct session *s);

/** Drops processes that have no agent and no role. */
void roster_prune(struct session *s);

/** Leaves out processes that are lost, have not answered, and are not needed. */
void roster_leave_out(struct session *s);

/** Digests the step for agents of a process that were disposed of: they do nothing. */
void roster_rest(struct session *s, uint32_t process);

/** Between two steps: moves agents to their next processes. */
void roster_change_processes(struct session *s);

/* --- agents.c: which process each agent lives in ---------------------------------------------- */

/** Takes memory at start-up, and the robots of a world. */
void agents_open(struct session_agents *a, const struct world *world);

/** Before the first step: takes in an agent without a body, which the first step waits for. */
void agents_expect(struct session_agents *a, const char *name, int32_t totals);

/** @return the agent of that name that takes part in this step, or NULL */
struct session_agent *agents_find(const struct session_agents *a, const char *name);

/**
 * Moves an agent to a process with the next step, or at once if it has none.  An unknown name
 * becomes an agent without a body, which begins with the next step.
 *
 * @param process  -1: it has died meanwhile
 * @return MU_OK, or MU_FULL: more than MU_CAPSULES_MAX begin in one step, or too many live
 */
MU_MUST_USE mu_result agents_seat(struct session_agents *a, const char *name, int32_t process);

/** Changes the index of a process; to -1: it is dead.  An agent that was to leave it moves at once.
 */
void agents_renumber(struct session_agents *a, int32_t from, int32_t to);

/** @return the process of an agent from the next step on; -1: none */
int32_t agents_home(const struct session_agent *agent);

/** @return whether an agent lives in a process, or will with the next step */
bool agents_live_in(const struct session_agents *a, int32_t process);

/** Between two steps: moves agents with a body. */
void agents_move_robots(struct session_agents *a);

/** Between two steps: moves agents without a body, removes those that have ended, adds those that
 * begin. */
void agents_settle(struct session_agents *a);

/* --- member.c: the states of a process -------------------------------------------------------- */

/**
 * Applies an event to a process.  Aborts if its state refuses one of the session's own events.
 *
 * @return false: its state refuses an event of a peer, which is counted
 */
bool member_on(struct session_process *p, enum member_event event);

/** Applies the claim of another process.  A process does not claim its own place. */
void member_claim(struct session_process *p, const char *claimer);

/** Ends a claim, as its claimer is gone. */
void member_claim_ends(struct session_process *p, const char *claimer);

/** @return whether steps go to it and wait for its answer */
bool member_is_in_steps(const struct session_process *p);

/** @return whether the run needs it without an agent, as it does a resolver */
bool member_is_needed(const struct session_process *p);

/** @return whether it watches or hosts: the run waits for its answers, whatever lives in it */
bool member_attends(const struct session_process *p);

/* --- phase.c: the states of a run ------------------------------------------------------------- */

/**
 * Applies an event to a run.  Aborts if the phase refuses one of the session's own events.
 *
 * @return false: the phase refuses an event of a peer, which is counted
 */
bool phase_on(struct session *s, enum phase_event event);

/** Takes a signal into account.  @return whether the run is ending */
bool phase_ends(struct session *s);

/** @return whether the first step has begun */
bool phase_has_begun(const struct session *s);

bool phase_is_held(const struct session *s);
bool phase_is_paused(const struct session *s);

/** @return the phase, in the words of the wire */
muster_RunState phase_word(const struct session *s);

/* --- inbox.c: what comes in ------------------------------------------------------------------- */

/** Takes all samples that have come. */
void inbox_take(struct session *s);

/* --- percepts.c: what goes out ---------------------------------------------------------------- */

/** Puts the samples of a step together. */
void percepts_fill_samples(struct session *s, bool last);

/** Sets the step that the sample of a process is of: the last one that was put together or, for a
 * watcher, the one before. */
void percepts_set_step(const struct session *s, struct session_process *p, int64_t step);

/** Writes the sample of a process.  @return false: the network is busy; percepts_retry tries again
 */
bool percepts_write(struct session_process *p);

/** Reads the sensors that agents request. */
void percepts_read(struct session *s);

/** Sends each process its step.  @param last  no step follows */
void percepts_send(struct session *s, bool last);

/** Sends again what the network has refused.  @return whether all processes have the step */
bool percepts_retry(struct session *s);

/* --- commands.c: orders from outside, and answers to them ------------------------------------- */

/** Takes an order.  It waits for edits_apply, but for a change of the pace. */
void commands_take(struct session *s, const muster_RunCommand *c);

enum { REASON_MAX = 255 };

/* What became of an order. */
struct outcome {
    muster_RunOutcome result;
    char reason[REASON_MAX + 1];
};

struct outcome commands_outcome(muster_RunOutcome result, const char *reason);

/** Answers the sender of an order. */
void commands_answer(struct session *s, const muster_RunCommand *c, const struct outcome *o);

/* --- edits.c: what orders do ------------------------------------------------------------------ */

/** Carries out the orders that are due, and answers them. */
void edits_apply(struct session *s);

/* --- observe.c: what observers see; each is called at its place in a step --------------------- */

/** Opens topics and takes memory. */
MU_MUST_USE mu_result observe_open(struct session *s);

/** Publishes the Scene, once. */
void observe_scene(struct session *s);

/** Updates the statistics of robots, and begins the Frame of a step.  @param last  no step follows
 */
void observe_begin(struct session *s, bool last);

void observe_act(struct session *s, size_t robot, const muster_Act *act);
void observe_outside(struct session *s, const muster_Delivery *d);
void observe_order(struct session *s, const muster_RunCommand *order);

/** Records how the run has ended, once. */
void observe_status(struct session *s, const muster_RunStatus *status);

/** Ends the Frame before the world moves on, and publishes it. */
void observe_finish(struct session *s);

/** Waits shortly for the last Frames to arrive, and logs how many were cut. */
void observe_close(struct session *s);

/* --- status.c --------------------------------------------------------------------------------- */

/** Takes memory. */
void status_open(struct session *s);

/** Publishes the state of the run, at most every 50 ms unless always.  @return false: the network
 * is busy */
bool status_tell(struct session *s, bool always);

/* --- step.c: the parts of one step ------------------------------------------------------------ */

/** Hashes and records the world at the beginning of a step, once, while agents compute. */
void step_record(struct session *s);

/** Folds the digest of mail from outside of the last step into the hash. */
void step_fold_outside(struct session *s);

/** Applies the answers and orders of a step, and advances the world. */
void step_finish(struct session *s);

/* --- recover.c: a process that dies and is started again -------------------------------------- */

/** @return how long a step may wait for a silent process, by the wall clock */
uint64_t recover_patience_ns(const struct session *s);

/** @return whether the step waits for a process that has a successor */
bool recover_is_due(const struct session *s);

/**
 * Holds the lock step until all successors are there, and gives them the step.
 *
 * @return MU_OK; MU_TIMEOUT: they did not come within return_ns, and waits_for names them; MU_DONE:
 * the run is ending
 */
MU_MUST_USE mu_result recover_await(struct session *s);

/* --- lockstep.c: one step after the other ----------------------------------------------------- */

/** Runs in lock step to the end.  @return MU_OK, or as session_run */
MU_MUST_USE mu_result lockstep_run(struct session *s);

/** Runs freely to the end. */
MU_MUST_USE mu_result lockstep_run_free(struct session *s);

#endif
