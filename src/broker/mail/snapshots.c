/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"

/* So long a host may be silent, with a run that waits for it, or with an agent that no other
 * process has: less than a simulator waits for any process. */
static const uint64_t HOST_NS = 3000000000;

/* A process that is gone by the network's word may have been slow only: a run waits for so
 * long. */
static const uint64_t LOSS_NS = 1000000000;

static struct snapshot *snapshot_of(struct broker *b, uint32_t agent)
{
    SNAPSHOTS_EACH (c, &b->snapshots) {
        if (c->phase != SNAPSHOT_FREE && c->agent == agent) {
            return c;
        }
    }
    return NULL;
}

/* @return whether it is at its host, whose word is awaited */
static bool is_out(const struct snapshot *c)
{
    return c->phase == SNAPSHOT_SENT || c->phase == SNAPSHOT_HOLDS;
}

/* --- words ------------------------------------------------------------------------------------ */

/* To a process that is no more, or an arrival whose snapshot has gone since. */
static bool word_is_void(const struct broker *b, const struct snapshot_word *w)
{
    const struct process *at = &b->processes.at[w->place];
    const struct snapshot *c = &b->snapshots.snapshots[w->snapshot];
    if (at->session == SESSION_FREE || strcmp(at->name, w->process) != 0) {
        return true;
    }
    return w->word == muster_TRIP_ARRIVE &&
           (!is_out(c) || strcmp(c->name, w->name) != 0 || c->epoch != w->epoch);
}

static void words_tidy(struct broker *b)
{
    struct snapshots *d = &b->snapshots;
    for (uint32_t i = d->words_count; i > 0; i--) {
        if (word_is_void(b, &d->words[i - 1])) {
            array_remove(d->words, sizeof d->words[0], &d->words_count, i - 1);
        }
    }
}

/* A word without a receiver, or one too many, is lost; a process that waits for it has a time
 * limit. */
static void word_say(struct broker *b, const struct snapshot_word *word, const char *name,
                     const char *reason)
{
    struct snapshots *d = &b->snapshots;
    if (word->place == MU_NONE) {
        return;
    }
    if (d->words_count == SNAPSHOT_WORDS) {
        words_tidy(b);
    }
    if (d->words_count == SNAPSHOT_WORDS) {
        d->lost++;
        return;
    }
    struct snapshot_word *said = &d->words[d->words_count++];
    *said = *word;
    (void)mu_text_copy(said->process, sizeof said->process, b->processes.at[word->place].name);
    (void)mu_text_copy(said->name, sizeof said->name, name);
    (void)mu_text_copy(said->reason, sizeof said->reason, reason);
    processes_wake(&b->processes, word->place);
}

void snapshots_tell(struct broker *b, const struct snapshot *c, uint32_t place, muster_TripWord say,
                    const char *reason)
{
    const struct snapshot_word word = {.place = place,
                                       .word = say,
                                       .asker = c->agent == MU_NONE ? c->asker : MU_NONE,
                                       .host = c->host,
                                       .at = c->target,
                                       .epoch = c->epoch,
                                       .snapshot = (uint32_t)(c - b->snapshots.snapshots)};
    word_say(b, &word, c->name, reason);
}

void snapshots_refuse_copy(struct broker *b, uint32_t place, uint32_t asker, const char *name,
                           uint64_t epoch, const char *reason)
{
    const struct snapshot_word word = {.place = place,
                                       .word = muster_TRIP_REFUSED,
                                       .asker = asker,
                                       .host = MU_NONE,
                                       .at = MU_NONE,
                                       .epoch = epoch};
    word_say(b, &word, name, reason);
}

