/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "core/hash.h"

static const char PREFIX[] = "broker.";
enum { PREFIX_LEN = sizeof PREFIX - 1 };

static const uint64_t PAUSE_NS = FEDERATION_PAUSE_MS * 1000000ull;

const char *remote_name(const char *process)
{
    return strncmp(process, PREFIX, PREFIX_LEN) == 0 ? process + PREFIX_LEN : NULL;
}

struct peer *remote_peer(struct broker *b, const char *name)
{
    for (uint32_t i = 0; i < b->federation.peers_count; i++) {
        if (strcmp(b->federation.peers[i].name, name) == 0) {
            return &b->federation.peers[i];
        }
    }
    return NULL;
}

/* @return whether one route is better than another, to the same agent or to another of its name */
static bool route_is_better(const struct presence *one, const struct presence *other)
{
    if (one->since_wall_ns != other->since_wall_ns) {
        return one->since_wall_ns < other->since_wall_ns;
    }
    return one->hops != other->hops ? one->hops < other->hops : strcmp(one->home, other->home) < 0;
}

struct peer *remote_best_peer(struct broker *b, uint32_t agent)
{
    struct peer *best = NULL;
    for (uint32_t i = 0; i < b->federation.peers_count; i++) {
        struct peer *p = &b->federation.peers[i];
        const struct route *route = &p->routes[agent];
        if (p->state == PEER_THERE && route->present && route->is.hops <= MU_DISTANCE_MAX &&
            (!best || route_is_better(&route->is, &best->routes[agent].is))) {
            best = p;
        }
    }
    return best;
}

bool remote_may_be_echo(const struct agent *a, const struct route *route, bool same_neighbour)
{
    const struct presence *is = &route->is;
    bool is_known = a->is.since_wall_ns == is->since_wall_ns && strcmp(a->is.home, is->home) == 0;
    return is_known && is->hops > 1 &&
           (same_neighbour ? is->hops > a->is.hops : is->hops >= a->is.hops);
}

void remote_hold_down(struct broker *b, uint32_t agent)
{
    struct federation *l = &b->federation;
    if (mu_list_append(&l->pausing, MU_LINKS(l->pauses, link), agent)) {
        l->pauses[agent].until_ns = b->clock.now_ns + PAUSE_NS;
    }
}

bool remote_pauses(const struct federation *l, uint32_t agent)
{
    return mu_list_has(MU_LINKS(l->pauses, link), agent);
}

uint64_t remote_deadline_ns(const struct broker *b)
{
    const struct federation *l = &b->federation;
    return l->pausing.count > 0 ? l->pauses[mu_list_first(&l->pausing)].until_ns : UINT64_MAX;
}

/* --- numbers ------------------------------------------------------------------------------------
 */

uint64_t remote_range(const struct broker *b)
{
    return mu_hash_number(mu_hash_string(b->name)) % FEDERATION_RANGES;
}

/* @return the last number before the next lane of this broker, or last if that is in one */
static uint64_t lane_after(const struct broker *b, uint64_t last)
{
    const uint64_t all = (uint64_t)FEDERATION_RANGES * FEDERATION_RANGE_NUMBERS;
    uint64_t lane = remote_range(b);
    uint64_t lane_at = lane * FEDERATION_RANGE_NUMBERS, in_round = last % all;
    if (in_round / FEDERATION_RANGE_NUMBERS == lane) {
        return last;
    }
    return last - in_round + lane_at + (in_round > lane_at ? all : 0);
}

/* A name that no agent has had yet begins at 1 everywhere, as long as all brokers would hear of it;
 * and in a run by steps all numbers are those of a run with one broker. */
uint64_t remote_begin_seq(const struct broker *b, uint32_t agent)
{
    const struct federation *l = &b->federation;
    uint64_t last = registry_last_seq(&b->registry.agents[agent]);
    bool others_may_begin = l->peers_count > 0 && (last > 0 || l->peers_there < l->peers_count);
    if (!others_may_begin || clock_by_steps(&b->clock)) {
        return last;
    }
    uint64_t begin = lane_after(b, last);
    return begin <= INT64_MAX / 2 ? begin : last;
}

/* --- states -------------------------------------------------------------------------------------
 */

/* clang-format off */
/* The letters of the table; X is a refusal. */
enum { X = 255, U = PEER_UNKNOWN, S = PEER_SILENT, T = PEER_THERE };

static const unsigned char next_peer[PEER_STATES][PEER_EVENTS] = {
    /*               speaks earlier speaks begins announces lost forgotten */
    [PEER_UNKNOWN] = {X,            X,     S,     X,        X,   X},
    [PEER_SILENT]  = {X,            S,     S,     T,        S,   U},
    [PEER_THERE]   = {X,            T,     T,     T,        S,   X},
};
/* clang-format on */

bool remote_peer_on(struct federation *l, struct peer *p, enum peer_event event)
{
    unsigned next = next_peer[p->state][event];
    if (next == X) {
        MU_ASSERT(event < PEER_OWN_EVENTS);
        l->count.earlier_lives++;
        return false;
    }
    l->peers_there += (uint32_t)(next == PEER_THERE) - (uint32_t)(p->state == PEER_THERE);
    p->state = (enum peer_state)next;
    return true;
}

struct peer *remote_add_peer(struct broker *b, const char *name)
{
    struct federation *l = &b->federation;
    struct peer *p = l->peers_count < MU_BROKERS_MAX ? &l->peers[l->peers_count++] : NULL;
    for (uint32_t i = 0; i < l->peers_count && !p; i++) {
        p = l->peers[i].state == PEER_THERE ? NULL : &l->peers[i];
    }
    if (p) {
        if (p->state == PEER_SILENT) {
            (void)remote_peer_on(l, p, PEER_FORGOTTEN);
        }
        (void)mu_text_copy(p->name, sizeof p->name, name);
        struct mu_text t = mu_text_in(p->place, sizeof p->place);
        mu_text_format(&t, "%s%s", PREFIX, name);
    }
    return p;
}
