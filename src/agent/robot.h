/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file robot.h
 * A robot's controller: a mind, and the agent that it speaks and drives through.
 *
 * A group process has several of them, which share its place on the bus and nothing else.
 */
#ifndef MUSTER_AGENT_ROBOT_H
#define MUSTER_AGENT_ROBOT_H

#include "agent/aside.h"
#include "agent/checkpoint.h"
#include "agent/migration.h"
#include "agent/options.h"
#include "agent/states/states.h"
#include "mind/mind.h"
#include "muster/muster.h"
#include "runtime/probes.h"
#include "runtime/process.h"

enum {
    ROBOT_ANSWER_MAX = MU_CONTENT_MAX / 2,
    ROBOT_PRINT_MAX = 1024,
    ROBOT_CONSOLES_MAX = 8,         /* that look at one robot */
    ROBOT_CREDIT_MAX = 1024,        /* pieces that a console can have room for */
    ROBOT_LISTING_MAX = 256 * 1024, /* bytes of an answer to a console */
    ROBOT_TRACE_MAX = 128 * 1024    /* bytes of one step that consoles get */
};

/* A console that watches a robot. */
struct console {
    char name[MU_NAME_MAX + 1];
    uint32_t credit; /* pieces that it has room for */
    uint32_t unread; /* pieces that it has said nothing of yet */
    uint64_t lost;   /* lines that it has missed since its last piece */
};

struct robot;

/* The functions of a process's program for its robots, a constant table. */
struct robot_program {
    const struct mu_agent_kind *kind;
    struct mu_handlers handlers; /* with a robot as .self */
    /** Hears that a mail of the rules did not get through: as returns_hear. */
    void (*on_return)(void *self, mu_agent *a, const char *to, bool directive,
                      enum mu_outcome outcome);
};

/* The robots of one process. */
struct group_process {
    const struct robot_program *program;
    const struct robot_options *set;
    mu_process *process;
    struct robot *robots;
    uint32_t count;
    struct world *world;     /* for (plan); NULL: none */
    struct planner *planner; /* over the world's map; shared */
    bool refused;            /* the broker has refused a name */
    bool prints;             /* rules print to standard output, without the name; else to the log */
    const char *rules_folder;     /* of the shared rules */
    const char *host;             /* the host's name; "": the process is no host */
    struct migration *migrations; /* migrations_max of them, in no order */
    uint32_t migrations_max;
    uint64_t migrations_begun;
    uint64_t migrations_unexpected; /* words of a broker that no migration was waiting for */
    struct checkpoints checkpoints;
    int64_t ticks;        /* so many steps were the process's own, */
    uint64_t tick_due_ns; /* and the next one is due then */
    mu_agent *envoy;      /* speaks for agents on their way; NULL: none was needed yet */
    /** Hears whether an agent that arrived got its name; NULL: no agent arrives. */
    void (*on_arrived)(struct robot *r, bool accepted, const char *reason);
    /* Buffers of an answer; one robot answers at a time. */
    char answer[ROBOT_ANSWER_MAX];
    char quoted[MU_CONTENT_MAX];
    struct mu_text listing;    /* for consoles: longer, and sent in pieces */
    struct mu_text trace;      /* lines that the consoles of one robot have not got yet */
    struct robot *traced;      /* the robot of trace, or NULL */
    uint32_t trace_cut;        /* lines that did not fit */
    struct mu_text step_trace; /* the execution trace of a robot's step */
    char step_trace_bytes[MU_NOTE_MAX + 1];
    char listing_bytes[ROBOT_LISTING_MAX], trace_bytes[ROBOT_TRACE_MAX];
};

