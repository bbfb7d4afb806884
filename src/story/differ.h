/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file differ.h
 * Where two recordings of one run part: the first step, who, and which value.
 */
#ifndef MUSTER_STORY_DIFFER_H
#define MUSTER_STORY_DIFFER_H

#include "muster/limits.h"
#include "story/recording.h"

enum { DIFFER_WHAT_MAX = 64, DIFFER_VALUE_MAX = 160 };

struct difference {
    int64_t step;
    char who[MU_NAME_MAX + 1]; /* a robot, an object, a sender; "": the run */
    char what[DIFFER_WHAT_MAX];
    char one[DIFFER_VALUE_MAX], other[DIFFER_VALUE_MAX]; /* the values; long ones are cut */
};

/**
 * Compares two recordings from their first steps on: poses and motion bit by bit, commands, mails,
 * rules fired, what came from outside, and minds' diaries where both have them.
 *
 * @param one  of a run that did not come to its end: then its last Frame is compared for how the
 *     world was left, and what the other has beyond it is no difference.  If both broke off, the
 *     other may lack that Frame
 * @param d  out: the first difference
 * @return false: there is none
 */
bool differ_find(struct recording *one, struct recording *other, struct difference *d);

/** Compares one step's Frames.  @return as differ_find */
bool differ_frames(const muster_Frame *one, const muster_Frame *other, struct difference *d);

#endif