bool snapshots_next(struct broker *b, uint32_t place, muster_Trip *out)
{
    struct snapshots *d = &b->snapshots;
    uint32_t i = 0;
    while (i < d->words_count && (d->words[i].place != place || word_is_void(b, &d->words[i]))) {
        if (d->words[i].place == place) {
            array_remove(d->words, sizeof d->words[0], &d->words_count, i);
        } else {
            i++;
        }
    }
    if (i == d->words_count) {
        return false;
    }
    const struct snapshot_word *w = &d->words[i];
    bool arrives = w->word == muster_TRIP_ARRIVE;
    d->open = i;
    *out = (muster_Trip){.word = w->word, .epoch = w->epoch};
    out->agent = sample_text(w->name);
    out->asker = sample_text(w->asker != MU_NONE ? b->registry.agents[w->asker].name : "");
    out->host = sample_text(w->host != MU_NONE ? b->registry.agents[w->host].name : "");
    out->process = sample_text(w->at != MU_NONE ? b->processes.at[w->at].name : "");
    out->reason = sample_text(w->reason);
    out->text = sample_text(arrives ? d->texts[w->snapshot] : "");
    return true;
}

void snapshots_sent(struct broker *b)
{
    struct snapshots *d = &b->snapshots;
    array_remove(d->words, sizeof d->words[0], &d->words_count, d->open);
}

/* --- keeping ---------------------------------------------------------------------------------- */

void snapshots_drop(struct broker *b, struct snapshot *c)
{
    b->snapshots.holding -= c->phase == SNAPSHOT_HOLDS;
    b->snapshots.count--;
    c->phase = SNAPSHOT_FREE;
    c->unsaved = b->journal.on && c->agent != MU_NONE; /* its line on disk goes */
    b->snapshots.unsaved |= c->unsaved;
}

/* @return a place for a snapshot of that agent, first that of an older one whose line on disk is to
 *         go; MU_NONE: for a new one's; NULL: there is none */
static struct snapshot *snapshot_take(struct broker *b, uint32_t agent)
{
    struct snapshots *d = &b->snapshots;
    struct snapshot *room = NULL, *c = agent != MU_NONE ? snapshot_of(b, agent) : NULL;
    if (c) {
        snapshots_drop(b, c);
    }
    for (uint32_t i = 0; i < MU_CAPSULES_MAX; i++) {
        struct snapshot *at = &d->snapshots[i];
        if (at->phase == SNAPSHOT_FREE && at->unsaved && at->agent == agent) {
            return at;
        }
        room = at->phase == SNAPSHOT_FREE && !at->unsaved && !room ? at : room;
    }
    return room;
}

struct snapshot *snapshots_add(struct broker *b, uint32_t agent, const char *name, uint64_t epoch,
                               const char *text)
{
    struct snapshot *c = snapshot_take(b, agent);
    if (!c) {
        return NULL;
    }
    *c = (struct snapshot){.phase = SNAPSHOT_KEPT,
                           .agent = agent,
                           .asker = agent,
                           .epoch = epoch,
                           .source = MU_NONE,
                           .target = MU_NONE,
                           .host = MU_NONE,
                           .unsaved = b->journal.on && agent != MU_NONE};
    (void)mu_text_copy(c->name, sizeof c->name, name);
    memcpy(b->snapshots.texts[c - b->snapshots.snapshots], text, strlen(text) + 1);
    b->snapshots.unsaved |= c->unsaved;
    b->snapshots.count++;
    b->snapshots.kept++;
    return c;
}

bool snapshots_restore(struct broker *b, uint32_t agent, uint64_t epoch, const char *text)
{
    size_t len = strnlen(text, MU_CAPSULE_MAX);
    bool fits = len > 0 && len < MU_CAPSULE_MAX && epoch > 0;
    const char *name = b->registry.agents[agent].name;
    struct snapshot *c = fits ? snapshots_add(b, agent, name, epoch, text) : NULL;
    if (c) {
        c->unsaved = false;
    }
    return c != NULL;
}

void snapshots_refuse(struct broker *b, struct snapshot *c, const char *reason)
{
    b->snapshots.refused++;
    b->snapshots.holding -= c->phase == SNAPSHOT_HOLDS;
    c->phase = SNAPSHOT_KEPT;
    snapshots_tell(b, c, c->source, muster_TRIP_REFUSED, reason);
    if (c->agent == MU_NONE) {
        snapshots_drop(b, c);
    }
}

void snapshots_send(struct broker *b, struct snapshot *c)
{
    c->target = b->registry.agents[c->host].process;
    c->phase = SNAPSHOT_SENT;
    c->until_ns = b->clock.now_ns + HOST_NS;
    snapshots_tell(b, c, c->target, muster_TRIP_ARRIVE, "");
}

