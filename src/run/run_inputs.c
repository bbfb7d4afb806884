/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What came into a recorded run from outside, put into this one again: all of it is handed over
 * before the first step, each with the step at which it is to come in.
 */
#include "run/run_inputs.h"

#include "core/text.h"
#include "muster/memory.h"
#include "runtime/letter.h"
#include "runtime/process.h"

#include <stdio.h>
#include <string.h>

/* Agents outside a run that had something to say; sensors that were switched for a while. */
enum { INPUTS_SENDERS_MAX = 64, INPUTS_UNDONE_MAX = 1024 };

struct sender {
    char name[MU_NAME_MAX + 1];
    mu_agent *agent;
    bool refused;
};

/* A sensor that was switched for a while. */
struct hand {
    char source[MU_PROCESS_MAX + 1];
    uint64_t seq;
};

struct run_inputs {
    struct recording recording;
    mu_process *process;
    mu_agent *observer; /* this process's own */
    struct bus_writer *orders;
    const char *simulator;
    struct sender senders[INPUTS_SENDERS_MAX];
    size_t senders_count;
    struct hand undone[INPUTS_UNDONE_MAX];
    size_t undone_count;
    const muster_Frame *frame; /* whose mails are handed over; NULL: none yet, or all are */
    uint32_t mail, order;      /* of the frame: the next ones */
    bool begun, refused;
};

struct run_inputs *run_inputs_open(const char *path, struct mu_fault *fault)
{
    struct run_inputs *in = mu_startup_alloc(sizeof *in);
    bool good = recording_create(&in->recording, path, fault) == MU_OK &&
                recording_open(&in->recording, path, fault) == MU_OK;
    return good ? in : NULL;
}

void run_inputs_join(struct run_inputs *in, mu_process *process, mu_agent *observer,
                     struct bus_writer *orders, const char *simulator)
{
    in->process = process;
    in->observer = observer;
    in->orders = orders;
    in->simulator = simulator;
}

/* --- senders ---------------------------------------------------------------------------------- */

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    struct sender *s = self;
    s->refused = !accepted;
    if (!accepted) {
        fprintf(stderr, "muster run: the broker refuses the name %s: %s\n", mu_agent_name(a),
                reason);
    }
}

/* @return NULL: there is no room for more of them */
static struct sender *sender_find(struct run_inputs *in, const char *name)
{
    for (size_t i = 0; i < in->senders_count; i++) {
        if (strcmp(in->senders[i].name, name) == 0) {
            return &in->senders[i];
        }
    }
    if (in->senders_count == INPUTS_SENDERS_MAX) {
        return NULL;
    }
    struct sender *s = &in->senders[in->senders_count++];
    mu_text_copy(s->name, sizeof s->name, name);
    if (strcmp(name, mu_agent_name(in->observer)) == 0) {
        s->agent = in->observer;
        return s;
    }
    struct mu_handlers handlers = {.self = s, .on_registered = on_registered};
    s->refused =
        mu_agent_join(in->process, &s->agent, name, MU_KIND_SPECIAL, 0, &handlers) != MU_OK;
    if (!s->refused) {
        mu_agent_decline_broadcasts(s->agent); /* robots are not to know it from the start */
    }
    return s;
}

/* --- what was said ---------------------------------------------------------------------------- */

/* @return whether it was handed over, or never will be */
static bool mail_tell(struct run_inputs *in, const muster_Mail *m)
{
    struct sender *s = sender_find(in, m->src);
    if (!s || s->refused) {
        in->refused = true;
        return true;
    }
    if (s->agent->name_state != NAME_ACCEPTED) {
        return false;
    }
    struct mu_mail mail = letter_of(m);
    mail.timed = true;
    mail.due_ns = in->frame->time_ns;
    mu_result sent = agent_replay(s->agent, m->seq, &mail);
    in->refused = in->refused || sent == MU_MALFORMED;
    return sent == MU_OK || sent == MU_MALFORMED;
}

/* @return the number of a sensor's order that the simulator is to undo; undone_count: it is none */
static size_t undone_find(const struct run_inputs *in, const muster_RunCommand *c)
{
    size_t i = 0;
    while (i < in->undone_count &&
           (in->undone[i].seq != c->seq || strcmp(in->undone[i].source, c->source) != 0)) {
        i++;
    }
    return i;
}

/* @return whether an order is one that a person gave, and that changes the world.  What an
 * experiment's chaos does comes of the experiment; what the simulator undoes by itself has the
 * number of what it undoes. */
static bool order_counts(const struct run_inputs *in, const muster_RunCommand *c)
{
    bool changes = c->order == muster_RUN_PLACE || c->order == muster_RUN_PUSH ||
                   c->order == muster_RUN_RESET || c->order == muster_RUN_SENSOR;
    bool undoes = c->order == muster_RUN_SENSOR && undone_find(in, c) < in->undone_count;
    return changes && !undoes && strncmp(c->source, "chaos.", 6) != 0;
}

static void order_note(struct run_inputs *in, const muster_RunCommand *c)
{
    if (c->order != muster_RUN_SENSOR || !(c->time_s > 0)) {
        return;
    }
    if (in->undone_count == INPUTS_UNDONE_MAX) {
        in->refused = true;
        return;
    }
    struct hand *h = &in->undone[in->undone_count++];
    mu_text_copy(h->source, sizeof h->source, c->source);
    h->seq = c->seq;
}

/* What was done to the world at the end of the frame's step. */
static bool order_tell(struct run_inputs *in, const muster_RunCommand *recorded)
{
    static char none[1];
    muster_RunCommand c = *recorded;
    if (!order_counts(in, &c)) {
        return true;
    }
    c.simulator = (char *)(uintptr_t)in->simulator;
    c.due_ns = in->frame->time_ns;
    c.when = none;
    bool told = bus_write(in->orders, &c) == MU_OK;
    if (told) {
        order_note(in, &c);
    }
    return told;
}

/* @return whether all of a frame was handed over */
static bool frame_tell(struct run_inputs *in)
{
    const muster_Frame *f = in->frame;
    while (in->mail < f->outside._length && mail_tell(in, &f->outside._buffer[in->mail])) {
        in->mail++;
    }
    while (in->order < f->orders._length && order_tell(in, &f->orders._buffer[in->order])) {
        in->order++;
    }
    return in->mail == f->outside._length && in->order == f->orders._length;
}

/* @return whether every name is in the white pages, and every mail is answered for */
static bool all_answered(const struct run_inputs *in)
{
    for (size_t i = 0; i < in->senders_count; i++) {
        const struct sender *s = &in->senders[i];
        if (!s->refused &&
            (s->agent->name_state != NAME_ACCEPTED || outbox_has_unanswered(&s->agent->outbox))) {
            return false;
        }
    }
    return true;
}

void run_inputs_seat(struct run_inputs *in, const char *name)
{
    struct sender *s = sender_find(in, name);
    in->refused = in->refused || !s || s->refused;
}

bool run_inputs_tell(struct run_inputs *in)
{
    if (!in->begun) {
        in->begun = true;
        recording_rewind(&in->recording);
        in->frame = recording_next(&in->recording);
    }
    while (in->frame && frame_tell(in)) {
        in->frame = recording_next(&in->recording);
        in->mail = in->order = 0;
    }
    return !in->frame && all_answered(in);
}

bool run_inputs_refused(const struct run_inputs *in)
{
    return in->refused;
}
