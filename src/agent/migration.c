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

/* Limits for the broker's receipts, for the host's word, and for the white pages. */
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

/* @return a free migration, or NULL */
static struct migration *migration_find_free(struct group_process *g)
{
    for (uint32_t i = 0; i < g->migrations_max; i++) {
        if (!g->migrations[i].robot) {
            return &g->migrations[i];
        }
    }
    return NULL;
}

/* Tells the runtime whether one waits for its host: then the process waits for no step. */
static void under_way_tell(struct group_process *g)
{
    bool any = false;
    for (uint32_t i = 0; i < g->migrations_max; i++) {
        any = any || g->migrations[i].state >= MIGRATION_KEPT;
    }
    trips_set_under_way(g->process, any);
}

/* --- the envoy ----------------------------------------------------------------------------------
 * */

static void envoy_on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    (void)migration_take_answer(self, mail);
}

/* An agent on its way takes no mail, so that an envoy speaks for it: the host, or an agent of the
 * process.  @return NULL: there is no room for one */
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

/* Tells the asker, if there is one, how the migration ended.  In lock step no envoy joins: a
 * success is told by the target host, a failure by the agent itself if it has no host. */
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

static void enter(struct migration *t, enum migration_event event)
{
    migration_state_enter(&t->state, t->purpose, event);
}

/* --- how it ends ------------------------------------------------------------------------------ */

static const char *verb_of(const struct migration *t)
{
    return t->purpose == MIGRATION_MOVE ? "moveTo" : "clone";
}

static void migration_end(struct migration *t, enum migration_event event, bool done,
                          const char *text)
{
    struct robot *r = t->robot;
    enter(t, event);
    MU_ASSERT(t->state == MIGRATION_STAYS);
    t->robot = NULL;
    r->migration = NULL;
    under_way_tell(r->group);
    mu_log(done ? MU_LOG_INFO : MU_LOG_WARNING, done ? "trip-done" : "trip-refused",
           "name=%s to=%s %s", r->name, t->host, text);
    migration_tell(t, r, done, text);
}

