/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/mail/mail.h"

#include "broker/control/parts.h"
#include "muster/memory.h"

#include <string.h>

void glances_init(struct glances *g)
{
    for (uint32_t i = 0; i < MU_GLANCES_MAX; i++) {
        g->at[i].text = mu_startup_alloc(MU_GLANCE_BYTES_MAX);
    }
}

/* --- words ------------------------------------------------------------------------------------ */

/* Of one word too many nobody hears: its asker waits for as long as it wants to.
 * @return whether it will be heard */
static bool word_say(struct broker *b, const struct glances_word *word)
{
    struct glances *g = &b->glances;
    if (g->words_count == GLANCES_WORDS) {
        g->lost++;
        return false;
    }
    g->words[g->words_count++] = *word;
    places_wake(&b->places, word->place);
    return true;
}

static void glance_free(struct glances *g, struct glance *glance)
{
    glance->used = false;
    g->count--;
}

/* A glance whose word is lost would be kept for nobody. */
static void word_of(struct broker *b, struct glance *glance, uint32_t place, muster_GlanceWord word)
{
    bool said = word_say(b, &(struct glances_word){.place = place,
                                                   .word = word,
                                                   .glance = (uint32_t)(glance - b->glances.at),
                                                   .asker = glance->asker,
                                                   .agent = glance->agent,
                                                   .number = glance->number});
    if (!said) {
        glance_free(&b->glances, glance);
    }
}

static void word_remove(struct glances *g, uint32_t i)
{
    g->words_count--;
    memmove(&g->words[i], &g->words[i + 1], (g->words_count - i) * sizeof g->words[0]);
}

bool glances_next(struct broker *b, uint32_t place, muster_Glance *out)
{
    struct glances *g = &b->glances;
    uint32_t i = 0;
    while (i < g->words_count && g->words[i].place != place) {
        i++;
    }
    if (i == g->words_count) {
        return false;
    }
    const struct glances_word *w = &g->words[i];
    bool has_text = w->glance != MU_NONE && w->word != muster_GLANCE_DECLINED;
    g->open = i;
    *out = (muster_Glance){.word = w->word, .number = w->number};
    out->asker = sample_text(b->registry.agents[w->asker].name);
    out->agent = sample_text(b->registry.agents[w->agent].name);
    out->text = sample_text(has_text ? g->at[w->glance].text : "");
    return true;
}

void glances_sent(struct broker *b)
{
    struct glances *g = &b->glances;
    const struct glances_word *w = &g->words[g->open];
    if (w->word != muster_GLANCE_ASK && w->glance != MU_NONE) {
        glance_free(g, &g->at[w->glance]);
    }
    word_remove(g, g->open);
}

/* --- questions -------------------------------------------------------------------------------- */

/* @return a free place; NULL: there is none, or the asker's process has its share */
static struct glance *glance_take(struct glances *g, uint32_t from)
{
    struct glance *free = NULL;
    uint32_t own = 0;
    for (uint32_t i = 0; i < MU_GLANCES_MAX; i++) {
        free = g->at[i].used || free ? free : &g->at[i];
        own += g->at[i].used && g->at[i].from == from;
    }
    return own < MU_GLANCES_EACH ? free : NULL;
}

/* @return the place at which somebody can be asked; MU_NONE: there is none */
static uint32_t place_of(const struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    bool there = a->process != MU_NONE && !a->gone && a->is.state != muster_STATE_MOVING;
    return there && !b->places.at[a->process].is_broker ? a->process : MU_NONE;
}

static void ask_take(struct broker *b, uint32_t from, uint32_t asker, const muster_Glance *asked)
{
    struct glances *g = &b->glances;
    uint32_t agent = registry_find(&b->registry, asked->agent);
    uint32_t to = agent != MU_NONE ? place_of(b, agent) : MU_NONE;
    struct glance *glance = to != MU_NONE ? glance_take(g, from) : NULL;
    if (!glance || !guard_glances(b, asker, agent, asked->text)) {
        g->declined++;
        (void)word_say(b, &(struct glances_word){.place = from,
                                                 .word = muster_GLANCE_DECLINED,
                                                 .glance = MU_NONE,
                                                 .asker = asker,
                                                 .agent = agent != MU_NONE ? agent : asker,
                                                 .number = asked->number});
        return;
    }
    *glance = (struct glance){.used = true,
                              .asker = asker,
                              .agent = agent,
                              .number = asked->number,
                              .from = from,
                              .to = to,
                              .text = glance->text};
    memcpy(glance->text, asked->text, strlen(asked->text) + 1);
    g->count++;
    g->asked++;
    word_of(b, glance, to, muster_GLANCE_ASK);
}

/* --- answers ---------------------------------------------------------------------------------- */

static void glance_answer(struct broker *b, struct glance *glance, muster_GlanceWord word)
{
    b->glances.declined += word == muster_GLANCE_DECLINED;
    glance->to = MU_NONE;
    word_of(b, glance, glance->from, word);
}

static void answer_take(struct broker *b, uint32_t place, uint32_t asker,
                        const muster_Glance *answer)
{
    struct glances *g = &b->glances;
    for (uint32_t i = 0; i < MU_GLANCES_MAX; i++) {
        struct glance *glance = &g->at[i];
        if (glance->used && glance->to == place && glance->asker == asker &&
            glance->number == answer->number) {
            memcpy(glance->text, answer->text, strlen(answer->text) + 1);
            glance_answer(b, glance, answer->word);
            return;
        }
    }
}

void glances_hear(struct broker *b, uint32_t place, const muster_Glance *glance)
{
    uint32_t asker = registry_find(&b->registry, glance->asker);
    if (asker == MU_NONE) {
        b->counters.malformed++;
    } else if (glance->word != muster_GLANCE_ASK) {
        answer_take(b, place, asker, glance);
    } else if (b->registry.agents[asker].process == place) {
        ask_take(b, place, asker, glance);
    } else {
        b->counters.malformed++; /* in the name of somebody else */
    }
}

/* --- ends ------------------------------------------------------------------------------------- */

/* Nothing is to be told to a process, or of a glance, that is no more. */
static void words_drop(struct glances *g, uint32_t place, uint32_t glance)
{
    for (uint32_t i = g->words_count; i > 0; i--) {
        const struct glances_word *w = &g->words[i - 1];
        if (w->place == place || (glance != MU_NONE && w->glance == glance)) {
            word_remove(g, i - 1);
        }
    }
}

void glances_gone(struct broker *b, uint32_t place)
{
    struct glances *g = &b->glances;
    if (g->count == 0 && g->words_count == 0) {
        return;
    }
    words_drop(g, place, MU_NONE);
    for (uint32_t i = 0; i < MU_GLANCES_MAX; i++) {
        struct glance *glance = &g->at[i];
        if (glance->used && glance->from == place) {
            words_drop(g, place, i);
            glance_free(g, glance);
        } else if (glance->used && glance->to == place) {
            glance_answer(b, glance, muster_GLANCE_DECLINED);
        }
    }
}
