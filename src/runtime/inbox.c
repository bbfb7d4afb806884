/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/inbox.h"

#include "core/clock.h"
#include "runtime/process.h"

#include <string.h>

void inbox_init(struct inbox *box)
{
    for (uint32_t i = 0; i < INBOX_MAX; i++) {
        box->at[i] = bus_sample(BUS_DELIVERY);
    }
}

/* --- multicasts ------------------------------------------------------------------------------- */

static bool is_multicast(const muster_Delivery *d)
{
    return d->seats._length > 0;
}

/* @return the first box of this process in a multicast, or its length: there is none */
static uint32_t first_box(const struct inbox *box, const muster_Delivery *d)
{
    uint32_t low = 0, high = d->seats._length;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (d->seats._buffer[middle] < box->seat) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < d->seats._length && d->seats._buffer[low] == box->seat ? low : d->seats._length;
}

/* The broker writes to a seat that the process has acknowledged: a process without one is not
 * meant.
 * @return whether it is a multicast that is for this process, too */
static bool names_us(const mu_process *p, const muster_Delivery *d)
{
    const struct inbox *box = &p->inbox;
    return box->seat != 0 && d->broker_incarnation == box->incarnation &&
           strcmp(d->broker, p->link.broker) == 0 && first_box(box, d) < d->seats._length;
}

/* A process with a later seat has been told anew what an earlier seat was told.
 * @return whether it is for this process, as it is now */
static bool is_for_us(const mu_process *p, const muster_Delivery *d)
{
    const struct inbox *box = &p->inbox;
    if (is_multicast(d)) {
        return names_us(p, d);
    }
    bool counts = d->serial > 0 && d->broker_incarnation == box->incarnation;
    return !counts || d->seat >= box->seat;
}

/* @return the agent of a slot, if it had that when the multicast of that serial was written; else
 * NULL.  The slot of an agent that has left is given to another. */
static struct mu_agent *tenant_find(const mu_process *p, uint32_t slot, uint64_t serial)
{
    struct mu_agent *a = slot < p->agent_count ? &p->agents[slot] : NULL;
    return a && a->name_state == NAME_ACCEPTED && serial > a->accepted_serial ? a : NULL;
}

/* @return it as a Delivery of items, whose letters stay where they are */
static const muster_Delivery *multicast_open(mu_process *p, const muster_Delivery *d)
{
    struct inbox *box = &p->inbox;
    uint32_t count = 0;
    box->open = (muster_Delivery){.process = p->name,
                                  .broker = d->broker,
                                  .broker_incarnation = d->broker_incarnation,
                                  .step = d->step};
    uint32_t first = first_box(box, d), boxes = d->seats._length;
    boxes = boxes - first < BUS_CIRCULAR_BOXES ? boxes : first + BUS_CIRCULAR_BOXES;
    for (uint32_t i = first; i < boxes && d->seats._buffer[i] == box->seat; i++) {
        struct mu_agent *a = tenant_find(p, d->slots._buffer[i], d->serials._buffer[i]);
        for (uint32_t k = 0; a && k < d->letters._length; k++) {
            box->items[count++] = (muster_Parcel){.box = a->name,
                                                  .number = d->numbers._buffer[i] + k,
                                                  .letter = d->letters._buffer[k]};
        }
    }
    box->open.parcels._buffer = box->items;
    box->open.parcels._length = box->open.parcels._maximum = count;
    return &box->open;
}

/* --- in and out ------------------------------------------------------------------------------- */

static void keep(struct inbox *box, struct bus_reader *from, bool multicast)
{
    void **place = &box->at[box->count++];
    *place = bus_keep(from, *place);
    box->multicasts += multicast;
}

static void multicasts_fill(mu_process *p)
{
    enum bus_life life;
    const muster_Delivery *d;
    while (p->inbox.multicasts < INBOX_EACH && (d = bus_next(&p->multicasts, &life))) {
        if (life == BUS_DATA && names_us(p, d)) {
            keep(&p->inbox, &p->multicasts, true);
        }
    }
}

void inbox_fill(mu_process *p)
{
    struct inbox *box = &p->inbox;
    const muster_Delivery *d;
    enum bus_life life;
    /* First: behind a Delivery to a new seat, a multicast to the old one does not count. */
    multicasts_fill(p);
    while (box->count - box->multicasts < INBOX_EACH && (d = bus_next(&p->delivery, &life))) {
        bool is_probe = life == BUS_DATA && d->glances._length > 0;
        if (is_probe && d->broker_incarnation == p->link.incarnation) {
            probes_take(p, d);
        } else if (life == BUS_DATA && !is_multicast(d)) {
            keep(box, &p->delivery, false);
        }
    }
}

