/* SPDX-License-Identifier: Apache-2.0 */
#include "agent/trip.h"

#include "agent/robot.h"
#include "core/clock.h"
#include "core/log.h"
#include "core/pieces.h"
#include "muster/memory.h"
#include "runtime/kind.h"
#include "runtime/trips.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* So long the broker may take for what was sent; the host for its word; the pages to show it. */
static const uint64_t SETTLE_NS = 5000000000;
static const uint64_t ANSWER_NS = 10000000000;
static const uint64_t NAME_NS = 5000000000;

void trip_reserve(struct crew *c)
{
    c->trips_max = c->count < MU_CAPSULES_MAX ? c->count : MU_CAPSULES_MAX;
    c->trips = mu_startup_array(c->trips_max, sizeof *c->trips);
    for (uint32_t i = 0; i < c->trips_max; i++) {
        mu_text_init(&c->trips[i].text, mu_startup_alloc(TRIP_CAPSULE_MAX), TRIP_CAPSULE_MAX);
    }
}

bool trip_holds(const struct robot *r)
{
    return r->trip && r->trip->phase > TRIP_DEPARTS && r->trip->purpose == TRIP_MOVE;
}

/* @return a trip that nobody is on, or NULL */
static struct trip *trip_find_free(struct crew *c)
{
    for (uint32_t i = 0; i < c->trips_max; i++) {
        if (!c->trips[i].robot) {
            return &c->trips[i];
        }
    }
    return NULL;
}

/* While one of them waits for its host's word, the process waits for no step. */
static void under_way_tell(struct crew *c)
{
    bool any = false;
    for (uint32_t i = 0; i < c->trips_max; i++) {
        any = any || c->trips[i].phase >= TRIP_KEPT;
    }
    trips_set_under_way(c->process, any);
}

/* --- who speaks ------------------------------------------------------------------------------- */

static void envoy_on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    (void)trip_take_answer(self, mail);
}

/* Who is on its way takes no mail, so that another one speaks for it: the host, where there is one,
 * else an agent of the process's own.  @return NULL: there is no room for it */
static mu_agent *envoy(struct crew *c)
{
    char name[MU_NAME_MAX + 1];
    struct mu_handlers handlers = {.self = c, .on_mail = envoy_on_mail};
    if (c->envoy) {
        return c->envoy;
    }
    snprintf(name, sizeof name, "envoy.%lx.%llx", (unsigned long)getpid() & 0xffffff,
             (unsigned long long)(mu_clock_wall_ns() / 1000000u) & 0xffffffffff);
    if (mu_agent_join(c->process, &c->envoy, name, MU_KIND_AGENT, 0, &handlers) != MU_OK) {
        c->envoy = NULL;
        return NULL;
    }
    mu_agent_decline_broadcasts(c->envoy);
    return c->envoy;
}

/* Tells whoever asked what became of it; a trip without an asker: nobody.  In lock step no envoy
 * comes, and an agent without a host speaks for itself when nothing comes of it; else the host does
 * to which it, or its copy, has come. */
static void trip_tell(const struct trip *t, struct robot *r, bool done, const char *text)
{
    struct crew *c = r->crew;
    bool lockstep = mu_process_in_lockstep(c->process);
    if (!t->reply_with[0] || (lockstep && done)) {
        return;
    }
    mu_agent *speaker = lockstep && !c->envoy ? r->agent : envoy(c);
    struct mu_mail mail = {.dst = t->asker,
                           .performative = done ? "inform" : "failure",
                           .in_reply_to = t->reply_with,
                           .content = text};
    if (speaker && mu_agent_send(speaker, &mail, NULL) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", t->asker);
    }
}

/* --- how it ends ------------------------------------------------------------------------------ */

static const char *verb_of(const struct trip *t)
{
    return t->purpose == TRIP_MOVE ? "moveTo" : "clone";
}

static void trip_end(struct trip *t, bool done, const char *text)
{
    struct robot *r = t->robot;
    t->phase = TRIP_NONE;
    t->robot = NULL;
    r->trip = NULL;
    under_way_tell(r->crew);
    mu_log(done ? MU_LOG_INFO : MU_LOG_WARNING, done ? "trip-done" : "trip-refused",
           "name=%s to=%s %s", r->name, t->host, text);
    trip_tell(t, r, done, text);
}

