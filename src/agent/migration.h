/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file migration.h
 * The way of an agent out of its process: docs/mobility.md has the order of events.
 *
 * Each robot of a crew can be on one trip at a time, MU_CAPSULES_MAX of them together.  What
 * crosses is a passport, one line, and a capsule behind it, in pieces that fit a mail.
 */
#ifndef MUSTER_AGENT_MIGRATION_H
#define MUSTER_AGENT_MIGRATION_H

#include "core/text.h"
#include "mind/mind.h"
#include "muster/muster.h"
#include "wire.h"

enum {
    MIGRATION_SNAPSHOT_MAX = MU_CAPSULE_MAX, /* bytes of passport and capsule */
    SNAPSHOT_HEADER_FIELDS = 11,             /* of a passport, without who asked */
    MIGRATION_ANSWER_MAX = 4 << 20, /* of all in one answer to a step, if they are several */
};

enum migration_purpose { MIGRATION_MOVE, MIGRATION_CLONE, MIGRATION_LAUNCH, MIGRATION_PURPOSES };

/* What a host must know of an agent beside its mind. */
struct snapshot_header {
    enum migration_purpose purpose;
    char name[MU_NAME_MAX + 1]; /* that it is to have */
    enum mu_state state;        /* that it goes on in */
    struct mu_passage passage;
    uint64_t mails;      /* that its rules have seen */
    uint32_t rules_left; /* that it may fire yet; 0: as many as it wants */
    /* Whom the host tells that it is there; "": nobody, or the source does that. */
    char asker[MU_NAME_MAX + 1], reply_with[MU_FIELD_MAX + 1];
    uint64_t seed; /* of one that is launched; its rules stand in the place of the capsule */
};

enum migration_phase {
    MIGRATION_NONE,
    MIGRATION_DEPARTS, /* it goes at the end of the step, or when all is sent, if there are none */
    MIGRATION_DEPOSITED, /* the capsule goes with the answer; in lock step the step waits for a word
                          */
    MIGRATION_KEPT,      /* the broker has it: the host's word is awaited */
    MIGRATION_SENDS,     /* pieces go out: of a clone, or to a host at another broker */
    MIGRATION_WAITS,     /* for the host's word */
    MIGRATION_YIELDS,    /* the host is ready; what was sent has no answer yet */
    MIGRATION_HANDS_OVER /* its name is free; the copy here is kept until the host has it */
};

struct group_process;
struct robot;

struct migration {
    enum migration_phase phase;
    enum migration_purpose purpose;
    struct robot *robot; /* NULL: nobody is on it */
    char host[MU_NAME_MAX + 1], name[MU_NAME_MAX + 1];
    char id[MU_FIELD_MAX + 1]; /* that the host's answer refers to */
    char asker[MU_NAME_MAX + 1], reply_with[MU_FIELD_MAX + 1]; /* "": nobody asked */
    enum mu_state was;
    bool left; /* its rules have had their last word */
    struct mu_passage passage;
    uint64_t until_ns;
    struct mu_text text; /* passport and capsule */
    size_t sent;
    uint32_t piece;
};

/** Takes the memory for a crew's trips. */
void migration_reserve(struct group_process *g);

/**
 * Begins one.
 *
 * @param asked  the directive that wants it, which is answered when it is over; NULL: the rules did
 * @return MU_OK, or MU_REFUSED: that was answered
 */
mu_result migration_begin(struct robot *r, const struct mind_travel *w,
                          const struct mu_mail *asked);

/**
 * Writes down an agent: its passport, and its mind behind it.
 *
 * @return NULL, or why that cannot be; fault has it
 */
const char *agent_write(struct robot *r, const struct snapshot_header *p, struct mu_text *out,
                        struct mu_fault *fault);

/** All go on as far as that is possible now. */
void migration_round(struct group_process *g);

/** Takes what the broker says of one that is on its way. */
void migration_hear(struct group_process *g, const muster_Trip *word);

/** The step at hand is about to be answered: who wants to go does so now. */
void migration_step_end(struct group_process *g);

/** It has been answered: out of lock step, who goes stands still from now on. */
void migration_step_answered(struct group_process *g);

/** Takes the answer of a host.  @return whether the mail was one */
bool migration_take_answer(struct group_process *g, const struct mu_mail *mail);

/** Adds a passport, one line. */
void snapshot_header_add(struct mu_text *out, const struct snapshot_header *p);

/** Reads a passport and moves behind it.  @return false: it is none */
bool snapshot_header_read(const char **text, struct snapshot_header *out);

#endif
