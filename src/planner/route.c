/* SPDX-License-Identifier: Apache-2.0 */
#include "planner/route.h"

#include "muster/memory.h"

#include <math.h>
#include <stdint.h>

enum { ROUTE_NONE = -1, ROUTE_NEIGHBOURS = 8 };

static const double route_start_m = 0.6, route_end_m = 0.25; /* how far they may be moved */

/* A metre with so much room costs one; nearer to things it costs up to so much more. */
static const double route_wide_m = 0.75;
static const double route_dear = 6;

/* A straight line may cost so much more than the way that it replaces. */
static const double route_straight = 1.02;

struct router {
    const struct map *map;
    double half_m;
    uint32_t search; /* the number of this one: what bears another is old */
    uint32_t *seen;
    float *cost, *guess; /* from the start; by way of this cell to the end */
    int *from;
    int *heap, *place; /* of cells, the least guess first; where each is in it */
    int heap_count;
    int end;
    size_t looked;
};

struct router *router_make(const struct map *map)
{
    struct router *r = mu_startup_alloc(sizeof *r);
    size_t cells = (size_t)map->nx * (size_t)map->ny;
    r->map = map;
    r->seen = mu_startup_array(cells, sizeof *r->seen);
    r->cost = mu_startup_array(cells, sizeof *r->cost);
    r->guess = mu_startup_array(cells, sizeof *r->guess);
    r->from = mu_startup_array(cells, sizeof *r->from);
    r->heap = mu_startup_array(cells, sizeof *r->heap);
    r->place = mu_startup_array(cells, sizeof *r->place);
    return r;
}

static bool route_free(const struct router *r, int cell)
{
    return cell >= 0 && (double)r->map->room_m[cell] >= r->half_m;
}

/* What a metre costs there. */
static double route_price(const struct router *r, int cell)
{
    double lack = fmax(0, route_wide_m - (double)r->map->room_m[cell]) / route_wide_m;
    return 1 + route_dear * lack * lack;
}

static double route_between(const struct router *r, int a, int b)
{
    int nx = r->map->nx;
    return r->map->cell_m * hypot(a % nx - b % nx, a / nx - b / nx);
}

/* Equal guesses: the lower cell first, so that no way depends on the order of insertion. */
static bool route_before(const struct router *r, int a, int b)
{
    return r->guess[a] < r->guess[b] || (!(r->guess[b] < r->guess[a]) && a < b);
}

static void route_put(struct router *r, int at, int cell)
{
    r->heap[at] = cell;
    r->place[cell] = at;
}

static void route_rise(struct router *r, int cell)
{
    int at = r->place[cell];
    while (at > 0 && route_before(r, cell, r->heap[(at - 1) / 2])) {
        route_put(r, at, r->heap[(at - 1) / 2]);
        at = (at - 1) / 2;
    }
    route_put(r, at, cell);
}

static int route_pop(struct router *r)
{
    int first = r->heap[0];
    int last = r->heap[--r->heap_count];
    int at = 0;
    for (int child = 1; child < r->heap_count; child = 2 * at + 1) {
        if (child + 1 < r->heap_count && route_before(r, r->heap[child + 1], r->heap[child])) {
            child++;
        }
        if (!route_before(r, r->heap[child], last)) {
            break;
        }
        route_put(r, at, r->heap[child]);
        at = child;
    }
    if (r->heap_count > 0) {
        route_put(r, at, last);
    }
    return first;
}

/* A way to a cell: kept when it is the first or a cheaper one. */
static void route_offer(struct router *r, int cell, int from, double cost)
{
    bool is_new = r->seen[cell] != r->search;
    if (!is_new && (double)r->cost[cell] <= cost) {
        return;
    }
    if (is_new) {
        r->seen[cell] = r->search;
        route_put(r, r->heap_count++, cell);
    }
    r->cost[cell] = (float)cost;
    r->guess[cell] = (float)(cost + route_between(r, cell, r->end));
    r->from[cell] = from;
    if (r->place[cell] != ROUTE_NONE) {
        route_rise(r, cell);
    }
}

/* Neighbours at a corner count only when both cells beside are free: nobody cuts corners. */
static void route_look_round(struct router *r, int cell)
{
    static const int dx[ROUTE_NEIGHBOURS] = {1, -1, 0, 0, 1, 1, -1, -1};
    static const int dy[ROUTE_NEIGHBOURS] = {0, 0, 1, -1, 1, -1, 1, -1};
    int nx = r->map->nx;
    int x = cell % nx;
    int y = cell / nx;
    for (int k = 0; k < ROUTE_NEIGHBOURS; k++) {
        int tx = x + dx[k];
        int ty = y + dy[k];
        int to = ty * nx + tx;
        bool inside = tx >= 0 && ty >= 0 && tx < nx && ty < r->map->ny;
        if (!inside || !route_free(r, to) || !route_free(r, y * nx + tx) ||
            !route_free(r, ty * nx + x)) {
            continue;
        }
        bool done = r->seen[to] == r->search && r->place[to] == ROUTE_NONE;
        if (!done) {
            double price = 0.5 * (route_price(r, cell) + route_price(r, to));
            double way_m = r->map->cell_m * hypot(dx[k], dy[k]);
            route_offer(r, to, cell, (double)r->cost[cell] + way_m * price);
        }
    }
}