static void remove_at(struct inbox *box, uint32_t index)
{
    void *spare = box->at[index];
    box->multicasts -= is_multicast(spare);
    memmove(&box->at[index], &box->at[index + 1], (--box->count - index) * sizeof spare);
    box->at[box->count] = spare;
}

void inbox_drop(mu_process *p)
{
    if (p->mail) {
        p->mail = NULL;
        remove_at(&p->inbox, 0);
    }
}

/* --- in order --------------------------------------------------------------------------------- */

/* @return where a Delivery stands among those to this seat; 0: nowhere */
static uint64_t serial_of(const struct inbox *box, const muster_Delivery *d)
{
    if (d->broker_incarnation != box->incarnation) {
        return 0;
    }
    if (is_multicast(d)) {
        uint32_t i = first_box(box, d);
        return i < d->seats._length ? d->serials._buffer[i] : 0;
    }
    return d->seat == box->seat ? d->serial : 0;
}

/* @return the first that may be handled now; its count: each one has come too early */
static uint32_t find_next(const struct inbox *box)
{
    uint32_t i = 0;
    while (i < box->count && serial_of(box, box->at[i]) > box->serial + 1) {
        i++;
    }
    return i;
}

/* @return the earliest of the first count, which is at least 1 */
static uint32_t find_earliest(const struct inbox *box, uint32_t count)
{
    uint32_t earliest = 0;
    for (uint32_t i = 1; i < count; i++) {
        bool before = serial_of(box, box->at[i]) < serial_of(box, box->at[earliest]);
        earliest = before ? i : earliest;
    }
    return earliest;
}

/* @return whether it is the first to a new seat: Deliveries that are missing before it are lost */
static bool begins_anew(const struct inbox *box, const muster_Delivery *d)
{
    return !is_multicast(d) && d->serial > 0 && d->broker_incarnation == box->incarnation &&
           d->seat > box->seat;
}

/* @return the index of the next one, or the count: it has not come */
static uint32_t choose(struct inbox *box)
{
    uint32_t next = find_next(box);
    if (box->count == 0) {
        box->lacks_ns = 0;
        return next;
    }
    if (next < box->count) {
        return begins_anew(box, box->at[next]) ? find_earliest(box, next) : next;
    }
    uint64_t now_ns = mu_clock_ns();
    box->lacks_ns = box->lacks_ns ? box->lacks_ns : now_ns;
    if (now_ns - box->lacks_ns < INBOX_PATIENCE_NS) {
        return next;
    }
    return find_earliest(box, next); /* the others were lost: their mail comes again */
}

/* It is handled now: the one after it is next, and has a patience of its own. */
static void serial_note(struct inbox *box, const muster_Delivery *d)
{
    uint64_t serial = is_multicast(d) ? serial_of(box, d) : d->serial;
    bool counts = serial_of(box, d) > 0;
    if (serial == 0 || (counts && serial <= box->serial)) {
        return;
    }
    box->serial = serial;
    box->lacks_ns = 0;
    if (!is_multicast(d)) {
        box->seat = d->seat;
        box->incarnation = d->broker_incarnation;
    }
}

static void put_first(struct inbox *box, uint32_t index)
{
    void *chosen = box->at[index];
    memmove(&box->at[1], &box->at[0], index * sizeof chosen);
    box->at[0] = chosen;
}

void inbox_next(mu_process *p)
{
    struct inbox *box = &p->inbox;
    inbox_drop(p);
    if (box->count == 0 || box->lacks_ns) {
        inbox_fill(p);
    }
    uint32_t index;
    while (!p->mail && (index = choose(box)) < box->count) {
        put_first(box, index);
        const muster_Delivery *d = box->at[0];
        p->mail = d;
        if (!is_for_us(p, d) || !link_is_ours(p, d)) {
            inbox_drop(p);
            continue;
        }
        serial_note(box, d);
        p->mail = is_multicast(d) ? multicast_open(p, d) : d;
    }
}

bool inbox_has_step_behind(const mu_process *p)
{
    const struct inbox *box = &p->inbox;
    bool has = box->count - box->multicasts == INBOX_EACH; /* it may lie behind these */
    for (uint32_t i = 1; i < box->count && !has; i++) {
        const muster_Delivery *d = box->at[i];
        has = d->step != muster_STEP_NOW && d->broker_incarnation == p->mail->broker_incarnation;
    }
    return has;
}

bool inbox_lacks(const mu_process *p)
{
    return p->inbox.lacks_ns != 0;
}
