/* SPDX-License-Identifier: Apache-2.0 */
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

void migration_reserve(struct group_process *g)
{
    g->migrations_max = g->count < MU_CAPSULES_MAX ? g->count : MU_CAPSULES_MAX;
    g->migrations = mu_startup_array(g->migrations_max, sizeof *g->migrations);
    for (uint32_t i = 0; i < g->migrations_max; i++) {
        mu_text_init(&g->migrations[i].text, mu_startup_alloc(MIGRATION_SNAPSHOT_MAX),
                     MIGRATION_SNAPSHOT_MAX);
    }
}

/* @return a trip that nobody is on, or NULL */
static struct migration *migration_find_free(struct group_process *g)
{
    for (uint32_t i = 0; i < g->migrations_max; i++) {
        if (!g->migrations[i].robot) {
            return &g->migrations[i];
        }
    }
    return NULL;
}

/* While one of them waits for its host's word, the process waits for no step. */
static void under_way_tell(struct group_process *g)
{
    bool any = false;
    for (uint32_t i = 0; i < g->migrations_max; i++) {
        any = any || g->migrations[i].phase >= MIGRATION_KEPT;
    }
    trips_set_under_way(g->process, any);
}

/* --- who speaks ------------------------------------------------------------------------------- */

static void envoy_on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    (void)migration_take_answer(self, mail);
}

/* Who is on its way takes no mail, so that another one speaks for it: the host, where there is one,
 * else an agent of the process's own.  @return NULL: there is no room for it */
static mu_agent *envoy(struct group_process *g)
{
    char name[MU_NAME_MAX + 1];
    struct mu_handlers handlers = {.self = g, .on_mail = envoy_on_mail};
    if (g->envoy) {
        return g->envoy;
    }
    snprintf(name, sizeof name, "envoy.%lx.%llx", (unsigned long)getpid() & 0xffffff,
             (unsigned long long)(mu_clock_wall_ns() / 1000000u) & 0xffffffffff);
    if (mu_agent_join(g->process, &g->envoy, name, MU_KIND_AGENT, 0, &handlers) != MU_OK) {
        g->envoy = NULL;
        return NULL;
    }
    mu_agent_decline_broadcasts(g->envoy);
    return g->envoy;
}

/* Tells whoever asked what became of it; a trip without an asker: nobody.  In lock step no envoy
 * comes, and an agent without a host speaks for itself when nothing comes of it; else the host does
 * to which it, or its copy, has come. */
static void migration_tell(const struct migration *t, struct robot *r, bool done, const char *text)
{
    struct group_process *g = r->group;
    bool lockstep = mu_process_in_lockstep(g->process);
    if (!t->reply_with[0] || (lockstep && done)) {
        return;
    }
    mu_agent *speaker = lockstep && !g->envoy ? r->agent : envoy(g);
    struct mu_mail mail = {.dst = t->asker,
                           .performative = done ? "inform" : "failure",
                           .in_reply_to = t->reply_with,
                           .content = text};
    if (speaker && mu_agent_send(speaker, &mail, NULL) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", t->asker);
    }
}

/* --- how it ends ------------------------------------------------------------------------------ */

static const char *verb_of(const struct migration *t)
{
    return t->purpose == MIGRATION_MOVE ? "moveTo" : "clone";
}

static void migration_end(struct migration *t, bool done, const char *text)
{
    struct robot *r = t->robot;
    t->phase = MIGRATION_NONE;
    t->robot = NULL;
    r->migration = NULL;
    under_way_tell(r->group);
    mu_log(done ? MU_LOG_INFO : MU_LOG_WARNING, done ? "trip-done" : "trip-refused",
           "name=%s to=%s %s", r->name, t->host, text);
    migration_tell(t, r, done, text);
}

