/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/sensors/fan.h"

#include "muster/memory.h"
#include "muster/result.h"

#include <string.h>

#define GATHER_TILE_M                                                                             \
    4.0 /* of the smallest tier: the best of 2 to 4, measured; each next tier has four times that \
         */

/* Rows of tiles that a circle may cover in gather_cast, in both layers. */
enum { GATHER_SPANS = 64 };

static void gather_solids_init(struct gather_solids *solids, size_t max)
{
    size_t room = max + GATHER_PAD;
    double **numbers[] = {&solids->x,      &solids->y,      &solids->c,    &solids->s,
                          &solids->half_x, &solids->half_y, &solids->reach};
    for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
        *numbers[k] = mu_startup_array(room, sizeof **numbers[k]);
    }
    solids->disc = mu_startup_array(room, sizeof *solids->disc);
    solids->returns = mu_startup_array(room, sizeof *solids->returns);
    solids->id = mu_startup_array(room, sizeof *solids->id);
    solids->owner = mu_startup_array(room, sizeof *solids->owner);
}

static void gather_put(struct gather_solids *to, size_t at, const struct solid *solid, size_t id)
{
    to->x[at] = solid->x;
    to->y[at] = solid->y;
    to->c[at] = solid->c;
    to->s[at] = solid->s;
    to->half_x[at] = solid->half_x;
    to->half_y[at] = solid->half_y;
    to->reach[at] = solid->reach;
    to->disc[at] = solid->kind == WORLD_DISC ? -1 : 0;
    to->returns[at] = solid->away ? 0 : solid->returns;
    to->id[at] = (int64_t)id;
    to->owner[at] = solid->owner;
}

static struct gather_tier *gather_tier_of(struct gather *g, const struct solid *solid)
{
    size_t k = 0;
    while (k + 1 < GATHER_TIERS && solid->reach > g->tiers[k].tile_m / 2) {
        k++;
    }
    return &g->tiers[k];
}

static uint32_t gather_tile_of(struct gather *g, const struct solid *solid)
{
    struct gather_tier *tier = gather_tier_of(g, solid);
    tier->used = true;
    int i = grid_clamp((solid->x - g->x0) * tier->per_m, tier->nx);
    int j = grid_clamp((solid->y - g->y0) * tier->per_m, tier->ny);
    return (uint32_t)(tier->first + (size_t)j * (size_t)tier->nx + (size_t)i);
}

static void gather_sort(struct gather *g, struct gather_layer *layer)
{
    size_t count = layer->solids.count;
    memset(layer->start, 0, (g->tiles + 1) * sizeof *layer->start);
    for (size_t k = 0; k < count; k++) {
        layer->tile[k] = gather_tile_of(g, &layer->from[k]);
        layer->start[layer->tile[k] + 1]++;
    }
    for (size_t t = 0; t < g->tiles; t++) {
        layer->start[t + 1] += layer->start[t];
    }
    memcpy(g->cursor, layer->start, g->tiles * sizeof *g->cursor);
    for (size_t k = 0; k < count; k++) {
        size_t at = g->cursor[layer->tile[k]]++;
        gather_put(&layer->solids, at, &layer->from[k], layer->first_id + k);
    }
}

static void gather_layer_init(struct gather *g, struct gather_layer *layer,
                              const struct solid *from, size_t count)
{
    MU_ASSERT(count < UINT32_MAX);
    layer->from = from;
    gather_solids_init(&layer->solids, count);
    layer->solids.count = count;
    layer->tile = mu_startup_array(count, sizeof *layer->tile);
    layer->start = mu_startup_array(g->tiles + 1, sizeof *layer->start);
    gather_sort(g, layer);
}

