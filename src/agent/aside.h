/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file aside.h
 * Lines that end the life of whoever carries them out.  The broker hands a line that was not
 * acknowledged to the next life, which would end of it, too, and so would the next.  After two it
 * is set aside: answered, listed, and not carried out.
 *
 * Of an agent that has a folder for checkpoints NAME.lines has the line at hand, and those that
 * have ended a life, for the next one to read.
 */
#ifndef MUSTER_AGENT_ASIDE_H
#define MUSTER_AGENT_ASIDE_H

#include "muster/limits.h"
#include "muster/muster.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct robot;

enum { ASIDE_LINES = 8, ASIDE_LIVES = 2 };

struct aside_line {
    uint64_t number;                  /* of the mail in the robot's box; 0: the place is free */
    uint64_t hash;                    /* of the whole line */
    unsigned lives;                   /* that it has ended */
    bool at_hand;                     /* it is being carried out */
    char text[MU_ATTRIBUTES_MAX + 1]; /* how it begins */
};

struct asides {
    struct aside_line lines[ASIDE_LINES];
};

/** Takes up what the life before has left; of one that begins anew it goes. */
void aside_open(struct robot *r, bool returns);

/** A line is about to be carried out.  @return false: it is set aside */
MU_MUST_USE bool aside_begin(struct robot *r, const struct mu_mail *mail);

/** It was. */
void aside_end(struct robot *r);

/** @return the index-th line that is set aside, as it begins; NULL past the last */
const char *aside_entry(struct robot *r, size_t index);

/** Takes the index-th from the list.  @return whether there is one */
bool aside_drop(struct robot *r, size_t index);

#endif