/* Nothing has happened: the agent goes on here, and its rules hear why. */
static void migration_fail(struct migration *t, const char *reason)
{
    struct robot *r = t->robot;
    char change[2 * MU_NAME_MAX], said[MU_FIELD_MAX + MU_NAME_MAX + 16];
    snprintf(change, sizeof change, "%s %s", verb_of(t),
             t->purpose == MIGRATION_MOVE ? t->host : t->name);
    snprintf(said, sizeof said, "%s %.63s", r->name, reason);
    mind_refused(r->mind, change, reason);
    bool deposited = t->phase == MIGRATION_DEPOSITED && t->purpose == MIGRATION_MOVE;
    migration_end(t, false, said);
    if (deposited) { /* the broker's copy is one journey ahead */
        mu_agent_set_out(r->agent);
        mu_agent_set_out(r->agent);
    }
    if (t->purpose == MIGRATION_MOVE && mu_agent_state(r->agent) == MU_MOVING) {
        mu_agent_set_out(r->agent); /* the host may have a copy yet */
        mu_agent_set_state(r->agent, t->was);
    }
}

static const char *objection(struct robot *r, const struct mind_travel *w, const char *host)
{
    struct group_process *g = r->group;
    const struct mu_member *m = mu_process_lookup(g->process, host);
    const struct mu_member *taken = mu_process_lookup(g->process, w->name);
    if (r->migration || !migration_find_free(g)) {
        return "busy";
    }
    if (!host[0] || !m || m->kind != MU_KIND_HOST) {
        return "unknown-host";
    }
    if (m->state == MU_GONE) {
        return "host-absent";
    }
    if (w->kind == MIND_MOVES && strcmp(host, g->host) == 0) {
        return "here-already";
    }
    return w->kind == MIND_CLONES && taken && taken->state != MU_GONE ? "name-taken" : NULL;
}

static void migration_fill(struct robot *r, const struct mind_travel *w, const char *host,
                           const struct mu_mail *asked)
{
    struct migration *t = migration_find_free(r->group);
    t->robot = r;
    r->migration = t;
    t->purpose = w->kind == MIND_CLONES ? MIGRATION_CLONE : MIGRATION_MOVE;
    t->was = mu_agent_state(r->agent);
    t->passage = (struct mu_passage){.epoch = 0};
    t->sent = t->piece = 0;
    t->left = false;
    t->until_ns = mu_clock_ns() + SETTLE_NS;
    snprintf(t->id, sizeof t->id, "trip-%llx-%llu",
             (unsigned long long)(mu_clock_wall_ns() / 1000u),
             (unsigned long long)++r->group->migrations_begun);
    (void)mu_text_copy(t->host, sizeof t->host, host);
    (void)mu_text_copy(t->name, sizeof t->name, w->name);
    (void)mu_text_copy(t->asker, sizeof t->asker, asked ? asked->src : "");
    (void)mu_text_copy(t->reply_with, sizeof t->reply_with, asked ? asked->reply_with : "");
}

/* Hands the capsule to the broker. */
static mu_result snapshot_deposit(struct migration *t)
{
    struct robot *r = t->robot;
    static char nobody[1];
    bool moves = t->purpose == MIGRATION_MOVE;
    muster_Trip word = {.word = moves ? muster_TRIP_DEPOSIT : muster_TRIP_NEW,
                        .agent = moves ? r->name : t->name,
                        .asker = moves ? nobody : r->name,
                        .state = (muster_State)t->was,
                        .epoch = moves ? t->passage.epoch : 0,
                        .host = t->host,
                        .text = t->text.at};
    return trips_say(r->group->process, &word);
}

/* In lock step the host answers for one that has come to it. */
static void asker_pass(const struct migration *t, struct snapshot_header *p)
{
    if (t->reply_with[0] && mu_process_in_lockstep(t->robot->group->process)) {
        (void)mu_text_copy(p->asker, sizeof p->asker, t->asker);
        (void)mu_text_copy(p->reply_with, sizeof p->reply_with, t->reply_with);
    }
}

/* --- departure -------------------------------------------------------------------------------- */

