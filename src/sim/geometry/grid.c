/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/geometry/geometry.h"

#include "muster/memory.h"
#include "muster/result.h"

#include <string.h>

/*
 * Measured with 1, 1.3, 1.6 and 2 m: larger cells suit longer rays, smaller cells suit rays of 5 m.
 */
#define GRID_CELL_M   1.5
#define GRID_MARGIN_M 1.0  /* around the standing solids */
#define GRID_SLACK    1e-7 /* cells count as slightly larger, so that rounding leaves no gap */

/* The cells of an upright box. */
struct grid_span {
    int x0, x1, y0, y1;
    bool inside; /* wholly on the grid; otherwise these are the nearest cells */
};

static struct grid_span grid_span_at(const struct grid *grid, const struct solid *solid, double ex,
                                     double ey)
{
    double x0 = (solid->x - ex - grid->x0) * grid->per_m - GRID_SLACK;
    double x1 = (solid->x + ex - grid->x0) * grid->per_m + GRID_SLACK;
    double y0 = (solid->y - ey - grid->y0) * grid->per_m - GRID_SLACK;
    double y1 = (solid->y + ey - grid->y0) * grid->per_m + GRID_SLACK;
    return (struct grid_span){.x0 = grid_clamp(x0, grid->nx),
                              .x1 = grid_clamp(x1, grid->nx),
                              .y0 = grid_clamp(y0, grid->ny),
                              .y1 = grid_clamp(y1, grid->ny),
                              .inside = x0 >= 0 && y0 >= 0 && x1 < grid->nx && y1 < grid->ny};
}

static struct grid_span grid_span(const struct grid *grid, const struct solid *solid)
{
    double ex;
    double ey;
    solid_extent(solid, &ex, &ey);
    return grid_span_at(grid, solid, ex, ey);
}

/* @return whether a solid may reach into a cell; a cell that it reaches is never refused */
static bool grid_touches(const struct grid *grid, const struct solid *solid, int i, int j)
{
    double half = grid->cell_m / 2 * (1 + GRID_SLACK);
    double x = grid->x0 + (i + 0.5) * grid->cell_m - solid->x;
    double y = grid->y0 + (j + 0.5) * grid->cell_m - solid->y;
    if (solid->kind == WORLD_DISC) {
        double dx = fabs(x) > half ? fabs(x) - half : 0;
        double dy = fabs(y) > half ? fabs(y) - half : 0;
        return dx * dx + dy * dy <= solid->half_x * solid->half_x * (1 + GRID_SLACK);
    }
    double lx = solid->c * x + solid->s * y;
    double ly = solid->c * y - solid->s * x;
    double reach = half * (fabs(solid->c) + fabs(solid->s)) + GRID_SLACK;
    return fabs(lx) <= solid->half_x + reach && fabs(ly) <= solid->half_y + reach;
}

/* Notes the cells of a solid.  @return the number of parts so far */
static uint32_t grid_part(const struct grid *grid, struct grid_layer *layer, uint32_t solid,
                          uint32_t count)
{
    if (layer->solids[solid].away) {
        return count;
    }
    struct grid_span span = grid_span(grid, &layer->solids[solid]);
    if (!span.inside) {
        layer->outside[layer->outside_count++] = solid;
        return count;
    }
    /*
     * In a single row or column a solid reaches every cell; in a larger span it may miss the
     * corners.
     */
    bool all = span.x0 == span.x1 || span.y0 == span.y1;
    for (int j = span.y0; j <= span.y1; j++) {
        for (int i = span.x0; i <= span.x1; i++) {
            if (all || grid_touches(grid, &layer->solids[solid], i, j)) {
                MU_ASSERT(count < layer->entries_max);
                uint32_t cell = (uint32_t)(j * grid->nx + i);
                layer->parts[count++] = (struct grid_part){cell, solid};
                layer->start[cell + 1]++;
            }
        }
    }
    return count;
}

static void grid_build(struct grid *grid, struct grid_layer *layer)
{
    size_t cells = (size_t)grid->nx * (size_t)grid->ny;
    memset(layer->start, 0, (cells + 1) * sizeof *layer->start);
    layer->outside_count = 0;
    uint32_t count = 0;
    for (uint32_t k = 0; k < layer->count; k++) {
        count = grid_part(grid, layer, k, count);
    }
    for (size_t c = 0; c < cells; c++) {
        grid->cursor[c] = layer->start[c];
        layer->start[c + 1] += layer->start[c];
    }
    for (uint32_t k = 0; k < count; k++) {
        const struct grid_part *part = &layer->parts[k];
        layer->entries[grid->cursor[part->cell]++] = part->solid;
    }
}