struct robot {
    struct group_process *group;
    char name[MU_NAME_MAX + 1];
    enum mu_kind kind; /* as which it begins here */
    struct mind *mind;
    mu_agent *agent;
    struct migration *migration; /* of the robot or its copy; NULL: none */
    enum robot_state state;
    uint32_t early_steps;        /* steps that began before it had its name */
    struct mu_percept percept;   /* of this step; .robot NULL: it has no body */
    int64_t saved_step;          /* the last step of its checkpoint, ... */
    struct answer answer;        /* ... and its answer to that; text NULL: not known */
    enum mu_state returns_as;    /* the state that it goes on in when it has its name */
    struct mu_passage passage;   /* of its checkpoint */
    int64_t step;                /* the last one that began; -1: none */
    uint64_t time_ns;            /* of that step */
    bool box_full;               /* said once */
    int64_t mends;               /* how often it got another mind for one that was broken */
    uint32_t rules_left;         /* so many may fire before it is suspended; 0: any number */
    uint64_t mails;              /* that the rules have got */
    bool numbered;               /* the mail at hand is among them */
    char print[ROBOT_PRINT_MAX]; /* a line that rules have begun */
    size_t print_len;
    struct asides asides;
    struct console consoles[ROBOT_CONSOLES_MAX];
    uint32_t console_count;
};

/* handlers.c */

/** The behaviour class of robots: their handlers, and the events that rules hear. */
extern const struct mu_agent_kind handlers_robot_kind;
extern const struct robot_program handlers_of_robots;

/** Takes the memory of so many robots.  @param host  the host's name; "": none */
void agent_reserve(struct group_process *g, const struct robot_options *set, uint32_t count,
                   const char *host);

/* join.c */

/** Lets a robot join its process, or come back.  @return as mu_agent_join */
MU_MUST_USE mu_result agent_join(struct robot *r);

/**
 * Lets a robot from elsewhere, or one with a checkpoint, ask for its name.  @return as
 * mu_agent_arrive
 */
MU_MUST_USE mu_result agent_arrive(struct robot *r, const struct mu_passage *from,
                                   enum mu_event event);

/**
 * Makes a robot the resolver of the scheme that its rules resolve, if they do; before it has joined
 * its process, nothing.
 *
 * @return as mu_agent_resolve
 */
MU_MUST_USE mu_result join_resolve(struct robot *r);

/* group_process.c */

/** @return whether the robot has set out for another process */
bool agent_is_away(const struct robot *r);

/** Removes a robot whose place gets free. */
void group_process_drop(struct robot *r);

/** Ends a robot's part; a process without a host ends with its last robot. */
void group_process_leave(struct robot *r);

/** Ends a process without robots; in lock step it answers for them until the run ends. */
void group_process_look(struct group_process *g);

/* robot_mind.c */

/** Sets a global: "mate=red".  @return MU_OK; MU_FAULT_USAGE: the mistake was printed */
MU_MUST_USE mu_result robot_mind_set_global(struct mind *mind, const char *word);

/**
 * @param folder  of the shared rules; NULL: the snapshot has them
 * @return the options of its mind: those of the process, and the ports of the robot
 */
struct mind_options robot_mind_options(struct robot *r, const char *folder);

/**
 * Makes a robot's mind: of its checkpoint, if it is to come back and has one; else of the rules.
 *
 * A robot that is to come back, but has ended since, gets no mind and stays vacant.
 *
 * @return MU_OK; MU_FAULT_FILE, MU_FAULT_USAGE: the mistake was printed
 */
MU_MUST_USE mu_result robot_mind_make(struct robot *r);

/** Lets a robot go on behind the step of its checkpoint; takes start-up memory. */
void robot_mind_take_up(struct robot *r, const struct checkpoint_head *head);

/**
 * Makes a broken mind anew, of its checkpoint or of its rules, if that is wanted and not done too
 * often.
 *
 * The agent lives on; what its mind has done since then is lost.
 *
 * @return whether it was broken and is whole again
 */
bool robot_mind_mend(struct robot *r);

/**
 * Makes the map of the world that the options name, if they do.
 *
 * @return MU_OK; MU_FAULT_FILE: the mistake was printed
 */
MU_MUST_USE mu_result robot_mind_open_map(struct group_process *g);

/** Looks after minds whose engine hangs, from now on, four times a second. */
void robot_mind_watch(void);

/* percept.c */

/** Asks for the sensors that the rules read. */
void percept_ask(mu_agent *a, const struct mind *mind);

