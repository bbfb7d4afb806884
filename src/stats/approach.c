/* SPDX-License-Identifier: Apache-2.0 */
#include "stats/stats.h"

#include "muster/memory.h"

#include <math.h>
#include <string.h>

enum {
    SLOTS = 1 << 16, /* a power of two, twice the pairs */
    BUCKETS = 1 << 11,
    NOBODY = -1,
    NO_PAIR = 0 /* slots and bests have the index of a pair and one */
};
_Static_assert(SLOTS >= 2 * MU_STATS_PAIRS_MAX, "a table that stays half empty");
_Static_assert(MU_STATS_ALL_PAIRS *(MU_STATS_ALL_PAIRS - 1) / 2 <= MU_STATS_PAIRS_MAX,
               "room for all pairs");

struct approach {
    size_t robots;
    struct mu_stats_pair pairs[MU_STATS_PAIRS_MAX];
    size_t count;
    uint16_t slots[SLOTS];
    uint16_t best[MU_ROBOTS_MAX]; /* of each robot */
    int32_t first[BUCKETS], next[MU_ROBOTS_MAX];
    uint64_t refused;
};

struct approach *approach_reserve(void)
{
    return mu_startup_alloc(sizeof(struct approach));
}

void approach_begin(struct approach *a, size_t robots)
{
    memset(a, 0, sizeof *a);
    a->robots = robots < MU_ROBOTS_MAX ? robots : MU_ROBOTS_MAX;
}

static uint32_t mixed(uint32_t x)
{
    x *= 0x9e3779b1u;
    return x ^ x >> 15;
}

/* @return the pair's place, which is NO_PAIR where it is not known yet */
static uint16_t *slot_find(struct approach *a, size_t one, size_t other)
{
    uint32_t at = mixed((uint32_t)(one * MU_ROBOTS_MAX + other)) % SLOTS;
    while (a->slots[at] != NO_PAIR) {
        const struct mu_stats_pair *p = &a->pairs[a->slots[at] - 1];
        if (p->one == one && p->other == other) {
            break;
        }
        at = (at + 1) % SLOTS;
    }
    return &a->slots[at];
}

static void best_take(struct approach *a, size_t robot, uint16_t pair)
{
    uint16_t *best = &a->best[robot];
    if (*best == NO_PAIR || a->pairs[pair - 1].near_m < a->pairs[*best - 1].near_m) {
        *best = pair;
    }
}

static void pair_take(struct approach *a, size_t one, size_t other, double near_m, double time_s)
{
    uint16_t *slot = slot_find(a, one, other);
    if (*slot == NO_PAIR && a->count == MU_STATS_PAIRS_MAX) {
        a->refused++;
        return;
    }
    if (*slot == NO_PAIR) {
        a->pairs[a->count++] = (struct mu_stats_pair){one, other, INFINITY, time_s};
        *slot = (uint16_t)a->count;
    }
    struct mu_stats_pair *p = &a->pairs[*slot - 1];
    if (near_m < p->near_m) {
        p->near_m = near_m;
        p->time_s = time_s;
        best_take(a, one, *slot);
        best_take(a, other, *slot);
    }
}

static double distance_m(const struct approach_place *p, size_t one, size_t other)
{
    return hypot(p[one].x_m - p[other].x_m, p[one].y_m - p[other].y_m);
}

static void all_take(struct approach *a, const struct approach_place *places, double time_s)
{
    for (size_t i = 0; i < a->robots; i++) {
        for (size_t j = i + 1; j < a->robots; j++) {
            pair_take(a, i, j, distance_m(places, i, j), time_s);
        }
    }
}

/* Places beyond the range of a number of cells share the last ones. */
static int32_t cell_of(double at_m)
{
    return (int32_t)fmax(-1e9, fmin(1e9, floor(at_m / MU_STATS_NEAR_M)));
}

static uint32_t bucket_of(int32_t x, int32_t y)
{
    return mixed((uint32_t)x * 0x85ebca6bu ^ (uint32_t)y) % BUCKETS;
}

/* Robots that were entered before are looked at: each pair once, unless cells share a bucket. */
static void bucket_take(struct approach *a, const struct approach_place *places, size_t robot,
                        uint32_t bucket, double time_s)
{
    for (int32_t i = a->first[bucket]; i != NOBODY; i = a->next[i]) {
        double near_m = distance_m(places, (size_t)i, robot);
        if (near_m < MU_STATS_NEAR_M) {
            pair_take(a, (size_t)i, robot, near_m, time_s);
        }
    }
}

static void grid_take(struct approach *a, const struct approach_place *places, double time_s)
{
    for (size_t b = 0; b < BUCKETS; b++) {
        a->first[b] = NOBODY;
    }
    for (size_t i = 0; i < a->robots; i++) {
        int32_t x = cell_of(places[i].x_m), y = cell_of(places[i].y_m);
        for (int32_t dx = -1; dx <= 1; dx++) {
            for (int32_t dy = -1; dy <= 1; dy++) {
                bucket_take(a, places, i, bucket_of(x + dx, y + dy), time_s);
            }
        }
        uint32_t own = bucket_of(x, y);
        a->next[i] = a->first[own];
        a->first[own] = (int32_t)i;
    }
}

void approach_take(struct approach *a, const struct approach_place *places, double time_s)
{
    if (a->robots <= MU_STATS_ALL_PAIRS) {
        all_take(a, places, time_s);
    } else {
        grid_take(a, places, time_s);
    }
}

const struct mu_stats_pair *approach_pair(const struct approach *a, size_t index)
{
    return index < a->count ? &a->pairs[index] : NULL;
}

const struct mu_stats_pair *approach_of(const struct approach *a, size_t robot)
{
    bool known = robot < a->robots && a->best[robot] != NO_PAIR;
    return known ? &a->pairs[a->best[robot] - 1] : NULL;
}

uint64_t approach_refused(const struct approach *a)
{
    return a->refused;
}
