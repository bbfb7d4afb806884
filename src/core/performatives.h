/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file performatives.h
 * The words for the intent of a mail: KQML's (Finin and others, 1993; Labrou and Finin, 1997) and
 * FIPA's (SC00037J).
 */
#ifndef MUSTER_CORE_PERFORMATIVES_H
#define MUSTER_CORE_PERFORMATIVES_H

#include <stdbool.h>
#include <stddef.h>

enum {
    MU_OF_KQML = 1,
    MU_OF_FIPA = 2,
    MU_OF_ANSWERS = 4, /* said in answer to a mail, and only so */
};

struct mu_performative {
    const char *word;
    unsigned of;
};

/** @return the index-th performative in order of word; NULL past the last */
const struct mu_performative *mu_performative_at(size_t index);

/** @return the row of a word; NULL: neither KQML nor FIPA has it */
const struct mu_performative *mu_performative_find(const char *word);

/** @return whether the word only ever answers: to it nothing is answered unless it asks for it */
bool mu_performative_answers(const char *word);

#endif
