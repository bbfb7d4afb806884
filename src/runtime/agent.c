/* SPDX-License-Identifier: Apache-2.0 */
#include "core/clock.h"
#include "core/name.h"
#include "core/performatives.h"
#include "core/text.h"
#include "muster/kind.h"
#include "muster/refusal.h"
#include "runtime/life.h"
#include "runtime/process.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
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

/* An agent of that name that is gone gives the name up to the one that comes now. */
static void name_free(mu_process *p, const char *name)
{
    struct mu_agent *holder = agent_find(p, name);
    if (holder) {
        (void)mu_table_remove(&p->names, name);
        life_exit_on(holder, EXIT_MOVES);
    }
}

bool agent_has_last_words(const struct mu_agent *a)
{
    bool is_mute = life_is_elsewhere(a) && process_in_lockstep(a->process);
    return (queue_has(a, QUEUE_SEND) && !is_mute) || queue_has(a, QUEUE_ACK);
}

/* @return a place for one more agent: a new one, or that of one that has left; NULL: full */
static struct mu_agent *place_take(mu_process *p)
{
    if (p->agent_count < p->agents_max) {
        return &p->agents[p->agent_count++];
    }
    struct mu_agent *a = p->agents;
    while (a < p->agents + p->agent_count &&
           (a->exit == EXIT_PRESENT || (life_is_leaving(a) && agent_has_last_words(a)))) {
        a++;
    }
    if (a == p->agents + p->agent_count ||
        p->up_state == UP_PENDING) { /* the Up that waits names it */
        return NULL;
    }
    for (enum queue_kind kind = 0; kind < QUEUES; kind++) {
        queue_remove(a, kind);
    }
    if (agent_find(p, a->name) == a) {
        (void)mu_table_remove(&p->names, a->name);
    }
    *a = (struct mu_agent){0};
    return a;
}

/* Another program may pass any number. */
static bool kind_is_one(enum mu_kind kind)
{
    return (unsigned)kind <= MU_KIND_SPECIAL;
}

mu_result mu_agent_join(mu_process *p, mu_agent **out, const char *name, enum mu_kind kind,
                        uint64_t last_number, const struct mu_handlers *handlers)
{
    name = name ? name : getenv("MUSTER_AGENT");
    if (!name || !mu_name_valid(name) || !kind_is_one(kind)) {
        return MU_MALFORMED;
    }
    const struct mu_agent *holder = agent_find(p, name);
    bool follows = holder && (life_is_leaving(holder) || holder->name_state == NAME_FOLLOWS);
    if (holder && holder->exit == EXIT_PRESENT) {
        return MU_EXISTS;
    }
    struct mu_agent *a = place_take(p);
    if (!a) {
        return MU_FULL;
    }
    name_free(p, name);
    uint32_t index = (uint32_t)(a - p->agents);
    a->name_state = follows ? NAME_FOLLOWS : NAME_UNSAID;
    a->process = p;
    mu_text_copy(a->name, sizeof a->name, name);
    (void)mu_table_put(&p->names, a->name, index);
    a->kind = kind;
    if (kind == MU_KIND_HOST) {
        mu_text_copy(p->platform, sizeof p->platform, name);
    }
    a->state = kind == MU_KIND_ROBOT ? MU_STANDBY : MU_RUNNING;
    a->handlers = (struct mu_handlers){0};
    if (handlers) {
        memcpy(&a->handlers, handlers, p->handlers_size);
    }
    a->senses = kind == MU_KIND_ROBOT ? MU_SENSE_SONAR : 0;
    a->since_wall_ns = mu_clock_wall_ns();
    a->last_number = a->acked_number = last_number;
    a->rules = p->rules_text ? p->rules_text + (size_t)index * (PROCESS_RULES_MAX + 1) : NULL;
    if (p->note_text) {
        mu_text_init(&a->note, p->note_text + (size_t)index * (MU_NOTE_MAX + 1), MU_NOTE_MAX + 1);
    }
    outbox_init(&a->outbox, p->outbox_mails, p->outbox_slots + (size_t)index * p->outbox_mails,
                p->outbox_text + index * outbox_text_bytes(p->outbox_mails), a->since_wall_ns);
    a->dedup = &p->dedup[index];
    dedup_clear(a->dedup);
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
    enum mu_kind kind = from ? from->kind : MU_KIND_ROBOT;
    mu_result joined = mu_agent_join(p, out, name, kind, last, handlers);
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
                               .epoch = a->epoch,
                               .kind = a->kind};
}

