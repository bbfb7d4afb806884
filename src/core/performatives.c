/* SPDX-License-Identifier: Apache-2.0 */
#include "core/performatives.h"

#include "muster/kind.h"

#include <stdlib.h>
#include <string.h>

enum { K = MU_OF_KQML, F = MU_OF_FIPA, A = MU_OF_ANSWERS };

/* In order of word, for the search. */
static const struct mu_performative table[] = {
    {"accept-proposal", F | A},
    {"achieve", K},
    {"advertise", K},
    {"agree", F | A},
    {"ask", K},
    {"ask-about", K},
    {"ask-all", K},
    {"ask-if", K},
    {"ask-one", K},
    {"break", K},
    {"broadcast", K},
    {"broker-all", K},
    {"broker-one", K},
    {"cancel", F},
    {"cfp", F},
    {"confirm", F},
    {"delete", K},
    {"delete-all", K},
    {"delete-one", K},
    {"deny", K},
    {"discard", K},
    {"disconfirm", F},
    {"eos", K | A},
    {"error", K | A},
    {"evaluate", K},
    {"failure", F | A},
    {"forward", K},
    {"generator", K},
    {"inform", F},
    {"inform-if", F},
    {"inform-ref", F},
    {"insert", K},
    {"monitor", K},
    {"next", K},
    {"not-understood", F | A},
    {"pipe", K},
    {"propagate", F},
    {"propose", F},
    {"proxy", F},
    {"query-if", F},
    {"query-ref", F},
    {"ready", K | A},
    {"recommend-all", K},
    {"recommend-one", K},
    {"recruit-all", K},
    {"recruit-one", K},
    {"refuse", F | A},
    {"register", K},
    {"reject-proposal", F | A},
    {"reply", K | A},
    {"request", F},
    {"request-when", F},
    {"request-whenever", F},
    {"rest", K},
    {"sorry", K | A},
    {"standby", K},
    {"stream-about", K},
    {"stream-all", K},
    {"subscribe", K | F},
    {"tell", K},
    {"transport-address", K},
    {"unachieve", K},
    {"unadvertise", K},
    {"undelete", K},
    {"uninsert", K},
    {"unregister", K},
    {"untell", K},
};
enum { PERFORMATIVES = sizeof table / sizeof table[0] };

const struct mu_performative *mu_performative_at(size_t index)
{
    return index < PERFORMATIVES ? &table[index] : NULL;
}

static int word_compare(const void *word, const void *row)
{
    return strcmp(word, ((const struct mu_performative *)row)->word);
}

const struct mu_performative *mu_performative_find(const char *word)
{
    return bsearch(word, table, PERFORMATIVES, sizeof table[0], word_compare);
}

bool mu_performative_answers(const char *word)
{
    const struct mu_performative *found = mu_performative_find(word);
    return found && (found->of & MU_OF_ANSWERS);
}

bool mu_performative_known(const char *performative)
{
    return performative && mu_performative_find(performative) != NULL;
}
