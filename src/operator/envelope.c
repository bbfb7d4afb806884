/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include <stdio.h>
#include <string.h>

struct choice {
    const char *word;
    int value;
};

static const struct choice levels[] = {
    {"ram", MU_LEVEL_RAM}, {"logged", MU_LEVEL_LOGGED}, {"synced", MU_LEVEL_SYNCED}, {NULL, 0}};
static const struct choice priorities[] = {{"low", MU_PRIORITY_LOW},
                                           {"normal", MU_PRIORITY_NORMAL},
                                           {"high", MU_PRIORITY_HIGH},
                                           {NULL, 0}};

/* @return false: said */
static bool choice_read(const struct choice *choices, const char *word, const char *where,
                        int *value)
{
    char shown[MU_TEXT_SHOWN];
    const struct choice *c = choices;
    while (word && c->word && strcmp(c->word, word) != 0) {
        c++;
    }
    if (!c->word) {
        fprintf(stderr, "muster %s '%s': expected %s, %s or %s\n", where, mu_text_show(shown, word),
                choices[0].word, choices[1].word, choices[2].word);
        return false;
    }
    *value = word ? c->value : *value;
    return true;
}

/* @return false: said */
static bool field_check(const char *verb, const char *option, const char *field)
{
    if (field && (strlen(field) > MU_FIELD_MAX || !words_are_utf8(field))) {
        fprintf(stderr, "muster %s --%s: expected at most %d bytes of UTF-8\n", verb, option,
                MU_FIELD_MAX);
        return false;
    }
    return true;
}

bool envelope_fill(const struct envelope *e, struct mu_mail *mail, const char *verb)
{
    char where[64];
    int level = MU_LEVEL_RAM, priority = MU_PRIORITY_NORMAL;
    const struct {
        const char *option, *field;
    } fields[] = {{"performative", e->performative},
                  {"language", e->language},
                  {"ontology", e->ontology},
                  {"conversation", e->conversation},
                  {"reply-with", e->reply_with}};
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++) {
        if (!field_check(verb, fields[i].option, fields[i].field)) {
            return false;
        }
    }
    snprintf(where, sizeof where, "%s --level", verb);
    bool good = choice_read(levels, e->level, where, &level);
    snprintf(where, sizeof where, "%s --priority", verb);
    if (!good || !choice_read(priorities, e->priority, where, &priority)) {
        return false;
    }
    mail->layer = (uint32_t)e->layer;
    mail->performative = e->performative;
    mail->language = e->language;
    mail->ontology = e->ontology;
    mail->conversation = e->conversation;
    mail->reply_with = e->reply_with;
    mail->level = (enum mu_level)level;
    mail->priority = (enum mu_priority)priority;
    mail->ttl_ns = (uint64_t)(e->ttl_s * 1e9);
    mail->reply_by_ns = (uint64_t)(e->reply_by_s * 1e9);
    return true;
}