struct snapshot *snapshots_answered_by(struct broker *b, uint32_t place, const muster_Trip *trip)
{
    SNAPSHOTS_EACH (c, &b->snapshots) {
        if (is_out(c) && c->target == place && c->epoch == trip->epoch &&
            strcmp(c->name, trip->agent) == 0) {
            return c;
        }
    }
    return NULL;
}

void snapshots_process_gone(struct broker *b, uint32_t place)
{
    SNAPSHOTS_EACH (c, &b->snapshots) {
        if (c->phase != SNAPSHOT_FREE && c->source == place) {
            c->source = MU_NONE;
        }
        if (c->phase == SNAPSHOT_HOLDS && c->target == place) {
            uint64_t until_ns = b->clock.now_ns + LOSS_NS;
            c->until_ns = c->until_ns < until_ns ? c->until_ns : until_ns;
        } else if (c->phase == SNAPSHOT_SENT && c->target == place) {
            snapshots_refuse(b, c, "host-absent");
        } else if (c->phase == SNAPSHOT_KEPT && c->target == place) {
            snapshots_tell(b, c, c->source, muster_TRIP_REFUSED,
                           "host-absent"); /* it takes it back */
            c->target = MU_NONE;
        }
    }
}

/* The agent lives at its target. */
static void snapshot_end(struct broker *b, struct snapshot *c)
{
    if (!c->seated) {
        c->target = b->registry.agents[c->agent].process;
        snapshots_tell(b, c, c->source, muster_TRIP_TAKEN, "");
    }
    snapshots_drop(b, c);
}

void snapshots_review(struct broker *b, uint32_t agent)
{
    struct snapshot *c = snapshot_of(b, agent);
    if (!c || c->phase == SNAPSHOT_HOLDS) {
        return;
    }
    const struct agent *a = &b->registry.agents[agent];
    bool lives = a->process != MU_NONE && a->is.state != muster_STATE_MOVING;
    bool elsewhere = a->process != c->source && a->is.epoch == c->epoch;
    if (a->is.epoch > c->epoch) {
        snapshots_drop(b, c);
    } else if (lives && elsewhere && c->phase == SNAPSHOT_KEPT &&
               !(c->seated && clock_by_steps(&b->clock))) {
        snapshot_end(b, c);
    }
}

void snapshots_heard(struct broker *b, uint32_t agent, uint32_t place)
{
    struct snapshot *c = snapshot_of(b, agent);
    if (c && c->phase == SNAPSHOT_KEPT && place != c->source) {
        snapshot_end(b, c);
    }
}

/* @return whether this is late word of an agent that has set out from there; behind a run, a bearer
 * of its name since another time is another one */
static bool has_left(const struct broker *b, const struct agent *a, uint32_t seat,
                     const struct presence *is)
{
    bool is_same = clock_by_steps(&b->clock) || is->since_wall_ns == a->left_wall_ns;
    return a->left == seat && is->epoch < a->is.epoch && is_same;
}

bool snapshots_overrule(const struct broker *b, uint32_t agent, uint32_t place,
                        const struct presence *is)
{
    const struct agent *a = &b->registry.agents[agent];
    const struct process *at = &b->processes.at[place];
    if ((a->passed && scope_is_inside(at->scope)) || has_left(b, a, at->seat, is)) {
        return true;
    }
    SNAPSHOTS_EACH (c, &b->snapshots) {
        if (c->phase == SNAPSHOT_HOLDS && strcmp(c->name, a->name) == 0 && c->target == place) {
            return true;
        }
    }
    return false;
}

uint64_t snapshots_epoch(struct broker *b, uint32_t agent)
{
    const struct snapshot *c = snapshot_of(b, agent);
    return c ? c->epoch : 0;
}

uint64_t snapshots_deadline_ns(const struct broker *b)
{
    uint64_t first_ns = UINT64_MAX;
    SNAPSHOTS_EACH (c, &b->snapshots) {
        bool holds = c->phase == SNAPSHOT_HOLDS;
        first_ns = holds && c->until_ns < first_ns ? c->until_ns : first_ns;
    }
    return first_ns;
}
