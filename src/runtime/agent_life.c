/* SPDX-License-Identifier: Apache-2.0 */
/* The life of an agent: verdicts of the broker, directives, mail, its own program. */
#include "core/clock.h"
#include "core/text.h"
#include "muster/refusal.h"
#include "runtime/letter.h"
#include "runtime/process.h"

#include <stdio.h>

void mu_agent_leave(mu_agent *a)
{
    a->part.ended = true; /* it lives on: nothing is disposed of */
    life_exit_on(a, EXIT_MOVES);
    for (enum queue_kind kind = 0; kind < QUEUES; kind++) {
        queue_remove(a, kind); /* nor is anything more to be said */
    }
    mu_agent_set_state(a, MU_GONE);
}

/* Mail that went out and has no answer may be lost, or may have reached its receiver. */
static void meet_other_broker(struct mu_agent *a, uint64_t incarnation)
{
    dedup_leave(a->dedup, a->broker_incarnation, a->last_number);
    a->last_number = dedup_last_number(a->dedup, incarnation);
    a->acked_number = 0; /* acknowledgements that waited there never went out */
    a->in_order = false; /* its boxes count from anywhere */
    outbox_to_other(&a->outbox);
    a->earlier_end = a->outbox.next_seq;
}

/* The broker had lost the agent for a while, and perhaps the mail that it sent then. */
static void meet_broker_again(struct mu_agent *a)
{
    outbox_again(&a->outbox);
    a->earlier_end = a->outbox.next_seq;
}

static void agent_accepted(struct mu_agent *a, const muster_Verdict *v, bool again)
{
    bool is_new = a->broker_incarnation != v->broker_incarnation;
    if (a->broker_incarnation != 0 && a->broker_incarnation != v->broker_incarnation) {
        meet_other_broker(a, v->broker_incarnation);
    } else if (again) {
        meet_broker_again(a);
    }
    a->broker_incarnation = v->broker_incarnation;
    a->in_order = false; /* another one may have had the name, and mail, meanwhile */
    /* last_seq is of all lives of the broker: it says where a new sender begins, and nothing of
     * what the broker still knows.  What an earlier one may have had keeps its numbers. */
    if (a->outbox.first_seq >= a->earlier_end) {
        outbox_continue(&a->outbox, v->last_seq);
    }
    if (is_new) {
        resolver_offer(a);
    }
    agent_progress(a);
    if (outbox_has_unsent(&a->outbox)) {
        queue_add(a, QUEUE_SEND);
    }
}

/* A refusal before the agent was registered is for an earlier agent of its name. */
void agent_verdict(struct mu_agent *a, const muster_Verdict *v)
{
    enum life_name was = a->name_state;
    if (!life_name_on(a, v->accepted ? NAME_GRANT : NAME_REFUSAL)) {
        return;
    }
    if (v->accepted) {
        agent_accepted(a, v, was == NAME_ACCEPTED);
    } else {
        queue_remove(a, QUEUE_SEND);
        queue_remove(a, QUEUE_ACK);
    }
    bool is_news = a->name_state != was && !(v->accepted && was == NAME_ASKED_AGAIN);
    a->refusal = v->accepted ? MU_REFUSAL_NONE : (enum mu_refusal)v->code;
    a->accepted_serial = a->process->inbox.serial;
    if ((was == NAME_REFUSED) == v->accepted) {
        roll_mark(a); /* another broker is not to hear of a name that was refused */
    }
    if (is_news && a->exit == EXIT_PRESENT && a->handlers.on_registered) {
        a->handlers.on_registered(a->handlers.self, a, v->accepted, v->reason);
    }
    kind_follow(a);
}

static struct mu_mail mail_of(const muster_Parcel *item)
{
    struct mu_mail mail = letter_of(&item->letter);
    mail.number = item->number;
    return mail;
}

void agent_live(struct mu_agent *a, enum life_event event, const char *by)
{
    enum mu_state next = life_next(a->state, event);
    if (next != a->state && next == MU_SUSPENDED) {
        char reason[MU_FIELD_MAX + 1];
        snprintf(reason, sizeof reason, "told by %s", by);
        mu_agent_suspend(a, reason);
    } else if (next != a->state) {
        mu_agent_set_state(a, next);
    } else if (event == LIFE_RESUME && next == MU_RUNNING && a->handlers.on_state) {
        a->handlers.on_state(a->handlers.self, a, next); /* it may have been about to stop */
    }
}

/* Nothing of a host stops with its state, nor of a special agent that does not hear of it, such as
 * a run's observer. */
static bool life_obeys(const struct mu_agent *a, enum life_event event)
{
    if (a->kind == MU_KIND_HOST) {
        return event != LIFE_SUSPEND;
    }
    bool stops = event == LIFE_SUSPEND || event == LIFE_DISPOSE;
    return !stops || a->kind != MU_KIND_SPECIAL || a->handlers.on_state;
}

/* Refuses in words that say why, or answers before it is gone. */
static void directive_live(struct mu_agent *a, enum life_event event, const struct mu_mail *mail)
{
    char content[MU_FIELD_MAX * 2];
    struct mu_text t;
    mu_text_init(&t, content, sizeof content);
    mu_text_add(&t, mail->performative);
    bool obeys = life_obeys(a, event);
    bool done = obeys && life_next(a->state, event) == life_wanted(event);
    if (!obeys) {
        mu_text_format(&t, " %s", mu_refusal_word(MU_REFUSAL_UNSUPPORTED));
    } else if (!done) {
        mu_text_format(&t, " %s %s", mu_refusal_word(MU_REFUSAL_STATE), mu_state_text(a->state));
    }
    mu_result sent =
        mail->reply_with[0] ? mu_agent_reply(a, mail, done ? "agree" : "refuse", content) : MU_OK;
    (void)sent; /* a full outbox: the asker's own time limit is the answer */
    if (done) {
        agent_live(a, event, mail->src);
    }
}

void agent_directive(struct mu_agent *a, const muster_Parcel *item)
{
    struct mu_mail mail = mail_of(item);
    enum life_event event;
    if (life_event_named(mail.performative, &event) == MU_OK) {
        directive_live(a, event, &mail);
    } else if (a->handlers.on_directive) {
        a->handlers.on_directive(a->handlers.self, a, &mail);
    } else if (mail.reply_with[0]) {
        kind_not_understood(a, &mail);
    }
}

void agent_mail(struct mu_agent *a, const muster_Parcel *item)
{
    if (!directory_take_answer(a, &item->letter)) {
        struct mu_mail mail = mail_of(item);
        kind_mail(a, &mail);
    }
}

void mu_agent_suspend(mu_agent *a, const char *reason)
{
    if (a->state == MU_RUNNING) {
        mu_agent_set_state(a, MU_SUSPENDED);
        mu_text_copy(a->reason, sizeof a->reason, reason ? reason : "");
    }
}

void mu_agent_set_state(mu_agent *a, enum mu_state state)
{
    MU_ASSERT((unsigned)state <= MU_GONE);
    if (state == a->state || a->state == MU_GONE) {
        return;
    }
    a->reason[0] = '\0';
    if (state == MU_GONE) {
        kind_end(a);
        if (a->state == MU_GONE) {
            return; /* its last hook has done it */
        }
        a->last_state = a->state;
    }
    a->state = state;
    if (state == MU_GONE) {
        life_exit_on(a, EXIT_GOES);
        directory_forget(&a->process->directory, a);
        probes_forget(a);
    } else {
        roll_mark(a);
    }
    if (a->handlers.on_state) {
        a->handlers.on_state(a->handlers.self, a, state);
    }
    kind_follow(a);
}