/* Nothing has happened: the agent goes on here, and its rules hear why. */
static void trip_fail(struct trip *t, const char *reason)
{
    struct robot *r = t->robot;
    char change[2 * MU_NAME_MAX], said[MU_FIELD_MAX + MU_NAME_MAX + 16];
    snprintf(change, sizeof change, "%s %s", verb_of(t),
             t->purpose == TRIP_MOVE ? t->host : t->name);
    snprintf(said, sizeof said, "%s %.63s", r->name, reason);
    mind_refused(r->mind, change, reason);
    bool deposited = t->phase == TRIP_DEPOSITED && t->purpose == TRIP_MOVE;
    trip_end(t, false, said);
    if (deposited) { /* the broker's copy is one journey ahead */
        mu_agent_set_out(r->agent);
        mu_agent_set_out(r->agent);
    }
    if (t->purpose == TRIP_MOVE && mu_agent_state(r->agent) == MU_MOVING) {
        mu_agent_set_out(r->agent); /* the host may have a copy yet */
        mu_agent_set_state(r->agent, t->was);
    }
}

static const char *objection(struct robot *r, const struct mind_travel *w, const char *host)
{
    struct crew *c = r->crew;
    const struct mu_member *m = mu_process_lookup(c->process, host);
    const struct mu_member *taken = mu_process_lookup(c->process, w->name);
    if (r->trip || !trip_find_free(c)) {
        return "busy";
    }
    if (!host[0] || !m || m->kind != MU_KIND_HOST) {
        return "unknown-host";
    }
    if (m->state == MU_GONE) {
        return "host-absent";
    }
    if (w->kind == MIND_MOVES && strcmp(host, c->host) == 0) {
        return "here-already";
    }
    return w->kind == MIND_CLONES && taken && taken->state != MU_GONE ? "name-taken" : NULL;
}

static void trip_fill(struct robot *r, const struct mind_travel *w, const char *host,
                      const struct mu_mail *asked)
{
    struct trip *t = trip_find_free(r->crew);
    t->robot = r;
    r->trip = t;
    t->purpose = w->kind == MIND_CLONES ? TRIP_CLONE : TRIP_MOVE;
    t->was = mu_agent_state(r->agent);
    t->passage = (struct mu_passage){.epoch = 0};
    t->sent = t->piece = 0;
    t->left = false;
    t->until_ns = mu_clock_ns() + SETTLE_NS;
    snprintf(t->id, sizeof t->id, "trip-%llx-%llu",
             (unsigned long long)(mu_clock_wall_ns() / 1000u),
             (unsigned long long)++r->crew->trips_begun);
    (void)mu_text_copy(t->host, sizeof t->host, host);
    (void)mu_text_copy(t->name, sizeof t->name, w->name);
    (void)mu_text_copy(t->asker, sizeof t->asker, asked ? asked->src : "");
    (void)mu_text_copy(t->reply_with, sizeof t->reply_with, asked ? asked->reply_with : "");
}

const char *trip_write(struct robot *r, const struct passport *p, struct mu_text *out,
                       struct mu_fault *fault)
{
    struct mu_text rest;
    mu_text_clear(out);
    passport_add(out, p);
    mu_text_init(&rest, out->at + out->len, out->size - out->len);
    if (mind_save(r->mind, &rest, fault) != MU_OK) {
        return fault->text;
    }
    out->len += rest.len;
    return NULL;
}

/* Hands the capsule to the broker. */
static mu_result capsule_deposit(struct trip *t)
{
    struct robot *r = t->robot;
    static char nobody[1];
    bool moves = t->purpose == TRIP_MOVE;
    muster_Trip word = {.word = moves ? muster_TRIP_DEPOSIT : muster_TRIP_NEW,
                        .agent = moves ? r->name : t->name,
                        .asker = moves ? nobody : r->name,
                        .state = (muster_State)t->was,
                        .epoch = moves ? t->passage.epoch : 0,
                        .host = t->host,
                        .text = t->text.at};
    return trips_say(r->crew->process, &word);
}

/* In lock step the host answers for one that has come to it. */
static void asker_pass(const struct trip *t, struct passport *p)
{
    if (t->reply_with[0] && mu_process_in_lockstep(t->robot->crew->process)) {
        (void)mu_text_copy(p->asker, sizeof p->asker, t->asker);
        (void)mu_text_copy(p->reply_with, sizeof p->reply_with, t->reply_with);
    }
}

/* --- departure -------------------------------------------------------------------------------- */

