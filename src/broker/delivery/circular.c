/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/delivery/delivery.h"

#include "broker/control/parts.h"
#include "core/sort.h"

void circulars_hears(struct broker *b, uint32_t place, bool hears)
{
    struct place *at = &b->places.at[place];
    b->circulars.hearers += (uint32_t)hears - (uint32_t)at->hears;
    at->hears = hears;
}

void circulars_read_by(struct broker *b, uint32_t readers)
{
    b->circulars.readers = readers;
}

/* The first ones have gone out, or will go as any mail does. */
static void waiting_drop(struct broker *b, uint32_t count)
{
    struct circulars *c = &b->circulars;
    for (uint32_t i = 0; i < count; i++) {
        store_release(&b->store, c->waiting[i]);
    }
    c->count -= count;
    for (uint32_t i = 0; i < c->count; i++) {
        c->waiting[i] = c->waiting[i + count];
    }
}

/* --- whose boxes ------------------------------------------------------------------------------ */

/* @return whether a place has nothing else to be told before */
static bool place_is_ready(const struct broker *b, const struct place *at)
{
    bool is_there = at->hears && at->matched && !at->blocked;
    bool is_alone = !at->rostered && !at->simulator && !at->is_broker;
    return is_there && is_alone && !at->held && !at->roll_call_due && at->refusals_count == 0 &&
           changes_after(&b->registry.changes, at->version_had) == MU_NONE && view_has_told(b, at);
}

/* @return whether this is the next mail that its receiver gets, and may go to many at once */
static bool post_is_ready(struct broker *b, uint32_t post)
{
    uint32_t agent = b->mailbox.posts[post].agent;
    const struct agent *a = &b->registry.agents[agent];
    return a->process != MU_NONE && place_is_ready(b, &b->places.at[a->process]) && a->seated &&
           !a->verdict_due && names_gate(b, agent) == GATE_OPEN && !barrier_awaits(b, agent) &&
           mailbox_box(&b->mailbox, agent)->out == MU_NONE &&
           mailbox_next_is(&b->mailbox, agent, b->mailbox.posts[post].mail);
}

static int box_compare(const void *x, const void *y, const void *context)
{
    (void)context;
    const struct circular_box *one = x, *other = y;
    uint32_t a = one->seat != other->seat ? one->seat : one->agent;
    uint32_t b = one->seat != other->seat ? other->seat : other->agent;
    return (a > b) - (a < b);
}

/* Keeps the first few of each place. */
static void boxes_bound(struct circulars *c)
{
    uint32_t kept = 0, same = 0;
    c->places_count = 0;
    for (uint32_t i = 0; i < c->boxes_count; i++) {
        bool another = i == 0 || c->boxes[i].seat != c->boxes[i - 1].seat;
        c->places_count += another;
        same = another ? 1 : same + 1;
        if (same <= BUS_CIRCULAR_BOXES) {
            c->boxes[kept++] = c->boxes[i];
        }
    }
    c->boxes_count = kept;
}

static void boxes_find(struct broker *b, const struct mail *m)
{
    struct circulars *c = &b->circulars;
    c->boxes_count = 0;
    for (uint32_t post = m->posts; post != MU_NONE && c->boxes_count < CIRCULAR_BOXES;
         post = b->mailbox.posts[post].sibling_next) {
        if (post_is_ready(b, post)) {
            uint32_t agent = b->mailbox.posts[post].agent;
            uint32_t place = b->registry.agents[agent].process;
            c->boxes[c->boxes_count++] = (struct circular_box){
                .agent = agent, .place = place, .seat = b->places.at[place].seat};
        }
    }
    mu_sort(c->boxes, c->boxes_count, sizeof c->boxes[0], box_compare, NULL);
    boxes_bound(c);
}

/* --- putting together ------------------------------------------------------------------------- */

/* Adds the waiting mail of that index, if it is next in each of the boxes, and no durable mail has
 * taken it to the store.  @return whether it is */
