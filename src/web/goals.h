/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file goals.h
 * What each robot wants just now: the fact (goal ...) of its mind, out of the diaries of frames.
 *
 * A diary says what has changed.  So when frames are missing nothing is known any more, until a
 * robot says a goal anew.  Without diaries (docs/observing.md) nothing is ever known.  Pure.
 */
#ifndef MUSTER_WEB_GOALS_H
#define MUSTER_WEB_GOALS_H

#include "core/json.h"
#include "muster/limits.h"
#include "wire.h"

enum { GOALS_TEXT_MAX = 63 };

struct goal {
    long long fact;                /* its index; 0: no goal is known */
    char text[GOALS_TEXT_MAX + 1]; /* "gohome 3000.0 0.0" */
};

struct goals {
    struct goal robots[MU_ROBOTS_MAX]; /* in the order of frames */
    int64_t step;                      /* of the last frame */
    bool known;                        /* of one of them */
};

/** Takes a fact, by its index and text, for what is wanted now, if it is a goal. */
void goals_fact(struct goal *goal, long long fact, const char *text);

/** Goes on to a frame. */
void goals_take(struct goals *g, const muster_Frame *frame);

/** Writes a list with a text for each robot, "" when nothing is known; empty when none is. */
void goals_write(struct mu_json *j, const char *key, const struct goals *g, uint32_t robots);

#endif
