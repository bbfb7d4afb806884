/* SPDX-License-Identifier: Apache-2.0 */
#include "planner/planner.h"

#include "muster/memory.h"

#include <math.h>
#include <stdint.h>

enum { PATH_NONE = -1, PATH_NEIGHBOURS = 8 };

static const double path_start_m = 0.6, path_end_m = 0.25; /* how far they may be moved */

/* With so much room a metre costs 1; nearer to obstacles, it costs up to so much more. */
static const double path_wide_m = 0.75;
static const double path_dear = 6;

/* A straight line may cost so much more than the piece of the path that it replaces. */
static const double path_straight = 1.02;

struct planner {
    const struct distance_map *map;
    double half_m;
    uint32_t search; /* number of this search; cells with another number are unvisited */
    uint32_t *seen;
    float *cost, *guess; /* from the start; by way of this cell to the end */
    int *from;
    int *heap, *place; /* of cells, the least guess first; where each is in it */
    int heap_count;
    int end;
    size_t looked;
};

struct planner *planner_make(const struct distance_map *map)
{
    struct planner *r = mu_startup_alloc(sizeof *r);
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

static bool path_free(const struct planner *r, int cell)
{
    return cell >= 0 && (double)r->map->room_m[cell] >= r->half_m;
}

/* @return the cost of a metre in a cell */
static double path_price(const struct planner *r, int cell)
{
    double lack = fmax(0, path_wide_m - (double)r->map->room_m[cell]) / path_wide_m;
    return 1 + path_dear * lack * lack;
}

static double path_between(const struct planner *r, int a, int b)
{
    int nx = r->map->nx;
    return r->map->cell_m * hypot(a % nx - b % nx, a / nx - b / nx);
}

/* Equal guesses: the lower cell first, so that no way depends on the order of insertion. */
static bool path_before(const struct planner *r, int a, int b)
{
    return r->guess[a] < r->guess[b] || (!(r->guess[b] < r->guess[a]) && a < b);
}

static void path_put(struct planner *r, int at, int cell)
{
    r->heap[at] = cell;
    r->place[cell] = at;
}

static void path_rise(struct planner *r, int cell)
{
    int at = r->place[cell];
    while (at > 0 && path_before(r, cell, r->heap[(at - 1) / 2])) {
        path_put(r, at, r->heap[(at - 1) / 2]);
        at = (at - 1) / 2;
    }
    path_put(r, at, cell);
}

static int path_pop(struct planner *r)
{
    int first = r->heap[0];
    int last = r->heap[--r->heap_count];
    int at = 0;
    for (int child = 1; child < r->heap_count; child = 2 * at + 1) {
        if (child + 1 < r->heap_count && path_before(r, r->heap[child + 1], r->heap[child])) {
            child++;
        }
        if (!path_before(r, r->heap[child], last)) {
            break;
        }
        path_put(r, at, r->heap[child]);
        at = child;
    }
    if (r->heap_count > 0) {
        path_put(r, at, last);
    }
    return first;
}

/* Keeps a path to a cell if it is the first or a cheaper one. */
static void path_offer(struct planner *r, int cell, int from, double cost)
{
    bool is_new = r->seen[cell] != r->search;
    if (!is_new && (double)r->cost[cell] <= cost) {
        return;
    }
    if (is_new) {
        r->seen[cell] = r->search;
        path_put(r, r->heap_count++, cell);
    }
    r->cost[cell] = (float)cost;
    r->guess[cell] = (float)(cost + path_between(r, cell, r->end));
    r->from[cell] = from;
    if (r->place[cell] != PATH_NONE) {
        path_rise(r, cell);
    }
}

/* A diagonal neighbour counts only if both cells beside it are free: no path cuts corners. */
static void path_look_round(struct planner *r, int cell)
{
    static const int dx[PATH_NEIGHBOURS] = {1, -1, 0, 0, 1, 1, -1, -1};
    static const int dy[PATH_NEIGHBOURS] = {0, 0, 1, -1, 1, -1, 1, -1};
    int nx = r->map->nx;
    int x = cell % nx;
    int y = cell / nx;
    for (int k = 0; k < PATH_NEIGHBOURS; k++) {
        int tx = x + dx[k];
        int ty = y + dy[k];
        int to = ty * nx + tx;
        bool inside = tx >= 0 && ty >= 0 && tx < nx && ty < r->map->ny;
        if (!inside || !path_free(r, to) || !path_free(r, y * nx + tx) ||
            !path_free(r, ty * nx + x)) {
            continue;
        }
        bool done = r->seen[to] == r->search && r->place[to] == PATH_NONE;
        if (!done) {
            double price = 0.5 * (path_price(r, cell) + path_price(r, to));
            double way_m = r->map->cell_m * hypot(dx[k], dy[k]);
            path_offer(r, to, cell, (double)r->cost[cell] + way_m * price);
        }
    }
}

/* @return whether there is a path; from has it, from the end back */
static bool path_find(struct planner *r, int start)
{
    r->search++;
    r->heap_count = 0;
    r->looked = 0;
    path_offer(r, start, PATH_NONE, 0);
    while (r->heap_count > 0) {
        int cell = path_pop(r);
        r->place[cell] = PATH_NONE;
        r->looked++;
        if (cell == r->end) {
            return true;
        }
        path_look_round(r, cell);
    }
    return false;
}

/* @return the free cell that is nearest to a place, within most_m; PATH_NONE: there is none */
static int path_near(const struct planner *r, const double at_m[2], double most_m)
{
    int cell = distance_map_cell(r->map, at_m[0], at_m[1]);
    int reach = (int)ceil(most_m / r->map->cell_m);
    int best = PATH_NONE;
    double best_m = most_m;
    if (path_free(r, cell)) {
        return cell;
    }
    for (int k = 0; k < (2 * reach + 1) * (2 * reach + 1); k++) {
        double x_m = at_m[0] + (k % (2 * reach + 1) - reach) * r->map->cell_m;
        double y_m = at_m[1] + (k / (2 * reach + 1) - reach) * r->map->cell_m;
        double far_m = hypot(x_m - at_m[0], y_m - at_m[1]);
        int other = distance_map_cell(r->map, x_m, y_m);
        if (path_free(r, other) && far_m < best_m) {
            best = other;
            best_m = far_m;
        }
    }
    return best;
}

/* @return the cost of the straight line between two cells; infinite: an obstacle is on it */
static double path_line(const struct planner *r, int a, int b)
{
    double from_m[2];
    double to_m[2];
    distance_map_middle(r->map, a, from_m);
    distance_map_middle(r->map, b, to_m);
    double way_m = hypot(to_m[0] - from_m[0], to_m[1] - from_m[1]);
    int parts = (int)ceil(2 * way_m / r->map->cell_m);
    double sum = 0;
    for (int i = 0; i <= parts && parts > 0; i++) {
        double t = (double)i / parts;
        int cell = distance_map_cell(r->map, from_m[0] + t * (to_m[0] - from_m[0]),
                                     from_m[1] + t * (to_m[1] - from_m[1]));
        if (!path_free(r, cell)) {
            return INFINITY;
        }
        sum += path_price(r, cell) * (i == 0 || i == parts ? 0.5 : 1);
    }
    return parts > 0 ? sum * way_m / parts : 0;
}

/* Turns the path round: from becomes the next cell, beginning at the start. */
static void path_turn(struct planner *r)
{
    int next = PATH_NONE;
    for (int cell = r->end; cell != PATH_NONE;) {
        int before = r->from[cell];
        r->from[cell] = next;
        next = cell;
        cell = before;
    }
}

/* @return the farthest cell of the path that a straight line reaches at about the same cost */
static int path_farthest(const struct planner *r, int cell)
{
    int best = r->from[cell];
    for (int to = best; to != PATH_NONE; to = r->from[to]) {
        double along = (double)(r->cost[to] - r->cost[cell]);
        if (path_line(r, cell, to) <= path_straight * along + 1e-3) {
            best = to;
        }
    }
    return best;
}

/* A path of too many points ends early, and is searched again from there. */
static void path_straighten(struct planner *r, int start, struct path *out)
{
    path_turn(r);
    int cell = start;
    while (cell != r->end && out->count < PATH_POINTS_MAX) {
        cell = path_farthest(r, cell);
        distance_map_middle(r->map, cell, out->points_m[out->count++]);
    }
}

mu_result planner_search(struct planner *r, const double from_m[2], const double to_m[2],
                         double half_m, struct path *out)
{
    r->half_m = half_m;
    out->count = 0;
    out->looked = 1;
    int start = path_near(r, from_m, path_start_m);
    r->end = path_near(r, to_m, path_end_m);
    if (start == PATH_NONE || r->end == PATH_NONE) {
        return MU_ABSENT;
    }
    bool found = path_find(r, start);
    out->looked += r->looked;
    if (!found) {
        return MU_ABSENT;
    }
    path_straighten(r, start, out);
    if (out->count == 0) { /* it stands where the way ends */
        distance_map_middle(r->map, r->end, out->points_m[out->count++]);
    }
    bool whole = out->count < PATH_POINTS_MAX;
    if (whole && distance_map_cell(r->map, to_m[0], to_m[1]) == r->end) {
        out->points_m[out->count - 1][0] = to_m[0];
        out->points_m[out->count - 1][1] = to_m[1];
    }
    return MU_OK;
}
