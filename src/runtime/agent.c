/* SPDX-License-Identifier: Apache-2.0 */
#include "core/clock.h"
#include "core/name.h"
#include "core/text.h"
#include "muster/kind.h"
#include "muster/refusal.h"
#include "runtime/letter.h"
#include "runtime/life.h"
#include "runtime/process.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The public enumerations are those of the wire, so that they can be cast. */
_Static_assert((int)MU_KIND_SPECIAL == (int)muster_KIND_SPECIAL, "kinds");
_Static_assert((int)MU_GONE == (int)muster_STATE_ABSENT, "states");
_Static_assert((int)MU_MAIL_NO_STORE == (int)muster_OUTCOME_NO_STORE, "outcomes");
#define X(name, word, text) \
    _Static_assert((int)MU_REFUSAL_##name == (int)muster_REFUSAL_##name, word);
MU_REFUSALS(X)
#undef X
_Static_assert((int)MU_LEVEL_SYNCED == (int)muster_LEVEL_SYNCED, "levels");

const char *mu_kind_text(enum mu_kind kind)
{
    static const char *const texts[] = {"agent", "robot", "host", "special"};
    return (unsigned)kind < sizeof texts / sizeof texts[0] ? texts[kind] : "unknown";
}

const char *mu_state_text(enum mu_state state)
{
    static const char *const texts[] = {"standby", "running", "suspended", "moving", "absent"};
    return (unsigned)state < sizeof texts / sizeof texts[0] ? texts[state] : "unknown";
}

const char *mu_outcome_text(enum mu_outcome outcome)
{
    static const char *const texts[] = {"delivered", "stored",       "expired",
                                        "box-full",  "unknown-name", "duplicate",
                                        "refused",   "dropped",      "no-store"};
    return (unsigned)outcome < sizeof texts / sizeof texts[0] ? texts[outcome] : "unknown";
}

/* One of that name who has left gives it up: who comes now answers for it. */
static void name_free(mu_process *p, const char *name)
{
    struct mu_agent *holder = agent_find(p, name);
    if (holder) {
        (void)mu_table_remove(&p->names, name);
        holder->departed = true;
    }
}

bool agent_has_last_words(const struct mu_agent *a)
{
    bool is_mute = a->departed && a->process->in_lockstep; /* another process answers for it */
    return (a->links[QUEUE_SEND].in && !is_mute) || a->links[QUEUE_ACK].in;
}

/* @return a place for one more agent: a new one, or that of one that has left; NULL: full */
static struct mu_agent *place_take(mu_process *p)
{
    if (p->agent_count < p->agents_max) {
        return &p->agents[p->agent_count++];
    }
    struct mu_agent *a = p->agents;
    while (a < p->agents + p->agent_count &&
           (!a->gone || (a->leaving && agent_has_last_words(a)))) {
        a++;
    }
    if (a == p->agents + p->agent_count || p->out_pending) { /* what is pending speaks of it */
        return NULL;
    }
    for (enum queue_kind kind = 0; kind < QUEUES; kind++) {
        queue_remove(&p->queues[kind], kind, a);
    }
    if (agent_find(p, a->name) == a) {
        (void)mu_table_remove(&p->names, a->name);
    }
    *a = (struct mu_agent){0};
    return a;
}

/* What comes from another program may be any number. */
static bool kind_is_one(enum mu_kind kind)
{
    return (unsigned)kind <= MU_KIND_SPECIAL;
}

mu_result mu_agent_join(mu_process *p, mu_agent **out, const char *name, enum mu_kind kind,
                        uint64_t last_number, const struct mu_handlers *handlers)
{
    if (!mu_name_valid(name) || !kind_is_one(kind)) {
        return MU_MALFORMED;
    }
    const struct mu_agent *holder = agent_find(p, name);
    bool follows = holder && (holder->leaving || holder->follows);
    if (holder && !holder->gone) {
        return MU_EXISTS;
    }
    struct mu_agent *a = place_take(p);
    if (!a) {
        return MU_FULL;
    }
    name_free(p, name);
    uint32_t index = (uint32_t)(a - p->agents);
    a->follows = follows;
    a->process = p;
    mu_text_copy(a->name, sizeof a->name, name);
    (void)mu_table_put(&p->names, a->name, index);
    a->kind = kind;
    if (kind == MU_KIND_HOST) {
        mu_text_copy(p->platform, sizeof p->platform, name);
    }
    a->state = kind == MU_KIND_ROBOT ? MU_STANDBY : MU_RUNNING;
    a->handlers = handlers ? *handlers : (struct mu_handlers){0};
    a->senses = kind == MU_KIND_ROBOT ? MU_SENSE_SONAR : 0;
    a->since_wall_ns = mu_clock_wall_ns();
    a->last_number = a->acked_number = last_number;
    a->rules = p->rules_text ? p->rules_text + (size_t)index * (PROCESS_RULES_MAX + 1) : NULL;
    if (p->note_text) {
        mu_text_init(&a->note, p->note_text + (size_t)index * (MU_NOTE_MAX + 1), MU_NOTE_MAX + 1);
    }
    outbox_init(&a->outbox, p->outbox_mails, p->outbox_slots + (size_t)index * p->outbox_mails,
                p->outbox_text + index * outbox_text_bytes(p->outbox_mails), a->since_wall_ns);
    a->taken = &p->taken[index];
    taken_clear(a->taken);
    roll_mark(a);
    *out = a;
    return MU_OK;
}

mu_result mu_agent_arrive(mu_process *p, mu_agent **out, const char *name,
                          const struct mu_passage *from, enum mu_event event,
                          const struct mu_handlers *handlers)
{
    uint64_t last = from ? from->last_number : 0;
    if ((unsigned)event >= MU_EVENTS) {
        return MU_MALFORMED;
    }
    mu_result joined = mu_agent_join(p, out, name, MU_KIND_ROBOT, last, handlers);
    if (joined != MU_OK) {
        return joined;
    }
    (*out)->broker_incarnation = from ? from->broker : 0; /* another one numbers its box anew */
    (*out)->epoch = from ? from->epoch : 0;
    (*out)->handed = from ? from->handed : 0;
    (*out)->state = MU_MOVING;
    (*out)->part.beginning = event;
    (*out)->part.begun = true; /* it ran before, or will be started */
    return MU_OK;
}

struct mu_passage mu_agent_passage(const mu_agent *a)
{
    return (struct mu_passage){.last_number = a->last_number,
                               .handed = a->handed,
                               .broker = a->broker_incarnation,
                               .epoch = a->epoch};
}

void mu_agent_set_out(mu_agent *a)
{
    a->epoch++;
    roll_mark(a);
}

bool mu_agent_is_settled(const mu_agent *a)
{
    return a->registered && !outbox_has_unsent(&a->outbox) && !outbox_has_unanswered(&a->outbox) &&
           !a->links[QUEUE_ACK].in && !a->process->out_pending;
}

void mu_agent_leave(mu_agent *a)
{
    a->part.ended = true; /* it lives on: nothing is disposed of */
    a->departed = true;
    for (enum queue_kind kind = 0; kind < QUEUES; kind++) {
        queue_remove(&a->process->queues[kind], kind, a); /* nor is anything more to be said */
    }
    mu_agent_set_state(a, MU_GONE);
}

struct mu_agent *agent_find(mu_process *p, const char *name)
{
    uint32_t index = mu_table_find(&p->names, name);
    return index == MU_NONE ? NULL : &p->agents[index];
}

void agent_progress(struct mu_agent *a)
{
    struct queue *waits = &a->process->queues[QUEUE_WAIT];
    a->progress_ns = mu_clock_ns();
    queue_remove(waits, QUEUE_WAIT, a);
    if (outbox_has_unanswered(&a->outbox)) {
        queue_add(waits, QUEUE_WAIT, a);
    }
}

/* What went out and has no answer may be lost, or may have reached its receiver. */
static void meet_other_broker(struct mu_agent *a, uint64_t incarnation)
{
    taken_leave(a->taken, a->broker_incarnation, a->last_number);
    a->last_number = taken_last_number(a->taken, incarnation);
    a->acked_number = 0; /* what was owed when it left there was never said */
    a->in_order = false; /* its boxes count from anywhere */
    outbox_to_other(&a->outbox);
    a->earlier_end = a->outbox.next_seq;
}

/* The broker had lost it for a while, and perhaps what it sent then. */
static void meet_broker_again(struct mu_agent *a)
{
    outbox_again(&a->outbox);
    a->earlier_end = a->outbox.next_seq;
}

static void agent_accepted(struct mu_agent *a, const muster_Verdict *v)
{
    bool is_new = a->broker_incarnation != v->broker_incarnation;
    if (a->broker_incarnation != 0 && a->broker_incarnation != v->broker_incarnation) {
        meet_other_broker(a, v->broker_incarnation);
    } else if (a->registered) {
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
        queue_add(&a->process->queues[QUEUE_SEND], QUEUE_SEND, a);
    }
}

/* Who is gone has nothing to do with the name any more; and a refusal before anybody was asked is
 * that of an earlier one of that name. */
void agent_verdict(struct mu_agent *a, const muster_Verdict *v)
{
    if (!v->accepted && !a->said) {
        return;
    }
    if (v->accepted) {
        agent_accepted(a, v);
    } else {
        queue_remove(&a->process->queues[QUEUE_SEND], QUEUE_SEND, a);
        queue_remove(&a->process->queues[QUEUE_ACK], QUEUE_ACK, a);
    }
    bool is_news = v->accepted ? !a->welcomed : !a->refused;
    a->registered = v->accepted;
    a->refusal = v->accepted ? MU_REFUSAL_NONE : (enum mu_refusal)v->code;
    a->accepted_serial = a->process->inbox.serial;
    if (a->refused == v->accepted) {
        a->refused = !v->accepted;
        roll_mark(a); /* who comes later is not to hear of a name that was refused */
    }
    a->welcomed = v->accepted;
    if (is_news && !a->gone && a->handlers.on_registered) {
        a->handlers.on_registered(a->handlers.self, a, v->accepted, v->reason);
    }
    kind_follow(a);
}

static struct mu_mail mail_of(const muster_Parcel *parcel)
{
    struct mu_mail mail = letter_of(&parcel->letter);
    mail.number = parcel->number;
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

/* Nothing of a host stops with its state, nor of somebody special that does not hear of it, such as
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

void agent_directive(struct mu_agent *a, const muster_Parcel *parcel)
{
    struct mu_mail mail = mail_of(parcel);
    enum life_event event;
    if (life_event_named(mail.performative, &event) == MU_OK) {
        directive_live(a, event, &mail);
    } else if (a->handlers.on_directive) {
        a->handlers.on_directive(a->handlers.self, a, &mail);
    } else if (mail.reply_with[0]) {
        kind_not_understood(a, &mail);
    }
}

void agent_mail(struct mu_agent *a, const muster_Parcel *parcel)
{
    if (!directory_take_answer(a, &parcel->letter)) {
        struct mu_mail mail = mail_of(parcel);
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
    if (state == a->state || a->gone) {
        return;
    }
    a->reason[0] = '\0';
    if (state == MU_GONE) {
        kind_end(a);
        a->last_state = a->state;
    }
    a->state = state;
    if (state == MU_GONE) {
        a->gone = a->leaving = a->process->leaving = true;
        directory_forget(&a->process->directory, a);
        glances_forget(a);
    } else {
        roll_mark(a);
    }
    if (a->handlers.on_state) {
        a->handlers.on_state(a->handlers.self, a, state);
    }
    kind_follow(a);
}

void mu_agent_decline_broadcasts(mu_agent *a)
{
    a->no_broadcasts = true;
    roll_mark(a);
}

void mu_agent_limit_box(mu_agent *a, enum mu_box_policy policy, uint32_t mails, uint64_t bytes)
{
    MU_ASSERT((unsigned)policy <= MU_BOX_DROP_LOWEST);
    a->box_policy = policy;
    a->box_mails = mails;
    a->box_bytes = bytes;
    roll_mark(a);
}

mu_result mu_agent_send(mu_agent *a, const struct mu_mail *mail, uint64_t *seq)
{
    if (a->gone && !a->leaving) {
        return MU_REFUSED; /* its last words are out, and the name may be another's */
    }
    mu_result put = outbox_put(&a->outbox, a->name, mail);
    if (put == MU_OK && a->registered) {
        queue_add(&a->process->queues[QUEUE_SEND], QUEUE_SEND, a);
    }
    if (put == MU_OK && seq) {
        *seq = a->outbox.next_seq - 1;
    }
    return put;
}

