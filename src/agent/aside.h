/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file aside.h
 * Lines that end the life of the agent that carries them out.
 *
 * The broker hands a line that was not acknowledged to the next life.  That life would end of it,
 * too, and so would the next.  After two lives the line is set aside: answered, listed, not carried
 * out.
 *
 * An agent with a folder for checkpoints has a file NAME.lines there.  It holds the line at hand,
 * and the lines that have ended a life, for the next life to read.
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

/** Reads the file of the life before; an agent that begins anew loses that file. */
void aside_open(struct robot *r, bool returns);

/** Notes a line that is about to be carried out.  @return false: it is set aside */
MU_MUST_USE bool aside_begin(struct robot *r, const struct mu_mail *mail);

/** Notes that the line was carried out. */
void aside_end(struct robot *r);

/** @return the index-th line that is set aside, as it begins; NULL past the last */
const char *aside_entry(struct robot *r, size_t index);

/** Takes the index-th from the list.  @return whether there is one */
bool aside_drop(struct robot *r, size_t index);

#endif
