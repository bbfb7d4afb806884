/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file parts.h
 * A run, seen from the simulator: who controls which robot, and one step after the other.
 *
 * docs/lockstep.md has the protocol.  The order of a step is fixed: senses out, answers in,
 * commands in the order of the robots, hash, record, physics.
 */
#ifndef MUSTER_SIM_SESSION_PARTS_H
#define MUSTER_SIM_SESSION_PARTS_H

#include "core/table.h"
#include "sim/session/session.h"

/* The dead-man, in control steps and, in free running, by the wall. */
enum { SESSION_QUIET_STEPS = 10 };

/* An agent of the run. */
struct session_agent {
    char name[MU_NAME_MAX + 1];
    bool controlled;      /* a process is to have it; else its body is an obstacle */
    int32_t body;         /* index of its robot; -1: none */
    int32_t process;      /* index of the one that it lives in; -1: none */
    int32_t next_process; /* from the next step on; -1: the same */
    uint32_t slot;        /* of a robot's, in that process */
    muster_State state;   /* by its last word */
    unsigned char digest[RUN_HASH_BYTES]; /* of what it did in this step */
};

/*
 * All of them: first the robots', in the world's order, then those without a body that began while
 * the run went on, in order of name, so that the order in which they came does not show.
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
    char goal[MU_FIELD_MAX + 1]; /* by the agent's last word: what it wants */
    bool drives;                 /* of the last answer: a speed was set */
    double forward_m_s, turn_rad_s;
    double command_forward_m_s, command_turn_rad_s; /* what its motors were told last */
    int32_t paddles, lift; /* of the last answer, as in Act: what its gripper is to do */
    uint32_t senses;       /* that its controller asks for: bits of enum mu_sense */
    uint32_t off;          /* of them, those that somebody has switched off */
    uint32_t quiet_steps;  /* since a speed was set */
    uint64_t firings, mails_sent, mails_received, mails_duplicated;
    bool returned; /* its controller has begun in the middle: it was not handed all mail itself */
    struct engine_sample sensed;
};

/* What a process is in the run. */
enum member_state {
    MEMBER_REFUSES,    /* no state: the event is refused */
    MEMBER_JOINING,    /* it has not had a step yet */
    MEMBER_ACTIVE,     /* it takes part */
    MEMBER_CONTESTED,  /* another process claims its place, and it may be dead */
    MEMBER_LOST,       /* the network says that it is gone; it may come back */
    MEMBER_SUPERSEDED, /* it is gone, and its place is another's, whether it comes back or not */
    MEMBER_RELEASED,   /* its agents are free for its successor */
    MEMBER_LEFT_OUT,   /* it is gone, nobody needs it, and steps go on without it */
    MEMBER_STATES
};

enum member_event {
    MEMBER_HEARTBEAT, /* its registration has come */
    MEMBER_LOSS,      /* its liveliness or its registration has ended */
    MEMBER_CLAIM,     /* another process has registered an agent or a host of its name */
    MEMBER_ANSWER,    /* it has answered the step */
    MEMBER_OWN_EVENTS,
    MEMBER_JOINS = MEMBER_OWN_EVENTS, /* all that it needs is there, and it gets steps */
    MEMBER_CLAIM_ENDS,                /* the process that claimed its place is gone */
    MEMBER_LEAVES_OUT,                /* the steps go on without it */
    MEMBER_RELEASES,                  /* recovery takes its agents from it */
    MEMBER_EVENTS
};

enum {                     /* roles */
       MEMBER_WATCHES = 1, /* it sees all bodies, and has none */
       MEMBER_HOSTS = 2, /* it takes in robots: it belongs to the run, whether it has any or not */
       MEMBER_ONLOOKS = 4, /* it watches, and all its agents are special: nobody needs it */
};

enum {                     /* what one that joins has of what it needs */
       MEMBER_GREETED = 1, /* a Sense with nothing in it has gone to it */
       MEMBER_HEARD = 2,   /* a sample of it has come */
       MEMBER_READY = 4,   /* it says that it has matched all its partners */
       MEMBER_JOINED = 7
};

