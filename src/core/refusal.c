/* SPDX-License-Identifier: Apache-2.0 */
#include "muster/refusal.h"

#include <string.h>

static const struct {
    const char *word, *text;
} refusals[] = {
#define X(name, word, text) {word, text},
    MU_REFUSALS(X)
#undef X
};

enum { COUNT = sizeof refusals / sizeof refusals[0] };

const char *mu_refusal_word(enum mu_refusal code)
{
    return (unsigned)code < COUNT ? refusals[code].word : "";
}

const char *mu_refusal_text(enum mu_refusal code)
{
    return (unsigned)code < COUNT ? refusals[code].text : "";
}

static enum mu_refusal word_find(const char *word, size_t len)
{
    for (int i = 1; i < COUNT; i++) {
        if (strlen(refusals[i].word) == len && memcmp(refusals[i].word, word, len) == 0) {
            return (enum mu_refusal)i;
        }
    }
    return MU_REFUSAL_NONE;
}

enum mu_refusal mu_refusal_named(const char *word)
{
    return word_find(word, strlen(word));
}

enum mu_refusal mu_refusal_of(const char *content)
{
    const char *word = content + strcspn(content, " ");
    word += *word == ' ';
    return word_find(word, strcspn(word, " "));
}
