/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/membership/depot.h"

#include "broker/base/sample.h"
#include "broker/control/parts.h"
#include "broker/membership/presence.h"
#include "core/sort.h"
#include "core/text.h"
#include "muster/memory.h"

#include <string.h>

/* So long a host may be silent, with a lock step that waits for it, or with an agent that nobody
 * else has: less than a simulator waits for anybody. */
static const uint64_t HOST_NS = 3000000000;

/* Who is gone by the network's word may have been slow only: a lock step waits for so long. */
static const uint64_t LOSS_NS = 1000000000;

/* Who is absent for so long has no source that would take it back, or host that has only not said
 * yet that it has it. */
static const uint64_t ORPHAN_NS = 2000000000;

void depot_init(struct depot *d)
{
    for (uint32_t i = 0; i < MU_CAPSULES_MAX; i++) {
        d->capsules[i].text = mu_startup_alloc(MU_CAPSULE_MAX);
    }
}

static uint32_t capsule_find(const struct broker *b, uint32_t agent)
{
    const struct depot *d = &b->depot;
    for (uint32_t i = 0; i < MU_CAPSULES_MAX && d->count > 0; i++) {
        if (d->capsules[i].phase != DEPOT_FREE && d->capsules[i].agent == agent) {
            return i;
        }
    }
    return MU_NONE;
}

static struct depot_capsule *capsule_of(struct broker *b, uint32_t agent)
{
    uint32_t i = capsule_find(b, agent);
    return i != MU_NONE ? &b->depot.capsules[i] : NULL;
}

/* --- words ------------------------------------------------------------------------------------ */

/* To a process that is no more, or an arrival whose capsule has gone since. */
static bool word_is_void(const struct broker *b, const struct depot_word *w)
{
    const struct place *at = &b->places.at[w->place];
    const struct depot_capsule *c = &b->depot.capsules[w->capsule];
    if (!at->used || strcmp(at->name, w->process) != 0) {
        return true;
    }
    return w->word == muster_TRIP_ARRIVE &&
           (c->phase != DEPOT_SENT || strcmp(c->name, w->name) != 0 || c->epoch != w->epoch);
}

static void word_remove(struct depot *d, uint32_t i)
{
    d->words_count--;
    memmove(&d->words[i], &d->words[i + 1], (d->words_count - i) * sizeof d->words[0]);
}

static void words_tidy(struct broker *b)
{
    for (uint32_t i = b->depot.words_count; i > 0; i--) {
        if (word_is_void(b, &b->depot.words[i - 1])) {
            word_remove(&b->depot, i - 1);
        }
    }
}

/* A word to nobody, or one too many, is lost; whoever waits for it has a time limit. */
static void word_say(struct broker *b, const struct depot_word *word)
{
    struct depot *d = &b->depot;
    if (word->place == MU_NONE) {
        return;
    }
    if (d->words_count == DEPOT_WORDS) {
        words_tidy(b);
    }
    if (d->words_count == DEPOT_WORDS) {
        d->lost++;
        return;
    }
    struct depot_word *said = &d->words[d->words_count++];
    *said = *word;
    (void)mu_text_copy(said->process, sizeof said->process, b->places.at[word->place].name);
    places_wake(&b->places, word->place);
}

static void word_of(struct broker *b, const struct depot_capsule *c, uint32_t place,
                    muster_TripWord say, const char *reason)
{
    struct depot_word word = {.place = place,
                              .word = say,
                              .asker = c->agent == MU_NONE ? c->asker : MU_NONE,
                              .host = c->host,
                              .at = c->target,
                              .epoch = c->epoch,
                              .capsule = (uint32_t)(c - b->depot.capsules)};
    (void)mu_text_copy(word.name, sizeof word.name, c->name);
    (void)mu_text_copy(word.reason, sizeof word.reason, reason);
    word_say(b, &word);
}

/* It is to drop the copy that it has made. */
static void copy_refuse(struct broker *b, uint32_t place, const char *name, uint64_t epoch,
                        const char *reason)
{
    struct depot_word word = {.place = place,
                              .word = muster_TRIP_REFUSED,
                              .asker = MU_NONE,
                              .host = MU_NONE,
                              .at = MU_NONE,
                              .epoch = epoch};
    (void)mu_text_copy(word.name, sizeof word.name, name);
    (void)mu_text_copy(word.reason, sizeof word.reason, reason);
    word_say(b, &word);
}