/* As it is now: for the host it is a journey ahead of what it is here. */
static const char *departure_write(struct trip *t, struct mu_fault *fault)
{
    struct robot *r = t->robot;
    t->was = mu_agent_state(r->agent);
    t->passage = mu_agent_passage(r->agent);
    t->passage.epoch++;
    struct passport p = {.purpose = TRIP_MOVE,
                         .state = t->was,
                         .passage = t->passage,
                         .mails = r->mails,
                         .rules_left = r->rules_left};
    (void)mu_text_copy(p.name, sizeof p.name, r->name);
    asker_pass(t, &p);
    return trip_write(r, &p, &t->text, fault);
}

/* Who is copied stays what it is. */
static const char *copy_write(struct trip *t, struct mu_fault *fault)
{
    t->was = mu_agent_state(t->robot->agent);
    struct passport p = {.purpose = TRIP_CLONE, .state = t->was, .mails = t->robot->mails};
    (void)mu_text_copy(p.name, sizeof p.name, t->name);
    asker_pass(t, &p);
    return trip_write(t->robot, &p, &t->text, fault);
}

/* One answer to a step takes a few large capsules along; the others set out with the next. */
static void deposit(struct trip *t, const char *objection)
{
    size_t waiting = trips_bytes(t->robot->crew->process);
    if (!objection && waiting > 0 && waiting + t->text.len > TRIP_ANSWER_MAX) {
        return;
    }
    if (objection || capsule_deposit(t) != MU_OK) {
        trip_fail(t, objection ? objection : "busy");
        return;
    }
    t->phase = TRIP_DEPOSITED;
}

static void depart(struct trip *t)
{
    struct mu_fault fault;
    if (!t->left) {
        t->left = true;
        kind_event(t->robot->agent, MU_ON_LEAVE);
    }
    if (!trips_fits_answer(t->robot->agent)) {
        return; /* its last words need a step more */
    }
    deposit(t, departure_write(t, &fault));
}

/* It goes now, if it can. */
static void set_out(struct trip *t)
{
    if (t->robot->out || mu_agent_state(t->robot->agent) == MU_GONE) {
        trip_end(t, false, "gone");
    } else if (t->purpose == TRIP_CLONE) {
        struct mu_fault fault;
        deposit(t, copy_write(t, &fault));
    } else if (t->left || trips_fits_answer(t->robot->agent)) {
        depart(t);
    }
}

void trip_step_end(struct crew *c)
{
    for (uint32_t i = 0; i < c->trips_max; i++) {
        if (c->trips[i].phase == TRIP_DEPARTS) {
            set_out(&c->trips[i]);
        }
    }
}

/* Its capsule is on its way to the broker: it stands still. */
static void stand_still(struct trip *t)
{
    mu_agent_set_out(t->robot->agent);
    mu_agent_set_state(t->robot->agent, MU_MOVING);
    t->phase = TRIP_KEPT;
    t->until_ns = mu_clock_ns() + ANSWER_NS;
    under_way_tell(t->robot->crew);
}

void trip_step_answered(struct crew *c)
{
    for (uint32_t i = 0; i < c->trips_max && !mu_process_in_lockstep(c->process); i++) {
        struct trip *t = &c->trips[i];
        if (t->phase == TRIP_DEPOSITED && t->purpose == TRIP_MOVE) {
            stand_still(t);
        }
    }
}

/* Where no steps come, at once; what it has said goes out before. */
static void depart_now(struct trip *t)
{
    struct crew *c = t->robot->crew;
    if (trips_awaits_step(c->process)) {
        return;
    }
    if (mu_clock_ns() > t->until_ns) {
        trip_fail(t, "broker-silent");
    } else if (trips_all_sent(t->robot->agent)) {
        set_out(t);
        trip_step_answered(c);
    }
}

/* In lock step the host has it, or its copy, and answers for that from the next step on. */
static void departed(struct trip *t)
{
    struct robot *r = t->robot;
    if (t->purpose == TRIP_CLONE) {
        trip_end(t, true, t->name);
        return;
    }
    mu_agent_leave(r->agent);
    trip_end(t, true, "");
    robot_drop(r);
}

static void clone_begin(struct trip *t)
{
    struct mu_fault fault;
    const char *why = copy_write(t, &fault);
    t->phase = TRIP_SENDS;
    t->until_ns = mu_clock_ns() + ANSWER_NS;
    under_way_tell(t->robot->crew);
    if (why) {
        trip_fail(t, why);
    }
}

