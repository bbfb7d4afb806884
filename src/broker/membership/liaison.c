/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/membership/liaison.h"

#include "broker/base/border.h"
#include "broker/control/parts.h"
#include "broker/membership/presence.h"
#include "core/hash.h"
#include "core/name.h"
#include "core/text.h"
#include "muster/memory.h"

#include <string.h>

static const char PREFIX[] = "broker.";
enum { PREFIX_LEN = sizeof PREFIX - 1 };

static const uint64_t PAUSE_NS = LIAISON_PAUSE_MS * 1000000ull;

/* So long DDS keeps what somebody has written who is not heard. */
static const uint64_t OVER_NS = 10000000000;

void liaison_init(struct liaison *l)
{
    *l = (struct liaison){.part_open = MU_NONE, .peer_open = MU_NONE};
    /* For all peers together: memory in large pieces stays untouched until it is used. */
    size_t all = (size_t)MU_BROKERS_MAX * REGISTRY_MAX;
    struct way *ways = mu_startup_array(all, sizeof *ways);
    uint64_t *taken = mu_startup_array(all, sizeof *taken);
    bool *ack_due = mu_startup_array(all, sizeof *ack_due);
    uint32_t *acks = mu_startup_array(all, sizeof *acks);
    for (size_t i = 0; i < MU_BROKERS_MAX; i++) {
        l->peers[i] = (struct peer){.ways = ways + i * REGISTRY_MAX,
                                    .taken = taken + i * REGISTRY_MAX,
                                    .ack_due = ack_due + i * REGISTRY_MAX,
                                    .acks = acks + i * REGISTRY_MAX};
    }
    l->pauses = mu_startup_array(REGISTRY_MAX, sizeof *l->pauses);
    l->pausing = mu_startup_array(REGISTRY_MAX, sizeof *l->pausing);
    l->acks_open = mu_startup_array(LIAISON_ACKS, sizeof *l->acks_open);
}

bool liaison_is_broker(const char *process)
{
    return strncmp(process, PREFIX, PREFIX_LEN) == 0;
}

const char *liaison_name(const char *process)
{
    return process + PREFIX_LEN;
}

struct peer *liaison_peer(struct broker *b, const char *name)
{
    for (uint32_t i = 0; i < b->liaison.peers_count; i++) {
        if (strcmp(b->liaison.peers[i].name, name) == 0) {
            return &b->liaison.peers[i];
        }
    }
    return NULL;
}

const char *liaison_holder(struct broker *b, const char *home)
{
    struct liaison *l = &b->liaison;
    char reason[MU_FIELD_MAX + 1];
    struct mu_text t;
    mu_text_init(&t, reason, sizeof reason);
    mu_text_format(&t, "held by another participant at %s", home);
    for (uint32_t i = 0; i < l->holders_count; i++) {
        if (strcmp(l->holders[i], reason) == 0) {
            return l->holders[i];
        }
    }
    if (l->holders_count == MU_BROKERS_MAX) {
        return "held by another participant at another broker";
    }
    memcpy(l->holders[l->holders_count], reason, sizeof reason);
    return l->holders[l->holders_count++];
}

/* --- the best way to an agent ------------------------------------------------------------------
 */

/* @return whether one way is better than another, to the same agent or to another of its name */
static bool way_is_better(const struct way *one, const struct way *other)
{
    if (one->since_wall_ns != other->since_wall_ns) {
        return one->since_wall_ns < other->since_wall_ns;
    }
    return one->hops != other->hops ? one->hops < other->hops : strcmp(one->home, other->home) < 0;
}

static struct peer *best_peer(struct broker *b, uint32_t agent)
{
    struct peer *best = NULL;
    for (uint32_t i = 0; i < b->liaison.peers_count; i++) {
        struct peer *p = &b->liaison.peers[i];
        const struct way *way = &p->ways[agent];
        if (p->there && way->present && way->hops < MU_DISTANCE_MAX &&
            (!best || way_is_better(way, &best->ways[agent]))) {
            best = p;
        }
    }
    return best;
}

static struct presence presence_of(const struct way *way)
{
    struct presence is = {.kind = (muster_Kind)way->kind,
                          .state = (muster_State)way->state,
                          .no_broadcasts = way->no_broadcasts,
                          .hops = way->hops + 1,
                          .since_wall_ns = way->since_wall_ns,
                          .pid = way->pid,
                          .busy_since_wall_ns = way->busy_since_wall_ns};
    (void)mu_text_copy(is.home, sizeof is.home, way->home);
    (void)mu_text_copy(is.host, sizeof is.host, way->host);
    (void)mu_text_copy(is.reason, sizeof is.reason, way->reason);
    return is;
}