struct session_process {
    char name[MU_PROCESS_MAX + 1];
    char broker[MU_NAME_MAX + 1]; /* of its agents */
    struct bus_writer sense;
    enum member_state state;
    unsigned roles;                   /* MEMBER_WATCHES ... */
    unsigned joined;                  /* MEMBER_GREETED ... */
    char host[MU_NAME_MAX + 1];       /* the name of one that hosts */
    char claimer[MU_PROCESS_MAX + 1]; /* of one that is contested: the process that claims it */
    uint32_t refused;                 /* events that its state does not allow */
    int64_t answered;                 /* the last step that it has answered */
    uint64_t answered_wall_ns;
    muster_Sense sample; /* what it is sent; its robots lie in the session's pool */
    bool sample_pending; /* the network has refused it: try again */
};

/* What the run is doing. */
enum phase {
    PHASE_REFUSES,   /* no phase: the event is refused */
    PHASE_GATHERING, /* somebody is missing */
    PHASE_READY,     /* everybody is there; the word to go is missing */
    PHASE_CALLED,    /* the word to go has come; the first step begins when everybody is there */
    PHASE_RUNNING,
    PHASE_SETTLING,        /* an agent departs: the next step waits for the broker's word */
    PHASE_PAUSED,          /* an order has paused it until the word to go */
    PHASE_PAUSED_SETTLING, /* likewise, and then it settles */
    PHASE_HELD,            /* it waits for a process that is being started again */
    PHASE_HELD_SETTLING,   /* likewise, and then it settles */
    PHASE_ENDING,
    PHASE_DONE,
    PHASE_FAULT,
    PHASES
};

enum phase_event {
    PHASE_GO,        /* somebody says that it is to begin, or to go on */
    PHASE_END,       /* somebody, a signal or its duration says that it is to end */
    PHASE_DEPARTURE, /* an answer of the step has an agent that departs */
    PHASE_OWN_EVENTS,
    PHASE_COMPLETE = PHASE_OWN_EVENTS,
    PHASE_INCOMPLETE,
    PHASE_SETTLED, /* the broker has said where those are who departed */
    PHASE_PAUSES,
    PHASE_HOLDS,
    PHASE_RESUMES, /* from a pause or a hold */
    PHASE_FINISHES,
    PHASE_FAILS,
    PHASE_EVENTS
};

/* status.c's own */
struct session_status {
    struct bus_writer writer;
    muster_RobotTotals *totals;
    muster_ObjectPlace *places; /* of the objects */
    uint64_t told_wall_ns;
};

/* For whom a Frame is made: bits. */
enum { SESSION_FOR_EVERY = 1, SESSION_FOR_LATEST = 2, SESSION_FOR_RECORDING = 4 };

/* observe.c's own, but for the tallies: docs/observing.md */
struct session_observe {
    struct bus_writer scenes, every, latest;
    bool end_recorded;
    muster_Scene *scene;
    struct frame_builder *frame;
    unsigned wanted;         /* this step's Frame: SESSION_FOR_...; 0: nobody wants it */
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
    struct order_queue *orders;    /* those of this step, and of later ones */
    char name[MU_PROCESS_MAX + 1]; /* also its partition */
    struct bus_writer roster, answers;
    struct bus_reader registrations, ups, deliveries, commands;
    struct session_agents agents;
    struct session_robot *robots;
    size_t robot_count;
    uint32_t *wanted; /* of each robot: the sensors that this step reads, enum mu_sense */
    struct mu_table process_names;
    struct session_process *processes; /* MU_PROCESSES_MAX */
    uint32_t process_count;
    muster_Percept *percepts; /* one for each robot, in order of process */
    muster_Percept *bodies; /* what those see who watch: every robot's pose, in the world's order */
    enum phase phase;
    uint32_t refused; /* events that the phase does not allow */
    int64_t step;
    int64_t mail_step; /* the last step whose Delivery is in */
    /* Digests of the mails from outside, of even and of odd steps: the broker may be a step ahead.
     */
    unsigned char outside[2][RUN_HASH_BYTES];
    uint32_t answers_missing;
    int64_t sent_step;       /* the last step that went out */
    int64_t recorded;        /* the first step that the hash and the tracks do not have yet */
    unsigned char *snapshot; /* room for one */
    int64_t pace_step;       /* since when, and since which step, it goes at this rate */
    uint64_t pace_wall_ns;
    uint64_t first_step_wall_ns, last_step_wall_ns;
    uint64_t skipped;
    bool roster_due;         /* the network has refused it */
    uint32_t roster_readers; /* that it had found when it was told, in free running */
    struct session_status status;
    struct session_observe observe;
    char waits_for[1024];
    char hash_text[RUN_HASH_TEXT];
};