/* A host speaks for its agents. */
static void refusal_answer(struct robot *r, const struct mu_mail *asked, const char *said)
{
    mu_agent *speaker = r->crew->host[0] ? r->crew->envoy : r->agent;
    if (asked && asked->reply_with[0] && mu_agent_reply(speaker, asked, "failure", said) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", asked->src);
    }
}

mu_result trip_begin(struct robot *r, const struct mind_travel *w, const struct mu_mail *asked)
{
    struct crew *c = r->crew;
    const char *host = w->host[0] ? w->host : c->host;
    const char *wrong = objection(r, w, host);
    if (wrong) {
        char change[2 * MU_NAME_MAX], said[MU_FIELD_MAX + MU_NAME_MAX + 16];
        bool moves = w->kind == MIND_MOVES;
        snprintf(change, sizeof change, "%s %s", moves ? "moveTo" : "clone",
                 moves ? host : w->name);
        snprintf(said, sizeof said, "%s %s", r->name, wrong);
        mind_refused(r->mind, change, wrong);
        refusal_answer(r, asked, said);
        return MU_REFUSED;
    }
    trip_fill(r, w, host, asked);
    if (r->trip->purpose == TRIP_CLONE && !mu_process_in_lockstep(c->process)) {
        clone_begin(r->trip);
        return MU_OK;
    }
    r->trip->phase = TRIP_DEPARTS;
    if (!mu_process_in_lockstep(c->process) && r->trip->reply_with[0]) {
        (void)envoy(c); /* who leaves its process empty has no time for that */
    }
    return MU_OK;
}

/* --- the way ---------------------------------------------------------------------------------- */

/* As many pieces as the outbox takes. */
static void pieces_send(struct trip *t)
{
    static char content[MU_CONTENT_MAX + 1];
    mu_agent *speaker = envoy(t->robot->crew);
    while (speaker && t->sent < t->text.len) {
        size_t bytes = mu_pieces_numbered(content, t->piece, t->text.at, t->text.len, t->sent);
        struct mu_mail mail = {.dst = t->host,
                               .layer = MU_LAYER_SYSTEM,
                               .performative = "arrive",
                               .language = "capsule",
                               .reply_with = t->id,
                               .conversation = t->id,
                               .content = content};
        if (mu_agent_send(speaker, &mail, NULL) != MU_OK) {
            return; /* full: it goes on when the broker has answered */
        }
        t->sent += bytes;
        t->piece++;
    }
    if (speaker) {
        t->phase = TRIP_WAITS;
    }
}

/* @return whether the white pages show the agent on the host, and no longer on its way */
static bool is_there(const struct trip *t)
{
    const struct mu_member *m = mu_process_lookup(t->robot->crew->process, t->robot->name);
    return m && m->state != MU_GONE && m->state != MU_MOVING && strcmp(m->host, t->host) == 0;
}

/* The host has it; the copy here goes. */
static void hand_over_end(struct trip *t)
{
    struct robot *r = t->robot;
    char said[2 * MU_NAME_MAX + 16];
    snprintf(said, sizeof said, "%s at %s", r->name, t->host);
    trip_end(t, true, said);
    robot_drop(r);
}

/* Nobody has it: whoever the broker gives the name now is the agent. */
static void hand_over_undo(struct trip *t)
{
    t->robot->returns_as = t->was;
    t->passage.epoch++; /* the host's copy is out of date, if it comes back */
    if (robot_arrive(t->robot, &t->passage, MU_ON_ARRIVE) != MU_OK) {
        robot_drop(t->robot);
    }
    trip_end(t, false, "the host has gone");
}

static void hand_over(struct trip *t)
{
    if (is_there(t)) {
        hand_over_end(t);
    } else if (mu_clock_ns() > t->until_ns) {
        hand_over_undo(t);
    }
}

static void answer_await(struct trip *t)
{
    const struct mu_member *m = mu_process_lookup(t->robot->crew->process, t->host);
    if (!m || m->state == MU_GONE) {
        trip_fail(t, "host-absent");
    } else if (mu_clock_ns() > t->until_ns) {
        trip_fail(t, "host-silent");
    }
}

/* Lets the name go, when nobody has anything more to say to the agent here. */
static void yield(struct trip *t)
{
    if (mu_agent_is_settled(t->robot->agent)) {
        t->phase = TRIP_HANDS_OVER;
        t->until_ns = mu_clock_ns() + NAME_NS;
        mu_agent_leave(t->robot->agent);
    } else if (mu_clock_ns() > t->until_ns) {
        trip_fail(t, "broker-silent");
    }
}