/* The agent goes on here, and its rules hear why. */
static void migration_fail(struct migration *t, enum migration_event event, const char *reason)
{
    struct robot *r = t->robot;
    char change[2 * MU_NAME_MAX], said[MU_FIELD_MAX + MU_NAME_MAX + 16];
    snprintf(change, sizeof change, "%s %s", verb_of(t),
             t->purpose == MIGRATION_MOVE ? t->host : t->name);
    snprintf(said, sizeof said, "%s %.63s", r->name, reason);
    mind_refused(r->mind, change, reason);
    bool deposited = t->state == MIGRATION_DEPOSITED && t->purpose == MIGRATION_MOVE;
    migration_end(t, event, false, said);
    if (deposited) { /* the broker's copy is one epoch ahead */
        mu_agent_set_out(r->agent);
        mu_agent_set_out(r->agent);
    }
    if (t->purpose == MIGRATION_MOVE && mu_agent_state(r->agent) == MU_MOVING) {
        mu_agent_set_out(r->agent); /* the host may have a copy */
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
    t->until_ns = mu_clock_ns() + SETTLE_NS;
    snprintf(t->id, sizeof t->id, "trip-%llx-%llu",
             (unsigned long long)(mu_clock_wall_ns() / 1000u),
             (unsigned long long)++r->group->migrations_begun);
    (void)mu_text_copy(t->host, sizeof t->host, host);
    (void)mu_text_copy(t->name, sizeof t->name, w->name);
    (void)mu_text_copy(t->asker, sizeof t->asker, asked ? asked->src : "");
    (void)mu_text_copy(t->reply_with, sizeof t->reply_with, asked ? asked->reply_with : "");
}

/* Gives the snapshot to the broker. */
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

/* In lock step the target host answers for an agent that has arrived. */
static void asker_pass(const struct migration *t, struct snapshot_header *p)
{
    if (t->reply_with[0] && mu_process_in_lockstep(t->robot->group->process)) {
        (void)mu_text_copy(p->asker, sizeof p->asker, t->asker);
        (void)mu_text_copy(p->reply_with, sizeof p->reply_with, t->reply_with);
    }
}

/* --- departure -------------------------------------------------------------------------------- */

/* Writes the agent as it is now; the host's copy is one epoch ahead. */
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

/* Writes a copy; the agent itself stays as it is. */
static const char *copy_write(struct migration *t, struct mu_fault *fault)
{
    t->was = mu_agent_state(t->robot->agent);
    struct snapshot_header p = {
        .purpose = MIGRATION_CLONE, .state = t->was, .mails = t->robot->mails};
    (void)mu_text_copy(p.name, sizeof p.name, t->name);
    asker_pass(t, &p);
    return agent_write(t->robot, &p, &t->text, fault);
}

/* One answer to a step carries a few large snapshots; the rest go with the next. */
static void deposit(struct migration *t, const char *objection)
{
    size_t waiting = trips_bytes(t->robot->group->process);
    if (!objection && waiting > 0 && waiting + t->text.len > MIGRATION_ANSWER_MAX) {
        return;
    }
    if (objection || snapshot_deposit(t) != MU_OK) {
        migration_fail(t, MIGRATION_FAILS, objection ? objection : "busy");
        return;
    }
    enter(t, MIGRATION_DEPOSITS);
}

static void depart(struct migration *t)
{
    struct mu_fault fault;
    if (t->state == MIGRATION_DEPARTS) {
        enter(t, MIGRATION_TAKES_LEAVE);
        kind_event(t->robot->agent, MU_ON_LEAVE);
    }
    if (!trips_fits_answer(t->robot->agent)) {
        return; /* its last words need one more step */
    }
    deposit(t, departure_write(t, &fault));
}

/* Sets out, unless the agent has gone or its mail needs another step. */
static void set_out(struct migration *t)
{
    if (t->robot->state == ROBOT_VACANT || mu_agent_state(t->robot->agent) == MU_GONE) {
        migration_end(t, MIGRATION_GONE, false, "gone");
    } else if (t->purpose == MIGRATION_CLONE) {
        struct mu_fault fault;
        deposit(t, copy_write(t, &fault));
    } else if (t->state == MIGRATION_LAST_WORDS || trips_fits_answer(t->robot->agent)) {
        depart(t);
    }
}

static bool is_departing(const struct migration *t)
{
    return t->state == MIGRATION_DEPARTS || t->state == MIGRATION_LAST_WORDS;
}

void migration_step_end(struct group_process *g)
{
    for (uint32_t i = 0; i < g->migrations_max; i++) {
        if (is_departing(&g->migrations[i])) {
            set_out(&g->migrations[i]);
        }
    }
}

/* The snapshot is on its way to the broker, so that the agent stands still. */
static void stand_still(struct migration *t)
{
    mu_agent_set_out(t->robot->agent);
    mu_agent_set_state(t->robot->agent, MU_MOVING);
    enter(t, MIGRATION_STANDS_STILL);
    t->until_ns = mu_clock_ns() + ANSWER_NS;
    under_way_tell(t->robot->group);
}

void migration_step_answered(struct group_process *g)
{
    for (uint32_t i = 0; i < g->migrations_max && !mu_process_in_lockstep(g->process); i++) {
        struct migration *t = &g->migrations[i];
        if (t->state == MIGRATION_DEPOSITED && t->purpose == MIGRATION_MOVE) {
            stand_still(t);
        }
    }
}

/* Sets out without waiting for a step, once all mail of the agent is out. */
static void depart_now(struct migration *t)
{
    struct group_process *g = t->robot->group;
    if (trips_awaits_step(g->process)) {
        return;
    }
    if (mu_clock_ns() > t->until_ns) {
        migration_fail(t, MIGRATION_FAILS, "broker-silent");
    } else if (trips_all_sent(t->robot->agent)) {
        set_out(t);
        migration_step_answered(g);
    }
}

/* In lock step the host has the agent or its copy, and answers for it from the next step on. */
static void departed(struct migration *t)
{
    struct robot *r = t->robot;
    if (t->purpose == MIGRATION_CLONE) {
        migration_end(t, MIGRATION_TAKEN, true, t->name);
        return;
    }
    mu_agent_leave(r->agent);
    migration_end(t, MIGRATION_TAKEN, true, "");
    group_process_drop(r);
}

static void clone_begin(struct migration *t)
{
    struct mu_fault fault;
    const char *why = copy_write(t, &fault);
    enter(t, MIGRATION_BEGINS_APART);
    t->until_ns = mu_clock_ns() + ANSWER_NS;
    under_way_tell(t->robot->group);
    if (why) {
        migration_fail(t, MIGRATION_FAILS, why);
    }
}

/* Answers a directive that cannot be followed; a host speaks for its agents. */
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
    enter(r->migration, MIGRATION_BEGINS);
    if (!mu_process_in_lockstep(g->process) && r->migration->reply_with[0]) {
        (void)envoy(g); /* an envoy could not join any more when the process is empty */
    }
    return MU_OK;
}

