/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file clips_post.h
 * Fields as text, and the functions of rules that write mail.
 */
#ifndef MUSTER_AGENT_CLIPS_POST_H
#define MUSTER_AGENT_CLIPS_POST_H

#include "agent/clips_mind.h"

/** Adds a field as it reads back.  @return false: an address or a number that is not finite */
bool clips_post_field(struct mu_text *out, unsigned short type, const void *value);

/** (send WHO field...) to an agent; the instance case is taken before. */
void clips_post_send(void *env, DATA_OBJECT *out);

#endif