void mu_agent_set_out(mu_agent *a)
{
    a->epoch++;
    roll_mark(a);
}

bool mu_agent_is_settled(const mu_agent *a)
{
    return a->name_state == NAME_ACCEPTED && !outbox_has_unsent(&a->outbox) &&
           !outbox_has_unanswered(&a->outbox) && !queue_has(a, QUEUE_ACK) &&
           a->process->up_state != UP_PENDING;
}

struct mu_agent *agent_find(mu_process *p, const char *name)
{
    uint32_t index = mu_table_find(&p->names, name);
    return index == MU_NONE ? NULL : &p->agents[index];
}

void agent_progress(struct mu_agent *a)
{
    a->progress_ns = a->process->now_ns;
    queue_remove(a, QUEUE_WAIT);
    if (outbox_has_unanswered(&a->outbox)) {
        queue_add(a, QUEUE_WAIT);
    }
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
    if (a->exit != EXIT_PRESENT && !life_is_leaving(a)) {
        return MU_REFUSED; /* its last words are out, and the name may be another's */
    }
    mu_result put = outbox_put(&a->outbox, a->name, mail);
    if (put == MU_OK && a->name_state == NAME_ACCEPTED) {
        queue_add(a, QUEUE_SEND);
    }
    if (put == MU_OK && seq) {
        *seq = a->outbox.next_seq - 1;
    }
    return put;
}

bool agent_mail_answers(const struct mu_mail *mail)
{
    return mail->in_reply_to[0] != '\0' || mu_performative_answers(mail->performative);
}

/* The time of the run as the step at hand has it.  @return 0: this process is not told */
static uint64_t run_time_ns(const struct mu_process *p)
{
    return p->step ? p->step->time_ns : 0;
}

mu_result mu_agent_reply(mu_agent *a, const struct mu_mail *mail, const char *performative,
                         const char *content)
{
    if (agent_mail_answers(mail) && !mail->reply_with[0]) {
        return MU_REFUSED;
    }
    uint64_t now_ns = run_time_ns(a->process);
    bool limited = mail->reply_by_ns > 0 && now_ns > 0;
    if (limited && now_ns >= mail->reply_by_ns) {
        return MU_TIMEOUT;
    }
    char number[24];
    snprintf(number, sizeof number, "%llu", (unsigned long long)mail->seq);
    struct mu_mail answer = {.dst = mail->src,
                             .layer = mail->layer,
                             .performative = performative,
                             .language = mail->language,
                             .ontology = mail->ontology,
                             .in_reply_to = mail->reply_with[0] ? mail->reply_with : number,
                             .conversation = mail->conversation,
                             .content = content,
                             .ttl_ns = limited ? mail->reply_by_ns - now_ns : 0};
    return mu_agent_send(a, &answer, NULL);
}

mu_result agent_replay(struct mu_agent *a, uint64_t seq, const struct mu_mail *mail)
{
    bool follows = a->outbox.replays && seq == a->outbox.next_seq;
    if (!follows && a->outbox.first_seq != a->outbox.next_seq) {
        return MU_BUSY;
    }
    if (!follows) { /* mail that waits would be numbered anew */
        outbox_continue(&a->outbox, seq - 1);
    }
    if (seq != a->outbox.next_seq) {
        return MU_MALFORMED;
    }
    a->outbox.replays = true;
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
    a->speed = (struct agent_speed){true, forward_m_s, turn_rad_s};
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