/**
 * Lets the mind take the waiting percept, before anything else reaches the mind.
 *
 * While the robot runs, that is when it acts or has mail.  Each of many minds is met once a step
 * then, with its data in the processor's caches.
 */
void percept_settle(struct robot *r);

/* ports.c */

/** @return the ports of its mind */
struct mind_ports ports_of(struct robot *r);

/** Ends a line that rules have begun to print. */
void ports_print_rest(struct robot *r);

/* console.c */

/** Keeps text for the robot's consoles.  @return whether it has any */
bool console_print(struct robot *r, const char *text);

/** Sends the kept text to the consoles. */
void console_flush(struct robot *r);

/** Does the same at the end of a step, if there is much, or a console has read all before. */
void console_offer(struct robot *r);

/** Forgets the consoles of a robot that has gone. */
void console_end(struct robot *r);

/** Asks the mind, and answers a console in pieces.  @return whether the mind did it */
bool console_answer(struct robot *r, const struct mu_mail *asked,
                    mu_result (*ask)(struct mind *m, const char *line, struct mu_text *out));

/** Answers a read-only line between two steps: for probes_answer. */
enum probe_end console_look(void *self, const char *line, const char **text);

/** Answers with the words of mind_words. */
void console_words(struct robot *r, const struct mu_mail *asked);

/** Takes a directive of a console: it comes, has room for more, or goes. */
void console_directive(struct robot *r, const struct mu_mail *mail);

/* mail.c */

/** Offers a mail to the rules' handlers of its layer. */
enum mu_take mail_take_by_rules(void *self, mu_agent *a, const struct mu_mail *mail);

/** Answers with all facts, or those of a relation. */
enum mu_take mail_take_facts(void *self, mu_agent *a, const struct mu_mail *mail);

/** Answers a one-word question by the rules' deffunction answer-WORD. */
enum mu_take mail_take_question(void *self, mu_agent *a, const struct mu_mail *mail);

/** Moves to the host that the content names: `dispatch` there, `retract` back. */
enum mu_take mail_take_dispatch(void *self, mu_agent *a, const struct mu_mail *mail);

/** Makes a copy, with the name and on the host that the content says. */
enum mu_take mail_take_clone(void *self, mu_agent *a, const struct mu_mail *mail);

void mail_on_mail(void *self, mu_agent *a, const struct mu_mail *mail);
void mail_on_directive(void *self, mu_agent *a, const struct mu_mail *mail);

/** Answers an unsupported directive: refuse, `VERB unsupported`. */
void mail_refuse_directive(mu_agent *a, const struct mu_mail *mail);

/* lifecycle.c */

void lifecycle_on_registered(void *self, mu_agent *a, bool accepted, const char *reason);
void lifecycle_on_refusal(void *self, mu_agent *a, const char *change, const char *reason);
/** A mail of its rules does not get through: as returns_hear says it. */
void lifecycle_on_return(void *self, mu_agent *a, const char *to, bool directive,
                         enum mu_outcome outcome);
void lifecycle_on_state(void *self, mu_agent *a, enum mu_state state);

/** Begins the migration that rules or a line want. */
void lifecycle_travel(struct robot *r);

/** Runs, suspends or steps the robot as a line or a rule wants. */
void lifecycle_do_wish(struct robot *r, mu_agent *a);

/* ticks.c */

/**
 * Handles all that comes until the process ends: as mu_process_run.  Where no simulator is, agents
 * without a body have a control step of the wall's time every MU_STEP_NS.
 *
 * @return as mu_process_run
 */
MU_MUST_USE mu_result ticks_run(struct group_process *g);

/* step.c */

void step_on_step(void *self, mu_agent *a, const struct mu_percept *percept);

/** Saves what the robots of a process (a struct group_process) are, or says again what an earlier
 * life of it did in a step.  @see process_before_up */
void step_before_up(void *self, enum process_up_due due, int64_t step);
/** A step of a robot without a body. */
void step_on_tick(void *self, mu_agent *a, const struct mu_percept *percept);
void step_on_act(void *self, mu_agent *a, const struct mu_percept *percept);

#endif
