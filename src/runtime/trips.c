/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/trips.h"

#include "core/clock.h"
#include "core/text.h"
#include "runtime/process.h"

#include <string.h>

static char nothing[1];

void trips_listen(mu_process *p, const struct trips *listener)
{
    p->trips.prompt = listener->prompt;
    p->trips.self = listener->self;
    p->trips.on_trip = listener->on_trip;
    p->trips.on_step_end = listener->on_step_end;
    p->trips.on_answered = listener->on_answered;
}

mu_result trips_say(mu_process *p, const muster_Trip *trip)
{
    struct trips *t = &p->trips;
    if (t->count == TRIPS_OUT_MAX) {
        return MU_FULL;
    }
    struct trips_word *w = &t->words[t->count];
    muster_Trip *out = &t->out[t->count++];
    (void)mu_text_copy(w->agent, sizeof w->agent, trip->agent ? trip->agent : "");
    (void)mu_text_copy(w->asker, sizeof w->asker, trip->asker ? trip->asker : "");
    (void)mu_text_copy(w->host, sizeof w->host, trip->host ? trip->host : "");
    (void)mu_text_copy(w->reason, sizeof w->reason, trip->reason ? trip->reason : "");
    *out = (muster_Trip){
        .word = trip->word, .state = trip->state, .epoch = trip->epoch, .slot = trip->slot};
    out->process = nothing;
    out->text = trip->text ? trip->text : nothing;
    return MU_OK;
}

void trips_set_under_way(mu_process *p, bool under_way)
{
    p->trips.under_way = under_way;
}

bool trips_fill(mu_process *p, muster_Up *up)
{
    struct trips *t = &p->trips;
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

void trips_sent(mu_process *p, uint32_t count)
{
    struct trips *t = &p->trips;
    MU_ASSERT(count <= t->count);
    t->count -= count;
    memmove(t->words, t->words + count, t->count * sizeof t->words[0]);
    memmove(t->out, t->out + count, t->count * sizeof t->out[0]);
}

size_t trips_bytes(const mu_process *p)
{
    size_t bytes = 0;
    for (uint32_t i = 0; i < p->trips.count; i++) {
        bytes += strlen(p->trips.out[i].text);
    }
    return bytes;
}

void trips_take(mu_process *p, const muster_Delivery *d)
{
    for (uint32_t i = 0; i < d->trips._length && p->trips.on_trip; i++) {
        p->trips.on_trip(p->trips.self, &d->trips._buffer[i]);
    }
}

bool trips_awaits_step(const mu_process *p)
{
    return process_in_lockstep(p) ||
           (p->step_wall_ns && mu_clock_ns() - p->step_wall_ns < PROCESS_STEP_PATIENCE_NS);
}

bool trips_fits_answer(const mu_agent *a)
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

bool trips_all_sent(const mu_agent *a)
{
    return a->name_state == NAME_ACCEPTED && !outbox_has_unsent(&a->outbox) &&
           a->process->up_state != UP_PENDING;
}

uint32_t trips_slot(const mu_agent *a)
{
    return (uint32_t)(a - a->process->agents);
}
