/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file past.h
 * A recorded run, as the page reads it: any moment of it, with what was in a robot's mind, and why
 * a robot drove as it did.
 *
 * Memory is taken when it is opened, which reads the recording through once.
 */
#ifndef MUSTER_WEB_PAST_H
#define MUSTER_WEB_PAST_H

#include "muster/limits.h"
#include "story/recording.h"
#include "web/board.h"

enum {
    PAST_TEXT_MAX = 2 * 1024 * 1024, /* bytes of an answer */
    PAST_STALLS_MAX = 4096,          /* that are shown */
    PAST_LATELY_STEPS = 30,          /* so long mails are shown */
    PAST_MAILS_MAX = 200,            /* of that time, the first ones */
    PAST_PLACES_MAX = 60000          /* of all tracks together */
};

/* From the first step that found a robot stalled to the last. */
struct past_stall {
    uint32_t robot;
    int64_t from, to;
};

/* Where a robot was, whole millimetres. */
struct past_place {
    int32_t x_mm, y_mm;
};

/* Where all robots were: each step, or of a long recording each second, third, ... one. */
struct past_tracks {
    size_t robots, every;
    int64_t *steps;            /* of rows */
    struct past_place *places; /* row by row, the robots in the order of the Scene */
    size_t rows, rows_max;
};

struct past {
    struct recording recording;
    struct past_stall stalls[PAST_STALLS_MAX];
    size_t stalls_count;
    size_t stalls_last[MU_ROBOTS_MAX]; /* of each robot: its last one's index, and 1; 0: none */
    uint64_t stalls_lost;              /* that found no room */
    struct past_tracks tracks;
    struct mu_text text; /* the last answer */
    const char *name;    /* of the file */
};

/** Opens a recording.  @return MU_OK; MU_FAULT_FILE */
MU_MUST_USE mu_result past_open(struct past *p, const char *path, struct mu_fault *fault);

/** Puts its scene on the board. */
void past_show(const struct past *p, struct board *board);

/**
 * Writes what there is:
 *
 *     name, first, last (steps), step_ms
 *     robots    those that have a diary
 *     stalls    [robot's index, first step, last step], ...
 *
 * @return the text, good until the next question
 */
const struct mu_text *past_whole(struct past *p);

/**
 * Writes where robots were:
 *
 *     steps     those of the places
 *     robots    of each [x, y, x, y, ...], whole millimetres
 *
 * @return the text, good until the next question; NULL: it is too long
 */
const struct mu_text *past_tracks(struct past *p);

/**
 * Writes the moment at the end of a step, or of the last one before it that there is:
 *
 *     frame       as frame_json.h
 *     statistics  as frame_json_totals
 *     lately      [step, from, to, performative, content], ...    mails of the steps before it
 *     mind        as mind_json.h, if somebody's was asked for
 *
 * @param robot  whose mind; "": nobody's
 * @return the text, good until the next question; NULL: there is no step at all, or it is too long
 */
const struct mu_text *past_moment(struct past *p, int64_t step, const char *robot);

/**
 * Writes why a robot's motors did what they did at a step, as indented lines.
 *
 * @return the text, good until the next question; NULL: it has no diary
 */
const struct mu_text *past_why(struct past *p, int64_t step, const char *robot);

void past_close(struct past *p);

#endif