/* The host has made its copy and asked for the name: it is let go. */
static void answer_yes(struct trip *t)
{
    char said[2 * MU_NAME_MAX + 16];
    if (t->purpose == TRIP_CLONE) {
        snprintf(said, sizeof said, "%s at %s", t->name, t->host);
        trip_end(t, true, said);
        return;
    }
    t->phase = TRIP_YIELDS;
    t->until_ns = mu_clock_ns() + SETTLE_NS;
    yield(t);
}

/* Pieces for one host go out one agent after the other, and the time for its word counts from
 * then.  @return whether those of another one do */
static bool waits_for_another(const struct trip *t)
{
    const struct crew *c = t->robot->crew;
    bool waits = false;
    for (uint32_t i = 0; i < c->trips_max && t->sent == 0; i++) {
        const struct trip *other = &c->trips[i];
        bool sends = other->phase == TRIP_WAITS || (other->phase == TRIP_SENDS && other->sent > 0);
        waits = waits || (other != t && sends && strcmp(other->host, t->host) == 0);
    }
    return waits;
}

static void trip_go_on(struct trip *t)
{
    switch (t->phase) {
    case TRIP_NONE:
    case TRIP_DEPOSITED: return;
    case TRIP_DEPARTS: depart_now(t); return;
    case TRIP_SENDS:
        if (waits_for_another(t)) {
            t->until_ns = mu_clock_ns() + ANSWER_NS;
        } else {
            pieces_send(t);
        }
        answer_await(t);
        return;
    case TRIP_KEPT:
    case TRIP_WAITS: answer_await(t); return;
    case TRIP_YIELDS: yield(t); return;
    case TRIP_HANDS_OVER: hand_over(t); return;
    }
}

void trip_round(struct crew *c)
{
    for (uint32_t i = 0; i < c->trips_max; i++) {
        trip_go_on(&c->trips[i]);
    }
}

/* The host refuses, or is no more.  Who has let go takes the agent back. */
static void refused(struct trip *t, const char *reason)
{
    if (t->phase == TRIP_HANDS_OVER) {
        hand_over_undo(t);
    } else if (t->phase == TRIP_DEPOSITED || t->phase == TRIP_KEPT || t->phase == TRIP_YIELDS) {
        trip_fail(t, reason);
    }
}

/* What is said of an earlier journey of the same agent is not. */
static bool trip_is_meant(const struct trip *t, const muster_Trip *word)
{
    if (t->phase == TRIP_NONE || t->passage.epoch != word->epoch) {
        return false;
    }
    bool moves = t->purpose == TRIP_MOVE;
    return strcmp(word->agent, moves ? t->robot->name : t->name) == 0 &&
           strcmp(word->asker, moves ? "" : t->robot->name) == 0;
}

static void word_take(struct trip *t, const muster_Trip *word)
{
    if (word->word == muster_TRIP_REFUSED) {
        refused(t, word->reason);
    } else if (word->word == muster_TRIP_TAKEN && t->phase == TRIP_DEPOSITED) {
        departed(t);
    } else if (word->word == muster_TRIP_TAKEN && t->phase == TRIP_HANDS_OVER) {
        hand_over_end(t);
    } else if (word->word == muster_TRIP_READY && t->phase == TRIP_KEPT) {
        answer_yes(t);
    } else if (word->word == muster_TRIP_STORED && t->phase == TRIP_KEPT) {
        t->phase = TRIP_SENDS;
    }
}

void trip_hear(struct crew *c, const muster_Trip *word)
{
    for (uint32_t i = 0; i < c->trips_max; i++) {
        if (trip_is_meant(&c->trips[i], word)) {
            word_take(&c->trips[i], word);
            return;
        }
    }
}

bool trip_take_answer(struct crew *c, const struct mu_mail *mail)
{
    struct trip *t = NULL;
    for (uint32_t i = 0; i < c->trips_max && !t; i++) {
        struct trip *at = &c->trips[i];
        bool ours = at->phase == TRIP_WAITS && strcmp(mail->in_reply_to, at->id) == 0 &&
                    strcmp(mail->src, at->host) == 0;
        t = ours ? at : NULL;
    }
    if (t && strcmp(mail->performative, "agree") == 0) {
        answer_yes(t);
    } else if (t) {
        trip_fail(t, mail->content);
    }
    return t != NULL;
}