static bool letter_add(struct broker *b, uint32_t index, size_t *room)
{
    struct circulars *c = &b->circulars;
    const struct mail *m = c->waiting[index];
    bool fits = m->row == 0 && m->bytes <= *room && c->letters_count < BUS_CIRCULAR_LETTERS;
    for (uint32_t i = 0; i < c->boxes_count && fits; i++) {
        fits = mailbox_next_is(&b->mailbox, c->boxes[i].agent, m);
    }
    if (!fits) {
        return false;
    }
    for (uint32_t i = 0; i < c->boxes_count; i++) {
        mailbox_hand_next(&b->mailbox, c->boxes[i].agent, m);
    }
    *room -= m->bytes;
    c->letters[c->letters_count++] = m->letter;
    return true;
}

static void boxes_write(struct broker *b)
{
    struct circulars *c = &b->circulars;
    for (uint32_t i = 0; i < c->boxes_count; i++) {
        const struct circular_box *to = &c->boxes[i];
        const struct box *box = mailbox_box(&b->mailbox, to->agent);
        c->seats[i] = to->seat;
        c->serials[i] = b->places.at[to->place].serial + 1;
        c->slots[i] = b->registry.agents[to->agent].tenant.slot;
        c->numbers[i] = box->acked + box->written + 1;
    }
}

static void circular_write(struct broker *b, muster_Delivery *d)
{
    struct circulars *c = &b->circulars;
    uint32_t boxes = c->boxes_count;
    *d = (muster_Delivery){
        .broker = b->name, .broker_incarnation = b->incarnation, .step = muster_STEP_NOW};
    d->process = sample_text(BUS_TO_ALL);
    boxes_write(b);
    d->seats._buffer = c->seats;
    d->serials._buffer = c->serials;
    d->slots._buffer = c->slots;
    d->numbers._buffer = c->numbers;
    d->letters._buffer = c->letters;
    d->seats._length = d->seats._maximum = boxes;
    d->serials._length = d->serials._maximum = boxes;
    d->slots._length = d->slots._maximum = boxes;
    d->numbers._length = d->numbers._maximum = boxes;
    d->letters._length = d->letters._maximum = c->letters_count;
}

/* @return whether the first mail that waits goes out so, and whatever follows it everywhere */
static bool circular_begin(struct broker *b)
{
    struct circulars *c = &b->circulars;
    size_t room = CIRCULAR_BYTES;
    boxes_find(b, c->waiting[0]);
    c->letters_count = 0;
    uint32_t all = c->hearers > c->readers ? c->hearers : c->readers;
    bool worth = c->places_count >= CIRCULAR_PLACES_MIN && 2 * c->places_count >= all;
    while (worth && c->letters_count < c->count && letter_add(b, c->letters_count, &room)) {
    }
    return c->letters_count > 0;
}

bool circulars_next(struct broker *b, muster_Delivery *d)
{
    struct circulars *c = &b->circulars;
    if (b->clock.now_ns < c->retry_ns) {
        waiting_drop(b, c->count);
    }
    while (c->count > 0) {
        if (circular_begin(b)) {
            circular_write(b, d);
            return true;
        }
        waiting_drop(b, 1);
    }
    return false;
}

/* --- the network's answer --------------------------------------------------------------------- */

uint32_t circulars_sent(struct broker *b)
{
    struct circulars *c = &b->circulars;
    for (uint32_t i = 0; i < c->boxes_count; i++) {
        uint32_t agent = c->boxes[i].agent;
        uint32_t again = mailbox_mark_written(&b->mailbox, agent, c->letters_count);
        MU_ASSERT(again == 0);
        if (!mailbox_box(&b->mailbox, agent)->watched) {
            mailbox_watch(&b->mailbox, agent, b->clock.now_ns);
        }
        b->places.at[c->boxes[i].place].serial = c->serials[i];
    }
    waiting_drop(b, c->letters_count);
    return c->boxes_count * c->letters_count;
}

void circulars_unsent(struct broker *b)
{
    struct circulars *c = &b->circulars;
    for (uint32_t i = 0; i < c->boxes_count; i++) {
        mailbox_take_back(&b->mailbox, c->boxes[i].agent);
    }
    c->retry_ns = b->clock.now_ns + CIRCULAR_PAUSE_NS;
}
