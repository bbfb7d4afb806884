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
#include "mind/mind.h"
#include "muster/muster.h"
#include "runtime/glances.h"

enum {
    ROBOT_ANSWER_MAX = MU_CONTENT_MAX / 2,
    ROBOT_PRINT_MAX = 1024,
    ROBOT_CONSOLES_MAX = 8,         /* that look at one robot */
    ROBOT_CREDIT_MAX = 1024,        /* pieces that a console can have room for */
    ROBOT_LISTING_MAX = 256 * 1024, /* bytes of an answer to a console */
    ROBOT_TRACE_MAX = 128 * 1024    /* bytes that consoles see of one step */
};

/* Somebody who looks at a robot. */
struct console {
    char name[MU_NAME_MAX + 1];
    uint32_t credit; /* pieces that it has room for */
    uint32_t unread; /* pieces that it has said nothing of yet */
    uint64_t lost;   /* lines that it has missed since its last piece */
};

struct robot;

/* What the process that has them does for robots: one constant table of its program. */
struct robot_program {
    const struct mu_agent_kind *kind;
    struct mu_handlers handlers; /* of a robot, which is put into .self */
    /** A mail of its rules does not get through: as returns_hear says it. */
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
    struct world *world;     /* that (plan) knows; NULL: none */
    struct planner *planner; /* over its map; the robots share it */
    bool refused;            /* the broker has refused a name */
    bool prints;             /* what rules print is the program's answer, as it stands; else it goes
                                to the log, with the robot's name */
    const char *rules_folder;     /* of the shared rules */
    const char *host;             /* the platform's name; "": the process takes nobody in */
    struct migration *migrations; /* trips_max of them, in no order */
    uint32_t migrations_max;
    uint64_t migrations_begun;
    struct checkpoints checkpoints;
    mu_agent *envoy; /* speaks for who is on its way; NULL: nobody was yet */
    /** One that has come has its name, or will not get it; NULL: nobody comes. */
    void (*on_arrived)(struct robot *r, bool accepted, const char *reason);
    /* Of whoever answers a question; one robot does at a time. */
    char answer[ROBOT_ANSWER_MAX];
    char quoted[MU_CONTENT_MAX];
    struct mu_text listing; /* the same for consoles: longer, and sent in pieces */
    struct mu_text trace;   /* what the consoles of one robot have not been told of yet */
    struct robot *traced;   /* that one, or NULL */
    uint32_t trace_cut;     /* lines for which there was no room */
    struct mu_text diary;   /* of one robot's step */
    char diary_bytes[MU_NOTE_MAX + 1];
    char listing_bytes[ROBOT_LISTING_MAX], trace_bytes[ROBOT_TRACE_MAX];
};

struct robot {
    struct group_process *group;
    char name[MU_NAME_MAX + 1];
    struct mind *mind;
    mu_agent *agent;
    struct migration *migration; /* that it is on, or its copy is; NULL: none */
    struct mu_percept percept;   /* of this step, */
    bool percept_waits;          /* which the mind has not taken yet */
    bool bodiless;               /* in this step; the percept says what time it is */
    bool out;                    /* it takes no part: it is disposed of, or its name is refused */
    bool native;                 /* the command line names it, and it has begun here */
    bool arrives;                /* it has not got its name here yet; then it goes on */
    bool returns;              /* its mind was made of a checkpoint: it goes on where that ends, */
    int64_t saved_step;        /* behind this step, */
    struct answer answer;      /* whose answer was this; text NULL: it is not known */
    bool repeats;              /* that answer, in the step at hand */
    enum mu_state returns_as;  /* in this state, */
    struct mu_passage passage; /* from there: of one that has a checkpoint */
    int64_t step;              /* that began last; -1: none has */
    uint64_t time_ns;          /* of that step */
    bool box_full;             /* said once */
    int64_t mends;             /* how often it got another mind for one that was broken */
    uint32_t rules_left; /* it fires so many yet and is suspended then; 0: as many as it wants */
    uint64_t mails;      /* that the rules have seen */
    bool numbered;       /* the mail at hand is among them */
    char print[ROBOT_PRINT_MAX]; /* a line that rules have begun */
    size_t print_len;
    struct asides asides;
    struct console consoles[ROBOT_CONSOLES_MAX];
    uint32_t console_count;
};

/* handlers.c */

/** What robots do beside their rules, and with which events their rules hear of their life. */
extern const struct mu_agent_kind handlers_robot_kind;
extern const struct robot_program handlers_of_robots;

/** Takes the memory of a process of so many.  @param host  the platform's name; "": none */
void agent_reserve(struct group_process *g, const struct robot_options *set, uint32_t count,
                   const char *host);

/* join.c */

/** Lets it join its crew's process, or come back.  @return as mu_agent_join */
MU_MUST_USE mu_result agent_join(struct robot *r);

/** The same for one that comes from elsewhere, or returns.  @return as mu_agent_arrive */
MU_MUST_USE mu_result agent_arrive(struct robot *r, const struct mu_passage *from,
                                   enum mu_event event);

/* group_process.c */

/** @return whether this robot is on its way to another process */
bool agent_is_away(const struct robot *r);

/** It is not here any more; its place is free, and a process without a host ends with the last. */
void group_process_drop(struct robot *r);

/** Takes no part any more; a process without a host ends with the last one. */
void group_process_leave(struct robot *r);

/** Ends a process that has no robots left; in lock step it answers for them until the run ends. */
void group_process_look(struct group_process *g);