/* @return whether a way can lead back to here: its neighbour may have it from us */
static bool may_be_echo(const struct agent *a, const struct way *way, bool same_neighbour)
{
    uint32_t hops = way->hops + 1;
    bool is_known = a->is.since_wall_ns == way->since_wall_ns && strcmp(a->is.home, way->home) == 0;
    return is_known && way->hops > 0 && (same_neighbour ? hops > a->is.hops : hops >= a->is.hops);
}

static void pause_begin(struct broker *b, uint32_t agent)
{
    struct liaison *l = &b->liaison;
    if (!l->pausing[agent]) {
        uint32_t at = (l->pauses_head + l->pauses_count++) % REGISTRY_MAX;
        l->pausing[agent] = true;
        l->pauses[at] = (struct pause){.agent = agent, .until_ns = b->clock.now_ns + PAUSE_NS};
    }
}

/* An agent of this broker has to give its name to one that has had it longer. */
static void clash_lose(struct broker *b, uint32_t agent, const struct way *way)
{
    const struct agent *a = &b->registry.agents[agent];
    b->liaison.count.clashes++;
    places_refuse(&b->places, a->process, a->name, muster_REFUSAL_NAME_HELD,
                  liaison_holder(b, way->home));
}

static void way_use(struct broker *b, uint32_t agent, const struct peer *p)
{
    const struct agent *a = &b->registry.agents[agent];
    const struct way *way = &p->ways[agent];
    uint32_t place = places_find(&b->places, p->place);
    struct presence is = presence_of(way);
    if (place == MU_NONE) {
        return;
    }
    if (a->process == MU_NONE) {
        presence_seat(b, agent, place, way->slot, &is);
    } else if (a->process == place) {
        presence_reregister(b, agent, way->slot, &is);
    } else {
        presence_move(b, agent, place, way->slot, &is);
    }
}

/* @param echoes  ways that may be echoes will do, too, as for who has had no way for long enough */
static void way_choose(struct broker *b, uint32_t agent, bool echoes)
{
    const struct agent *a = &b->registry.agents[agent];
    bool is_here = a->process != MU_NONE && !b->places.at[a->process].is_broker;
    struct peer *p = best_peer(b, agent);
    const struct way *way = p ? &p->ways[agent] : NULL;
    if (is_here) {
        if (way && way->since_wall_ns < a->is.since_wall_ns && !presence_in_lockstep(b, agent)) {
            clash_lose(b, agent, way);
            way_use(b, agent, p);
        }
        return;
    }
    bool same = p && a->process != MU_NONE && strcmp(a->place, p->place) == 0;
    bool is_fresh = a->process == MU_NONE && !b->liaison.pausing[agent];
    if (way && !echoes && !is_fresh && may_be_echo(a, way, same)) {
        way = NULL;
    }
    if (way) {
        way_use(b, agent, p);
    } else if (a->process != MU_NONE) {
        pause_begin(b, agent);
        presence_depart(b, agent);
    }
}

void liaison_review(struct broker *b, uint32_t agent)
{
    if (b->liaison.peers_there > 0) {
        way_choose(b, agent, false);
    }
}

void liaison_tick(struct broker *b)
{
    struct liaison *l = &b->liaison;
    while (liaison_deadline_ns(b) <= b->clock.now_ns) {
        uint32_t agent = l->pauses[l->pauses_head].agent;
        l->pauses_head = (l->pauses_head + 1) % REGISTRY_MAX;
        l->pauses_count--;
        l->pausing[agent] = false;
        way_choose(b, agent, true);
    }
}

uint64_t liaison_deadline_ns(const struct broker *b)
{
    const struct liaison *l = &b->liaison;
    return l->pauses_count > 0 ? l->pauses[l->pauses_head].until_ns : UINT64_MAX;
}

/* --- numbers ------------------------------------------------------------------------------------
 */

uint64_t liaison_lane(const struct broker *b)
{
    return mu_hash_number(mu_hash_string(b->name)) % LIAISON_LANES;
}

