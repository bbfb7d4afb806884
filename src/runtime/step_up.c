/* SPDX-License-Identifier: Apache-2.0 */
/* The Up: what a process answers to a step, and says outside of one. */
#include "core/clock.h"
#include "runtime/process.h"

#include <string.h>

/* Mail that went out and has no answer after this long, by the wall, goes out again. */
static const uint64_t RESEND_NS = 1000000000;

static uint32_t acks_fill(mu_process *p)
{
    uint32_t count = 0;
    struct mu_agent *next = NULL;
    for (struct mu_agent *a = queue_first(p, QUEUE_ACK); a && count < p->acks_max; a = next) {
        next = queue_next(a, QUEUE_ACK);
        if (a->acked_number == a->last_number) {
            queue_remove(a, QUEUE_ACK);
            continue;
        }
        if (a->name_state != NAME_ACCEPTED) {
            continue; /* a broker that has not said yes does not know the box */
        }
        p->out_ackers[count] = a;
        p->acks[count++] =
            (muster_Ack){.box = a->name, .number = a->last_number, .handed = a->handed};
    }
    return count;
}

/* How many of these mails go into one Up: as many as PROCESS_UP_BYTES allow, and at least one. */
static uint32_t mails_bounded(const muster_Mail *mails, uint32_t count, size_t *room)
{
    for (uint32_t i = 0; i < count; i++) {
        size_t bytes = strlen(mails[i].content) + sizeof *mails;
        if (bytes > *room && i > 0) {
            *room = 0;
            return i;
        }
        *room -= bytes < *room ? bytes : *room;
    }
    return count;
}

static muster_Act act_of(struct mu_agent *a, bool answer)
{
    static char none[1];
    bool runs = a->state == MU_RUNNING;
    return (muster_Act){.agent = a->name,
                        .state = (muster_State)a->state,
                        .drives = runs ? a->speed.set
                                       : true, /* an agent that does not run stands still */
                        .forward_m_s = runs ? a->speed.forward_m_s : 0.0,
                        .turn_rad_s = runs ? a->speed.turn_rad_s : 0.0,
                        .paddles = runs ? (int32_t)a->paddles : 0,
                        .lift = runs ? (int32_t)a->lift : 0,
                        .senses = a->senses,
                        .firings = a->firings,
                        .rules = a->rules ? a->rules : none,
                        .first_seq = a->outbox.first_seq,
                        .goal = a->goal,
                        .replays = a->outbox.replays,
                        .diary = answer && a->note.at ? a->note.at : none};
}

/* The content of the Up that is being put together, and the room that is left in it. */
struct up_load {
    bool answer; /* to a step */
    uint32_t acts, mails;
    uint32_t left; /* mails */
    size_t room;   /* bytes of content */
};

static void act_add(mu_process *p, struct mu_agent *a, struct up_load *load)
{
    muster_Mail *from = &p->mails[load->mails];
    bool may_send = a->name_state == NAME_ACCEPTED && load->room > 0;
    uint32_t count = may_send ? outbox_unsent(&a->outbox, from, load->left) : 0;
    count = mails_bounded(from, count, &load->room);
    muster_Act *act = &p->acts[load->acts];
    *act = act_of(a, load->answer);
    act->mails = (dds_sequence_muster_Mail){
        ._maximum = count, ._length = count, ._buffer = from, ._release = false};
    a->act = load->acts;
    p->out_agents[load->acts++] = a;
    load->mails += count;
    load->left -= count;
}

/* The room of one agent in the answer to a step, or of all in another Up. */
static void load_begin(const mu_process *p, struct up_load *load)
{
    uint32_t left = p->mails_max - load->mails;
    load->left = left < PROCESS_UP_MAILS ? left : PROCESS_UP_MAILS;
    load->room = PROCESS_UP_BYTES;
}

/* Puts the next Up together: the answer to a step has an act of every agent, else those alone that
 * have mail.  @return whether there is any mail, acknowledgement, transfer or probe in it */
static bool up_fill(mu_process *p, int64_t step)
{
    struct up_load load = {.answer = step != muster_STEP_NOW};
    load_begin(p, &load);
    for (uint32_t i = 0; step != muster_STEP_NOW && i < p->agent_count; i++) {
        load_begin(p, &load);
        if (!life_is_elsewhere(&p->agents[i])) { /* another process answers for it */
            act_add(p, &p->agents[i], &load);
        }
    }
    for (struct mu_agent *a = step == muster_STEP_NOW ? queue_first(p, QUEUE_SEND) : NULL;
         a && load.left > 0 && load.room > 0; a = queue_next(a, QUEUE_SEND)) {
        act_add(p, a, &load);
    }
    uint32_t acks = acks_fill(p);
    p->out =
        (muster_Up){.process = p->name, .broker_incarnation = p->broker_incarnation, .step = step};
    p->out.acts._buffer = p->acts;
    p->out.acts._length = p->out.acts._maximum = load.acts;
    p->out.acks._buffer = p->acks;
    p->out.acks._length = p->out.acks._maximum = acks;
    bool transfers = transfers_fill(p, &p->out);
    bool probes = step == muster_STEP_NOW && probes_fill(p, &p->out);
    return load.mails > 0 || acks > 0 || transfers || probes;
}