mu_result agent_replay(struct mu_agent *a, uint64_t seq, const struct mu_mail *mail)
{
    bool follows = a->replays && seq == a->outbox.next_seq;
    if (!follows && a->outbox.first_seq != a->outbox.next_seq) {
        return MU_BUSY;
    }
    if (!follows) { /* what waits would be numbered anew */
        outbox_continue(&a->outbox, seq - 1);
    }
    if (seq != a->outbox.next_seq) {
        return MU_MALFORMED;
    }
    a->replays = true;
    return mu_agent_send(a, mail, NULL);
}

mu_result mu_agent_broadcast(mu_agent *a, const char *content)
{
    return mu_agent_send(
        a, &(struct mu_mail){.dst = "all", .layer = MU_LAYER_SPEECH, .content = content}, NULL);
}

mu_result mu_agent_drive(mu_agent *a, double forward_m_s, double turn_rad_s)
{
    if (!isfinite(forward_m_s) || !isfinite(turn_rad_s)) {
        return MU_REFUSED;
    }
    a->drives = true;
    a->forward_m_s = forward_m_s;
    a->turn_rad_s = turn_rad_s;
    return MU_OK;
}

void mu_agent_senses(mu_agent *a, uint32_t senses)
{
    if (a->senses != (senses & MU_SENSES)) {
        a->senses = senses & MU_SENSES;
        roll_mark(a);
    }
}

