/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file refusal.h
 * Why something is refused: codes on the wire (Refusal in idl/wire.idl), and words in the content
 * of an answer.  docs/reference/refusals.md is printed from the table.
 */
#ifndef MUSTER_CORE_REFUSAL_H
#define MUSTER_CORE_REFUSAL_H

/* The numbers are those of Refusal in idl/wire.idl. */
enum mu_refusal {
    MU_REFUSAL_NONE,
    MU_REFUSAL_NAME_HELD,
    MU_REFUSAL_NOT_A_NAME,
    MU_REFUSAL_FULL,
    MU_REFUSAL_UNKNOWN_HOST,
    MU_REFUSAL_HOST_ABSENT,
    MU_REFUSAL_HERE_ALREADY,
    MU_REFUSAL_NAME_TAKEN,
    MU_REFUSAL_BUSY,
    MU_REFUSAL_TOO_LARGE,
    MU_REFUSAL_STATE,
    MU_REFUSAL_UNSUPPORTED,
    MU_REFUSALS
};

/** @return the word of a code; "" of MU_REFUSAL_NONE and of a number that is none */
const char *mu_refusal_word(enum mu_refusal code);

/** @return what a person is told of a code; "" of MU_REFUSAL_NONE and of a number that is none */
const char *mu_refusal_text(enum mu_refusal code);

/**
 * Finds the code in an answer.  Its second word is the code's: `suspend wrong-state standby`,
 * `red unknown-host`.
 *
 * @return MU_REFUSAL_NONE if it is not
 */
enum mu_refusal mu_refusal_of(const char *content);

#endif
