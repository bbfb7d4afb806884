/* SPDX-License-Identifier: Apache-2.0 */
#include "agent/robot.h"
#include "core/clock.h"
#include "core/log.h"
#include "core/pieces.h"
#include "muster/memory.h"
#include "runtime/kind.h"
#include "runtime/transfers.h"

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
    transfers_set_under_way(g->process, any);
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
static void migration_tell(const struct migration *m, struct robot *r, bool done, const char *text)
{
    struct group_process *g = r->group;
    bool lockstep = mu_process_in_lockstep(g->process);
    if (!m->reply_with[0] || (lockstep && done)) {
        return;
    }
    mu_agent *speaker = lockstep && !g->envoy ? r->agent : envoy(g);
    struct mu_mail mail = {.dst = m->asker,
                           .performative = done ? "inform" : "failure",
                           .in_reply_to = m->reply_with,
                           .content = text};
    if (speaker && mu_agent_send(speaker, &mail, NULL) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", m->asker);
    }
}

static void enter(struct migration *m, enum migration_event event)
{
    migration_state_enter(&m->state, m->purpose, event);
}

/* --- how it ends ------------------------------------------------------------------------------ */

static const char *verb_of(const struct migration *m)
{
    return m->purpose == MIGRATION_MOVE ? "moveTo" : "clone";
}

static void migration_end(struct migration *m, enum migration_event event, bool done,
                          const char *text)
{
    struct robot *r = m->robot;
    enter(m, event);
    MU_ASSERT(m->state == MIGRATION_STAYS);
    m->robot = NULL;
    r->migration = NULL;
    under_way_tell(r->group);
    mu_log(done ? MU_LOG_INFO : MU_LOG_WARNING, done ? "trip-done" : "trip-refused",
           "name=%s to=%s %s", r->name, m->host, text);
    migration_tell(m, r, done, text);
}

/* The agent goes on here, and its rules hear why. */
static void migration_fail(struct migration *m, enum migration_event event, const char *reason)
{
    struct robot *r = m->robot;
    char change[2 * MU_NAME_MAX], said[MU_FIELD_MAX + MU_NAME_MAX + 16];
    snprintf(change, sizeof change, "%s %s", verb_of(m),
             m->purpose == MIGRATION_MOVE ? m->host : m->name);
    snprintf(said, sizeof said, "%s %.63s", r->name, reason);
    mind_refused(r->mind, change, reason);
    bool deposited = m->state == MIGRATION_DEPOSITED && m->purpose == MIGRATION_MOVE;
    migration_end(m, event, false, said);
    if (deposited) { /* the broker's copy is one epoch ahead */
        mu_agent_set_out(r->agent);
        mu_agent_set_out(r->agent);
    }
    if (m->purpose == MIGRATION_MOVE && mu_agent_state(r->agent) == MU_MOVING) {
        mu_agent_set_out(r->agent); /* the host may have a copy */
        mu_agent_set_state(r->agent, m->was);
    }
}