/* --- the way ---------------------------------------------------------------------------------- */

/* Sends as many pieces as the outbox takes. */
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
            return; /* full: the rest follows when the broker has answered */
        }
        t->sent += bytes;
        t->piece++;
    }
    if (speaker) {
        enter(t, MIGRATION_SENT);
    }
}

/* @return whether the white pages show the agent on the host, and no longer on its way */
static bool is_there(const struct migration *t)
{
    const struct mu_member *m = mu_process_lookup(t->robot->group->process, t->robot->name);
    return m && m->state != MU_GONE && m->state != MU_MOVING && strcmp(m->host, t->host) == 0;
}

/* Drops the agent here: the host has it. */
static void hand_over_end(struct migration *t, enum migration_event event)
{
    struct robot *r = t->robot;
    char said[2 * MU_NAME_MAX + 16];
    snprintf(said, sizeof said, "%s at %s", r->name, t->host);
    migration_end(t, event, true, said);
    group_process_drop(r);
}

/* Asks for the name again: the host did not take the agent. */
static void hand_over_undo(struct migration *t, enum migration_event event)
{
    t->robot->returns_as = t->was;
    t->passage.epoch++; /* a late copy of the host is out of date then */
    if (agent_arrive(t->robot, &t->passage, MU_ON_ARRIVE) != MU_OK) {
        group_process_drop(t->robot);
    }
    migration_end(t, event, false, "the host has gone");
}

static void hand_over(struct migration *t)
{
    if (is_there(t)) {
        hand_over_end(t, MIGRATION_SHOWN);
    } else if (mu_clock_ns() > t->until_ns) {
        hand_over_undo(t, MIGRATION_FAILS);
    }
}

static void answer_await(struct migration *t)
{
    const struct mu_member *m = mu_process_lookup(t->robot->group->process, t->host);
    if (!m || m->state == MU_GONE) {
        migration_fail(t, MIGRATION_FAILS, "host-absent");
    } else if (mu_clock_ns() > t->until_ns) {
        migration_fail(t, MIGRATION_FAILS, "host-silent");
    }
}

/* Releases the name when all that was sent has an answer. */
static void yield(struct migration *t)
{
    if (mu_agent_is_settled(t->robot->agent)) {
        enter(t, MIGRATION_SETTLED);
        t->until_ns = mu_clock_ns() + NAME_NS;
        mu_agent_leave(t->robot->agent);
    } else if (mu_clock_ns() > t->until_ns) {
        migration_fail(t, MIGRATION_FAILS, "broker-silent");
    }
}

/* The host has made its own agent and asks for the name. */
static void yield_begin(struct migration *t, enum migration_event event)
{
    enter(t, event);
    t->until_ns = mu_clock_ns() + SETTLE_NS;
    yield(t);
}

static void copy_end(struct migration *t)
{
    char said[2 * MU_NAME_MAX + 16];
    snprintf(said, sizeof said, "%s at %s", t->name, t->host);
    migration_end(t, MIGRATION_AGREED, true, said);
}

/* Pieces go to a host for one agent after the other.  The time for its word begins with the first
 * one.  @return whether another agent's pieces are going there */