/* @return whether there is a way; it stands in from, from the end back */
static bool route_find(struct router *r, int start)
{
    r->search++;
    r->heap_count = 0;
    r->looked = 0;
    route_offer(r, start, ROUTE_NONE, 0);
    while (r->heap_count > 0) {
        int cell = route_pop(r);
        r->place[cell] = ROUTE_NONE;
        r->looked++;
        if (cell == r->end) {
            return true;
        }
        route_look_round(r, cell);
    }
    return false;
}

/* @return the free cell that is nearest to a place, within most_m; ROUTE_NONE: there is none */
static int route_near(const struct router *r, const double at_m[2], double most_m)
{
    int cell = map_cell(r->map, at_m[0], at_m[1]);
    int reach = (int)ceil(most_m / r->map->cell_m);
    int best = ROUTE_NONE;
    double best_m = most_m;
    if (route_free(r, cell)) {
        return cell;
    }
    for (int k = 0; k < (2 * reach + 1) * (2 * reach + 1); k++) {
        double x_m = at_m[0] + (k % (2 * reach + 1) - reach) * r->map->cell_m;
        double y_m = at_m[1] + (k / (2 * reach + 1) - reach) * r->map->cell_m;
        double far_m = hypot(x_m - at_m[0], y_m - at_m[1]);
        int other = map_cell(r->map, x_m, y_m);
        if (route_free(r, other) && far_m < best_m) {
            best = other;
            best_m = far_m;
        }
    }
    return best;
}

/* What the straight line between two cells costs; infinite when something is in its way. */
static double route_line(const struct router *r, int a, int b)
{
    double from_m[2];
    double to_m[2];
    map_middle(r->map, a, from_m);
    map_middle(r->map, b, to_m);
    double way_m = hypot(to_m[0] - from_m[0], to_m[1] - from_m[1]);
    int parts = (int)ceil(2 * way_m / r->map->cell_m);
    double sum = 0;
    for (int i = 0; i <= parts && parts > 0; i++) {
        double t = (double)i / parts;
        int cell = map_cell(r->map, from_m[0] + t * (to_m[0] - from_m[0]),
                            from_m[1] + t * (to_m[1] - from_m[1]));
        if (!route_free(r, cell)) {
            return INFINITY;
        }
        sum += route_price(r, cell) * (i == 0 || i == parts ? 0.5 : 1);
    }
    return parts > 0 ? sum * way_m / parts : 0;
}

/* Turns the way round: from becomes the next cell, from the start on. */
static void route_turn(struct router *r)
{
    int next = ROUTE_NONE;
    for (int cell = r->end; cell != ROUTE_NONE;) {
        int before = r->from[cell];
        r->from[cell] = next;
        next = cell;
        cell = before;
    }
}

/* The farthest cell of the way that can be had in a straight line. */
static int route_farthest(const struct router *r, int cell)
{
    int best = r->from[cell];
    for (int to = best; to != ROUTE_NONE; to = r->from[to]) {
        double along = (double)(r->cost[to] - r->cost[cell]);
        if (route_line(r, cell, to) <= route_straight * along + 1e-3) {
            best = to;
        }
    }
    return best;
}

/* A way of too many points ends early, and is searched again from there. */
static void route_straighten(struct router *r, int start, struct route *out)
{
    route_turn(r);
    int cell = start;
    while (cell != r->end && out->count < ROUTE_POINTS_MAX) {
        cell = route_farthest(r, cell);
        map_middle(r->map, cell, out->points_m[out->count++]);
    }
}

mu_result route_search(struct router *r, const double from_m[2], const double to_m[2],
                       double half_m, struct route *out)
{
    r->half_m = half_m;
    out->count = 0;
    out->looked = 1;
    int start = route_near(r, from_m, route_start_m);
    r->end = route_near(r, to_m, route_end_m);
    if (start == ROUTE_NONE || r->end == ROUTE_NONE) {
        return MU_ABSENT;
    }
    bool found = route_find(r, start);
    out->looked += r->looked;
    if (!found) {
        return MU_ABSENT;
    }
    route_straighten(r, start, out);
    if (out->count == 0) { /* it stands where the way ends */
        map_middle(r->map, r->end, out->points_m[out->count++]);
    }
    bool whole = out->count < ROUTE_POINTS_MAX;
    if (whole && map_cell(r->map, to_m[0], to_m[1]) == r->end) {
        out->points_m[out->count - 1][0] = to_m[0];
        out->points_m[out->count - 1][1] = to_m[1];
    }
    return MU_OK;
}