static void grid_measure(struct grid *grid, const struct solid *solids, size_t count)
{
    double min[2] = {HUGE_VAL, HUGE_VAL};
    double max[2] = {-HUGE_VAL, -HUGE_VAL};
    for (size_t k = 0; k < count; k++) {
        double ex;
        double ey;
        solid_extent(&solids[k], &ex, &ey);
        min[0] = fmin(min[0], solids[k].x - ex);
        max[0] = fmax(max[0], solids[k].x + ex);
        min[1] = fmin(min[1], solids[k].y - ey);
        max[1] = fmax(max[1], solids[k].y + ey);
    }
    double width = count ? max[0] - min[0] + 2 * GRID_MARGIN_M : GRID_MARGIN_M;
    double height = count ? max[1] - min[1] + 2 * GRID_MARGIN_M : GRID_MARGIN_M;
    grid->x0 = count ? min[0] - GRID_MARGIN_M : 0;
    grid->y0 = count ? min[1] - GRID_MARGIN_M : 0;
    grid->cell_m = GRID_CELL_M;
    while (ceil(width / grid->cell_m) * ceil(height / grid->cell_m) > GRID_CELLS_MAX) {
        grid->cell_m *= 2;
    }
    grid->per_m = 1 / grid->cell_m;
    grid->nx = (int)ceil(width * grid->per_m);
    grid->ny = (int)ceil(height * grid->per_m);
}

/* @return the most cells that a solid can lie in, at any pose */
static uint32_t grid_cells_of(const struct grid *grid, const struct solid *solid)
{
    double side = floor(2 * solid->reach * grid->per_m + GRID_SLACK) + 2;
    double cells = fmin(side, grid->nx) * fmin(side, grid->ny);
    return (uint32_t)cells;
}

static void grid_layer_init(struct grid *grid, struct grid_layer *layer, const struct solid *solids,
                            size_t count)
{
    size_t cells = (size_t)grid->nx * (size_t)grid->ny;
    uint64_t entries = 0;
    for (size_t k = 0; k < count; k++) {
        entries += grid_cells_of(grid, &solids[k]);
    }
    MU_ASSERT(entries < UINT32_MAX && count < UINT32_MAX);
    layer->solids = solids;
    layer->count = (uint32_t)count;
    layer->entries_max = (uint32_t)entries;
    layer->start = mu_startup_array(cells + 1, sizeof *layer->start);
    layer->entries = mu_startup_array(layer->entries_max, sizeof *layer->entries);
    layer->parts = mu_startup_array(layer->entries_max, sizeof *layer->parts);
    layer->outside = mu_startup_array(count, sizeof *layer->outside);
    layer->seen = mu_startup_array(count, sizeof *layer->seen);
    grid_build(grid, layer);
}

void grid_init(struct grid *grid, const struct solid *still, size_t still_count,
               const struct solid *moving, size_t moving_count)
{
    *grid = (struct grid){0};
    bool open = still_count == 0; /* nothing stands: lay the grid over the moving solids */
    grid_measure(grid, open ? moving : still, open ? moving_count : still_count);
    grid->cursor = mu_startup_array((size_t)grid->nx * (size_t)grid->ny, sizeof *grid->cursor);
    grid_layer_init(grid, &grid->still, still, still_count);
    MU_ASSERT(grid->still.outside_count == 0);
    grid_layer_init(grid, &grid->moving, moving, moving_count);
}

void grid_update(struct grid *grid)
{
    grid_build(grid, &grid->moving);
}

/*
 * A ray in flight: the nearest hit so far, and its distance.  Passed by value to stay in registers.
 */
struct grid_flight {
    double from[2], along[2];
    double best_m;
    const struct solid *hit;
};

static inline bool grid_sees(struct grid_eye eye, const struct solid *solid)
{
    return (solid->returns & eye.returns) && solid->owner != eye.self;
}

static inline struct grid_flight grid_try(struct grid_flight flight, const struct solid *solid)
{
    double range = solid_ray(solid, flight.from, flight.along, flight.best_m);
    flight.hit = range < flight.best_m ? solid : flight.hit;
    flight.best_m = range;
    return flight;
}

static inline struct grid_flight grid_try_some(struct grid_flight flight,
                                               const struct grid_layer *layer, struct grid_eye eye,
                                               const uint32_t *some, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        const struct solid *solid = &layer->solids[some ? some[k] : k];
        if (grid_sees(eye, solid)) {
            flight = grid_try(flight, solid);
        }
    }
    return flight;
}

static inline struct grid_flight grid_try_cell(struct grid_flight flight,
                                               const struct grid_layer *layer, struct grid_eye eye,
                                               size_t cell)
{
    uint32_t first = layer->start[cell];
    return grid_try_some(flight, layer, eye, layer->entries + first,
                         layer->start[cell + 1] - first);
}