/* --- roster.c: who belongs to the run --------------------------------------------------------- */

/** @return the index of the process of that name, or -1 */
int32_t roster_process(const struct session *s, const char *name);

/** Takes who controls or watches what, and who has gone. */
void roster_register(struct session *s, const muster_Registration *r, enum bus_life life);

/** While steps of a lock step run: notes who dies and, while it is held, who comes. */
void roster_hear(struct session *s, const muster_Registration *r, enum bus_life life);

/** Greets the processes that have come.  @return whether everybody is there; waits_for says who is
 * not */
bool roster_is_complete(struct session *s);

/** Tells the broker which processes make the lock step, or that there is none any more. */
MU_MUST_USE mu_result roster_tell(struct session *s, bool lockstep);

/** Lays the percepts out so that each process's robots stand together. */
void roster_lay_out(struct session *s);

/** Drops the processes that neither control nor watch anything. */
void roster_prune(struct session *s);

/** Goes on without those who are gone, have no robot and have not answered. */
void roster_leave_out(struct session *s);

/** What those have done whose process is no more, and who were disposed of: nothing. */
void roster_rest(struct session *s, uint32_t process);

/** Between two steps: those who have moved are with their new processes. */
void roster_change_processes(struct session *s);

/* --- agents.c: which process each agent lives in ---------------------------------------------- */

/** Takes memory, and the robots of a world, which must live as long. */
void agents_open(struct session_agents *a, const struct world *world);

/** @return the one of that name that takes part in this step, or NULL */
struct session_agent *agents_find(const struct session_agents *a, const char *name);

/**
 * From the next step on an agent lives in that process, or at once if it had none.  One that is not
 * known has no body, and begins with the next step.
 *
 * @param process  -1: it has died since
 * @return MU_OK, or MU_FULL: more than MU_CAPSULES_MAX begin in one step, or too many live
 */
MU_MUST_USE mu_result agents_seat(struct session_agents *a, const char *name, int32_t process);

/** A process has another index now; -1: it is dead, and its agents have none.  One that was to move
 * lives where it was to go. */
void agents_renumber(struct session_agents *a, int32_t from, int32_t to);

/** @return the process that an agent lives in from the next step on; -1: none */
int32_t agents_home(const struct session_agent *agent);

/** @return whether an agent lives in a process, or is to */
bool agents_live_in(const struct session_agents *a, int32_t process);

/** Between two steps: agents with a body that move have moved. */
void agents_move_robots(struct session_agents *a);

/** Between two steps, for those without a body: the coming are in, the moving have moved, and those
 * that have ended are out. */
void agents_settle(struct session_agents *a);

/* --- member.c: the states of a process -------------------------------------------------------- */

/**
 * Applies an event to a process.
 *
 * @return false: its state refuses that of a peer, which is counted.  One of the session's own that
 *         is refused ends the program.
 */
bool member_on(struct session_process *p, enum member_event event);

/** Another process claims what a process has.  A process does not claim its own. */
void member_claim(struct session_process *p, const char *claimer);

/** A process is gone: what it claimed is not contested any more. */
void member_claim_ends(struct session_process *p, const char *claimer);

/** @return whether it gets each step, which waits for its answer */
bool member_is_in_steps(const struct session_process *p);

/** @return whether the run needs it, even if it has no agent: it watches as resolvers do */
bool member_is_needed(const struct session_process *p);

/* --- phase.c: the states of a run ------------------------------------------------------------- */

/**
 * Applies an event to a run.
 *
 * @return false: the phase refuses that of a peer, which is counted.  One of the session's own that
 *         is refused ends the program.
 */
bool phase_on(struct session *s, enum phase_event event);

/** Takes note of a signal.  @return whether the run is to end */
bool phase_ends(struct session *s);