/* The act of an agent has gone out; answer: to a step. */
static void act_sent(struct mu_agent *a, uint32_t mails, bool answer)
{
    if (mails > 0) {
        outbox_sent(&a->outbox, mails);
        agent_progress(a);
    }
    if (!outbox_has_unsent(&a->outbox)) {
        queue_remove(a, QUEUE_SEND);
    }
    a->speed.set = false;
    if (answer) { /* the simulator takes orders from nothing else */
        a->paddles = MU_PADDLES_KEEP;
        a->lift = MU_LIFT_KEEP;
    }
    mu_agent_fired(a, 0, "");
    if (answer && a->note.at) {
        mu_text_clear(&a->note);
    }
}

bool step_retry(mu_process *p)
{
    if (p->up_state != UP_PENDING) {
        return true;
    }
    if (bus_write(&p->up, &p->out) != MU_OK) {
        return false;
    }
    process_up_on(p, UP_WRITTEN);
    p->said_ns = p->now_ns;
    for (uint32_t i = 0; i < p->out.acts._length; i++) {
        act_sent(p->out_agents[i], p->acts[i].mails._length, p->out.step != muster_STEP_NOW);
    }
    for (uint32_t i = 0; i < p->out.acks._length; i++) {
        struct mu_agent *a = p->out_ackers[i];
        a->acked_number = p->acks[i].number;
        if (a->acked_number == a->last_number) {
            queue_remove(a, QUEUE_ACK);
        }
    }
    transfers_sent(p, p->out.trips._length);
    probes_sent(p, &p->out);
    if (!queue_first(p, QUEUE_ACK)) { /* else some did not fit in, and are due with the next Up */
        ack_delay_clear(&p->ack_delay, p->now_ns);
    }
    return true;
}

void step_announce(mu_process *p, enum process_up_due due, int64_t step)
{
    if (p->before_up) {
        p->before_up(p->before_up_self, due, step);
    }
}

void step_answer(mu_process *p, int64_t step)
{
    (void)up_fill(p, step);
    process_up_on(p, UP_ANSWERS);
    step_announce(p, UP_DUE, step);
    process_up_on(p, UP_GOES);
    (void)step_retry(p);
}

void step_hello(mu_process *p)
{
    if (step_retry(p)) {
        (void)up_fill(p, muster_STEP_NOW);
        process_up_on(p, UP_GOES);
        (void)step_retry(p);
    }
}

static void unanswered_again(mu_process *p)
{
    struct mu_agent *a = queue_first(p, QUEUE_WAIT);
    for (; a && p->now_ns - a->progress_ns > RESEND_NS; a = queue_first(p, QUEUE_WAIT)) {
        queue_remove(a, QUEUE_WAIT);
        outbox_again(&a->outbox);
        if (a->name_state == NAME_ACCEPTED) {
            queue_add(a, QUEUE_SEND);
        }
    }
}

/* Acknowledgements wait a little for mail to go with, but not when their agent is about to leave,
 * or when a poll loop of the program's own decides when we are here again. */
static bool acks_are_due(const mu_process *p)
{
    return queue_first(p, QUEUE_ACK) &&
           (p->leaving > 0 || p->bus.wakes || ack_delay_due(&p->ack_delay, p->now_ns));
}

static bool is_anything_to_say(const mu_process *p)
{
    return queue_first(p, QUEUE_SEND) || acks_are_due(p) || p->transfers.count > 0 ||
           p->probes.unsent > 0;
}

void step_say_transfers(mu_process *p)
{
    if (p->transfers.count > 0 && step_retry(p)) {
        p->out = (muster_Up){.process = p->name, .step = muster_STEP_NOW};
        (void)transfers_fill(p, &p->out);
        process_up_on(p, UP_GOES);
        (void)step_retry(p);
    }
}

void step_flush(mu_process *p)
{
    directory_settle(&p->directory);
    if (!step_retry(p)) {
        return; /* mail of a pending Up is marked as sent when that has gone: it must not move
                   before */
    }
    unanswered_again(p);
    if (is_anything_to_say(p)) {
        step_announce(p, UP_DUE, muster_STEP_NOW);
    }
    while (step_retry(p) && is_anything_to_say(p) && bus_writer_matches(&p->up) > 0 &&
           up_fill(p, muster_STEP_NOW)) {
        process_up_on(p, UP_GOES);
    }
}
