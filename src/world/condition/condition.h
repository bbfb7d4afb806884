/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file condition.h
 * What may be so of a run at a step, in words: `red.stalled_s > 2`, `red near blue 0.5`.
 *
 *     time > 20                    simulated seconds
 *     red.distance_m >= 5          a number of a robot: x_m y_m heading_rad distance_m stalls
 *     robots.stalls < 3            stalled_s mail_sent mail_received rule_firings; of robots: the
 *                                  mean over all that have a controller
 *     red near blue 0.5            the middles of two robots or things, in metres
 *     red at 1.5 -2 0.5            x, y and how near, in metres
 *     red stalled                  it is held up
 *     red told near-wall           it has sent a mail in this step whose content begins so; with
 *     red told near-wall to blue   `to`, whose receiver is written so, alone or among several; an
 *                                  address is not resolved
 *     red fired turn-away          a rule of it has fired in this step
 *
 * An agent without a body has told and fired alone.
 *
 * `not` stands before near, at, stalled, told, fired.
 */
#ifndef MUSTER_WORLD_CONDITION_H
#define MUSTER_WORLD_CONDITION_H

#include "muster/limits.h"
#include "muster/result.h"

#include <stdbool.h>
#include <stddef.h>

enum {
    CONDITION_TEXT_MAX = MU_CONDITION_MAX + 1,
    CONDITION_WORD_MAX = 64,
    CONDITION_WHY_MAX = 256
};

/* Numbers of a robot that a condition may compare. */
struct condition_numbers {
    double x_m, y_m, heading_rad, distance_m, stalls, stalled_s;
    double mail_sent, mail_received, rule_firings;
};

enum condition_kind {
    CONDITION_TIME,
    CONDITION_NUMBER,
    CONDITION_NEAR,
    CONDITION_AT,
    CONDITION_STALLED,
    CONDITION_TOLD,
    CONDITION_FIRED,
};

enum condition_compare {
    CONDITION_ABOVE,
    CONDITION_NOT_BELOW,
    CONDITION_BELOW,
    CONDITION_NOT_ABOVE
};

enum {
    CONDITION_ALL_ROBOTS = -1,
    CONDITION_AGENTS = 1 << 20 /* the first number of an agent without a body */
};

struct condition {
    enum condition_kind kind;
    bool negated;
    int body, other; /* numbers of them; body CONDITION_ALL_ROBOTS: the mean over robots */
    size_t number;   /* offset in struct condition_numbers */
    enum condition_compare compare;
    double value;    /* compared with, or how near in metres */
    double x_m, y_m; /* of a place */
    char word[CONDITION_WORD_MAX], to[CONDITION_WORD_MAX]; /* "": any receiver */
};

/* The bodies that a condition may name: robots first, then things. */
struct condition_names {
    /* @return the number of a body, or -1 */
    int (*find)(const void *self, const char *name);
    const void *self;
    int robots; /* so many of the numbers are robots' */
    /* @return the index of an agent without a body, or -1; NULL: there are none */
    int (*find_agent)(const void *agents, const char *name);
    const void *agents;
};

/**
 * Reads a condition.
 *
 * @param why  CONDITION_WHY_MAX bytes, filled with the expectation if the text is malformed
 * @return MU_OK or MU_MALFORMED
 */
MU_MUST_USE mu_result condition_read(struct condition *c, const char *text,
                                     const struct condition_names *names, char *why);

/* How a step stands. */
struct condition_view {
    double time_s;
    const void *self;
    /* Fills in the numbers of a body; of a thing its position alone. */
    void (*numbers)(const void *self, int body, struct condition_numbers *out);
    bool (*stalled)(const void *self, int robot);
    bool (*counts)(const void *self, int robot); /* it has a controller */
    int robots;
};

/** @return whether it is so.  @param happened  of told and fired: an act of this step fits */
bool condition_holds(const struct condition *c, const struct condition_view *view, bool happened);

/* A condition that is looked at once a step. */
struct condition_watch {
    struct condition condition;
    bool happened; /* a mail or a rule of this step fits */
    bool was;      /* it was so at the step before */
};

/** A robot has fired these rules in the step, as a list in its act: condition_fired. */
void condition_note_rules(struct condition_watch *w, int robot, const char *rules);

/** A robot has sent a mail in the step: condition_told. */
void condition_note_mail(struct condition_watch *w, int robot, const char *content,
                         const char *dst);

/**
 * Looks whether it holds, which stays in was, at the end of a step.
 *
 * @return whether it has come true just now: a state when it begins, and a mail or a rule in every
 *         step that has one
 */
bool condition_watch_look(struct condition_watch *w, const struct condition_view *view);

/**
 * Says whether a mail fits `told`.
 *
 * @param content  CLIPS fields
 */
bool condition_told(const struct condition *c, const char *content, const char *to);

/** Says whether rules fired, names separated by spaces, have the one of `fired` among them. */
bool condition_fired(const struct condition *c, const char *rules);

#endif