mu_result mu_agent_grip(mu_agent *a, enum mu_paddles paddles, enum mu_lift lift)
{
    if (paddles < MU_PADDLES_OPEN || paddles > MU_PADDLES_CLOSE || lift < MU_LIFT_DOWN ||
        lift > MU_LIFT_UP) {
        return MU_MALFORMED;
    }
    a->paddles = paddles == MU_PADDLES_KEEP ? a->paddles : paddles;
    a->lift = lift == MU_LIFT_KEEP ? a->lift : lift;
    return MU_OK;
}

void mu_agent_fired(mu_agent *a, uint32_t firings, const char *rules)
{
    a->firings = firings;
    if (a->rules) {
        mu_text_copy(a->rules, PROCESS_RULES_MAX + 1, rules ? rules : "");
    }
}

void mu_agent_fired_also(mu_agent *a, uint32_t firings, const char *rules)
{
    struct mu_text t;
    a->firings += firings;
    if (a->rules && rules && rules[0]) {
        mu_text_init(&t, a->rules + strlen(a->rules), PROCESS_RULES_MAX + 1 - strlen(a->rules));
        mu_text_format(&t, "%s%s", a->rules[0] ? " " : "", rules);
    }
}

void mu_agent_note(mu_agent *a, const char *text)
{
    if (a->note.at && text) {
        mu_text_add(&a->note, text);
    }
}

void mu_agent_want(mu_agent *a, const char *goal)
{
    mu_text_copy(a->goal, sizeof a->goal, goal ? goal : "");
}

const char *mu_agent_name(const mu_agent *a)
{
    return a->name;
}

enum mu_refusal mu_agent_refusal(const mu_agent *a)
{
    return a->refusal;
}

enum mu_state mu_agent_state(const mu_agent *a)
{
    return a->state;
}