/* As it is now: for the host it is a journey ahead of what it is here. */
static const char *departure_write(struct migration *t, struct mu_fault *fault)
{
    struct robot *r = t->robot;
    t->was = mu_agent_state(r->agent);
    t->passage = mu_agent_passage(r->agent);
    t->passage.epoch++;
    struct snapshot_header p = {.purpose = MIGRATION_MOVE,
                                .state = t->was,
                                .passage = t->passage,
                                .mails = r->mails,
                                .rules_left = r->rules_left};
    (void)mu_text_copy(p.name, sizeof p.name, r->name);
    asker_pass(t, &p);
    return agent_write(r, &p, &t->text, fault);
}

/* Who is copied stays what it is. */
static const char *copy_write(struct migration *t, struct mu_fault *fault)
{
    t->was = mu_agent_state(t->robot->agent);
    struct snapshot_header p = {
        .purpose = MIGRATION_CLONE, .state = t->was, .mails = t->robot->mails};
    (void)mu_text_copy(p.name, sizeof p.name, t->name);
    asker_pass(t, &p);
    return agent_write(t->robot, &p, &t->text, fault);
}

/* One answer to a step takes a few large capsules along; the others set out with the next. */
static void deposit(struct migration *t, const char *objection)
{
    size_t waiting = trips_bytes(t->robot->group->process);
    if (!objection && waiting > 0 && waiting + t->text.len > MIGRATION_ANSWER_MAX) {
        return;
    }
    if (objection || snapshot_deposit(t) != MU_OK) {
        migration_fail(t, objection ? objection : "busy");
        return;
    }
    t->phase = MIGRATION_DEPOSITED;
}

static void depart(struct migration *t)
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
static void set_out(struct migration *t)
{
    if (t->robot->out || mu_agent_state(t->robot->agent) == MU_GONE) {
        migration_end(t, false, "gone");
    } else if (t->purpose == MIGRATION_CLONE) {
        struct mu_fault fault;
        deposit(t, copy_write(t, &fault));
    } else if (t->left || trips_fits_answer(t->robot->agent)) {
        depart(t);
    }
}

void migration_step_end(struct group_process *g)
{
    for (uint32_t i = 0; i < g->migrations_max; i++) {
        if (g->migrations[i].phase == MIGRATION_DEPARTS) {
            set_out(&g->migrations[i]);
        }
    }
}

/* Its capsule is on its way to the broker: it stands still. */
static void stand_still(struct migration *t)
{
    mu_agent_set_out(t->robot->agent);
    mu_agent_set_state(t->robot->agent, MU_MOVING);
    t->phase = MIGRATION_KEPT;
    t->until_ns = mu_clock_ns() + ANSWER_NS;
    under_way_tell(t->robot->group);
}

void migration_step_answered(struct group_process *g)
{
    for (uint32_t i = 0; i < g->migrations_max && !mu_process_in_lockstep(g->process); i++) {
        struct migration *t = &g->migrations[i];
        if (t->phase == MIGRATION_DEPOSITED && t->purpose == MIGRATION_MOVE) {
            stand_still(t);
        }
    }
}

/* Where no steps come, at once; what it has said goes out before. */
static void depart_now(struct migration *t)
{
    struct group_process *g = t->robot->group;
    if (trips_awaits_step(g->process)) {
        return;
    }
    if (mu_clock_ns() > t->until_ns) {
        migration_fail(t, "broker-silent");
    } else if (trips_all_sent(t->robot->agent)) {
        set_out(t);
        migration_step_answered(g);
    }
}

/* In lock step the host has it, or its copy, and answers for that from the next step on. */
static void departed(struct migration *t)
{
    struct robot *r = t->robot;
    if (t->purpose == MIGRATION_CLONE) {
        migration_end(t, true, t->name);
        return;
    }
    mu_agent_leave(r->agent);
    migration_end(t, true, "");
    group_process_drop(r);
}

static void clone_begin(struct migration *t)
{
    struct mu_fault fault;
    const char *why = copy_write(t, &fault);
    t->phase = MIGRATION_SENDS;
    t->until_ns = mu_clock_ns() + ANSWER_NS;
    under_way_tell(t->robot->group);
    if (why) {
        migration_fail(t, why);
    }
}

