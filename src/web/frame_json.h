/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file frame_json.h
 * A Frame as the page reads it: numbers in the order of the Scene, whole millimetres, milliradians
 * and milliseconds; of what agents said, as much as a person can take in.
 *
 *     robots    [x, y, heading, forward, turn, told forward, told turn, flags], ...
 *               flags: the state, 8 if stalled, 16 if the simulator had to put it back
 *     objects   [x, y, heading], ...
 *     sonar     [robot's index, beams], ...        beams.h
 *     laser     likewise
 *     fired     [robot's index, how many, rules], ...
 *     mails     [from, to, performative, content], ...
 *     goals     what each robot wants, "" for who does not say; empty when nobody does
 *     orders    [source, order, name], ...
 *
 * Pure.
 */
#ifndef MUSTER_WEB_FRAME_JSON_H
#define MUSTER_WEB_FRAME_JSON_H

#include "core/json.h"
#include "wire.h"

enum {
    FRAME_JSON_MAILS_MAX = 64,   /* shown of a step */
    FRAME_JSON_CONTENT_MAX = 96, /* bytes shown of a mail */
    FRAME_JSON_RULES_MAX = 240   /* of the rules that a robot fired */
};

/** Writes one object.  @param key  NULL: it has none.  @param lean  with empty lists of readings */
void frame_json_write(struct mu_json *j, const char *key, const muster_Frame *frame, bool lean);

/**
 * Writes the totals of a Frame as one object:
 *
 *     robots    [distance, stalls, stalled, firings, sent, received], ...    mm, ms
 */
void frame_json_totals(struct mu_json *j, const char *key, const muster_Frame *frame);

/** Writes a mail of a step as [step, from, to, performative, content]. */
void frame_json_mail(struct mu_json *j, int64_t step, const muster_Mail *mail);

#endif
