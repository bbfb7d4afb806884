/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file directory.h
 * Groups, services and standing queries, which processes are shown them, and which agents may
 * direct which.
 */
#ifndef MUSTER_BROKER_DIRECTORY_H
#define MUSTER_BROKER_DIRECTORY_H

#include "broker/directory/trust.h"
#include "broker/steps/steps.h"
#include "core/attributes.h"
#include "core/pairs.h"

/* --- lines.c --------------------------------------------------------------------------------- */

/*
 * A bounded table of lines, each of which an agent or a broker has said of a key and an agent: that
 * an agent is a member of a group, that a group is there ("" for the agent), that an agent offers a
 * service.
 *
 * The youngest word counts, by stamp, then by the broker's name: lines of several brokers can be
 * merged in any order.  A line that says "no longer" stays, so that older word is known to be
 * older and every process is told, until the table needs its place.
 *
 * Every change moves its line to the end of `changes`: that is where the keepers of lines elsewhere
 * (processes, a disk, other brokers) find what is new, each by the version that it has had.
 *
 * While a run goes by steps there are two views of groups.  What takes effect at the end of a step
 * is seen by all; what is said by the wall clock, outside the run, is not seen inside, where each
 * line stays as it was.
 */

enum lines_kind { LINES_GROUPS, LINES_SERVICES, LINES_KINDS };

/* When something was said, and its receiver. */
struct said {
    uint64_t stamp_ns;  /* nanoseconds since 1970; inside, of the run */
    const char *origin; /* the broker; at most MU_NAME_MAX bytes */
    bool inside;        /* takes effect at the end of a step */
    uint64_t mail_ns;   /* the mail clock, by which leases count */
};

/* A line as processes, disks and other brokers have it. */
struct line_word {
    const char *key;        /* the group, the service */
    const char *agent;      /* "": the line is of the group alone */
    bool present;           /* false: joined no more, withdrawn */
    const char *attributes; /* "" when it has none */
    const char *origin;     /* the broker that it was said to */
    uint64_t lease_ns, stamp_ns;
};

struct line {
    bool holds;        /* of the group's own line: it is there, even without members */
    bool holds_inside; /* as it is seen inside */
    uint64_t stamp_ns;
    char origin[MU_NAME_MAX + 1];
};

/* What a line of services has besides. */
struct line_offer {
    uint64_t lease_ns; /* from stamp_ns on; 0: until withdrawn */
    uint64_t until_ns; /* mail clock; UINT64_MAX: until withdrawn */
    char attributes[MU_ATTRIBUTES_MAX + 1];
};

struct subscriptions;

struct lines {
    struct mu_pairs pairs; /* (key, agent) */
    struct line *at;
    struct line_offer *offers; /* NULL: groups, which have none of these: */
    struct mu_pairs by_agent;  /* (agent, key) */
    uint32_t *line_of;         /* by index of by_agent */
    struct changelog changes;
    struct subscriptions *told_to; /* processes that have been told of lines; NULL: none */
    uint32_t keys, keys_max;       /* keys that have lines */
    uint32_t keys_now, now;        /* own lines of groups, and others, that hold outside */
    uint64_t soonest_ns;           /* no lease ends before this */
    uint64_t told;                 /* all have had the changes up to this version: see lines_full */
    uint64_t seen;                 /* the version that all were woken for */
    uint64_t open;                 /* the version that the open Delivery leads to */
};

/** Takes memory at start-up. */
void lines_init(struct lines *l, enum lines_kind kind);

/** @return the line, made if it is not there; MU_NONE: full */
uint32_t lines_get(struct lines *l, const char *key, const char *agent);

/** Notes whether a line holds, and moves it to the end of the changes. */
void lines_say(struct lines *l, uint32_t line, bool holds, const struct said *said);

/** Sets what a line of services offers.  @param left_ns  what is left of the lease now */
void lines_offer(struct lines *s, uint32_t line, const struct line_word *word, uint64_t left_ns,
                 const struct said *now);

/**
 * Takes in a line of another broker, or one that was kept on a disk.
 *
 * @param now  what is left of a lease is counted from its stamp to now->stamp_ns
 * @return MU_OK; MU_EXISTS: a younger one, or this one, is there; MU_FULL; MU_MALFORMED
 */
mu_result lines_merge(struct lines *l, const struct line_word *word, const struct said *now);

/** @return whether a line may have to make room: set `told` before the next change */
bool lines_full(const struct lines *l);

/** @return a line, with pointers into the table */
struct line_word lines_word(const struct lines *l, uint32_t line, bool inside);

/* --- groups.c -------------------------------------------------------------------------------- */

/* The members of groups. */

/* Changes.  Names are checked here.  @return NULL, or why not: one word */

const char *groups_create(struct lines *g, const char *group, const struct said *said);
const char *groups_join(struct lines *g, const char *group, const char *agent,
                        const struct said *said);
const char *groups_leave(struct lines *g, const char *group, const char *agent,
                         const struct said *said);

/** A run by steps begins: inside, everything is seen as it is now. */
void groups_freeze(struct lines *g);

/** An agent enters the run: its lines are seen there as they are now. */
void groups_enter(struct lines *g, const char *agent);

/** @return whether there is such a group */
bool groups_exists(const struct lines *g, const char *group, bool inside);

/** @return whether the agent is a member of the group */
bool groups_has(const struct lines *g, const char *group, const char *agent, bool inside);

/**
 * Goes through the members of a group in order of name.
 *
 * @param place  0 at first; kept up to date
 * @return the next member's name, or NULL
 */
const char *groups_member(const struct lines *g, const char *group, bool inside, uint32_t *place);

