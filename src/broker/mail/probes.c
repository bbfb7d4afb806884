/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"

/* --- words ------------------------------------------------------------------------------------ */

static void probe_free(struct probes *g, struct probe *probe)
{
    probe->used = false;
    g->count--;
}

/* One word too many is not heard: its asker waits for as long as it wants to, and the probe, if it
 * is kept, would be in vain. */
static void word_say(struct broker *b, struct probe *of, uint32_t place, muster_GlanceWord word)
{
    struct probes *g = &b->probes;
    if (g->words_count < PROBES_WORDS) {
        uint32_t kept = of->used ? (uint32_t)(of - g->at) : MU_NONE;
        g->words[g->words_count++] = (struct probes_word){.place = place,
                                                          .word = word,
                                                          .probe = kept,
                                                          .asker = of->asker,
                                                          .agent = of->agent,
                                                          .number = of->number};
        processes_wake(&b->processes, place);
        return;
    }
    g->lost++;
    if (of->used) {
        probe_free(g, of);
    }
}

bool probes_next(struct broker *b, uint32_t place, muster_Glance *out)
{
    struct probes *g = &b->probes;
    uint32_t i = 0;
    while (i < g->words_count && g->words[i].place != place) {
        i++;
    }
    if (i == g->words_count) {
        return false;
    }
    const struct probes_word *w = &g->words[i];
    bool has_text = w->probe != MU_NONE && w->word != muster_GLANCE_DECLINED;
    g->open = i;
    *out = (muster_Glance){.word = w->word, .number = w->number};
    out->asker = sample_text(b->registry.agents[w->asker].name);
    out->agent = sample_text(b->registry.agents[w->agent].name);
    out->text = sample_text(has_text ? g->texts[w->probe] : "");
    return true;
}

void probes_sent(struct broker *b)
{
    struct probes *g = &b->probes;
    const struct probes_word *w = &g->words[g->open];
    if (w->word != muster_GLANCE_ASK && w->probe != MU_NONE) {
        probe_free(g, &g->at[w->probe]);
    }
    array_remove(g->words, sizeof g->words[0], &g->words_count, g->open);
}

/* --- questions -------------------------------------------------------------------------------- */

/* @return a free place; NULL: there is none, or the asker's process has its share */
static struct probe *probe_take(struct probes *g, uint32_t from)
{
    struct probe *free = NULL;
    uint32_t own = 0;
    for (uint32_t i = 0; i < MU_GLANCES_MAX; i++) {
        free = g->at[i].used || free ? free : &g->at[i];
        own += g->at[i].used && g->at[i].from == from;
    }
    return own < MU_GLANCES_EACH ? free : NULL;
}

/* @return the process in which an agent can be asked; MU_NONE: there is none */
static uint32_t process_of(const struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    bool there =
        a->process != MU_NONE && a->report != REPORT_GONE && a->is.state != muster_STATE_MOVING;
    return there && b->processes.at[a->process].kind != PROCESS_BROKER ? a->process : MU_NONE;
}

static void ask_take(struct broker *b, uint32_t from, uint32_t asker, const muster_Glance *asked)
{
    struct probes *g = &b->probes;
    uint32_t agent = registry_find(&b->registry, asked->agent);
    uint32_t to = agent != MU_NONE ? process_of(b, agent) : MU_NONE;
    struct probe *probe = to != MU_NONE ? probe_take(g, from) : NULL;
    struct probe begun = {.asker = asker,
                          .agent = agent != MU_NONE ? agent : asker,
                          .number = asked->number,
                          .from = from,
                          .to = to};
    if (!probe || !authorize_probe(b, asker, agent, asked->text)) {
        g->declined++;
        word_say(b, &begun, from, muster_GLANCE_DECLINED);
        return;
    }
    *probe = begun;
    probe->used = true;
    memcpy(g->texts[probe - g->at], asked->text, strlen(asked->text) + 1);
    g->count++;
    g->asked++;
    word_say(b, probe, to, muster_GLANCE_ASK);
}

/* --- answers ---------------------------------------------------------------------------------- */

static void probe_answer(struct broker *b, struct probe *probe, muster_GlanceWord word)
{
    b->probes.declined += word == muster_GLANCE_DECLINED;
    probe->to = MU_NONE;
    word_say(b, probe, probe->from, word);
}

static void answer_take(struct broker *b, uint32_t place, uint32_t asker,
                        const muster_Glance *answer)
{
    struct probes *g = &b->probes;
    for (uint32_t i = 0; i < MU_GLANCES_MAX; i++) {
        struct probe *probe = &g->at[i];
        if (probe->used && probe->to == place && probe->asker == asker &&
            probe->number == answer->number) {
            memcpy(g->texts[i], answer->text, strlen(answer->text) + 1);
            probe_answer(b, probe, answer->word);
            return;
        }
    }
}

void probes_hear(struct broker *b, uint32_t place, const muster_Glance *probe)
{
    uint32_t asker = registry_find(&b->registry, probe->asker);
    if (asker == MU_NONE) {
        b->counters.malformed++;
    } else if (probe->word != muster_GLANCE_ASK) {
        answer_take(b, place, asker, probe);
    } else if (b->registry.agents[asker].process == place) {
        ask_take(b, place, asker, probe);
    } else {
        b->counters.malformed++; /* in the name of another agent */
    }
}

/* --- ends ------------------------------------------------------------------------------------- */

/* Nothing is to be told to a process, or of a probe, that is no more. */
static void words_drop(struct probes *g, uint32_t place, uint32_t probe)
{
    for (uint32_t i = g->words_count; i > 0; i--) {
        const struct probes_word *w = &g->words[i - 1];
        if (w->place == place || (probe != MU_NONE && w->probe == probe)) {
            array_remove(g->words, sizeof g->words[0], &g->words_count, i - 1);
        }
    }
}

void probes_gone(struct broker *b, uint32_t place)
{
    struct probes *g = &b->probes;
    if (g->count == 0 && g->words_count == 0) {
        return;
    }
    words_drop(g, place, MU_NONE);
    for (uint32_t i = 0; i < MU_GLANCES_MAX; i++) {
        struct probe *probe = &g->at[i];
        if (probe->used && probe->from == place) {
            words_drop(g, place, i);
            probe_free(g, probe);
        } else if (probe->used && probe->to == place) {
            probe_answer(b, probe, muster_GLANCE_DECLINED);
        }
    }
}