bool depot_next(struct broker *b, uint32_t place, muster_Trip *out)
{
    struct depot *d = &b->depot;
    uint32_t i = 0;
    while (i < d->words_count && (d->words[i].place != place || word_is_void(b, &d->words[i]))) {
        if (d->words[i].place == place) {
            word_remove(d, i);
        } else {
            i++;
        }
    }
    if (i == d->words_count) {
        return false;
    }
    const struct depot_word *w = &d->words[i];
    bool arrives = w->word == muster_TRIP_ARRIVE;
    d->open = i;
    *out = (muster_Trip){.word = w->word, .epoch = w->epoch};
    out->agent = sample_text(w->name);
    out->asker = sample_text(w->asker != MU_NONE ? b->registry.agents[w->asker].name : "");
    out->host = sample_text(w->host != MU_NONE ? b->registry.agents[w->host].name : "");
    out->process = sample_text(w->at != MU_NONE ? b->places.at[w->at].name : "");
    out->reason = sample_text(w->reason);
    out->text = sample_text(arrives ? d->capsules[w->capsule].text : "");
    return true;
}

void depot_sent(struct broker *b)
{
    word_remove(&b->depot, b->depot.open);
}

/* --- keeping ---------------------------------------------------------------------------------- */

static void capsule_drop(struct broker *b, struct depot_capsule *c)
{
    b->depot.holding -= c->holds;
    b->depot.count--;
    c->holds = false;
    c->phase = DEPOT_FREE;
    c->unsaved = b->journal.on && c->agent != MU_NONE; /* its line on disk goes */
}

/* @return a place for a capsule of that agent, first that of an older one whose line on disk is to
 *         go; MU_NONE: for a new one's; NULL: there is none */
static struct depot_capsule *capsule_take(struct broker *b, uint32_t agent)
{
    struct depot *d = &b->depot;
    struct depot_capsule *room = NULL, *c = agent != MU_NONE ? capsule_of(b, agent) : NULL;
    if (c) {
        capsule_drop(b, c);
    }
    for (uint32_t i = 0; i < MU_CAPSULES_MAX; i++) {
        struct depot_capsule *at = &d->capsules[i];
        if (at->phase == DEPOT_FREE && at->unsaved && at->agent == agent) {
            return at;
        }
        room = at->phase == DEPOT_FREE && !at->unsaved && !room ? at : room;
    }
    return room;
}

static struct depot_capsule *capsule_keep(struct broker *b, uint32_t agent, const char *name,
                                          uint64_t epoch, const char *text)
{
    struct depot_capsule *c = capsule_take(b, agent);
    if (!c) {
        return NULL;
    }
    *c = (struct depot_capsule){.phase = DEPOT_KEPT,
                                .agent = agent,
                                .asker = agent,
                                .epoch = epoch,
                                .source = MU_NONE,
                                .target = MU_NONE,
                                .host = MU_NONE,
                                .unsaved = b->journal.on && agent != MU_NONE,
                                .len = strlen(text),
                                .text = c->text};
    (void)mu_text_copy(c->name, sizeof c->name, name);
    memcpy(c->text, text, c->len + 1);
    b->depot.count++;
    b->depot.kept++;
    return c;
}

bool depot_restore(struct broker *b, uint32_t agent, uint64_t epoch, const char *text)
{
    size_t len = strnlen(text, MU_CAPSULE_MAX);
    bool fits = len > 0 && len < MU_CAPSULE_MAX;
    const char *name = b->registry.agents[agent].name;
    struct depot_capsule *c = fits ? capsule_keep(b, agent, name, epoch, text) : NULL;
    if (c) {
        c->unsaved = false;
    }
    return c != NULL;
}

/* --- the way ---------------------------------------------------------------------------------- */

static void step_release(struct broker *b)
{
    if (b->depot.holding == 0) {
        lockstep_release(b);
    }
}

/* It stays where it is, which the source hears; the capsule is kept until the source has said that
 * it goes on.  Nobody takes back who is new. */
static void capsule_refuse(struct broker *b, struct depot_capsule *c, const char *reason)
{
    bool held = c->holds;
    b->depot.refused++;
    b->depot.holding -= held;
    c->holds = false;
    c->phase = DEPOT_KEPT;
    word_of(b, c, c->source, muster_TRIP_REFUSED, reason);
    if (c->agent == MU_NONE) {
        capsule_drop(b, c);
    }
}