/** Goes through the groups in order of name, likewise. */
const char *groups_name(const struct lines *g, bool inside, uint32_t *place);

/* --- services.c ------------------------------------------------------------------------------ */

/*
 * The yellow pages.  A lease counts on the mail clock, which may be simulated; when it is
 * over, the line is as if withdrawn.  Whether an offer is shown depends on its agent, too: that is
 * the caller's to know.
 */

/** @param word  service, agent, attributes and lease.  @return NULL, or why not: one word */
const char *services_advertise(struct lines *s, const struct line_word *word,
                               const struct said *said);
const char *services_withdraw(struct lines *s, const char *service, const char *agent,
                              const struct said *said);

/** Ends the leases that are over. */
void services_expire(struct lines *s, uint64_t mail_ns);

/** Something else about an agent has changed: its lines are news to all. */
void services_touch(struct lines *s, const char *agent);

/* --- subscriptions.c ------------------------------------------------------------------------- */

/*
 * Standing queries on services: the subscriber, the question, and the lines that it has been told
 * of.
 *
 * What a subscriber is told is the difference between what it has been told and what it would find
 * now; so nothing is said twice, whatever it was that changed.
 */

/** A bit for each line of the services. */
enum { SUBSCRIPTIONS_WORDS = (MU_SERVICES_MAX + 63) / 64 };

struct subscription {
    char agent[MU_NAME_MAX + 1];
    char text[MU_QUERY_MAX + 1];
    char in_reply_to[MU_FIELD_MAX + 1], conversation[MU_FIELD_MAX + 1]; /* of what it is sent */
    struct mu_query query;
    uint64_t told[SUBSCRIPTIONS_WORDS]; /* lines that it knows of */
    uint64_t owed[SUBSCRIPTIONS_WORDS]; /* gone from its sight without a word */
};

struct subscriptions {
    struct subscription at[MU_SUBSCRIPTIONS_MAX];
    uint32_t
        order[MU_SUBSCRIPTIONS_MAX]; /* [0, count) in use, oldest first; then those given back */
    uint32_t count, used;
};

/** @return the index-th in order of age; index < count */
struct subscription *subscriptions_at(struct subscriptions *s, uint32_t index);

/** @return the index of an agent's query with that text, or MU_NONE */
uint32_t subscriptions_find(struct subscriptions *s, const char *agent, const char *text);

/** @return a new one, told of nothing, last in order; NULL: full */
struct subscription *subscriptions_add(struct subscriptions *s, const char *agent,
                                       const char *text);

void subscriptions_remove(struct subscriptions *s, uint32_t index);

/** Notes whether a line is found now.  @return whether that is news */
bool subscriptions_note(struct subscription *s, uint32_t line, bool found);

/** Notes whether it is owed a word about a line. @return whether it was */
bool subscriptions_owe(struct subscription *s, uint32_t line, bool owed);

/** Notes the lines that a subscriber was told are found, and has not heard otherwise of since. */
void subscriptions_rest(struct subscriptions *s, uint64_t lines[SUBSCRIPTIONS_WORDS]);

/** A line of the services is no more; another one will have its index. */
void subscriptions_forget(struct subscriptions *s, uint32_t line);

/* --- view.c ---------------------------------------------------------------------------------- */

/*
 * Groups and services among the other parts of the broker: what each process is shown, and told.
 *
 * A service is shown while its agent is not absent and its lease is not over.  To members of a lock
 * step only services of members are shown, and groups as lines.c says: what others do by the wall
 * clock changes nothing inside.
 */

/* Lines in one Delivery outside; the others come in the next one. */
enum { PAGES_MEMBERSHIPS = 4096, PAGES_OFFERS = 1024 };

struct pages {
    struct lines groups, services;
    struct subscriptions subscriptions;
    /* Of the open Delivery; inside, one holds everything. */
    muster_Membership memberships[MU_MEMBERSHIPS_MAX];
    muster_Offer offers[MU_SERVICES_MAX];
    bool asked_inside; /* a policy asks because of a directive from inside */
};

/** @return whether the agent is inside a run that goes by steps */
bool view_inside(const struct broker *b, uint32_t agent);

/** @return whether a line of the services is shown, to agents inside or to others */
bool view_shows(const struct broker *b, uint32_t line, bool inside);

/** What is said now: its stamp, and whether it takes effect inside.  Call before each change. */
struct said view_said(struct broker *b);

/** Adds to a Delivery what has changed since the last one; view_delivered says that it is out. */
void view_fill(struct broker *b, const struct process *at, muster_Delivery *d);

/** @return whether there is nothing of it that a process has not been told */
static inline bool view_has_told(const struct pages *p, const struct process *at)
{
    return changelog_after(&p->groups.changes, at->groups_had) == MU_NONE &&
           changelog_after(&p->services.changes, at->services_had) == MU_NONE;
}

/** A Delivery begins.  @return whether view_fill may have something to add */
static inline bool view_open(struct pages *p, const struct process *at)
{
    p->groups.open = at->groups_had;
    p->services.open = at->services_had;
    return !view_has_told(p, at);
}

/** @return the lease of a line as others are to have it, which count it from its stamp by the wall
 */
uint64_t view_lease_ns(const struct broker *b, uint32_t line);

/** The Delivery has gone out. */
static inline void view_delivered(const struct pages *p, struct process *at)
{
    at->groups_had = p->groups.open;
    at->services_had = p->services.open;
}

bool view_process_is_told(const struct process *at);

/** @return the agent to ask about an address SCHEME:REST, or MU_NONE */
uint32_t view_resolver(const struct broker *b, const char *dst);

#endif
