/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file facts.h
 * What the engine is told from outside, as facts: percepts.
 */
#ifndef MUSTER_MIND_FACTS_FACTS_H
#define MUSTER_MIND_FACTS_FACTS_H

#include "mind/clips_mind.h"

/* fact.c */

/** Takes the reference to a fact back, retracting it if it is still there. */
void fact_retract(struct mind *m, struct fact **fact);

/** Asserts an ordered fact of one multifield; keeps a reference for the caller.  NULL: refused. */
struct fact *fact_assert(struct mind *m, struct deftemplate *template, struct multifield *fields);

/** @return whether a pattern or a query of some construct looks at facts of that template, or
 * somebody watches them */
bool fact_is_used(const struct deftemplate *template);

/* sensors.c */

/** Rules look at the facts, or call the function, of that name: its sensor is wanted from now on.
 */
void sensors_note(struct mind *m, const char *word);

/** @return the colour's name, or #rrggbb in bytes */
const char *sensors_color(uint32_t rgb, char bytes[8]);

/** Writes four fields: colour, bearing deg, width deg, range mm. */
void sensors_set_blob(struct mind *m, const struct mu_blob *b, struct multifield *fields,
                      size_t at);

/** Writes four fields: number, bearing deg, range mm, heading deg. */
void sensors_set_fiducial(struct mind *m, const struct mu_fiducial *f, struct multifield *fields,
                          size_t at);

/** Writes time s, x mm, y mm, speed mm/s, turn rate deg/s, compass deg in (-180, 180]. */
void sensors_set_position(const struct mu_percept *p, double out[6]);

/* percept.c */

/* Numbers of a percept that every body has; the order is that of a capsule. */
enum { PERCEPT_REALS = 12 };

/** Says where they are. */
void percept_reals(struct mu_percept *p, double *reals[PERCEPT_REALS]);

/** Makes the percept facts that no rule has a pattern of, for somebody who looks at facts. */
void percept_show(struct mind *m);

/** Replaces the percept and its facts. */
void percept_take(struct mind *m, const struct mu_percept *p);

/** There is no percept any more: its facts go, the time stays. */
void percept_lose(struct mind *m, uint64_t time_ns);

#endif