/* @return why an agent cannot be handed to the host that it names, or NULL */
static const char *objection(const struct broker *b, uint32_t host, bool in_step)
{
    const struct agent *a = host != MU_NONE ? &b->registry.agents[host] : NULL;
    if (!a || a->is.kind != muster_KIND_HOST) {
        return "unknown-host";
    }
    if (a->process == MU_NONE || (a->gone && !in_step)) { /* in lock step it may be slow only */
        return "host-absent";
    }
    return in_step && !b->places.at[a->process].rostered ? "lock-step" : NULL;
}

static void capsule_send(struct broker *b, struct depot_capsule *c)
{
    c->target = b->registry.agents[c->host].process;
    c->phase = DEPOT_SENT;
    c->until_ns = b->clock.now_ns + HOST_NS;
    word_of(b, c, c->target, muster_TRIP_ARRIVE, "");
}

static void deposit_refuse(struct broker *b, uint32_t place, const muster_Trip *trip,
                           const char *reason)
{
    struct depot_word word = {.place = place,
                              .word = muster_TRIP_REFUSED,
                              .asker = registry_find(&b->registry, trip->asker),
                              .host = MU_NONE,
                              .at = MU_NONE,
                              .epoch = trip->epoch};
    b->depot.refused++;
    (void)mu_text_copy(word.name, sizeof word.name, trip->agent);
    (void)mu_text_copy(word.reason, sizeof word.reason, reason);
    word_say(b, &word);
}

static void deposit_take(struct broker *b, uint32_t place, const muster_Trip *trip, bool in_step)
{
    uint32_t agent = registry_find(&b->registry, trip->agent);
    uint32_t host = registry_find(&b->registry, trip->host);
    if (agent == MU_NONE || b->registry.agents[agent].process != place) {
        b->counters.malformed++;
        return;
    }
    bool late = b->places.at[place].rostered && !in_step;
    const char *wrong = late ? "lock-step" : objection(b, host, in_step);
    struct depot_capsule *c =
        wrong ? NULL : capsule_keep(b, agent, trip->agent, trip->epoch, trip->text);
    if (!c) {
        deposit_refuse(b, place, trip, wrong ? wrong : "depot-full");
        return;
    }
    (void)mu_text_copy(c->home, sizeof c->home, b->places.at[place].name);
    c->state = trip->state;
    c->source = place;
    c->host = host;
    c->in_step = in_step;
    if (in_step) {
        c->phase = DEPOT_STEP;
    } else if (b->places.at[b->registry.agents[host].process].is_broker) {
        word_of(b, c, place, muster_TRIP_STORED, "");
    } else {
        capsule_send(b, c);
    }
}

/* Out of lock step a clone, or who is launched, goes to its host in pieces. */
static void new_take(struct broker *b, uint32_t place, const muster_Trip *trip, bool in_step)
{
    uint32_t asker = registry_find(&b->registry, trip->asker);
    if (asker == MU_NONE || b->registry.agents[asker].process != place ||
        registry_objection(trip->agent, muster_KIND_ROBOT)) {
        b->counters.malformed++;
        return;
    }
    struct depot_capsule *c =
        in_step ? capsule_keep(b, MU_NONE, trip->agent, trip->epoch, trip->text) : NULL;
    if (!c) {
        deposit_refuse(b, place, trip, in_step ? "depot-full" : "lock-step");
        return;
    }
    c->asker = asker;
    c->state = trip->state;
    c->source = place;
    c->host = registry_find(&b->registry, trip->host);
    c->phase = DEPOT_STEP;
}

/* @return whether an agent that moves has its name where it set out from */
static bool is_at_home(const struct broker *b, const struct depot_capsule *c)
{
    const struct agent *a = &b->registry.agents[c->agent];
    return a->process != MU_NONE && strcmp(b->places.at[a->process].name, c->home) == 0;
}

static void seat_tell(struct broker *b, struct depot_capsule *c)
{
    b->depot.taken++;
    b->depot.holding--;
    c->holds = false;
    c->seated = true;
    word_of(b, c, c->source, muster_TRIP_TAKEN, "");
    word_of(b, c, b->lockstep.simulator, muster_TRIP_TAKEN, "");
}

static void seat_refuse(struct broker *b, struct depot_capsule *c, const char *reason)
{
    copy_refuse(b, c->target, c->name, c->epoch, reason);
    capsule_refuse(b, c, reason);
    if (c->phase != DEPOT_FREE) {
        capsule_drop(b, c); /* the agent goes on as another process has it */
    }
}