/* Lays tiles over a box.  A solid outside counts as in the nearest tile. */
static void gather_lay(struct gather *g, double width, double height, double tile_m)
{
    g->tiles = 0;
    for (size_t k = 0; k < GATHER_TIERS; k++, tile_m *= 4) {
        bool last = k + 1 == GATHER_TIERS;
        g->tiers[k] = (struct gather_tier){.tile_m = last ? HUGE_VAL : tile_m,
                                           .per_m = last ? 0 : 1 / tile_m,
                                           .nx = last ? 1 : (int)fmin(width / tile_m + 1, 1e4),
                                           .ny = last ? 1 : (int)fmin(height / tile_m + 1, 1e4),
                                           .first = g->tiles};
        g->tiles += (size_t)g->tiers[k].nx * (size_t)g->tiers[k].ny;
    }
}

static void gather_measure(struct gather *g, const struct solid *solids, size_t count)
{
    double min[2] = {HUGE_VAL, HUGE_VAL};
    double max[2] = {-HUGE_VAL, -HUGE_VAL};
    for (size_t k = 0; k < count; k++) {
        min[0] = fmin(min[0], solids[k].x);
        min[1] = fmin(min[1], solids[k].y);
        max[0] = fmax(max[0], solids[k].x);
        max[1] = fmax(max[1], solids[k].y);
    }
    g->x0 = count ? min[0] : 0;
    g->y0 = count ? min[1] : 0;
    double tile_m = GATHER_TILE_M;
    do {
        gather_lay(g, count ? max[0] - min[0] : 0, count ? max[1] - min[1] : 0, tile_m);
        tile_m *= 2;
    } while (g->tiles > GATHER_TILES_MAX);
}

void gather_init(struct gather *g, const struct solid *still, size_t still_count,
                 const struct solid *moving, size_t moving_count)
{
    *g = (struct gather){.moving.first_id = still_count};
    bool open = still_count == 0; /* nothing stands: lay the tiles over the moving solids */
    gather_measure(g, open ? moving : still, open ? moving_count : still_count);
    g->cursor = mu_startup_array(g->tiles, sizeof *g->cursor);
    gather_layer_init(g, &g->still, still, still_count);
    gather_layer_init(g, &g->moving, moving, moving_count);
}

void gather_list_init(struct gather_list *list, const struct gather *g)
{
    size_t max = g->still.solids.count + g->moving.solids.count;
    gather_solids_init(&list->solids, max);
    list->solids.count = 0;
    list->found = mu_startup_array(max + GATHER_PAD, sizeof *list->found);
}

void gather_update(struct gather *g)
{
    gather_sort(g, &g->moving);
}

static void gather_copy(struct gather_solids *to, const struct gather_solids *from, size_t k)
{
    size_t at = to->count++;
    to->x[at] = from->x[k];
    to->y[at] = from->y[k];
    to->c[at] = from->c[k];
    to->s[at] = from->s[k];
    to->half_x[at] = from->half_x[k];
    to->half_y[at] = from->half_y[k];
    to->reach[at] = from->reach[k];
    to->disc[at] = from->disc[k];
    to->returns[at] = from->returns[k];
    to->id[at] = from->id[k];
}

/* A run of solids in one layer, some of which may come within a circle. */
struct gather_span {
    const struct gather_solids *solids;
    uint32_t begin, end;
};

/* The state of a query. */
struct gather_search {
    const struct gather *gather;
    const struct fan_kernel *kernel;
    const struct gather_circle *circle;
    int32_t self;
    void (*take)(struct gather_search *search, const struct gather_span *span);
    struct gather_list *list;   /* for gather_near */
    struct gather_span *spans;  /* for gather_cast */
    size_t span_count, between; /* number of solids in all spans */
};

/* Lists the solids of a span that come within the circle.  @return how many */
static size_t gather_sift(const struct gather_search *search, const struct gather_span *span,
                          uint32_t *found)
{
    const struct gather_solids *solids = span->solids;
    size_t count = search->kernel->near(solids, span->begin, span->end, search->circle, found);
    size_t others = 0;
    for (size_t k = 0; k < count; k++) {
        found[others] = found[k];
        others += solids->owner[found[k]] != search->self;
    }
    return others;
}

static void gather_take(struct gather_search *search, const struct gather_span *span)
{
    struct gather_list *list = search->list;
    size_t count = gather_sift(search, span, list->found);
    for (size_t k = 0; k < count; k++) {
        gather_copy(&list->solids, span->solids, list->found[k]);
    }
}

