/* SPDX-License-Identifier: Apache-2.0 */
#include "stats/stats.h"

#include "muster/limits.h"
#include "muster/memory.h"

#include <math.h>
#include <string.h>

/* Two walls that end on the line between two fine cells are told in single precision: what is less
 * than this apart is one place. */
static const double TOUCH_M = 1e-5;
static const double CELL_M = 0.5;

enum { DIVISION_MAX = 10, WORD_BITS = 64, LINE_PARTS_MAX = 1000 };

enum fine_state { FINE_FREE, FINE_SOLID, FINE_REACHED };

struct explored {
    bool there;
    double min_x_m, min_y_m, fine_m;
    int width, height; /* in fine cells; both multiples of the division */
    int division;      /* fine cells along a cell */
    int half;          /* of the fine cells of a cell */
    size_t robots, robots_here, cells;
    unsigned char *state;   /* of each fine cell */
    int *stack;             /* of the flood */
    uint8_t *reached;       /* fine cells of each cell */
    uint64_t *crossed;      /* a bit for each cell, */
    uint64_t *crossed_by;   /* and for each cell of each robot */
    size_t *crossed_counts; /* cells of each robot */
    size_t crossed_count, floor_count;
};

static size_t words_of(size_t bits)
{
    return (bits + WORD_BITS - 1) / WORD_BITS;
}

/* @return whether the bit was clear */
static bool bit_set(uint64_t *words, size_t at)
{
    uint64_t bit = (uint64_t)1 << at % WORD_BITS;
    bool clear = !(words[at / WORD_BITS] & bit);
    words[at / WORD_BITS] |= bit;
    return clear;
}

static bool bit_is_set(const uint64_t *words, size_t at)
{
    return words[at / WORD_BITS] >> at % WORD_BITS & 1;
}

struct explored *explored_reserve(size_t robots)
{
    struct explored *e = mu_startup_alloc(sizeof *e);
    e->robots = robots;
    e->state = mu_startup_array(MU_EXPLORED_FINE_MAX, sizeof *e->state);
    e->stack = mu_startup_array(MU_EXPLORED_FINE_MAX, sizeof *e->stack);
    e->reached = mu_startup_array(MU_EXPLORED_CELLS_MAX, sizeof *e->reached);
    e->crossed = mu_startup_array(words_of(MU_EXPLORED_CELLS_MAX), sizeof *e->crossed);
    e->crossed_by =
        mu_startup_array(robots * words_of(MU_EXPLORED_CELLS_MAX), sizeof *e->crossed_by);
    e->crossed_counts = mu_startup_array(robots, sizeof *e->crossed_counts);
    return e;
}

/* --- walls ------------------------------------------------------------------------------------ */

static int clamp(double value, int max)
{
    return !(value > 0) ? 0 : value > max ? max : (int)value;
}

/* Whether an outline covers a point, or comes as near as near_m. */
static bool outline_covers(const struct mu_outline *o, double x_m, double y_m, double near_m)
{
    const float *c = o->corners_m;
    size_t n = o->corner_count;
    if (o->radius_m > 0) {
        return hypot(x_m - (double)c[0], y_m - (double)c[1]) <= o->radius_m + near_m;
    }
    for (size_t i = 0; i < n; i++) {
        size_t j = (i + 1) % n;
        double ax = (double)c[2 * i], ay = (double)c[2 * i + 1];
        double ex = (double)c[2 * j] - ax, ey = (double)c[2 * j + 1] - ay;
        double outside = ey * (x_m - ax) - ex * (y_m - ay); /* times the edge's length */
        if (outside > near_m * hypot(ex, ey)) {
            return false;
        }
    }
    return true;
}

struct box {
    double x0, y0, x1, y1;
};

static struct box outline_box(const struct mu_outline *o)
{
    struct box b = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < o->corner_count; i++) {
        double x = (double)o->corners_m[2 * i], y = (double)o->corners_m[2 * i + 1];
        b.x0 = fmin(b.x0, x - o->radius_m);
        b.y0 = fmin(b.y0, y - o->radius_m);
        b.x1 = fmax(b.x1, x + o->radius_m);
        b.y1 = fmax(b.y1, y + o->radius_m);
    }
    return b;
}

static void wall_add(struct explored *e, const struct mu_outline *o)
{
    if (o->flat || o->corner_count == 0) {
        return; /* a mark on the floor can be driven over */
    }
    struct box b = outline_box(o);
    int x0 = clamp((b.x0 - e->min_x_m) / e->fine_m - 1, e->width - 1);
    int x1 = clamp((b.x1 - e->min_x_m) / e->fine_m + 1, e->width - 1);
    int y0 = clamp((b.y0 - e->min_y_m) / e->fine_m - 1, e->height - 1);
    int y1 = clamp((b.y1 - e->min_y_m) / e->fine_m + 1, e->height - 1);
    for (int y = y0; y <= y1; y++) {
        for (int x = x0; x <= x1; x++) {
            double x_m = e->min_x_m + (x + 0.5) * e->fine_m;
            double y_m = e->min_y_m + (y + 0.5) * e->fine_m;
            if (outline_covers(o, x_m, y_m, e->fine_m / 2 + TOUCH_M)) {
                e->state[y * e->width + x] = FINE_SOLID;
            }
        }
    }
}

