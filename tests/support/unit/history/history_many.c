/* SPDX-License-Identifier: Apache-2.0 */
/* One sample for many processes: each of them gets it at another time, or not at all. */
#include "history.h"

#include "broker/control/parts.h"

#include <string.h>

/* Readers of multicasts are found when they are found. */
void many_hear(void)
{
    for (int i = 0; i < PROCESSES; i++) {
        struct history_process *p = &history.processes[i];
        uint32_t place = processes_find(&history.life.b->processes, p->name);
        bool matched =
            place != MU_NONE && processes_is_matched(&history.life.b->processes.at[place]);
        if (matched && p->alive && p->has_ears && !p->hears && !history_chance(3)) {
            history_note("%s hears circulars", p->name);
            broker_hears(history.life.b, p->name);
            p->hears = true;
        }
    }
}

void many_count(struct history_process *p, uint32_t chair, uint64_t serial)
{
    HOLD(chair > 0 && chair < CHAIRS);
    struct chair *c = &history.life.chairs[chair];
    HOLD(!c->of || c->of == p);
    c->of = p;
    HOLD(serial == c->serial + 1); /* nobody waits for what never comes */
    c->serial = serial;
}

/* @return whose box that is, or NOBODY */
static int box_of(const struct history_process *p, uint32_t slot)
{
    const struct broker *b = history.life.b;
    for (int name = 0; name < NAMES; name++) {
        muster_Member m;
        if (life_member(name, &m) && m.state != muster_STATE_ABSENT &&
            strcmp(m.process, p->name) == 0 &&
            b->registry.agents[registry_find(&b->registry, m.name)].resident.slot == slot) {
            return name;
        }
    }
    return NOBODY;
}

static struct history_process *process_at(uint32_t chair)
{
    HOLD(chair > 0 && chair < CHAIRS && history.life.chairs[chair].of);
    return &history.processes[history.life.chairs[chair].of - history.processes];
}

/* Checks one box, and writes what it brings if somebody is to have it. */
static void box_copy(const muster_Delivery *d, uint32_t index, struct history_process *p,
                     struct delivery *to)
{
    uint32_t slot = d->slots._buffer[index];
    int box = box_of(p, slot);
    for (uint32_t k = 0; k < d->letters._length; k++) {
        struct item item;
        muster_Member m;
        net_parcel_copy(&d->letters._buffer[k], d->numbers._buffer[index] + k, &item);
        net_parcel_check(p, box, &item);
        HOLD(item.number == history.life.highest[box]); /* nothing comes again so */
        HOLD(life_member(box, &m) && m.state == muster_STATE_RUNNING);
        item.seat = (int)slot;
        if (to) {
            to->parcels[to->parcels_count++] = item;
        }
    }
}

/* @return the first box of the next process */
static uint32_t process_copy(const muster_Delivery *d, uint32_t index)
{
    uint32_t chair = d->seats._buffer[index];
    uint64_t serial = d->serials._buffer[index];
    struct history_process *p = process_at(chair);
    HOLD(p->hears);
    many_count(p, chair, serial);
    bool lost = history.loses && !history.is_quiet && history_chance(5);
    struct delivery *to = p->alive && !lost ? inbox_add(p, true) : NULL;
    history.seen.lost += !to;
    if (to) {
        to->chair = chair;
        to->serial = serial;
    }
    for (; index < d->seats._length && d->seats._buffer[index] == chair; index++) {
        HOLD(d->serials._buffer[index] == serial);
        box_copy(d, index, p, to);
    }
    return index;
}

void many_deliver(const muster_Delivery *d)
{
    if (history.loses && !history.is_quiet && history_chance(6)) {
        broker_undelivered(history.life.b);
        return;
    }
    uint32_t boxes = d->seats._length, processes = 0;
    HOLD(boxes == d->serials._length && boxes == d->slots._length && boxes == d->numbers._length);
    history_note("to all: %lu boxes, %lu letters", (unsigned long)boxes,
                 (unsigned long)d->letters._length);
    HOLD(d->parcels._length + d->receipts._length + d->verdicts._length + d->members._length == 0);
    for (uint32_t i = 0, before = 0; i < boxes; processes++) {
        HOLD(d->seats._buffer[i] > before);
        before = d->seats._buffer[i];
        i = process_copy(d, i);
    }
    HOLD(processes >= MULTICAST_PROCESSES_MIN);
    history.seen.multicasts++;
    history.seen.by_circular += boxes * d->letters._length;
    broker_delivered(history.life.b, life_now_ns());
}