/* The name goes from one process of a lock step to another, at once.  The one that it set out from
 * may have died meanwhile, and have a successor. */
static void seat_moved(struct broker *b, struct depot_capsule *c, uint32_t slot)
{
    const struct agent *a = &b->registry.agents[c->agent];
    bool free = a->process == MU_NONE;
    if (!free && !is_at_home(b, c)) {
        seat_refuse(b, c, "gone");
        return;
    }
    struct presence is = a->is;
    const struct agent *host = &b->registry.agents[c->host];
    is.epoch = c->epoch;
    is.pid = host->is.pid;
    is.state = free ? c->state : is.state;
    (void)mu_text_copy(is.host, sizeof is.host, host->name);
    (free ? presence_seat : presence_move)(b, c->agent, c->target, slot, &is);
    b->registry.agents[c->agent].handed = true;
    seat_tell(b, c);
    c->phase = DEPOT_KEPT;
}

static bool name_is_taken(const struct broker *b, const char *name)
{
    uint32_t agent = registry_find(&b->registry, name);
    return agent != MU_NONE && b->registry.agents[agent].process != MU_NONE;
}

/* A name is entered with its first process. */
static void seat_new(struct broker *b, struct depot_capsule *c, uint32_t slot)
{
    uint32_t agent = registry_find(&b->registry, c->name);
    const char *wrong = name_is_taken(b, c->name) ? "name-taken" : NULL;
    agent = agent != MU_NONE ? agent : registry_add(&b->registry, c->name);
    wrong = agent == MU_NONE ? "pages-full" : wrong;
    if (wrong) {
        seat_refuse(b, c, wrong);
        return;
    }
    const struct agent *host = &b->registry.agents[c->host];
    struct presence is = {.kind = muster_KIND_ROBOT,
                          .state = c->state,
                          .since_wall_ns = presence_wall_ns(b),
                          .pid = host->is.pid};
    (void)mu_text_copy(is.host, sizeof is.host, host->name);
    presence_seat(b, agent, c->target, slot, &is);
    b->registry.agents[agent].handed = true;
    seat_tell(b, c);
    capsule_drop(b, c);
}

static void seat(struct broker *b, struct depot_capsule *c, uint32_t slot)
{
    if (c->agent == MU_NONE) {
        seat_new(b, c, slot);
    } else {
        seat_moved(b, c, slot);
    }
    step_release(b);
}

/* A host has said something of a capsule that it was handed. */
static struct depot_capsule *capsule_answered(struct broker *b, uint32_t place,
                                              const muster_Trip *trip)
{
    for (uint32_t i = 0; i < MU_CAPSULES_MAX && b->depot.count > 0; i++) {
        struct depot_capsule *c = &b->depot.capsules[i];
        if (c->phase == DEPOT_SENT && c->target == place && c->epoch == trip->epoch &&
            strcmp(c->name, trip->agent) == 0) {
            return c;
        }
    }
    return NULL;
}

static void ready_take(struct broker *b, uint32_t place, const muster_Trip *trip)
{
    struct depot_capsule *c = capsule_answered(b, place, trip);
    if (!c) {
        copy_refuse(b, place, trip->agent, trip->epoch, "too-late");
    } else if (c->holds) {
        seat(b, c, trip->slot);
    } else {
        c->phase = DEPOT_KEPT;
        word_of(b, c, c->source, muster_TRIP_READY, "");
    }
}

static void refusal_take(struct broker *b, uint32_t place, const muster_Trip *trip)
{
    struct depot_capsule *c = capsule_answered(b, place, trip);
    if (c) {
        bool held = c->holds;
        capsule_refuse(b, c, trip->reason);
        if (held) {
            step_release(b);
        }
    }
}

/* Nobody bears its name, and nobody is about to: a host that has it has been silent for too long.
 */
static bool is_orphan(const struct broker *b, const struct depot_capsule *c)
{
    const struct agent *a = &b->registry.agents[c->agent];
    uint64_t absent_ns = presence_wall_ns(b) - a->since_wall_ns;
    bool silent = c->phase == DEPOT_SENT && !c->holds && c->source == MU_NONE &&
                  c->until_ns <= b->clock.now_ns;
    return (c->phase == DEPOT_KEPT || silent) && a->process == MU_NONE &&
           b->clock.now_ns >= ORPHAN_NS && absent_ns >= ORPHAN_NS;
}