/* J. Amanatides and A. Woo, "A fast voxel traversal algorithm for ray tracing", 1987. */
static inline struct grid_flight grid_walk(struct grid_flight flight, const struct grid *grid,
                                           struct grid_eye eye)
{
    double gx = (flight.from[0] - grid->x0) * grid->per_m;
    double gy = (flight.from[1] - grid->y0) * grid->per_m;
    int i = (int)gx;
    int j = (int)gy;
    double slope_x = fabs(flight.along[0]);
    double slope_y = fabs(flight.along[1]);
    double per_x = grid->cell_m / (slope_x > 1e-12 ? slope_x : 1e-12);
    double per_y = grid->cell_m / (slope_y > 1e-12 ? slope_y : 1e-12);
    double next_x = (flight.along[0] > 0 ? i + 1 - gx : gx - i) * per_x;
    double next_y = (flight.along[1] > 0 ? j + 1 - gy : gy - j) * per_y;
    int step_x = flight.along[0] > 0 ? 1 : -1;
    int step_y = flight.along[1] > 0 ? 1 : -1;
    int end_x = flight.along[0] > 0 ? grid->nx : -1;
    int end_y = flight.along[1] > 0 ? grid->ny : -1;
    ptrdiff_t row = step_y > 0 ? grid->nx : -grid->nx;
    ptrdiff_t cell = (ptrdiff_t)j * grid->nx + i;
    for (;;) {
        flight = grid_try_cell(flight, &grid->still, eye, (size_t)cell);
        flight = grid_try_cell(flight, &grid->moving, eye, (size_t)cell);
        if (next_x < next_y) {
            i += step_x;
            cell += step_x;
            if (flight.best_m <= next_x || i == end_x) {
                return flight;
            }
            next_x += per_x;
        } else {
            j += step_y;
            cell += row;
            if (flight.best_m <= next_y || j == end_y) {
                return flight;
            }
            next_y += per_y;
        }
    }
}

static inline struct grid_flight grid_fly(struct grid_flight flight, const struct grid *grid,
                                          struct grid_eye eye)
{
    const struct grid_layer *moving = &grid->moving;
    double gx = (flight.from[0] - grid->x0) * grid->per_m;
    double gy = (flight.from[1] - grid->y0) * grid->per_m;
    if (!(gx >= 0 && gy >= 0 && gx < grid->nx && gy < grid->ny)) { /* rare: outside the grid */
        flight = grid_try_some(flight, &grid->still, eye, NULL, grid->still.count);
        return grid_try_some(flight, moving, eye, NULL, moving->count);
    }
    flight = grid_try_some(flight, moving, eye, moving->outside, moving->outside_count);
    return grid_walk(flight, grid, eye);
}

double grid_find(const struct grid *grid, struct grid_eye eye, const double from[2],
                 const double along[2], double range_m, const struct solid **hit)
{
    struct grid_flight flight = {{from[0], from[1]}, {along[0], along[1]}, range_m, NULL};
    flight = grid_fly(flight, grid, eye);
    *hit = flight.hit;
    return flight.best_m;
}

/* The compiler sees that the hit is not used, and removes its computation. */
double grid_ray(const struct grid *grid, int self, const double from[2], const double along[2],
                double range_m)
{
    struct grid_flight flight = {{from[0], from[1]}, {along[0], along[1]}, range_m, NULL};
    return grid_fly(flight, grid, (struct grid_eye){self, SOLID_ECHOES}).best_m;
}

static size_t grid_meet(struct grid *grid, struct grid_layer *layer, uint32_t k, uint32_t *list,
                        size_t count)
{
    if (layer->seen[k] == grid->query) {
        return count;
    }
    layer->seen[k] = grid->query;
    list[count] = k;
    return count + 1;
}

/* Lists the solids of a cell; of the moving solids, those from number `least` on. */
static void grid_meet_cell(struct grid *grid, uint32_t least, int cell, struct grid_near *near)
{
    struct grid_layer *still = &grid->still;
    struct grid_layer *moving = &grid->moving;
    for (uint32_t k = still->start[cell]; k < still->start[cell + 1]; k++) {
        near->still_count =
            grid_meet(grid, still, still->entries[k], near->still, near->still_count);
    }
    for (uint32_t k = moving->start[cell]; k < moving->start[cell + 1]; k++) {
        if (moving->entries[k] >= least) {
            near->moving_count =
                grid_meet(grid, moving, moving->entries[k], near->moving, near->moving_count);
        }
    }
}

static void grid_meet_all(struct grid *grid, struct grid_span span, uint32_t least,
                          struct grid_near *near)
{
    struct grid_layer *moving = &grid->moving;
    near->still_count = 0;
    near->moving_count = 0;
    grid->query++;
    for (int j = span.y0; j <= span.y1; j++) {
        for (int i = span.x0; i <= span.x1; i++) {
            grid_meet_cell(grid, least, j * grid->nx + i, near);
        }
    }
    for (uint32_t k = 0; k < moving->outside_count; k++) {
        if (moving->outside[k] >= least) {
            near->moving_count =
                grid_meet(grid, moving, moving->outside[k], near->moving, near->moving_count);
        }
    }
}

void grid_near(struct grid *grid, uint32_t index, double reach_m, struct grid_near *near)
{
    const struct solid *solid = &grid->moving.solids[index];
    grid_meet_all(grid, grid_span_at(grid, solid, reach_m, reach_m), index + 1, near);
}

void grid_around(struct grid *grid, const struct solid *solid, struct grid_near *near)
{
    grid_meet_all(grid, grid_span(grid, solid), 0, near);
}