static const char *objection(struct robot *r, const struct mind_travel *w, const char *host)
{
    struct group_process *g = r->group;
    const struct mu_member *member = mu_process_lookup(g->process, host);
    const struct mu_member *taken = mu_process_lookup(g->process, w->name);
    if (r->migration || !migration_find_free(g)) {
        return "busy";
    }
    if (!host[0] || !member || member->kind != MU_KIND_HOST) {
        return "unknown-host";
    }
    if (member->state == MU_GONE) {
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
    struct migration *m = migration_find_free(r->group);
    m->robot = r;
    r->migration = m;
    m->purpose = w->kind == MIND_CLONES ? MIGRATION_CLONE : MIGRATION_MOVE;
    m->was = mu_agent_state(r->agent);
    m->passage = (struct mu_passage){.epoch = 0};
    m->sent = m->piece = 0;
    m->until_ns = mu_clock_ns() + SETTLE_NS;
    snprintf(m->id, sizeof m->id, "trip-%llx-%llu",
             (unsigned long long)(mu_clock_wall_ns() / 1000u),
             (unsigned long long)++r->group->migrations_begun);
    (void)mu_text_copy(m->host, sizeof m->host, host);
    (void)mu_text_copy(m->name, sizeof m->name, w->name);
    (void)mu_text_copy(m->asker, sizeof m->asker, asked ? asked->src : "");
    (void)mu_text_copy(m->reply_with, sizeof m->reply_with, asked ? asked->reply_with : "");
}

/* Gives the snapshot to the broker. */
static mu_result snapshot_deposit(struct migration *m)
{
    struct robot *r = m->robot;
    static char nobody[1];
    bool moves = m->purpose == MIGRATION_MOVE;
    muster_Trip word = {.word = moves ? muster_TRIP_DEPOSIT : muster_TRIP_NEW,
                        .agent = moves ? r->name : m->name,
                        .asker = moves ? nobody : r->name,
                        .state = (muster_State)m->was,
                        .epoch = moves ? m->passage.epoch : 0,
                        .host = m->host,
                        .text = m->text.at};
    return transfers_say(r->group->process, &word);
}

/* In lock step the target host answers for an agent that has arrived. */
static void asker_pass(const struct migration *m, struct snapshot_header *p)
{
    if (m->reply_with[0] && mu_process_in_lockstep(m->robot->group->process)) {
        (void)mu_text_copy(p->asker, sizeof p->asker, m->asker);
        (void)mu_text_copy(p->reply_with, sizeof p->reply_with, m->reply_with);
    }
}

/* --- departure -------------------------------------------------------------------------------- */

/* Writes the agent as it is now; the host's copy is one epoch ahead. */
static const char *departure_write(struct migration *m, struct mu_fault *fault)
{
    struct robot *r = m->robot;
    m->was = mu_agent_state(r->agent);
    m->passage = mu_agent_passage(r->agent);
    m->passage.epoch++;
    struct snapshot_header p = {.purpose = MIGRATION_MOVE,
                                .state = m->was,
                                .passage = m->passage,
                                .mails = r->mails,
                                .rules_left = r->rules_left};
    (void)mu_text_copy(p.name, sizeof p.name, r->name);
    asker_pass(m, &p);
    return agent_write(r, &p, &m->text, fault);
}

/* Writes a copy; the agent itself stays as it is. */
static const char *copy_write(struct migration *m, struct mu_fault *fault)
{
    m->was = mu_agent_state(m->robot->agent);
    struct snapshot_header p = {
        .purpose = MIGRATION_CLONE, .state = m->was, .mails = m->robot->mails};
    p.passage.kind = mu_agent_passage(m->robot->agent).kind;
    (void)mu_text_copy(p.name, sizeof p.name, m->name);
    asker_pass(m, &p);
    return agent_write(m->robot, &p, &m->text, fault);
}

/* One answer to a step carries a few large snapshots; the rest go with the next. */
static void deposit(struct migration *m, const char *objection)
{
    size_t waiting = transfers_bytes(m->robot->group->process);
    if (!objection && waiting > 0 && waiting + m->text.len > MIGRATION_ANSWER_MAX) {
        return;
    }
    if (objection || snapshot_deposit(m) != MU_OK) {
        migration_fail(m, MIGRATION_FAILS, objection ? objection : "busy");
        return;
    }
    enter(m, MIGRATION_DEPOSITS);
}

static void depart(struct migration *m)
{
    struct mu_fault fault;
    if (m->state == MIGRATION_DEPARTS) {
        enter(m, MIGRATION_TAKES_LEAVE);
        kind_event(m->robot->agent, MU_ON_LEAVE);
    }
    if (!transfers_fits_answer(m->robot->agent)) {
        return; /* its last words need one more step */
    }
    deposit(m, departure_write(m, &fault));
}

/* Sets out, unless the agent has gone or its mail needs another step. */
static void set_out(struct migration *m)
{
    if (m->robot->state == ROBOT_VACANT || mu_agent_state(m->robot->agent) == MU_GONE) {
        migration_end(m, MIGRATION_GONE, false, "gone");
    } else if (m->purpose == MIGRATION_CLONE) {
        struct mu_fault fault;
        deposit(m, copy_write(m, &fault));
    } else if (m->state == MIGRATION_LAST_WORDS || transfers_fits_answer(m->robot->agent)) {
        depart(m);
    }
}

static bool is_departing(const struct migration *m)
{
    return m->state == MIGRATION_DEPARTS || m->state == MIGRATION_LAST_WORDS;
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
static void stand_still(struct migration *m)
{
    mu_agent_set_out(m->robot->agent);
    mu_agent_set_state(m->robot->agent, MU_MOVING);
    enter(m, MIGRATION_STANDS_STILL);
    m->until_ns = mu_clock_ns() + ANSWER_NS;
    under_way_tell(m->robot->group);
}

void migration_step_answered(struct group_process *g)
{
    for (uint32_t i = 0; i < g->migrations_max && !mu_process_in_lockstep(g->process); i++) {
        struct migration *m = &g->migrations[i];
        if (m->state == MIGRATION_DEPOSITED && m->purpose == MIGRATION_MOVE) {
            stand_still(m);
        }
    }
}

/* Sets out without waiting for a step, once all mail of the agent is out. */
static void depart_now(struct migration *m)
{
    struct group_process *g = m->robot->group;
    if (transfers_awaits_step(g->process)) {
        return;
    }
    if (mu_clock_ns() > m->until_ns) {
        migration_fail(m, MIGRATION_FAILS, "broker-silent");
    } else if (transfers_all_sent(m->robot->agent)) {
        set_out(m);
        migration_step_answered(g);
    }
}

/* In lock step the host has the agent or its copy, and answers for it from the next step on. */
static void departed(struct migration *m)
{
    struct robot *r = m->robot;
    if (m->purpose == MIGRATION_CLONE) {
        migration_end(m, MIGRATION_TAKEN, true, m->name);
        return;
    }
    mu_agent_leave(r->agent);
    migration_end(m, MIGRATION_TAKEN, true, "");
    group_process_drop(r);
}

static void clone_begin(struct migration *m)
{
    struct mu_fault fault;
    const char *why = copy_write(m, &fault);
    enter(m, MIGRATION_BEGINS_APART);
    m->until_ns = mu_clock_ns() + ANSWER_NS;
    under_way_tell(m->robot->group);
    if (why) {
        migration_fail(m, MIGRATION_FAILS, why);
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
static void pieces_send(struct migration *m)
{
    static char content[MU_CONTENT_MAX + 1];
    mu_agent *speaker = envoy(m->robot->group);
    while (speaker && m->sent < m->text.len) {
        size_t bytes = mu_pieces_numbered(content, m->piece, m->text.at, m->text.len, m->sent);
        struct mu_mail mail = {.dst = m->host,
                               .layer = MU_LAYER_SYSTEM,
                               .performative = "arrive",
                               .language = "capsule",
                               .reply_with = m->id,
                               .conversation = m->id,
                               .content = content};
        if (mu_agent_send(speaker, &mail, NULL) != MU_OK) {
            return; /* full: the rest follows when the broker has answered */
        }
        m->sent += bytes;
        m->piece++;
    }
    if (speaker) {
        enter(m, MIGRATION_SENT);
    }
}

/* @return whether the white pages show the agent on the host, and no longer on its way */
static bool is_there(const struct migration *m)
{
    const struct mu_member *member = mu_process_lookup(m->robot->group->process, m->robot->name);
    return member && member->state != MU_GONE && member->state != MU_MOVING &&
           strcmp(member->host, m->host) == 0;
}

/* Drops the agent here: the host has it. */
static void hand_over_end(struct migration *m, enum migration_event event)
{
    struct robot *r = m->robot;
    char said[2 * MU_NAME_MAX + 16];
    snprintf(said, sizeof said, "%s at %s", r->name, m->host);
    migration_end(m, event, true, said);
    group_process_drop(r);
}

/* Asks for the name again: the host did not take the agent. */
static void hand_over_undo(struct migration *m, enum migration_event event)
{
    m->robot->returns_as = m->was;
    m->passage.epoch++; /* a late copy of the host is out of date then */
    if (agent_arrive(m->robot, &m->passage, MU_ON_ARRIVE) != MU_OK) {
        group_process_drop(m->robot);
    }
    migration_end(m, event, false, "the host has gone");
}

static void hand_over(struct migration *m)
{
    if (is_there(m)) {
        hand_over_end(m, MIGRATION_SHOWN);
    } else if (mu_clock_ns() > m->until_ns) {
        hand_over_undo(m, MIGRATION_FAILS);
    }
}

static void answer_await(struct migration *m)
{
    const struct mu_member *member = mu_process_lookup(m->robot->group->process, m->host);
    if (!member || member->state == MU_GONE) {
        migration_fail(m, MIGRATION_FAILS, "host-absent");
    } else if (mu_clock_ns() > m->until_ns) {
        migration_fail(m, MIGRATION_FAILS, "host-silent");
    }
}

/* Releases the name when all that was sent has an answer. */
static void yield(struct migration *m)
{
    if (mu_agent_is_settled(m->robot->agent)) {
        enter(m, MIGRATION_SETTLED);
        m->until_ns = mu_clock_ns() + NAME_NS;
        mu_agent_leave(m->robot->agent);
    } else if (mu_clock_ns() > m->until_ns) {
        migration_fail(m, MIGRATION_FAILS, "broker-silent");
    }
}

/* The host has made its own agent and asks for the name. */
static void yield_begin(struct migration *m, enum migration_event event)
{
    enter(m, event);
    m->until_ns = mu_clock_ns() + SETTLE_NS;
    yield(m);
}

static void copy_end(struct migration *m)
{
    char said[2 * MU_NAME_MAX + 16];
    snprintf(said, sizeof said, "%s at %s", m->name, m->host);
    migration_end(m, MIGRATION_AGREED, true, said);
}

/* Pieces go to a host for one agent after the other.  The time for its word begins with the first
 * one.  @return whether another agent's pieces are going there */
static bool waits_for_another(const struct migration *m)
{
    const struct group_process *g = m->robot->group;
    bool waits = false;
    for (uint32_t i = 0; i < g->migrations_max && m->sent == 0; i++) {
        const struct migration *other = &g->migrations[i];
        bool sends =
            other->state == MIGRATION_WAITS || (other->state == MIGRATION_SENDS && other->sent > 0);
        waits = waits || (other != m && sends && strcmp(other->host, m->host) == 0);
    }
    return waits;
}

static void send_on(struct migration *m)
{
    if (waits_for_another(m)) {
        m->until_ns = mu_clock_ns() + ANSWER_NS;
    } else {
        pieces_send(m);
    }
    answer_await(m);
}

void migration_round(struct group_process *g)
{
    static void (*const go_on[MIGRATION_STATES])(struct migration * m) = {
        [MIGRATION_DEPARTS] = depart_now,  [MIGRATION_LAST_WORDS] = depart_now,
        [MIGRATION_KEPT] = answer_await,   [MIGRATION_SENDS] = send_on,
        [MIGRATION_WAITS] = answer_await,  [MIGRATION_YIELDS] = yield,
        [MIGRATION_HANDS_OVER] = hand_over};
    for (uint32_t i = 0; i < g->migrations_max; i++) {
        struct migration *m = &g->migrations[i];
        if (go_on[m->state]) {
            go_on[m->state](m);
        }
    }
}

/* Words about an earlier migration of the same agent have another epoch. */
static bool migration_is_meant(const struct migration *m, const muster_Trip *word)
{
    if (m->state == MIGRATION_STAYS || m->passage.epoch != word->epoch) {
        return false;
    }
    bool moves = m->purpose == MIGRATION_MOVE;
    return strcmp(word->agent, moves ? m->robot->name : m->name) == 0 &&
           strcmp(word->asker, moves ? "" : m->robot->name) == 0;
}

/* Takes the agent back if its name was released; else it stays. */
static void refused(struct migration *m, const muster_Trip *word)
{
    if (m->state == MIGRATION_HANDS_OVER) {
        hand_over_undo(m, MIGRATION_REFUSED);
    } else {
        migration_fail(m, MIGRATION_REFUSED, word->reason);
    }
}

static void taken(struct migration *m, const muster_Trip *word)
{
    (void)word;
    if (m->state == MIGRATION_HANDS_OVER) {
        hand_over_end(m, MIGRATION_TAKEN);
    } else {
        departed(m);
    }
}

static void ready(struct migration *m, const muster_Trip *word)
{
    (void)word;
    yield_begin(m, MIGRATION_READY);
}

static void stored(struct migration *m, const muster_Trip *word)
{
    (void)word;
    enter(m, MIGRATION_STORED);
}

/* A word that the state does not have, such as a repeated one, is counted and changes nothing. */
static void word_take(struct migration *m, const muster_Trip *word)
{
    static const struct {
        muster_TripWord word;
        enum migration_event event;
        void (*take)(struct migration *m, const muster_Trip *word);
    } words[] = {{muster_TRIP_REFUSED, MIGRATION_REFUSED, refused},
                 {muster_TRIP_TAKEN, MIGRATION_TAKEN, taken},
                 {muster_TRIP_READY, MIGRATION_READY, ready},
                 {muster_TRIP_STORED, MIGRATION_STORED, stored}};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (words[i].word == word->word &&
            migration_state_has(m->state, m->purpose, words[i].event)) {
            words[i].take(m, word);
            return;
        }
    }
    struct group_process *g = m->robot->group;
    mu_log(MU_LOG_INFO, "trip-unexpected", "name=%s word=%d state=%d words=%llu", word->agent,
           (int)word->word, (int)m->state, (unsigned long long)++g->migrations_unexpected);
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
    struct migration *m = NULL;
    for (uint32_t i = 0; i < g->migrations_max && !m; i++) {
        struct migration *at = &g->migrations[i];
        bool ours = at->state == MIGRATION_WAITS && strcmp(mail->in_reply_to, at->id) == 0 &&
                    strcmp(mail->src, at->host) == 0;
        m = ours ? at : NULL;
    }
    bool agrees = strcmp(mail->performative, "agree") == 0;
    if (m && !agrees) {
        migration_fail(m, MIGRATION_DECLINED, mail->content);
    } else if (m && m->purpose == MIGRATION_CLONE) {
        copy_end(m);
    } else if (m) {
        yield_begin(m, MIGRATION_AGREED);
    }
    return m != NULL;
}