/** @return whether the first step has begun */
bool phase_has_begun(const struct session *s);

bool phase_is_held(const struct session *s);
bool phase_is_paused(const struct session *s);

/** @return the phase, in the words of the wire */
muster_RunState phase_word(const struct session *s);

/* --- inbox.c: what comes in ------------------------------------------------------------------- */

/** Takes what has come on every topic. */
void inbox_take(struct session *s);

/* --- percepts.c: what goes out ---------------------------------------------------------------- */

/** Puts the samples of a step together. */
void percepts_fill_samples(struct session *s, bool last);

/** Writes a process's sample.  @return false: the network is busy, and it is tried again */
bool percepts_write(struct session_process *p);

/** Reads the sensors that controllers ask for. */
void percepts_read(struct session *s);

/** Sends each process its step.  @param last  no step follows */
void percepts_send(struct session *s, bool last);

/** Sends again what the network has refused.  @return whether every process has its step */
bool percepts_retry(struct session *s);

/* --- commands.c: orders from outside, and answers to them ------------------------------------- */

/** Takes an order from outside: one that changes the world waits for edits_apply. */
void commands_take(struct session *s, const muster_RunCommand *c);

enum { REASON_MAX = 255 };

/* What became of an order. */
struct outcome {
    muster_RunOutcome result;
    char reason[REASON_MAX + 1];
};

struct outcome commands_outcome(muster_RunOutcome result, const char *reason);

/** Tells whoever sent an order what became of it. */
void commands_answer(struct session *s, const muster_RunCommand *c, const struct outcome *o);

/* --- edits.c: what they do -------------------------------------------------------------------- */

/** Carries out what came from outside since the last step, and answers for it. */
void edits_apply(struct session *s);

/* --- observe.c: what observers see; each is called at its place in a step --------------------- */

/** Opens topics and takes memory. */
MU_MUST_USE mu_result observe_open(struct session *s);

/** Says once what stands in the world. */
void observe_scene(struct session *s);

/** Counts what the robots have come to, and begins the Frame of the step.  @param last  no step
 * follows */
void observe_begin(struct session *s, bool last);

void observe_act(struct session *s, size_t robot, const muster_Act *act);
void observe_outside(struct session *s, const muster_Delivery *d);
void observe_order(struct session *s, const muster_RunCommand *order);

/** Has the recording say how the run has ended, once. */
void observe_status(struct session *s, const muster_RunStatus *status);

/** Ends the Frame, before the world moves on, and tells who wants it. */
void observe_finish(struct session *s);

/** Waits a little until the last Frames have arrived, and says if some were cut. */
void observe_close(struct session *s);

/* --- status.c --------------------------------------------------------------------------------- */

/** Takes memory. */
void status_open(struct session *s);

/** Says how the run goes; at most every 50 ms unless always.  @return false: the network is busy */
bool status_tell(struct session *s, bool always);

/* --- step.c: the parts of one step ------------------------------------------------------------ */

/** Hashes and records the world as this step found it; done while the controllers think.  A step
 * that is broken off has found it once. */
void step_record(struct session *s);

/** Folds in the mails from outside that the step before this one took in. */
void step_fold_outside(struct session *s);

/** Carries out what the controllers have answered, and moves the world on. */
void step_finish(struct session *s);

/* --- recover.c: a process that dies and is started again -------------------------------------- */

/** @return how long a step may wait for whoever is silent, by the wall */
uint64_t recover_patience_ns(const struct session *s);

/** @return whether this step waits for a process that has died and was started again */
bool recover_is_due(const struct session *s);

/**
 * Holds the lock step until all that died are there again, and gives them this step.
 *
 * @return MU_OK; MU_TIMEOUT: they did not come within return_ns, and waits_for says who; MU_DONE:
 *         the run was ended
 */
MU_MUST_USE mu_result recover_await(struct session *s);

/* --- lockstep.c: one step after the other ----------------------------------------------------- */

/** Runs in lock step to the end.  @return MU_OK, or as session_run */
MU_MUST_USE mu_result lockstep_run(struct session *s);

/** Runs freely to the end. */
MU_MUST_USE mu_result lockstep_run_free(struct session *s);

#endif