/* A host speaks for its agents. */
static void refusal_answer(struct robot *r, const struct mu_mail *asked, const char *said)
{
    mu_agent *speaker = r->group->host[0] ? r->group->envoy : r->agent;
    if (asked && asked->reply_with[0] && mu_agent_reply(speaker, asked, "failure", said) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", asked->src);
    }
}

mu_result migration_begin(struct robot *r, const struct mind_travel *w, const struct mu_mail *asked)
{
    struct group_process *g = r->group;
    const char *host = w->host[0] ? w->host : g->host;
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
    migration_fill(r, w, host, asked);
    if (r->migration->purpose == MIGRATION_CLONE && !mu_process_in_lockstep(g->process)) {
        clone_begin(r->migration);
        return MU_OK;
    }
    r->migration->phase = MIGRATION_DEPARTS;
    if (!mu_process_in_lockstep(g->process) && r->migration->reply_with[0]) {
        (void)envoy(g); /* who leaves its process empty has no time for that */
    }
    return MU_OK;
}

/* --- the way ---------------------------------------------------------------------------------- */

/* As many pieces as the outbox takes. */
static void pieces_send(struct migration *t)
{
    static char content[MU_CONTENT_MAX + 1];
    mu_agent *speaker = envoy(t->robot->group);
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
        t->phase = MIGRATION_WAITS;
    }
}

/* @return whether the white pages show the agent on the host, and no longer on its way */
static bool is_there(const struct migration *t)
{
    const struct mu_member *m = mu_process_lookup(t->robot->group->process, t->robot->name);
    return m && m->state != MU_GONE && m->state != MU_MOVING && strcmp(m->host, t->host) == 0;
}

/* The host has it; the copy here goes. */
static void hand_over_end(struct migration *t)
{
    struct robot *r = t->robot;
    char said[2 * MU_NAME_MAX + 16];
    snprintf(said, sizeof said, "%s at %s", r->name, t->host);
    migration_end(t, true, said);
    group_process_drop(r);
}

/* Nobody has it: whoever the broker gives the name now is the agent. */
static void hand_over_undo(struct migration *t)
{
    t->robot->returns_as = t->was;
    t->passage.epoch++; /* the host's copy is out of date, if it comes back */
    if (agent_arrive(t->robot, &t->passage, MU_ON_ARRIVE) != MU_OK) {
        group_process_drop(t->robot);
    }
    migration_end(t, false, "the host has gone");
}

static void hand_over(struct migration *t)
{
    if (is_there(t)) {
        hand_over_end(t);
    } else if (mu_clock_ns() > t->until_ns) {
        hand_over_undo(t);
    }
}

static void answer_await(struct migration *t)
{
    const struct mu_member *m = mu_process_lookup(t->robot->group->process, t->host);
    if (!m || m->state == MU_GONE) {
        migration_fail(t, "host-absent");
    } else if (mu_clock_ns() > t->until_ns) {
        migration_fail(t, "host-silent");
    }
}

/* Lets the name go, when nobody has anything more to say to the agent here. */
static void yield(struct migration *t)
{
    if (mu_agent_is_settled(t->robot->agent)) {
        t->phase = MIGRATION_HANDS_OVER;
        t->until_ns = mu_clock_ns() + NAME_NS;
        mu_agent_leave(t->robot->agent);
    } else if (mu_clock_ns() > t->until_ns) {
        migration_fail(t, "broker-silent");
    }
}

/* The host has made its copy and asked for the name: it is let go. */
static void answer_yes(struct migration *t)
{
    char said[2 * MU_NAME_MAX + 16];
    if (t->purpose == MIGRATION_CLONE) {
        snprintf(said, sizeof said, "%s at %s", t->name, t->host);
        migration_end(t, true, said);
        return;
    }
    t->phase = MIGRATION_YIELDS;
    t->until_ns = mu_clock_ns() + SETTLE_NS;
    yield(t);
}