/* --- the floor -------------------------------------------------------------------------------- */

static void floor_clear(struct explored *e)
{
    memset(e->state, FINE_FREE, (size_t)e->width * (size_t)e->height);
    memset(e->reached, 0, e->cells);
    memset(e->crossed, 0, words_of(e->cells) * sizeof *e->crossed);
    memset(e->crossed_by, 0, e->robots_here * words_of(e->cells) * sizeof *e->crossed_by);
    memset(e->crossed_counts, 0, e->robots * sizeof *e->crossed_counts);
    e->crossed_count = e->floor_count = 0;
}

bool explored_begin(struct explored *e, const struct mu_scene *scene)
{
    double columns = ceil((scene->max_x_m - scene->min_x_m) / CELL_M);
    double rows = ceil((scene->max_y_m - scene->min_y_m) / CELL_M);
    e->there = columns >= 1 && rows >= 1 && columns * rows <= MU_EXPLORED_CELLS_MAX;
    if (!e->there) {
        return false;
    }
    int division = DIVISION_MAX;
    while (columns * rows * division * division > MU_EXPLORED_FINE_MAX) {
        division--;
    }
    e->min_x_m = scene->min_x_m;
    e->min_y_m = scene->min_y_m;
    e->division = division;
    e->half = (division * division + 1) / 2;
    e->fine_m = CELL_M / division;
    e->width = (int)columns * division;
    e->height = (int)rows * division;
    e->cells = (size_t)columns * (size_t)rows;
    e->robots_here = scene->robot_count < e->robots ? scene->robot_count : e->robots;
    floor_clear(e);
    for (size_t i = 0; i < scene->wall_count; i++) {
        wall_add(e, &scene->walls[i]);
    }
    return true;
}

static size_t cell_of(const struct explored *e, int x, int y)
{
    return (size_t)(y / e->division) * (size_t)(e->width / e->division) + (size_t)(x / e->division);
}

static int fine_reach(struct explored *e, int x, int y, int count)
{
    int at = y * e->width + x;
    if (e->state[at] == FINE_FREE) {
        e->state[at] = FINE_REACHED;
        e->stack[count++] = at;
        size_t cell = cell_of(e, x, y);
        e->floor_count += ++e->reached[cell] == e->half && !bit_is_set(e->crossed, cell);
    }
    return count;
}

static void floor_flood(struct explored *e, int from_x, int from_y)
{
    int count = fine_reach(e, from_x, from_y, 0);
    while (count > 0) {
        int at = e->stack[--count];
        int x = at % e->width, y = at / e->width;
        count = x > 0 ? fine_reach(e, x - 1, y, count) : count;
        count = x + 1 < e->width ? fine_reach(e, x + 1, y, count) : count;
        count = y > 0 ? fine_reach(e, x, y - 1, count) : count;
        count = y + 1 < e->height ? fine_reach(e, x, y + 1, count) : count;
    }
}

static void floor_visit(struct explored *e, size_t robot, double x_m, double y_m)
{
    double x = floor((x_m - e->min_x_m) / e->fine_m), y = floor((y_m - e->min_y_m) / e->fine_m);
    if (!(x >= 0 && y >= 0 && x < e->width && y < e->height)) {
        return;
    }
    size_t cell = cell_of(e, (int)x, (int)y);
    if (bit_set(e->crossed, cell)) {
        e->crossed_count++;
        e->floor_count += e->reached[cell] < e->half;
    }
    uint64_t *own = e->crossed_by + robot * words_of(e->cells);
    e->crossed_counts[robot] += bit_set(own, cell);
    floor_flood(e, (int)x, (int)y);
}

void explored_cross(struct explored *e, size_t robot, double x0_m, double y0_m, double x1_m,
                    double y1_m)
{
    if (!e->there || robot >= e->robots_here) {
        return;
    }
    double length_m = hypot(x1_m - x0_m, y1_m - y0_m);
    int parts = 1 + clamp(length_m / (CELL_M / 4), LINE_PARTS_MAX);
    for (int i = 1; i <= parts; i++) {
        double t = (double)i / parts;
        floor_visit(e, robot, x0_m + t * (x1_m - x0_m), y0_m + t * (y1_m - y0_m));
    }
}

static double share(const struct explored *e, size_t crossed)
{
    if (!e->there) {
        return -1;
    }
    return e->floor_count ? (double)crossed / (double)e->floor_count : 0;
}

double explored_share(const struct explored *e)
{
    return share(e, e->crossed_count);
}

double explored_share_of(const struct explored *e, size_t robot)
{
    return share(e, robot < e->robots_here ? e->crossed_counts[robot] : 0);
}
