/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file clips_post.h
 * Fields as text, and what the functions of rules that write mail share.
 */
#ifndef MUSTER_AGENT_CLIPS_POST_H
#define MUSTER_AGENT_CLIPS_POST_H

#include "mind/clips_mind.h"

/* A letter in which nothing is said. */
extern const struct mind_letter send_blank;

/** Adds a field as it reads back.  @return false: an address or a number that is not finite */
bool send_field(struct mu_text *out, unsigned short type, const void *value);

/** Evaluates the arguments from first on, as one multifield.  @return false, after a CLIPS error */
bool send_fields(void *env, const char *function, int first, DATA_OBJECT *fields);

/** Adds a field, or all of a multifield.  @return false, after a CLIPS error: cannot be mailed */
bool send_content(void *env, const char *function, const DATA_OBJECT *fields, struct mu_text *out);

/**
 * Reads an argument that says for whom a mail is: a name, an address, or a multifield of names.
 *
 * @param wanted  what a CLIPS error is to say
 * @return the address, until the next call; NULL, after a CLIPS error
 */
const char *send_address(void *env, const char *function, int index, const char *wanted);

/** Writes a word for a question that this agent has not used yet.  @return to */
const char *send_question(void *env, char *to, size_t size);

/** Hands a letter over: FALSE when there is no room, else TRUE or the word that the answer bears.
 */
void send_hand(void *env, const struct mind_letter *letter, DATA_OBJECT *out);

/** (send WHO field...) to an agent; the instance case is taken before. */
void send_agent(void *env, DATA_OBJECT *out);

#endif
