/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/transfers.h"

#include "core/clock.h"
#include "core/text.h"
#include "runtime/process.h"

#include <string.h>

static char nothing[1];

void transfers_listen(mu_process *p, const struct transfers *listener)
{
    p->transfers.prompt = listener->prompt;
    p->transfers.self = listener->self;
    p->transfers.on_word = listener->on_word;
    p->transfers.on_step_end = listener->on_step_end;
    p->transfers.on_answered = listener->on_answered;
}

mu_result transfers_say(mu_process *p, const muster_Trip *word)
{
    struct transfers *t = &p->transfers;
    if (t->count == TRANSFERS_OUT_MAX) {
        return MU_FULL;
    }
    struct transfer_word *w = &t->words[t->count];
    muster_Trip *out = &t->out[t->count++];
    (void)mu_text_copy(w->agent, sizeof w->agent, word->agent ? word->agent : "");
    (void)mu_text_copy(w->asker, sizeof w->asker, word->asker ? word->asker : "");
    (void)mu_text_copy(w->host, sizeof w->host, word->host ? word->host : "");
    (void)mu_text_copy(w->reason, sizeof w->reason, word->reason ? word->reason : "");
    *out = (muster_Trip){
        .word = word->word, .state = word->state, .epoch = word->epoch, .slot = word->slot};
    out->process = nothing;
    out->text = word->text ? word->text : nothing;
    return MU_OK;
}

void transfers_set_under_way(mu_process *p, bool under_way)
{
    p->transfers.under_way = under_way;
}

bool transfers_fill(mu_process *p, muster_Up *up)
{
    struct transfers *t = &p->transfers;
    for (uint32_t i = 0; i < t->count; i++) {
        t->out[i].agent = t->words[i].agent;
        t->out[i].asker = t->words[i].asker;
        t->out[i].host = t->words[i].host;
        t->out[i].reason = t->words[i].reason;
    }
    up->trips._buffer = t->out;
    up->trips._length = up->trips._maximum = t->count;
    return t->count > 0;
}

void transfers_sent(mu_process *p, uint32_t count)
{
    struct transfers *t = &p->transfers;
    MU_ASSERT(count <= t->count);
    t->count -= count;
    memmove(t->words, t->words + count, t->count * sizeof t->words[0]);
    memmove(t->out, t->out + count, t->count * sizeof t->out[0]);
}

size_t transfers_bytes(const mu_process *p)
{
    size_t bytes = 0;
    for (uint32_t i = 0; i < p->transfers.count; i++) {
        bytes += strlen(p->transfers.out[i].text);
    }
    return bytes;
}

void transfers_take(mu_process *p, const muster_Delivery *d)
{
    for (uint32_t i = 0; i < d->trips._length && p->transfers.on_word; i++) {
        p->transfers.on_word(p->transfers.self, &d->trips._buffer[i]);
    }
}

bool transfers_awaits_step(const mu_process *p)
{
    return process_in_lockstep(p) ||
           (p->step_wall_ns && mu_clock_ns() - p->step_wall_ns < PROCESS_STEP_PATIENCE_NS);
}

bool transfers_fits_answer(const mu_agent *a)
{
    const mu_process *p = a->process;
    uint32_t count = outbox_unsent(&a->outbox, p->mails, PROCESS_UP_MAILS);
    size_t bytes = 0;
    for (uint32_t i = 0; i < count; i++) {
        bytes += strlen(p->mails[i].content) + sizeof p->mails[i];
    }
    bool whole = a->outbox.unsent_seq + count == a->outbox.next_seq;
    return count == 0 || (whole && bytes <= PROCESS_UP_BYTES);
}

bool transfers_all_sent(const mu_agent *a)
{
    return a->name_state == NAME_ACCEPTED && !outbox_has_unsent(&a->outbox) &&
           a->process->up_state != UP_PENDING;
}

uint32_t transfers_slot(const mu_agent *a)
{
    return (uint32_t)(a - a->process->agents);
}
