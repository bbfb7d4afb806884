/* SPDX-License-Identifier: Apache-2.0 */
#include "core/clock.h"
#include "core/name.h"
#include "core/text.h"
#include "runtime/life.h"
#include "runtime/process.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

/* The public enumerations are those of the wire, so that they can be cast. */
_Static_assert((int)MU_KIND_SPECIAL == (int)muster_KIND_SPECIAL, "kinds");
_Static_assert((int)MU_GONE == (int)muster_STATE_ABSENT, "states");
_Static_assert((int)MU_MAIL_NO_STORE == (int)muster_OUTCOME_NO_STORE, "outcomes");
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

void agent_register(struct mu_agent *a)
{
    mu_process *p = a->process;
    if (a->refused || a->gone) {
        return;
    }
    muster_Registration r = {.name = a->name,
                             .process = p->name,
                             .incarnation = a->incarnation,
                             .kind = (muster_Kind)a->kind,
                             .state = (muster_State)a->state,
                             .host = p->host,
                             .pid = (uint32_t)getpid(),
                             .no_broadcasts = a->no_broadcasts,
                             .ready = p->ready};
    mu_result written = bus_write(&p->registration, &r);
    (void)written; /* the next heartbeat says it again */
}

mu_result mu_agent_join(mu_process *p, mu_agent **out, const char *name, enum mu_kind kind,
                        uint64_t last_number, const struct mu_handlers *handlers)
{
    if (!mu_name_valid(name)) {
        return MU_MALFORMED;
    }
    if (p->agent_count == MU_LOCAL_AGENTS_MAX) {
        return MU_FULL;
    }
    struct mu_agent *a = &p->agents[p->agent_count++];
    a->process = p;
    mu_text_copy(a->name, sizeof a->name, name);
    a->kind = kind;
    a->state = kind == MU_KIND_ROBOT ? MU_STANDBY : MU_RUNNING;
    a->handlers = *handlers;
    a->incarnation = mu_clock_wall_ns();
    a->last_number = a->acked_number = last_number;
    outbox_init(&a->outbox);
    agent_register(a);
    *out = a;
    return MU_OK;
}

struct mu_agent *agent_find(mu_process *p, const char *name)
{
    for (uint32_t i = 0; i < p->agent_count; i++) {
        if (strcmp(p->agents[i].name, name) == 0) {
            return &p->agents[i];
        }
    }
    return NULL;
}

/* What went out and has no answer may be lost, or may have reached its receiver. */
static void meet_other_broker(struct mu_agent *a)
{
    a->last_number = a->acked_number = 0;
    a->in_order = false; /* its boxes count from anywhere */
    outbox_again(&a->outbox);
    a->earlier_end = a->outbox.next_seq;
}

static void accepted(struct mu_agent *a, const muster_Verdict *v)
{
    a->progress_ns = mu_clock_ns();
    if (a->broker != 0 && a->broker != v->broker_incarnation) {
        meet_other_broker(a);
    }
    a->broker = v->broker_incarnation;
    /* last_seq is of all lives of the broker: it says where a new sender begins, and nothing of
     * what the broker still knows.  What an earlier one may have had keeps its numbers. */
    if (a->outbox.first_seq >= a->earlier_end) {
        outbox_continue(&a->outbox, v->last_seq);
    }
}

void agent_verdict(struct mu_agent *a, const muster_Verdict *v)
{
    if (v->accepted) {
        accepted(a, v);
    }
    bool is_news = v->accepted ? !a->registered : !a->refused;
    a->registered = v->accepted;
    a->refused = !v->accepted;
    if (is_news && a->handlers.on_registered) {
        a->handlers.on_registered(a->handlers.self, a, v->accepted, v->reason);
    }
}

static struct mu_mail mail_of(const muster_Parcel *parcel)
{
    const muster_Mail *m = &parcel->letter;
    return (struct mu_mail){.src = m->src,
                            .dst = m->dst,
                            .seq = m->seq,
                            .number = parcel->number,
                            .directive = m->layer == WIRE_DIRECTIVE,
                            .layer = m->layer,
                            .performative = m->performative,
                            .language = m->language,
                            .ontology = m->ontology,
                            .reply_with = m->reply_with,
                            .in_reply_to = m->in_reply_to,
                            .conversation = m->conversation,
                            .content = m->content,
                            .timed = m->due_ns >= 0,
                            .due_ns = m->due_ns > 0 ? (uint64_t)m->due_ns : 0,
                            .ttl_ns = m->ttl_ns};
}

/* Who asks is not left waiting for an agent that has no handler. */
static void not_understood(struct mu_agent *a, const struct mu_mail *asked)
{
    mu_result sent = mu_agent_send(a,
                                   &(struct mu_mail){.dst = asked->src,
                                                     .layer = MU_LAYER_SPEECH,
                                                     .performative = "not-understood",
                                                     .in_reply_to = asked->reply_with,
                                                     .conversation = asked->conversation,
                                                     .content = asked->performative},
                                   NULL);
    (void)sent; /* a full outbox: the asker's own time limit is the answer */
}

void agent_directive(struct mu_agent *a, const muster_Parcel *parcel)
{
    struct mu_mail mail = mail_of(parcel);
    enum life_event event;
    if (life_event_named(mail.performative, &event) == MU_OK) {
        mu_agent_set_state(a, life_next(a->state, event));
    } else if (a->handlers.on_directive) {
        a->handlers.on_directive(a->handlers.self, a, &mail);
    } else if (mail.reply_with[0]) {
        not_understood(a, &mail);
    }
}

void agent_mail(struct mu_agent *a, const muster_Parcel *parcel)
{
    if (a->handlers.on_mail) {
        struct mu_mail mail = mail_of(parcel);
        a->handlers.on_mail(a->handlers.self, a, &mail);
    }
}

void mu_agent_set_state(mu_agent *a, enum mu_state state)
{
    if (state == a->state) {
        return;
    }
    a->state = state;
    if (state == MU_GONE) {
        muster_Registration r = {
            .name = a->name, .process = a->process->name, .host = a->process->host};
        bus_dispose(&a->process->registration, &r);
        a->gone = true;
    } else {
        agent_register(a);
    }
    if (a->handlers.on_state) {
        a->handlers.on_state(a->handlers.self, a, state);
    }
}

void mu_agent_decline_broadcasts(mu_agent *a)
{
    a->no_broadcasts = true;
    agent_register(a);
}

mu_result mu_agent_send(mu_agent *a, const struct mu_mail *mail, uint64_t *seq)
{
    mu_result put = outbox_put(&a->outbox, a->name, mail);
    if (put == MU_OK && seq) {
        *seq = a->outbox.next_seq - 1;
    }
    return put;
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

void mu_agent_fired(mu_agent *a, uint32_t firings, const char *rules)
{
    a->firings = firings;
    mu_text_copy(a->rules, sizeof a->rules, rules);
}

const char *mu_agent_name(const mu_agent *a)
{
    return a->name;
}

enum mu_state mu_agent_state(const mu_agent *a)
{
    return a->state;
}