static bool waits_for_another(const struct migration *t)
{
    const struct group_process *g = t->robot->group;
    bool waits = false;
    for (uint32_t i = 0; i < g->migrations_max && t->sent == 0; i++) {
        const struct migration *other = &g->migrations[i];
        bool sends =
            other->state == MIGRATION_WAITS || (other->state == MIGRATION_SENDS && other->sent > 0);
        waits = waits || (other != t && sends && strcmp(other->host, t->host) == 0);
    }
    return waits;
}

static void send_on(struct migration *t)
{
    if (waits_for_another(t)) {
        t->until_ns = mu_clock_ns() + ANSWER_NS;
    } else {
        pieces_send(t);
    }
    answer_await(t);
}

void migration_round(struct group_process *g)
{
    static void (*const go_on[MIGRATION_STATES])(struct migration * t) = {
        [MIGRATION_DEPARTS] = depart_now,  [MIGRATION_LAST_WORDS] = depart_now,
        [MIGRATION_KEPT] = answer_await,   [MIGRATION_SENDS] = send_on,
        [MIGRATION_WAITS] = answer_await,  [MIGRATION_YIELDS] = yield,
        [MIGRATION_HANDS_OVER] = hand_over};
    for (uint32_t i = 0; i < g->migrations_max; i++) {
        struct migration *t = &g->migrations[i];
        if (go_on[t->state]) {
            go_on[t->state](t);
        }
    }
}

/* Words about an earlier migration of the same agent have another epoch. */
static bool migration_is_meant(const struct migration *t, const muster_Trip *word)
{
    if (t->state == MIGRATION_STAYS || t->passage.epoch != word->epoch) {
        return false;
    }
    bool moves = t->purpose == MIGRATION_MOVE;
    return strcmp(word->agent, moves ? t->robot->name : t->name) == 0 &&
           strcmp(word->asker, moves ? "" : t->robot->name) == 0;
}

/* Takes the agent back if its name was released; else it stays. */
static void refused(struct migration *t, const muster_Trip *word)
{
    if (t->state == MIGRATION_HANDS_OVER) {
        hand_over_undo(t, MIGRATION_REFUSED);
    } else {
        migration_fail(t, MIGRATION_REFUSED, word->reason);
    }
}

static void taken(struct migration *t, const muster_Trip *word)
{
    (void)word;
    if (t->state == MIGRATION_HANDS_OVER) {
        hand_over_end(t, MIGRATION_TAKEN);
    } else {
        departed(t);
    }
}

static void ready(struct migration *t, const muster_Trip *word)
{
    (void)word;
    yield_begin(t, MIGRATION_READY);
}

static void stored(struct migration *t, const muster_Trip *word)
{
    (void)word;
    enter(t, MIGRATION_STORED);
}

/* A word that the state does not have, such as a repeated one, is counted and changes nothing. */
static void word_take(struct migration *t, const muster_Trip *word)
{
    static const struct {
        muster_TripWord word;
        enum migration_event event;
        void (*take)(struct migration *t, const muster_Trip *word);
    } words[] = {{muster_TRIP_REFUSED, MIGRATION_REFUSED, refused},
                 {muster_TRIP_TAKEN, MIGRATION_TAKEN, taken},
                 {muster_TRIP_READY, MIGRATION_READY, ready},
                 {muster_TRIP_STORED, MIGRATION_STORED, stored}};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (words[i].word == word->word &&
            migration_state_has(t->state, t->purpose, words[i].event)) {
            words[i].take(t, word);
            return;
        }
    }
    struct group_process *g = t->robot->group;
    mu_log(MU_LOG_INFO, "trip-unexpected", "name=%s word=%d state=%d words=%llu", word->agent,
           (int)word->word, (int)t->state, (unsigned long long)++g->migrations_unexpected);
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
        bool ours = at->state == MIGRATION_WAITS && strcmp(mail->in_reply_to, at->id) == 0 &&
                    strcmp(mail->src, at->host) == 0;
        t = ours ? at : NULL;
    }
    bool agrees = strcmp(mail->performative, "agree") == 0;
    if (t && !agrees) {
        migration_fail(t, MIGRATION_DECLINED, mail->content);
    } else if (t && t->purpose == MIGRATION_CLONE) {
        copy_end(t);
    } else if (t) {
        yield_begin(t, MIGRATION_AGREED);
    }
    return t != NULL;
}