/* Whom a lock step needs goes to a host of the run, when that has been started again. */
static bool is_for(const struct broker *b, const struct depot_capsule *c, uint32_t host)
{
    return !b->lockstep.on || !c->in_step || b->registry.agents[host].let_go;
}

static void wanted_take(struct broker *b, uint32_t place, const muster_Trip *trip)
{
    uint32_t host = registry_find(&b->registry, trip->host);
    if (objection(b, host, false) || b->registry.agents[host].process != place ||
        b->places.at[place].rostered) {
        return;
    }
    for (uint32_t i = 0; i < MU_CAPSULES_MAX && b->depot.count > 0; i++) {
        struct depot_capsule *c = &b->depot.capsules[i];
        if (is_orphan(b, c) && is_for(b, c, host)) {
            c->source = MU_NONE;
            c->host = host;
            b->depot.restored++;
            capsule_send(b, c);
        }
    }
}

void depot_hear(struct broker *b, uint32_t place, const muster_Trip *trip, bool in_step)
{
    switch (trip->word) {
    case muster_TRIP_DEPOSIT: deposit_take(b, place, trip, in_step); return;
    case muster_TRIP_READY: ready_take(b, place, trip); return;
    case muster_TRIP_REFUSED: refusal_take(b, place, trip); return;
    case muster_TRIP_WANTED: wanted_take(b, place, trip); return;
    case muster_TRIP_NEW: new_take(b, place, trip, in_step); return;
    case muster_TRIP_ARRIVE:
    case muster_TRIP_TAKEN:
    case muster_TRIP_STORED: b->counters.malformed++; return;
    }
}

/* --- lock step -------------------------------------------------------------------------------- */

/* @return whether another one of that name has been handed to its host, and has not come to life */
static bool name_is_awaited(const struct broker *b, const char *name)
{
    for (uint32_t i = 0; i < MU_CAPSULES_MAX; i++) {
        const struct depot_capsule *c = &b->depot.capsules[i];
        if (c->holds && c->agent == MU_NONE && strcmp(c->name, name) == 0) {
            return true;
        }
    }
    return false;
}

static void capsule_set_out(struct broker *b, struct depot_capsule *c)
{
    bool is_new = c->agent == MU_NONE;
    if (!is_new && !is_at_home(b, c)) { /* its process was let go of: this was never said */
        capsule_drop(b, c);
        return;
    }
    const char *wrong = objection(b, c->host, true);
    bool taken = is_new && (name_is_taken(b, c->name) || name_is_awaited(b, c->name));
    wrong = !wrong && taken ? "name-taken" : wrong;
    if (wrong) {
        capsule_refuse(b, c, wrong);
        return;
    }
    c->holds = true;
    b->depot.holding++;
    capsule_send(b, c);
}

static int asker_compare(const void *x, const void *y, const void *broker)
{
    const struct broker *b = broker;
    const struct depot_capsule *one = &b->depot.capsules[*(const uint32_t *)x];
    const struct depot_capsule *other = &b->depot.capsules[*(const uint32_t *)y];
    int askers = strcmp(b->registry.agents[one->asker].name, b->registry.agents[other->asker].name);
    return askers != 0 ? askers : strcmp(one->name, other->name);
}

/* Whose capsule came first depends on the clock; who sets out first does not. */
bool depot_step_ended(struct broker *b)
{
    struct depot *d = &b->depot;
    uint32_t order[MU_CAPSULES_MAX], count = 0;
    for (uint32_t i = 0; i < MU_CAPSULES_MAX && d->count > 0; i++) {
        if (d->capsules[i].phase == DEPOT_STEP) {
            order[count++] = i;
        }
    }
    mu_sort(order, count, sizeof order[0], asker_compare, b);
    for (uint32_t i = 0; i < count; i++) {
        capsule_set_out(b, &d->capsules[order[i]]);
    }
    return d->holding > 0;
}

void depot_lockstep_over(struct broker *b)
{
    for (uint32_t i = 0; i < MU_CAPSULES_MAX && b->depot.count > 0; i++) {
        struct depot_capsule *c = &b->depot.capsules[i];
        if (c->phase == DEPOT_STEP || c->holds) {
            capsule_refuse(b, c, "lock-step");
        }
    }
}

/* --- ends ------------------------------------------------------------------------------------- */