static inline void gather_tiles(struct gather_search *search, const struct gather_layer *layer,
                                size_t first_tile, size_t last_tile)
{
    struct gather_span span = {&layer->solids, layer->start[first_tile],
                               layer->start[last_tile + 1]};
    if (span.begin != span.end) {
        search->take(search, &span);
    }
}

/* @return the distance of y from a row of tiles; the outermost rows have no outer end */
static double gather_row_apart(const struct gather *g, const struct gather_tier *tier, int row,
                               double y)
{
    double low = row == 0 ? -HUGE_VAL : g->y0 + row * tier->tile_m;
    double high = row == tier->ny - 1 ? HUGE_VAL : g->y0 + (row + 1) * tier->tile_m;
    double below = low - y;
    double above = y - high;
    double apart = below > above ? below : above;
    return apart > 0 ? apart : 0;
}

static void gather_row(struct gather_search *search, const struct gather_tier *tier, int row,
                       double reach)
{
    const struct gather *g = search->gather;
    double apart = gather_row_apart(g, tier, row, search->circle->y);
    double square = reach * reach - apart * apart;
    double half = tier->ny == 1 ? reach : sqrt(square > 0 ? square : 0);
    double x = search->circle->x - g->x0;
    int left = grid_clamp((x - half) * tier->per_m, tier->nx);
    int right = grid_clamp((x + half) * tier->per_m, tier->nx);
    size_t first = tier->first + (size_t)row * (size_t)tier->nx;
    gather_tiles(search, &g->still, first + (size_t)left, first + (size_t)right);
    gather_tiles(search, &g->moving, first + (size_t)left, first + (size_t)right);
}

static void gather_search(struct gather_search *search)
{
    const struct gather *g = search->gather;
    const struct gather_circle *circle = search->circle;
    for (size_t k = 0; k < GATHER_TIERS; k++) {
        const struct gather_tier *tier = &g->tiers[k];
        if (tier->used) {
            bool last = k + 1 == GATHER_TIERS;
            /* Rounding must leave no gap. */
            double reach = last ? 0 : circle->reach_m + tier->tile_m / 2 + 1e-6;
            double y = circle->y - g->y0;
            int row = grid_clamp((y - reach) * tier->per_m, tier->ny);
            int row_last = grid_clamp((y + reach) * tier->per_m, tier->ny);
            for (; row <= row_last; row++) {
                gather_row(search, tier, row, reach);
            }
        }
    }
}

void gather_near(const struct gather *g, const struct gather_circle *circle, int32_t self,
                 struct gather_list *list)
{
    struct gather_search search = {.gather = g,
                                   .kernel = fan_kernel(),
                                   .circle = circle,
                                   .self = self,
                                   .take = gather_take,
                                   .list = list};
    list->solids.count = 0;
    gather_search(&search);
}

static void gather_note(struct gather_search *search, const struct gather_span *span)
{
    search->between += span->end - span->begin;
    if (search->span_count < GATHER_SPANS) {
        search->spans[search->span_count++] = *span;
    } else {
        search->between = SIZE_MAX / 2; /* too many */
    }
}

bool gather_cast(const struct gather *g, const struct gather_circle *circle, int32_t self,
                 const struct fan_rays *rays, uint32_t *found)
{
    struct gather_span spans[GATHER_SPANS];
    struct gather_search search = {.gather = g,
                                   .kernel = fan_kernel(),
                                   .circle = circle,
                                   .self = self,
                                   .take = gather_note,
                                   .spans = spans};
    gather_search(&search);
    if (search.between > search.kernel->crowd) {
        return false;
    }
    for (size_t k = 0; k < search.span_count; k++) {
        size_t count = gather_sift(&search, &spans[k], found);
        search.kernel->cast(rays, spans[k].solids, found, count);
    }
    return true;
}

const struct solid *gather_solid(const struct gather *g, int64_t id)
{
    size_t k = (size_t)id;
    return k < g->moving.first_id ? &g->still.from[k] : &g->moving.from[k - g->moving.first_id];
}