/* @return the last number before the next lane of this broker, or last if that is in one */
static uint64_t lane_after(const struct broker *b, uint64_t last)
{
    const uint64_t all = (uint64_t)LIAISON_LANES * LIAISON_LANE_NUMBERS;
    uint64_t lane = liaison_lane(b);
    uint64_t lane_at = lane * LIAISON_LANE_NUMBERS, in_round = last % all;
    if (in_round / LIAISON_LANE_NUMBERS == lane) {
        return last;
    }
    return last - in_round + lane_at + (in_round > lane_at ? all : 0);
}

/* A name that nobody has borne yet begins at 1 everywhere, as long as everybody would hear of it;
 * and in a lock step all numbers are those of a run with one broker. */
uint64_t liaison_begin_seq(const struct broker *b, uint32_t agent)
{
    const struct liaison *l = &b->liaison;
    uint64_t last = registry_last_seq(&b->registry.agents[agent]);
    bool others_may_begin = l->peers_count > 0 && (last > 0 || l->peers_there < l->peers_count);
    if (!others_may_begin || b->lockstep.on) {
        return last;
    }
    uint64_t begin = lane_after(b, last);
    return begin <= INT64_MAX / 2 ? begin : last;
}

/* --- coming and going --------------------------------------------------------------------------
 */

/* A process that comes after it must not begin with numbers that it has used. */
static void way_lose(struct broker *b, struct peer *p, uint32_t agent)
{
    struct way *way = &p->ways[agent];
    struct agent *a = &b->registry.agents[agent];
    uint64_t most = INT64_MAX / 2;
    uint64_t last = way->last_seq < most ? way->last_seq + JOURNAL_RESERVE : most;
    if (way->present && last > a->elsewhere_seq) {
        a->elsewhere_seq = last;
    }
    if (strcmp(way->home, p->name) == 0) {
        presence_keep(b, agent);
    }
    way->present = false;
}

static void ways_lose(struct broker *b, struct peer *p)
{
    for (uint32_t i = REGISTRY_OWN; i < b->registry.count; i++) {
        if (p->ways[i].present) {
            way_lose(b, p, i);
            liaison_review(b, i);
        }
    }
}

static void peer_set_there(struct broker *b, struct peer *p, bool there)
{
    b->liaison.peers_there += (uint32_t)there - (uint32_t)p->there;
    p->there = there;
}

void liaison_lose(struct broker *b, uint32_t place)
{
    struct place *at = &b->places.at[place];
    struct peer *p = liaison_peer(b, liaison_name(at->name));
    at->lost = true;
    if (p && p->there) {
        ways_lose(b, p);
        peer_set_there(b, p, false);
    }
    places_tidy(&b->places, place);
}

/* Who is silent makes room. */
static struct peer *peer_add(struct broker *b, const char *name)
{
    struct liaison *l = &b->liaison;
    struct peer *p = l->peers_count < MU_BROKERS_MAX ? &l->peers[l->peers_count++] : NULL;
    for (uint32_t i = 0; i < l->peers_count && !p; i++) {
        p = l->peers[i].there ? NULL : &l->peers[i];
    }
    if (p) {
        struct mu_text t;
        (void)mu_text_copy(p->name, sizeof p->name, name);
        mu_text_init(&t, p->place, sizeof p->place);
        mu_text_format(&t, "%s%s", PREFIX, name);
        p->incarnation = 0;
    }
    return p;
}

static void numbers_forget(struct broker *b, struct peer *p)
{
    for (uint32_t i = 0; i < b->registry.count; i++) {
        if (p->taken[i] > 0) { /* memory of others stays untouched */
            p->taken[i] = 0;
            p->ack_due[i] = false;
        }
    }
    p->acks_count = 0;
}

/* @return whether a life of a neighbour has been silent for so long that what is said by an earlier
 * number cannot be a word that was under way */
static bool is_over(const struct broker *b, const struct peer *p)
{
    return !p->there && b->clock.now_ns - p->heard_ns >= OVER_NS;
}

struct peer *liaison_meet(struct broker *b, const char *name, uint64_t incarnation)
{
    struct peer *p = liaison_peer(b, name);
    p = p ? p : peer_add(b, name);
    if (!p || incarnation < p->incarnation) {
        return NULL;
    }
    p->heard_ns = b->clock.now_ns;
    if (incarnation > p->incarnation) {
        ways_lose(b, p);
        numbers_forget(b, p);
        p->incarnation = incarnation;
    }
    return p;
}

