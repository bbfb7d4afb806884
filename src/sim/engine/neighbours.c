/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Neighbour lists: the parts that may come near a part soon.
 *
 * A query of the grid in each substep would cost more than all contacts.  So a part's pairs are
 * listed once with a margin, when they are first needed (L. Verlet, "Computer experiments on
 * classical fluids", 1967).  All lists are dropped once any part has moved half of the margin.  The
 * time of that leaves no trace in the result: neighbours_are_near tests each pair, and pairs are
 * ordered by number.
 */
#include "muster/memory.h"
#include "sim/engine/engine_core.h"

#include <string.h>

/* Nearer parts may overlap deeply after a substep. */
#define NEIGHBOURS_NEAR_M 0.05

/* A robot at its usual speed moves less than half of this in a control step. */
#define NEIGHBOURS_MARGIN_M 0.2

/* Mean number of neighbours that the lists have room for.  A disc in a heap has forty. */
enum { NEIGHBOURS_MEAN = 32 };

void neighbours_start(struct engine *e)
{
    struct neighbours *n = &e->neighbours;
    n->pairs_max = NEIGHBOURS_MEAN * e->part_count;
    n->pairs = mu_startup_array(n->pairs_max, sizeof *n->pairs);
    n->lists = mu_startup_array(e->part_count, sizeof *n->lists);
    n->marks = mu_startup_array(e->part_count, sizeof *n->marks);
    n->found = mu_startup_array(e->world->shape_count + e->part_count, sizeof *n->found);
    n->is_new = true;
}

bool neighbours_are_near(const struct engine *e, size_t part, const struct solid *other)
{
    const struct solid *own = &e->outlines[part];
    return solid_is_within(other, own->x, own->y, own->reach + NEIGHBOURS_NEAR_M);
}

/* Keeps the solids of a list that a circle reaches, sorted by number.  @return how many */
static size_t neighbours_sift(uint32_t *list, size_t count, const struct solid *solids,
                              const struct solid *own, double reach_m)
{
    size_t kept = 0;
    for (size_t k = 0; k < count; k++) {
        uint32_t next = list[k];
        if (!solid_is_within(&solids[next], own->x, own->y, reach_m)) {
            continue;
        }
        size_t at = kept++;
        for (; at > 0 && list[at - 1] > next; at--) {
            list[at] = list[at - 1];
        }
        list[at] = next;
    }
    return kept;
}

/* Finds the solids within a margin of a part, in the order of the lists.  @return how many */
static size_t neighbours_find(struct engine *e, uint32_t part, double margin_m)
{
    const struct solid *own = &e->outlines[part];
    struct grid_near *near = &e->near;
    struct engine_pair *found = e->neighbours.found;
    double reach = own->reach + NEIGHBOURS_NEAR_M + margin_m;
    grid_near(&e->grid, part, reach, near);
    size_t stand = neighbours_sift(near->still, near->still_count, e->shapes, own, reach);
    size_t move = neighbours_sift(near->moving, near->moving_count, e->outlines, own, reach);
    for (size_t k = 0; k < stand; k++) {
        found[k] = (struct engine_pair){part, near->still[k], true};
    }
    for (size_t k = 0; k < move; k++) {
        found[stand + k] = (struct engine_pair){part, near->moving[k], false};
    }
    return stand + move;
}

/* No point of a part moves farther than its middle and its rotation together. */
static bool neighbours_has_strayed(const struct solid *now, const struct neighbours_mark *then)
{
    double dx = now->x - then->place.x;
    double dy = now->y - then->place.y;
    double dc = now->c - then->place.c;
    double ds = now->s - then->place.s;
    double swept = now->reach * now->reach * (dc * dc + ds * ds);
    double most = NEIGHBOURS_MARGIN_M / 2;
    return !(2 * (dx * dx + dy * dy + swept) < most * most) || now->away != then->away;
}

static bool neighbours_any_strayed(const struct engine *e)
{
    bool any = e->neighbours.is_new;
    for (size_t p = 0; !any && p < e->part_count; p++) {
        any = neighbours_has_strayed(&e->outlines[p], &e->neighbours.marks[p]);
    }
    return any;
}

void neighbours_watch(struct engine *e)
{
    struct neighbours *n = &e->neighbours;
    /*
     * No part is farther than half a margin from its mark.  Two parts that had moved apart before
     * they are listed can therefore approach by two margins.
     */
    n->margin_m = 2 * NEIGHBOURS_MARGIN_M;
    if (!neighbours_any_strayed(e)) {
        return;
    }
    n->is_new = false;
    n->margin_m = NEIGHBOURS_MARGIN_M;
    n->pairs_used = 0;
    for (size_t p = 0; p < e->part_count; p++) {
        const struct solid *o = &e->outlines[p];
        n->marks[p] = (struct neighbours_mark){{o->x, o->y, o->c, o->s}, o->away};
        n->lists[p].is_there = false;
    }
}

/* Keeps the pairs that were found as the list of a part, if there is room. */
static void neighbours_keep_list(struct neighbours *n, uint32_t part, size_t count)
{
    if (count <= n->pairs_max - n->pairs_used) {
        memcpy(n->pairs + n->pairs_used, n->found, count * sizeof *n->found);
        n->lists[part] = (struct neighbours_list){n->pairs_used, count, true};
        n->pairs_used += count;
    }
}

const struct engine_pair *neighbours_of(struct engine *e, uint32_t part, size_t *count)
{
    struct neighbours *n = &e->neighbours;
    const struct neighbours_list *list = &n->lists[part];
    if (list->is_there) {
        *count = list->count;
        return n->pairs + list->first;
    }
    space_refresh(e);
    *count = neighbours_find(e, part, n->margin_m);
    neighbours_keep_list(n, part, *count);
    return n->found;
}
