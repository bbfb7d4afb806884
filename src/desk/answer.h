/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file answer.h
 * An answer to the command line's mail, as a person or a program wants it.
 */
#ifndef MUSTER_DESK_ANSWER_H
#define MUSTER_DESK_ANSWER_H

#include "muster/agent.h"
#include "muster/directory.h"

#include <stdio.h>

/** @return whether it says that the mail was of no use: refuse, not-understood, failure */
bool answer_is_failure(const struct mu_mail *mail);

/** @return MU_EXIT_DONE; MU_EXIT_REFUSED: another agent has the name, the agent or its state does
 *          not allow it, or the trust policy; MU_EXIT_UNDELIVERED for any other failure */
int answer_exit(const struct mu_mail *mail);

/** Prints what an agent says; on a terminal "?" stands for what would steer it. */
void answer_text_print(FILE *to, const char *text);

/** Prints likewise what an answer says, as a line; content that is a single CLIPS string without
 * quotes. */
void answer_content_print(FILE *to, const char *content);

/** Prints it on standard output, or, if it is a refusal, why on standard error. */
void answer_print(const struct mu_mail *mail, bool json);

/** @return the exit code for what became of a mail */
int answer_outcome_exit(enum mu_outcome outcome);

/** @return what follows the outcome's word in a message to a person; "": nothing.  @param to  whom
 * the mail was for */
const char *answer_outcome_advice(enum mu_outcome outcome, const char *to);

/** @return what is meant by the code in why an agent stays, such as `red unknown-host`; NULL:
 *          that says enough */
const char *answer_travel_advice(const char *content);

#endif