/* Pieces for one host go out one agent after the other, and the time for its word counts from
 * then.  @return whether those of another one do */
static bool waits_for_another(const struct migration *t)
{
    const struct group_process *g = t->robot->group;
    bool waits = false;
    for (uint32_t i = 0; i < g->migrations_max && t->sent == 0; i++) {
        const struct migration *other = &g->migrations[i];
        bool sends =
            other->phase == MIGRATION_WAITS || (other->phase == MIGRATION_SENDS && other->sent > 0);
        waits = waits || (other != t && sends && strcmp(other->host, t->host) == 0);
    }
    return waits;
}

static void migration_go_on(struct migration *t)
{
    switch (t->phase) {
    case MIGRATION_NONE:
    case MIGRATION_DEPOSITED: return;
    case MIGRATION_DEPARTS: depart_now(t); return;
    case MIGRATION_SENDS:
        if (waits_for_another(t)) {
            t->until_ns = mu_clock_ns() + ANSWER_NS;
        } else {
            pieces_send(t);
        }
        answer_await(t);
        return;
    case MIGRATION_KEPT:
    case MIGRATION_WAITS: answer_await(t); return;
    case MIGRATION_YIELDS: yield(t); return;
    case MIGRATION_HANDS_OVER: hand_over(t); return;
    }
}

void migration_round(struct group_process *g)
{
    for (uint32_t i = 0; i < g->migrations_max; i++) {
        migration_go_on(&g->migrations[i]);
    }
}

/* The host refuses, or is no more.  Who has let go takes the agent back. */
static void refused(struct migration *t, const char *reason)
{
    if (t->phase == MIGRATION_HANDS_OVER) {
        hand_over_undo(t);
    } else if (t->phase == MIGRATION_DEPOSITED || t->phase == MIGRATION_KEPT ||
               t->phase == MIGRATION_YIELDS) {
        migration_fail(t, reason);
    }
}

/* What is said of an earlier journey of the same agent is not. */
static bool migration_is_meant(const struct migration *t, const muster_Trip *word)
{
    if (t->phase == MIGRATION_NONE || t->passage.epoch != word->epoch) {
        return false;
    }
    bool moves = t->purpose == MIGRATION_MOVE;
    return strcmp(word->agent, moves ? t->robot->name : t->name) == 0 &&
           strcmp(word->asker, moves ? "" : t->robot->name) == 0;
}

static void word_take(struct migration *t, const muster_Trip *word)
{
    if (word->word == muster_TRIP_REFUSED) {
        refused(t, word->reason);
    } else if (word->word == muster_TRIP_TAKEN && t->phase == MIGRATION_DEPOSITED) {
        departed(t);
    } else if (word->word == muster_TRIP_TAKEN && t->phase == MIGRATION_HANDS_OVER) {
        hand_over_end(t);
    } else if (word->word == muster_TRIP_READY && t->phase == MIGRATION_KEPT) {
        answer_yes(t);
    } else if (word->word == muster_TRIP_STORED && t->phase == MIGRATION_KEPT) {
        t->phase = MIGRATION_SENDS;
    }
}

void migration_hear(struct group_process *g, const muster_Trip *word)
{
    for (uint32_t i = 0; i < g->migrations_max; i++) {
        if (migration_is_meant(&g->migrations[i], word)) {
            word_take(&g->migrations[i], word);
            return;
        }
    }
}

bool migration_take_answer(struct group_process *g, const struct mu_mail *mail)
{
    struct migration *t = NULL;
    for (uint32_t i = 0; i < g->migrations_max && !t; i++) {
        struct migration *at = &g->migrations[i];
        bool ours = at->phase == MIGRATION_WAITS && strcmp(mail->in_reply_to, at->id) == 0 &&
                    strcmp(mail->src, at->host) == 0;
        t = ours ? at : NULL;
    }
    if (t && strcmp(mail->performative, "agree") == 0) {
        answer_yes(t);
    } else if (t) {
        migration_fail(t, mail->content);
    }
    return t != NULL;
}
