/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file clips_sense.h
 * Sensors that are read only if rules look at them, and what they read as fields.
 */
#ifndef MUSTER_AGENT_CLIPS_SENSE_H
#define MUSTER_AGENT_CLIPS_SENSE_H

#include "mind/clips_mind.h"

/** Gives the functions of sensors a parser that notes who is called. */
void clips_sense_install(struct mind *m);

/** Rules look at the facts, or call the function, of that name: its sensor is wanted from now on.
 */
void clips_sense_note(struct mind *m, const char *word);

/** @return whether a pattern or a query of some construct looks at facts of that template, or
 * somebody watches them */
bool clips_sense_is_used(const struct deftemplate *template);

/** Writes four fields: colour, bearing deg, width deg, range mm. */
void clips_sense_blob(struct mind *m, const struct mu_blob *b, struct multifield *fields,
                      size_t at);

/** Writes four fields: number, bearing deg, range mm, heading deg. */
void clips_sense_fiducial(struct mind *m, const struct mu_fiducial *f, struct multifield *fields,
                          size_t at);

#endif