/* @return the place of a neighbour, or MU_NONE: there are too many processes */
static uint32_t place_hear(struct broker *b, struct peer *p)
{
    uint32_t place = places_get(&b->places, p->place);
    if (place == MU_NONE) {
        return MU_NONE;
    }
    struct place *at = &b->places.at[place];
    at->is_broker = true;
    at->incarnation = p->incarnation;
    if (!p->there || at->lost) { /* what it said while it was not heard */
        at->roll_call_due = true;
        places_wake(&b->places, place);
    }
    at->lost = false;
    peer_set_there(b, p, true);
    return place;
}

/* --- what a neighbour says ---------------------------------------------------------------------
 */

static bool entry_is_whole(const muster_Entry *e)
{
    return border_entry(e, true) && border_string(e->name, MU_NAME_MAX) &&
           !registry_objection(e->name, e->kind) && border_string(e->via, MU_NAME_MAX) &&
           border_string(e->host, MU_FIELD_MAX) &&
           (e->state == muster_STATE_ABSENT || e->home[0] != '\0');
}

/* @return whether the neighbour tells us what it has from us */
static bool entry_is_ours(const struct broker *b, const muster_Entry *e)
{
    return strcmp(e->home, b->name) == 0 || strcmp(e->via, b->name) == 0;
}

/* Its sender has left before the outcome of its mail came. */
static void receipts_forget(struct broker *b, uint32_t agent)
{
    struct agent *a = &b->registry.agents[agent];
    if (a->process == MU_NONE && a->awaited && !b->journal.awaits) {
        a->awaited = false;
        receipts_drop(&b->receipts, agent, receipts_of(&b->receipts, agent)->count);
    }
}

static void entry_take(struct broker *b, struct peer *p, const muster_Entry *e, uint32_t slot)
{
    uint32_t agent = registry_find(&b->registry, e->name);
    bool ours = entry_is_ours(b, e);
    bool present = e->state != muster_STATE_ABSENT && !ours;
    if (agent == MU_NONE) {
        agent = registry_add(&b->registry, e->name);
        if (agent == MU_NONE) {
            return;
        }
        b->registry.agents[agent].is.kind = e->kind;
        registry_touch(&b->registry, agent);
    }
    struct way *way = &p->ways[agent];
    struct agent *a = &b->registry.agents[agent];
    if (!ours && e->last_seq > a->elsewhere_seq && e->last_seq <= INT64_MAX / 2) {
        a->elsewhere_seq = e->last_seq;
    }
    if (!present && !way->present) {
        if (!ours) {
            receipts_forget(b, agent);
        }
        return;
    }
    *way = (struct way){.present = present,
                        .no_broadcasts = e->no_broadcasts,
                        .kind = (uint8_t)e->kind,
                        .state = (uint8_t)e->state,
                        .hops = e->hops,
                        .slot = slot,
                        .pid = e->pid,
                        .since_wall_ns = e->since_wall_ns,
                        .busy_since_wall_ns = e->busy_since_wall_ns,
                        .last_seq = e->last_seq};
    (void)mu_text_copy(way->home, sizeof way->home, e->home);
    (void)mu_text_copy(way->host, sizeof way->host, e->host);
    (void)mu_text_copy(way->reason, sizeof way->reason, e->reason ? e->reason : "");
    liaison_review(b, agent);
}

void liaison_hear(struct broker *b, const muster_Registration *r)
{
    const char *name = liaison_is_broker(r->process) ? liaison_name(r->process) : NULL;
    if (!r->is_broker || !name || !border_string(name, MU_NAME_MAX) ||
        !mu_name_valid(name)) {
        b->counters.malformed++;
        return;
    }
    if (strcmp(name, b->name) == 0) {
        return; /* our own */
    }
    struct peer *p = liaison_peer(b, name);
    if (p && r->incarnation < p->incarnation && is_over(b, p)) {
        numbers_forget(b, p); /* a later life, whose clock has been set back */
        p->incarnation = 0;
    }
    p = liaison_meet(b, name, r->incarnation);
    if (!p || place_hear(b, p) == MU_NONE) {
        return;
    }
    for (uint32_t i = 0; i < r->agents._length; i++) {
        const muster_Entry *e = &r->agents._buffer[i];
        if (e->name[0] == '\0') {
            continue;
        }
        if (entry_is_whole(e)) {
            entry_take(b, p, e, r->part * MU_PART_AGENTS + i);
        } else {
            b->counters.malformed++;
        }
    }
}
