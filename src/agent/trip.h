/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file trip.h
 * The way of an agent out of its process: docs/mobility.md has the order of events.
 *
 * Each robot of a crew can be on one trip at a time, MU_CAPSULES_MAX of them together.  What
 * crosses is a passport, one line, and a capsule behind it, in pieces that fit a mail.
 */
#ifndef MUSTER_AGENT_TRIP_H
#define MUSTER_AGENT_TRIP_H

#include "core/text.h"
#include "mind/mind.h"
#include "muster/muster.h"
#include "wire.h"

enum {
    TRIP_CAPSULE_MAX = MU_CAPSULE_MAX, /* bytes of passport and capsule */
    TRIP_FIELDS = 11,                  /* of a passport, without who asked */
    TRIP_ANSWER_MAX = 4 << 20,         /* of all in one answer to a step, if they are several */
};

enum trip_purpose { TRIP_MOVE, TRIP_CLONE, TRIP_LAUNCH, TRIP_PURPOSES };

/* What a host must know of an agent beside its mind. */
struct passport {
    enum trip_purpose purpose;
    char name[MU_NAME_MAX + 1]; /* that it is to have */
    enum mu_state state;        /* that it goes on in */
    struct mu_passage passage;
    uint64_t mails;      /* that its rules have seen */
    uint32_t rules_left; /* that it may fire yet; 0: as many as it wants */
    /* Whom the host tells that it is there; "": nobody, or the source does that. */
    char asker[MU_NAME_MAX + 1], reply_with[MU_FIELD_MAX + 1];
    uint64_t seed; /* of one that is launched; its rules stand in the place of the capsule */
};

enum trip_phase {
    TRIP_NONE,
    TRIP_DEPARTS,   /* it goes at the end of the step, or when all is sent, if there are none */
    TRIP_DEPOSITED, /* the capsule goes with the answer; in lock step the step waits for a word */
    TRIP_KEPT,      /* the broker has it: the host's word is awaited */
    TRIP_SENDS,     /* pieces go out: of a clone, or to a host at another broker */
    TRIP_WAITS,     /* for the host's word */
    TRIP_YIELDS,    /* the host is ready; what was sent has no answer yet */
    TRIP_HANDS_OVER /* its name is free; the copy here is kept until the host has it */
};

struct crew;
struct robot;

struct trip {
    enum trip_phase phase;
    enum trip_purpose purpose;
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
void trip_reserve(struct crew *c);

/**
 * Begins one.
 *
 * @param asked  the directive that wants it, which is answered when it is over; NULL: the rules did
 * @return MU_OK, or MU_REFUSED: that was answered
 */
mu_result trip_begin(struct robot *r, const struct mind_travel *w, const struct mu_mail *asked);

/**
 * Writes down an agent: its passport, and its mind behind it.
 *
 * @return NULL, or why that cannot be; fault has it
 */
const char *trip_write(struct robot *r, const struct passport *p, struct mu_text *out,
                       struct mu_fault *fault);

/** All go on as far as that is possible now. */
void trip_round(struct crew *c);

/** Takes what the broker says of one that is on its way. */
void trip_hear(struct crew *c, const muster_Trip *word);

/** The step at hand is about to be answered: who wants to go does so now. */
void trip_step_end(struct crew *c);

/** It has been answered: out of lock step, who goes stands still from now on. */
void trip_step_answered(struct crew *c);

/** Takes the answer of a host.  @return whether the mail was one */
bool trip_take_answer(struct crew *c, const struct mu_mail *mail);

/** @return whether this robot is on its way */
bool trip_holds(const struct robot *r);

/** Adds a passport, one line. */
void passport_add(struct mu_text *out, const struct passport *p);

/** Reads a passport and moves behind it.  @return false: it is none */
bool passport_read(const char **text, struct passport *out);

#endif
