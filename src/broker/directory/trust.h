/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file trust.h
 * Which agents may direct which, and the record of what was directed.
 */
#ifndef MUSTER_BROKER_TRUST_H
#define MUSTER_BROKER_TRUST_H

#include "broker/base/base.h"
#include "core/fault.h"

struct broker;

/* --- trust.c --------------------------------------------------------------------------------- */

/*
 * The trust policy: whose directives are carried out.
 *
 * A policy is a list of lines, and the last one that fits a sender and a receiver decides:
 *
 *     allow WHO direct WHOM        # a comment
 *     deny WHO direct WHOM
 *
 * WHO and WHOM are a name, all, robots, special, group:G or role:R.  When no line fits, the answer
 * is no.  The name operator also stands for special agents named operator-N, which are consoles.
 * Without a file it is as if there were these: allow observer direct all, allow operator
 * direct all.
 */

enum trust_party_kind {
    TRUST_NAME,
    TRUST_ALL,
    TRUST_ROBOTS,
    TRUST_SPECIAL,
    TRUST_GROUP,
    TRUST_ROLE
};

/* One side of a line. */
struct trust_party {
    enum trust_party_kind kind;
    char name[MU_NAME_MAX + 1]; /* of the agent, group or role */
};

struct trust_line {
    bool allow;
    struct trust_party who, whom;
};

/* What a line needs to know of others: asked when a directive comes, not when the file is read. */
struct trust_pages {
    void *self;
    /* Whether an agent is in the group, or has the role; NULL: none is, or has. */
    bool (*has)(void *self, const struct trust_party *party, const char *agent);
};

struct trust {
    struct trust_line *lines; /* MU_TRUST_LINES_MAX of them */
    uint32_t lines_count;
    struct trust_pages pages;
};

/* An agent as a policy sees it. */
struct trust_agent {
    const char *name;
    muster_Kind kind;
};

/** The policy that holds without a file. */
void trust_init(struct trust *t);

/**
 * Replaces the policy by that of a file.
 *
 * @param text  the whole file, zero-terminated
 * @param file  its name, for the fault
 * @return MU_OK; MU_FAULT_FILE with line, column and what was expected: the policy is of no use
 * then
 */
MU_MUST_USE mu_result trust_read(struct trust *t, const char *text, const char *file,
                                 struct mu_fault *fault);

/** @return whether a directive of `who` to `whom` is carried out */
bool trust_allows(const struct trust *t, const struct trust_agent *who,
                  const struct trust_agent *whom);

/** @return whether some line lets the agent direct any: for a directive without a receiver */
bool trust_allows_some(const struct trust *t, const struct trust_agent *who);

/* --- audit.c --------------------------------------------------------------------------------- */

/*
 * The audit: a record of every directive, carried out or refused, until it is written down.
 *
 * A directive to several receivers makes at most two records: one of the agents that get it, one of
 * the agents that it is refused for.
 */

enum { AUDIT_TEXT_MAX = 200, AUDIT_LINE_MAX = 4096 };

struct audit_record {
    bool simulated; /* time_ns is of the run; else since 1970 */
    uint64_t time_ns;
    char sender[MU_NAME_MAX + 1];
    char process[MU_PROCESS_MAX + 1];
    char receiver[AUDIT_TEXT_MAX + 1]; /* names joined by commas, cut */
    uint32_t receivers;                /* how many; 0: the address fits none */
    char performative[MU_FIELD_MAX + 1];
    char line[AUDIT_TEXT_MAX + 1]; /* the directive's content, cut */
    bool allowed;
};

struct audit {
    bool on; /* else nothing is recorded */
    struct audit_record ring[MU_AUDIT_MAX];
    uint32_t head, count;
    uint64_t recorded;
    uint64_t lost;   /* for want of room: the earlier ones were not taken */
    uint64_t failed; /* that could not be written */
};

/** Makes room for one record.  @return the record, zeroed; NULL: it is not wanted, or it is lost */
struct audit_record *audit_add(struct audit *a);

/** Adds a receiver's name to a record; NULL: none is kept. */
void audit_receiver(struct audit_record *r, const char *name);

/** Takes the oldest record.  @return false when there is none */
bool audit_next(struct audit *a, struct audit_record *out);

/** Writes a record as one line of JSON with its end.  @return its length in bytes */
size_t audit_line(const struct audit_record *r, char line[AUDIT_LINE_MAX]);

/* --- authorize.c ----------------------------------------------------------------------------- */

/* Directives that may go on: asks the policy, counts, and keeps the audit. */

/**
 * Takes the agents that its sender may not direct out of a directive's receivers.
 *
 * @param agents its receivers, count of them; those that stay keep their order
 * @return for how many it is refused; 1 when it has no receiver, and its sender may direct none
 */
uint32_t authorize_mail(struct broker *b, const struct mail *m, uint32_t *agents, uint32_t *count);

/**
 * Asks whether the sender of a mail may speak in another agent's name: an agent that may direct it
 * may, and one in the same process.
 *
 * @param agent  MU_NONE: none that the sender could know, with the name in receiver
 */
bool authorize_line(struct broker *b, const struct mail *m, uint32_t agent, const char *receiver);

/**
 * Asks whether an agent may look at another one's mind: an agent that it may direct it may look at.
 *
 * @return false: nothing is counted or audited yet
 */
bool authorize_probe(struct broker *b, uint32_t asker, uint32_t agent, const char *line);

/** Policies may ask for groups and roles from now on. */
void authorize_attach(struct broker *b);

#endif
