/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/probes.h"

#include "core/name.h"
#include "core/probe.h"
#include "core/text.h"
#include "runtime/process.h"

#include <string.h>

void probes_answer(mu_agent *a,
                   enum probe_end (*look)(void *self, const char *line, const char **text))
{
    a->probes.look = look;
}

void probes_hear(mu_agent *a,
                 void (*on_end)(void *self, uint64_t number, enum probe_end end, const char *text),
                 void *self)
{
    a->probes.on_end = on_end;
    a->probes.on_end_self = self;
}

/* --- questions -------------------------------------------------------------------------------- */

mu_result probes_ask(mu_agent *a, const char *agent, const char *line, uint64_t *number)
{
    mu_process *p = a->process;
    struct probes *g = &p->probes;
    if (process_takes_steps(p) || !mu_probe_is(line) || !mu_name_valid(agent)) {
        return MU_REFUSED;
    }
    if (g->count == MU_GLANCES_EACH || a->name_state != NAME_ACCEPTED) {
        return MU_FULL;
    }
    struct probes_asked *q = g->asked;
    while (q->asker) {
        q++;
    }
    *q = (struct probes_asked){.asker = a, .number = ++g->numbers};
    (void)mu_text_copy(q->agent, sizeof q->agent, agent);
    (void)mu_text_copy(q->line, sizeof q->line, line);
    *number = q->number;
    g->count++;
    g->unsent++;
    return MU_OK;
}

/* In the order of their numbers. */
static struct probes_asked *unsent_after(struct probes *g, uint64_t number)
{
    struct probes_asked *first = NULL;
    for (uint32_t i = 0; i < MU_GLANCES_EACH; i++) {
        struct probes_asked *q = &g->asked[i];
        bool later = q->asker && !q->out && q->number > number;
        first = later && (!first || q->number < first->number) ? q : first;
    }
    return first;
}

bool probes_fill(mu_process *p, muster_Up *up)
{
    struct probes *g = &p->probes;
    uint32_t count = 0;
    uint64_t number = 0;
    while (count < g->unsent) {
        struct probes_asked *q = unsent_after(g, number);
        number = q->number;
        g->out[count++] = (muster_Glance){.word = muster_GLANCE_ASK,
                                          .asker = q->asker->name,
                                          .number = q->number,
                                          .agent = q->agent,
                                          .text = q->line};
    }
    up->glances._buffer = g->out;
    up->glances._length = up->glances._maximum = count;
    return count > 0;
}

/* While an Up waits for the network, an asker may leave, and another may come.
 * @return NULL: it is no question any more */
static struct probes_asked *unsent_of(struct probes *g, const muster_Glance *asked)
{
    struct probes_asked *q = unsent_after(g, asked->number - 1);
    return asked->word == muster_GLANCE_ASK && q && q->number == asked->number ? q : NULL;
}

void probes_sent(mu_process *p, const muster_Up *up)
{
    struct probes *g = &p->probes;
    for (uint32_t i = 0; i < up->glances._length; i++) {
        struct probes_asked *q = unsent_of(g, &up->glances._buffer[i]);
        if (q) {
            q->out = true;
            g->unsent--;
            g->incarnation = p->link.incarnation;
        }
    }
}

static void question_end(mu_process *p, struct probes_asked *q, enum probe_end end,
                         const char *text)
{
    mu_agent *a = q->asker;
    q->asker = NULL;
    p->probes.count--;
    p->probes.unsent -= !q->out;
    if (a->probes.on_end && a->state != MU_GONE) {
        a->probes.on_end(a->probes.on_end_self, q->number, end, text);
    }
}

void probes_review(mu_process *p)
{
    struct probes *g = &p->probes;
    for (uint32_t i = 0; i < MU_GLANCES_EACH && g->count > 0; i++) {
        struct probes_asked *q = &g->asked[i];
        if (q->asker && q->out && g->incarnation != p->link.incarnation) {
            question_end(p, q, PROBE_DECLINED, "");
        }
    }
}

void probes_forget(mu_agent *a)
{
    struct probes *g = &a->process->probes;
    for (uint32_t i = 0; i < MU_GLANCES_EACH && g->count > 0; i++) {
        struct probes_asked *q = &g->asked[i];
        if (q->asker == a) {
            question_end(a->process, q, PROBE_DECLINED, "");
        }
    }
}

/* --- answers ---------------------------------------------------------------------------------- */

static void question_keep(struct probes *g, const muster_Glance *asked)
{
    if (g->due_count == MU_GLANCES_MAX) {
        return; /* of two brokers: an asker of the earlier one has none any more */
    }
    struct probes_due *due = &g->due[(g->due_first + g->due_count++) % MU_GLANCES_MAX];
    due->number = asked->number;
    (void)mu_text_copy(due->asker, sizeof due->asker, asked->asker);
    (void)mu_text_copy(due->agent, sizeof due->agent, asked->agent);
    (void)mu_text_copy(due->line, sizeof due->line, asked->text);
}

static void answer_take(mu_process *p, const muster_Glance *answer)
{
    for (uint32_t i = 0; i < MU_GLANCES_EACH; i++) {
        struct probes_asked *q = &p->probes.asked[i];
        if (q->asker && q->out && q->number == answer->number &&
            strcmp(q->asker->name, answer->asker) == 0) {
            question_end(p, q, (enum probe_end)answer->word, answer->text);
            return;
        }
    }
}

void probes_take(mu_process *p, const muster_Delivery *d)
{
    for (uint32_t i = 0; i < d->glances._length; i++) {
        const muster_Glance *g = &d->glances._buffer[i];
        if (g->word == muster_GLANCE_ASK) {
            question_keep(&p->probes, g);
        } else {
            answer_take(p, g);
        }
    }
}
