/* SPDX-License-Identifier: Apache-2.0 */
#include "core/refusal.h"

#include <string.h>

static const struct {
    const char *word, *text;
} refusals[MU_REFUSALS] = {
    [MU_REFUSAL_NONE] = {"", ""},
    [MU_REFUSAL_NAME_HELD] = {"held", "another agent has that name"},
    [MU_REFUSAL_NOT_A_NAME] = {"not-a-name", "that cannot be the name of an agent"},
    [MU_REFUSAL_FULL] = {"full", "the broker has no room for another name"},
    [MU_REFUSAL_UNKNOWN_HOST] = {"unknown-host",
                                 "there is no host of that name; muster ps lists them"},
    [MU_REFUSAL_HOST_ABSENT] = {"host-absent", "that host is there no more; muster ps lists them"},
    [MU_REFUSAL_HERE_ALREADY] = {"here-already", "it is on that host"},
    [MU_REFUSAL_NAME_TAKEN] = {"name-taken", "somebody has that name; muster ps lists all"},
    [MU_REFUSAL_BUSY] = {"busy", "its process sends another agent on its way; try again"},
    [MU_REFUSAL_TOO_LARGE] = {"too-large", "it has more facts and rules than fit into 1 MiB"},
    [MU_REFUSAL_STATE] = {"wrong-state", "its state does not allow that"},
    [MU_REFUSAL_UNSUPPORTED] = {"unsupported", "it is no agent that can be told so"},
};

const char *mu_refusal_word(enum mu_refusal code)
{
    return (unsigned)code < MU_REFUSALS ? refusals[code].word : "";
}

const char *mu_refusal_text(enum mu_refusal code)
{
    return (unsigned)code < MU_REFUSALS ? refusals[code].text : "";
}

enum mu_refusal mu_refusal_of(const char *content)
{
    const char *word = content + strcspn(content, " ");
    word += *word == ' ';
    size_t len = strcspn(word, " ");
    for (int i = 1; i < MU_REFUSALS; i++) {
        if (strlen(refusals[i].word) == len && memcmp(refusals[i].word, word, len) == 0) {
            return (enum mu_refusal)i;
        }
    }
    return MU_REFUSAL_NONE;
}
