/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts between bodies in a substep, and their effects: bumpers, chargers, sleep. */
#include "sim/engine/engine_core.h"

/* Sectors of a bumper: bits of a percept. */
enum { CONTACTS_SECTORS = 8 };

static void contacts_note(struct engine *e, const struct engine_pair *pair)
{
    if (e->pair_count < e->pairs_max) {
        e->pairs[e->pair_count++] = *pair;
    }
}

/* A moving body wakes the body that it touches, and keeps it awake. */
static void contacts_wake(struct engine *e, int32_t body, int32_t by)
{
    if (body == ODE_WORLD_STANDS || by == ODE_WORLD_STANDS) {
        return;
    }
    struct engine_body *b = &e->bodies[body];
    b->touched = true;
    if (b->asleep) {
        ode_world_sleep((size_t)body, false);
        b->asleep = false;
        motion_set_friction(e, (size_t)body - e->robot_count); /* only objects sleep */
    }
}

/* Marks the sector of a bumper: eighths of a turn, counted from ahead to the left. */
static void contacts_bump_at(struct engine *e, int32_t robot, double x, double y)
{
    const struct ode_motion *m = &e->bodies[robot].motion;
    double dx = x - m->x;
    double dy = y - m->y;
    double bearing = atan2(m->c * dy - m->s * dx, m->c * dx + m->s * dy);
    int sector = (int)floor(bearing * CONTACTS_SECTORS / (2 * M_PI) + 0.5);
    e->robots[robot].bumpers |= 1u << ((sector + CONTACTS_SECTORS) % CONTACTS_SECTORS);
}

/* Two points are the ends of one side, which touches along its whole length. */
static void contacts_bump(struct engine *e, const struct engine_part *part,
                          const struct narrow_contact *c)
{
    if (!part->is_case) {
        return;
    }
    for (size_t i = 0; i < c->count; i++) {
        contacts_bump_at(e, part->body, c->points[i].x, c->points[i].y);
    }
    if (c->count == 2) {
        contacts_bump_at(e, part->body, (c->points[0].x + c->points[1].x) / 2,
                         (c->points[0].y + c->points[1].y) / 2);
    }
}

static void contacts_charge(struct engine *e, const struct engine_part *part, double give_w)
{
    if (part->is_case) {
        struct engine_robot *r = &e->robots[part->body];
        r->charge_w = fmax(r->charge_w, give_w);
    }
}

static void contacts_touch(struct engine *e, const struct engine_pair *pair)
{
    const struct engine_part *a = &e->parts[pair->part];
    const struct engine_part *b = pair->stands ? &e->stands[pair->other] : &e->parts[pair->other];
    const struct solid *other = pair->stands ? &e->shapes[pair->other] : &e->outlines[pair->other];
    if (!neighbours_are_near(e, pair->part, other)) {
        return;
    }
    bool stop = a->look->stops && b->look->stops;
    struct narrow_contact contact;
    if (stop) {
        contacts_note(e, pair);
    }
    narrow_collide(&e->outlines[pair->part], other, &contact);
    if (contact.count == 0) {
        return;
    }
    contacts_charge(e, a, b->look->give_w);
    contacts_charge(e, b, a->look->give_w);
    if (!stop) {
        return;
    }
    ode_world_touch((size_t)a->body, b->body, &contact);
    contacts_bump(e, a, &contact);
    contacts_bump(e, b, &contact);
    contacts_wake(e, a->body, b->body);
    contacts_wake(e, b->body, a->body);
}

static bool contacts_may_meet(const struct engine *e, const struct engine_pair *pair)
{
    int32_t own = e->parts[pair->part].body;
    if (pair->stands) {
        return !e->bodies[own].asleep;
    }
    int32_t other = e->parts[pair->other].body;
    return other != own && !e->outlines[pair->other].away &&
           !(e->bodies[own].asleep && e->bodies[other].asleep);
}

/* The order of contacts is part of the result: by part, then in the order of its neighbours. */
static void contacts_find_of(struct engine *e, uint32_t i)
{
    bool sleeps = e->bodies[e->parts[i].body].asleep;
    if (e->outlines[i].away || (sleeps && i >= e->awake_end)) {
        return;
    }
    size_t count;
    const struct engine_pair *pairs = neighbours_of(e, i, &count);
    for (size_t k = 0; k < count; k++) {
        if (contacts_may_meet(e, &pairs[k])) {
            contacts_touch(e, &pairs[k]);
        }
    }
}

void contacts_find(struct engine *e)
{
    e->awake_end = 0;
    e->pair_count = 0;
    for (size_t k = 0; k < e->object_count; k++) {
        struct engine_body *b = &e->bodies[e->robot_count + k];
        b->touched = false;
        e->awake_end = b->asleep ? e->awake_end : bodies_object_part(e, k) + 1;
    }
    for (size_t i = 0; i < e->robot_count; i++) {
        e->robots[i].charge_w = 0;
    }
    neighbours_watch(e);
    for (uint32_t i = 0; i < e->part_count; i++) {
        contacts_find_of(e, i);
    }
}