void depot_gone(struct broker *b, uint32_t place)
{
    for (uint32_t i = 0; i < MU_CAPSULES_MAX && b->depot.count > 0; i++) {
        struct depot_capsule *c = &b->depot.capsules[i];
        if (c->phase != DEPOT_FREE && c->source == place) {
            c->source = MU_NONE;
        }
        if (c->holds && c->target == place) {
            uint64_t until_ns = b->clock.now_ns + LOSS_NS;
            c->until_ns = c->until_ns < until_ns ? c->until_ns : until_ns;
        } else if (c->phase == DEPOT_SENT && c->target == place) {
            capsule_refuse(b, c, "host-absent");
        } else if (c->phase == DEPOT_KEPT && c->target == place) {
            word_of(b, c, c->source, muster_TRIP_REFUSED, "host-absent"); /* it takes it back */
            c->target = MU_NONE;
        }
    }
}

/* The agent lives at its target. */
static void capsule_end(struct broker *b, struct depot_capsule *c)
{
    if (!c->seated) {
        c->target = b->registry.agents[c->agent].process;
        word_of(b, c, c->source, muster_TRIP_TAKEN, "");
    }
    capsule_drop(b, c);
}

void depot_review(struct broker *b, uint32_t agent)
{
    struct depot_capsule *c = capsule_of(b, agent);
    if (!c || c->holds) {
        return;
    }
    const struct agent *a = &b->registry.agents[agent];
    bool lives = a->process != MU_NONE && a->is.state != muster_STATE_MOVING;
    bool elsewhere = a->process != c->source && a->is.epoch == c->epoch;
    if (a->is.epoch > c->epoch) {
        capsule_drop(b, c);
    } else if (lives && elsewhere && c->phase == DEPOT_KEPT && !(c->seated && b->lockstep.on)) {
        capsule_end(b, c);
    }
}

void depot_answered(struct broker *b, uint32_t agent, uint32_t place)
{
    struct depot_capsule *c = capsule_of(b, agent);
    if (c && !c->holds && c->phase == DEPOT_KEPT && place != c->source) {
        capsule_end(b, c);
    }
}

/* @return whether this is late word of who has set out from there; behind a run, who has its name
 * since another time is another one */
static bool has_left(const struct broker *b, const struct agent *a, uint32_t seat,
                     const struct presence *is)
{
    bool is_same = b->lockstep.on || is->since_wall_ns == a->left_wall_ns;
    return a->left == seat && is->epoch < a->is.epoch && is_same;
}

bool depot_overrules(const struct broker *b, uint32_t agent, uint32_t place,
                     const struct presence *is)
{
    const struct agent *a = &b->registry.agents[agent];
    const struct place *at = &b->places.at[place];
    if ((a->passed && at->rostered) || has_left(b, a, at->seat, is)) {
        return true;
    }
    for (uint32_t i = 0; i < MU_CAPSULES_MAX && b->depot.holding > 0; i++) {
        const struct depot_capsule *c = &b->depot.capsules[i];
        if (c->holds && strcmp(c->name, a->name) == 0 && c->target == place) {
            return true;
        }
    }
    return false;
}

bool depot_keeps(const struct broker *b, uint32_t agent)
{
    return capsule_find(b, agent) != MU_NONE;
}

bool depot_has_later(const struct broker *b, uint32_t agent, uint64_t epoch)
{
    uint32_t i = capsule_find(b, agent);
    return i != MU_NONE && epoch > 0 && b->depot.capsules[i].epoch > epoch;
}

uint64_t depot_deadline_ns(const struct broker *b)
{
    uint64_t first_ns = UINT64_MAX;
    for (uint32_t i = 0; i < MU_CAPSULES_MAX && b->depot.holding > 0; i++) {
        const struct depot_capsule *c = &b->depot.capsules[i];
        first_ns = c->holds && c->until_ns < first_ns ? c->until_ns : first_ns;
    }
    return first_ns;
}

void depot_tick(struct broker *b)
{
    for (uint32_t i = 0; i < MU_CAPSULES_MAX && b->depot.holding > 0; i++) {
        struct depot_capsule *c = &b->depot.capsules[i];
        if (c->holds && c->until_ns <= b->clock.now_ns) {
            copy_refuse(b, c->target, c->name, c->epoch, "too-late");
            capsule_refuse(b, c, "host-silent");
            step_release(b);
        }
    }
}