/* robot_mind.c */

/** Sets a global of a mind: "mate=red".  @return MU_OK; MU_FAULT_USAGE: it has said what is wrong
 */
MU_MUST_USE mu_result robot_mind_set_global(struct mind *mind, const char *word);

/**
 * What its mind is to be made with: by the settings of its crew, and what it may ask of the robot.
 *
 * @param folder  of the shared rules; NULL: a capsule has them
 */
struct mind_options robot_mind_options(struct robot *r, const char *folder);

/**
 * Makes its mind: what its checkpoint says, if it is to come back and has one; else the shared
 * library, its rules, its globals.  Who is to come back, and has ended since, is out.
 *
 * @return MU_OK; MU_FAULT_FILE, MU_FAULT_USAGE: it has said what is wrong
 */
MU_MUST_USE mu_result robot_mind_make(struct robot *r);

/** It goes on behind the step that its checkpoint is of; memory is taken at start-up. */
void robot_mind_take_up(struct robot *r, const struct checkpoint_head *head);

/**
 * Gives a robot whose mind is broken another one, of its checkpoint or else of its rules, if that
 * is wanted and was not done too often.  The agent lives on; what its mind had done since is lost.
 *
 * @return whether it has; false: its mind is whole, or stays broken
 */
bool robot_mind_mend(struct robot *r);

/**
 * Makes the map of the world that the settings name, if they do.
 *
 * @return MU_OK; MU_FAULT_FILE: it has said what is wrong with the file
 */
MU_MUST_USE mu_result robot_mind_open_map(struct group_process *g);

/** Looks after minds whose engine hangs, from now on, four times a second. */
void robot_mind_watch(void);

/* percept.c */

/** Asks for the sensors that the rules look at. */
void percept_ask(mu_agent *a, const struct mind *mind);

/**
 * Lets the mind take the percept that waits, before anything else reaches it.  While it runs, that
 * is when it acts or has mail: of many minds each is met once a step, not twice, and what it works
 * on is in the processor's caches then.
 */
void percept_settle(struct robot *r);

/* ports.c */

/** @return what its mind may ask of it */
struct mind_ports ports_of(struct robot *r);

/** Ends the line that its rules have begun to print. */
void ports_print_rest(struct robot *r);

/* console.c */

/** Keeps text for the robot's consoles.  @return whether it has any */
bool console_print(struct robot *r, const char *text);

/** Sends them what was kept. */
void console_flush(struct robot *r);

/** A step is over: the same if it is much, or somebody has read all that came before. */
void console_offer(struct robot *r);

/** The robot is gone: another one may take its place, and has no consoles yet. */
void console_end(struct robot *r);

/** Asks the mind, and answers a console in pieces.  @return whether the mind did it */
bool console_answer(struct robot *r, const struct mu_mail *asked,
                    mu_result (*ask)(struct mind *m, const char *line, struct mu_text *out));

/** Answers a line that only looks, between two steps: for glances_answer. */
enum glance_end console_look(void *self, const char *line, const char **text);

/** Answers with the words that a line may have, as mind_words has them. */
void console_words(struct robot *r, const struct mu_mail *asked);

/** A console comes, has room for more, or goes. */
void console_directive(struct robot *r, const struct mu_mail *mail);

/* mail.c */

/** Offers a mail to the rules' handlers of its layer: for the kind of agents that robots are. */
enum mu_take mail_take_by_rules(void *self, mu_agent *a, const struct mu_mail *mail);

/** Answers what it knows: all facts, or those of the relation that is named. */
enum mu_take mail_take_facts(void *self, mu_agent *a, const struct mu_mail *mail);

/** Answers a question of one word for which rules have a deffunction (answer-WORD). */
enum mu_take mail_take_question(void *self, mu_agent *a, const struct mu_mail *mail);

/** Moves to the host that the content names: `dispatch` sends it there, `retract` calls it back. */
enum mu_take mail_take_dispatch(void *self, mu_agent *a, const struct mu_mail *mail);

/** Makes a copy of the name, and on the host, that the content says. */
enum mu_take mail_take_clone(void *self, mu_agent *a, const struct mu_mail *mail);

void mail_on_mail(void *self, mu_agent *a, const struct mu_mail *mail);
void mail_on_directive(void *self, mu_agent *a, const struct mu_mail *mail);

/** Answers a directive that means nothing to the agent: refuse, `VERB unsupported`. */
void mail_refuse_directive(mu_agent *a, const struct mu_mail *mail);

/* lifecycle.c */

void lifecycle_on_registered(void *self, mu_agent *a, bool accepted, const char *reason);
void lifecycle_on_refusal(void *self, mu_agent *a, const char *change, const char *reason);
/** A mail of its rules does not get through: as returns_hear says it. */
void lifecycle_on_return(void *self, mu_agent *a, const char *to, bool directive,
                         enum mu_outcome outcome);
void lifecycle_on_state(void *self, mu_agent *a, enum mu_state state);

/** Sets out where its rules, or a line, want it to go. */
void lifecycle_travel(struct robot *r);

/** Does what a line or a rule has said of the robot's own life. */
void lifecycle_do_wish(struct robot *r, mu_agent *a);

/* step.c */

void step_on_step(void *self, mu_agent *a, const struct mu_percept *percept);
/** A step of one without a body. */
void step_on_tick(void *self, mu_agent *a, const struct mu_percept *percept);
void step_on_act(void *self, mu_agent *a, const struct mu_percept *percept);

#endif
