/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file interface.h
 * What a mind and its owner hand each other: options, ports, mail, and what rules did.
 *
 * All of it is SI, and none of it is CLIPS.
 */
#ifndef MUSTER_MIND_INTERFACE_H
#define MUSTER_MIND_INTERFACE_H

#include "muster/kind.h"
#include "muster/limits.h"
#include "muster/percept.h"
#include "muster/result.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct planner;
struct mu_fault;
struct mu_text;

/* A mail that came; every string is set, "" where the sender said nothing. */
struct mind_mail {
    uint64_t id; /* the number in this agent's box */
    const char *src;
    const char *performative, *language, *ontology;
    const char *reply_with, *in_reply_to, *conversation;
    const char *content;  /* in its language; "clips": fields as CLIPS prints them */
    uint64_t reply_by_ns; /* an answer after this time of the run is not wanted; 0: any time */
    uint32_t layer;       /* enum mu_layer, or a higher one; 0: MU_LAYER_SPEECH */
};

/* A mail that rules send.  The strings live until the port returns. */
struct mind_letter {
    const char *dst; /* as in struct mu_mail */
    bool directive;  /* (you-do ...): performative "do", content a CLIPS line */
    const char *performative, *language, *ontology;
    const char *reply_with, *in_reply_to, *conversation;
    const char *content;
    uint64_t reply_by_ns; /* an answer after this time of the run is not wanted; 0: any time */
    uint64_t ttl_ns;      /* of no use when so old; 0: never */
    uint32_t layer;       /* 0: MU_LAYER_SPEECH */
    enum mu_priority priority;
    enum mu_level level;
};

/* What rules change in the groups and the yellow pages; MIND_RESOLVE: the agent resolves addresses
 * of the scheme that is named. */
enum mind_change {
    MIND_GROUP_CREATE,
    MIND_GROUP_JOIN,
    MIND_GROUP_LEAVE,
    MIND_ADVERTISE,
    MIND_WITHDRAW,
    MIND_RESOLVE
};

/* What rules ask of them. */
enum mind_list {
    MIND_GROUPS,   /* all groups */
    MIND_MEMBERS,  /* the members of a group */
    MIND_PROVIDERS /* the agents that a query finds */
};

/* A line of the white pages. */
struct mind_member {
    const char *name;
    const char *kind;  /* agent, robot, host, special */
    const char *state; /* standby, running, suspended, moving, absent */
    const char *host;  /* on which it lives; "": on none */
};

/* What the mind asks of its body; all calls return at once. */
struct mind_ports {
    void *self;
    /** Takes a mail over.  MU_OK; MU_FULL: no room, nothing was taken. */
    mu_result (*send)(void *self, const struct mind_letter *letter);
    /** The line of a name.  MU_OK or MU_ABSENT. */
    mu_result (*lookup)(void *self, const char *name, struct mind_member *out);
    /** The index-th line of the white pages in order of name.  MU_OK, or MU_DONE past the last. */
    mu_result (*listing)(void *self, size_t index, struct mind_member *out);
    /** Begins a change of a group or service.  MU_OK; MU_FULL: no room, nothing was begun.
     * lease_ns: of MIND_ADVERTISE, how long the offer stands; 0: until it is withdrawn. */
    mu_result (*change)(void *self, enum mind_change change, const char *name,
                        const char *attributes, uint64_t lease_ns);
    /** The index-th name of a list; of: the group, or the query.  NULL past the last. */
    const char *(*entry)(void *self, enum mind_list list, const char *of, size_t index);
    /** The index-th line that is set aside, as it begins.  NULL past the last; may be NULL. */
    const char *(*aside)(void *self, size_t index);
    /** Takes it from their list.  @return whether there is one */
    bool (*drop_aside)(void *self, size_t index);
    /** What rules and the engine print: whole lines or parts of them. */
    void (*print)(void *self, const char *text);
    /** What is watched, (watch facts) say, in whole lines or parts of them.  @return whether
     * a console looks; if none does it is printed.  May be NULL. */
    bool (*trace)(void *self, const char *text);
    /** Rules or a line have been at work for a while: called now and then.  May be NULL. */
    void (*work)(void *self);
    /** The engine has been in one call for so long, of the processor's time, and comes to no check
     * of its budget: called four times a second, in a signal handler.  @return MIND_WAITS,
     * MIND_BREAKS, or the exit code of the process, which says why and ends.  NULL: it waits */
    int (*stuck)(void *self, unsigned ms);
};

/* What becomes of a mind whose engine does not come back. */
enum { MIND_WAITS = 0, MIND_BREAKS = -1 };

struct mind_options {
    /* reads rule files: mu_text_file_read of core/text_file.h, or the like; NULL: there are none */
    mu_result (*read)(const char *path, struct mu_text *out, struct mu_fault *fault);
    const char *name;         /* the robot's: ?*my-name* */
    uint64_t seed;            /* of (random), together with the name */
    const char *rules_folder; /* the shared library, and what (extends "FILE") may reach */
    const char *rules_file;   /* the robot's; what lies beside it replaces files of the library by
                                 name; NULL: nothing does */
    uint32_t firings_max;     /* a step; 0: MU_FIRINGS_PER_STEP */
    uint32_t failures_max;    /* of one rule until it is enough; 0: never */
    double forward_max_m_s, turn_max_rad_s; /* setSpeed clamps to these; 0: no limit known */
    struct planner *planner; /* for (plan); minds may share it; NULL: there is no map */
    double half_m;           /* half the body's width, and what it wants to have beside it */
    bool trace;              /* notes what goes on, for mind_trace */
    struct mind_ports ports;
};

/* Why a step's firing ended. */
enum mind_end { MIND_IDLE, MIND_SENSE_AGAIN, MIND_BUDGET, MIND_STOPPED, MIND_BREAK };

/* What a line or a rule has said of its own agent's life. */
enum mind_wish { MIND_WISH_NOTHING, MIND_WISH_RUN, MIND_WISH_STEP, MIND_WISH_SUSPEND };

/* What the rules did in one step. */
struct mind_act {
    bool drives; /* setSpeed or stop was called; the last call counts */
    double forward_m_s, turn_rad_s;
    enum mu_paddles paddles; /* of the gripper */
    enum mu_lift lift;
    uint32_t firings;
    uint32_t errors;   /* right-hand sides that ended in an error */
    const char *rules; /* names of those fired, in order, between spaces; until the next call */
    enum mind_end end;
    const char *why;    /* MIND_STOPPED: which limit: "depth", "ticks", "memory"; MIND_BREAK: the
                           rule that would fire next */
    const char *enough; /* why the robot had better be suspended; NULL: it goes on */
};

/* Where rules want their agent to go: the first that they say in a step counts. */
enum mind_travel_kind { MIND_STAYS, MIND_MOVES, MIND_CLONES, MIND_DISPOSES };

struct mind_travel {
    enum mind_travel_kind kind;
    char name[MU_NAME_MAX + 1]; /* of the clone */
    char host[MU_NAME_MAX + 1]; /* "": where it is */
};

#endif
