/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "core/sort.h"

void multicast_note(struct broker *b, struct mail *m)
{
    struct multicast *c = &b->multicast;
    bool may = m->letter.level == muster_LEVEL_RAM && b->dispatch.interval_ns == 0 &&
               !view_inside(b, m->sender);
    if (may && b->processes.hearers >= MULTICAST_PROCESSES_MIN && c->count < MULTICAST_WAITING) {
        pool_keep(m);
        c->waiting[c->count++] = m;
    }
}

/* The first ones have gone out, or will go as any mail does. */
static void waiting_drop(struct broker *b, uint32_t count)
{
    struct multicast *c = &b->multicast;
    for (uint32_t i = 0; i < count; i++) {
        pool_release(&b->pool, c->waiting[i]);
    }
    c->count -= count;
    for (uint32_t i = 0; i < c->count; i++) {
        c->waiting[i] = c->waiting[i + count];
    }
}

/* --- whose boxes ------------------------------------------------------------------------------ */

/* @return whether a process has nothing else to be told before */
static bool process_is_ready(const struct broker *b, const struct process *at)
{
    bool is_there = processes_hears(at) && at->turn == TURN_IDLE;
    bool is_alone = !scope_is_paced(at->scope) && at->kind != PROCESS_BROKER;
    return is_there && is_alone && !at->roll_call_due && at->refusals_count == 0 &&
           changelog_after(&b->registry.changes, at->version_had) == MU_NONE &&
           view_has_told(&b->pages, at);
}

/* @return whether this is the next mail that its receiver gets, and may go to many at once */
static bool post_is_ready(struct broker *b, uint32_t post)
{
    uint32_t agent = b->mailbox.posts[post].agent;
    const struct agent *a = &b->registry.agents[agent];
    const struct box *box = mailbox_box(&b->mailbox, agent);
    /* It has acknowledged a number that was handed out since the last verdict: its process knows
     * its seat here, and which number comes next.  A reader that has had that number already takes
     * whatever follows it. */
    bool is_confirmed = box->acked > box->base && box->acked > a->seated_above;
    return a->process != MU_NONE && process_is_ready(b, &b->processes.at[a->process]) &&
           a->bearer == BEARER_TOLD && is_confirmed &&
           names_gate(&b->registry, &b->processes, agent) == GATE_OPEN && !scope_waits(a->scope) &&
           box->out == MU_NONE && mailbox_next_is(&b->mailbox, agent, b->mailbox.posts[post].mail);
}

static int box_compare(const void *x, const void *y, const void *context)
{
    (void)context;
    const struct multicast_box *one = x, *other = y;
    uint32_t a = one->seat != other->seat ? one->seat : one->agent;
    uint32_t b = one->seat != other->seat ? other->seat : other->agent;
    return (a > b) - (a < b);
}

/* Keeps the first few of each process. */
static void boxes_bound(struct multicast *c)
{
    uint32_t kept = 0, same = 0;
    c->processes_count = 0;
    for (uint32_t i = 0; i < c->boxes_count; i++) {
        bool another = i == 0 || c->boxes[i].seat != c->boxes[i - 1].seat;
        c->processes_count += another;
        same = another ? 1 : same + 1;
        if (same <= BUS_CIRCULAR_BOXES) {
            c->boxes[kept++] = c->boxes[i];
        }
    }
    c->boxes_count = kept;
}

static void boxes_find(struct broker *b, const struct mail *m)
{
    struct multicast *c = &b->multicast;
    c->boxes_count = 0;
    for (uint32_t post = mu_list_first(&m->posts);
         post != MU_NONE && c->boxes_count < MULTICAST_BOXES;
         post = mailbox_sibling(&b->mailbox, post)) {
        if (post_is_ready(b, post)) {
            uint32_t agent = b->mailbox.posts[post].agent;
            uint32_t place = b->registry.agents[agent].process;
            c->boxes[c->boxes_count++] = (struct multicast_box){
                .agent = agent, .place = place, .seat = b->processes.at[place].seat};
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
    struct multicast *c = &b->multicast;
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
    struct multicast *c = &b->multicast;
    for (uint32_t i = 0; i < c->boxes_count; i++) {
        const struct multicast_box *to = &c->boxes[i];
        const struct box *box = mailbox_box(&b->mailbox, to->agent);
        c->seats[i] = to->seat;
        c->serials[i] = b->processes.at[to->place].serial + 1;
        c->slots[i] = b->registry.agents[to->agent].resident.slot;
        c->numbers[i] = box->acked + box->written + 1;
    }
}

static void multicast_write(struct broker *b, muster_Delivery *d)
{
    struct multicast *c = &b->multicast;
    uint32_t boxes = c->boxes_count;
    *d = (muster_Delivery){.broker = b->name,
                           .broker_incarnation = b->incarnation,
                           .step = muster_STEP_NOW,
                           .process = sample_text(BUS_TO_ALL),
                           .seats = {boxes, boxes, c->seats, false},
                           .serials = {boxes, boxes, c->serials, false},
                           .slots = {boxes, boxes, c->slots, false},
                           .numbers = {boxes, boxes, c->numbers, false},
                           .letters = {c->letters_count, c->letters_count, c->letters, false}};
    boxes_write(b);
}

/* @return whether the first mail that waits goes out so, and whatever follows it everywhere */
static bool multicast_begin(struct broker *b)
{
    struct multicast *c = &b->multicast;
    size_t room = MULTICAST_BYTES;
    boxes_find(b, c->waiting[0]);
    c->letters_count = 0;
    uint32_t all = b->processes.hearers > c->readers ? b->processes.hearers : c->readers;
    bool worth = c->processes_count >= MULTICAST_PROCESSES_MIN && 2 * c->processes_count >= all;
    while (worth && c->letters_count < c->count && letter_add(b, c->letters_count, &room)) {
    }
    return c->letters_count > 0;
}

bool multicast_next(struct broker *b, muster_Delivery *d)
{
    struct multicast *c = &b->multicast;
    if (b->clock.now_ns < c->retry_ns) {
        waiting_drop(b, c->count);
    }
    while (c->count > 0) {
        if (multicast_begin(b)) {
            multicast_write(b, d);
            return true;
        }
        waiting_drop(b, 1);
    }
    return false;
}

/* --- the network's answer --------------------------------------------------------------------- */

uint32_t multicast_sent(struct broker *b)
{
    struct multicast *c = &b->multicast;
    for (uint32_t i = 0; i < c->boxes_count; i++) {
        uint32_t agent = c->boxes[i].agent;
        uint32_t again =
            mailbox_mark_written(&b->mailbox, agent, c->letters_count, b->clock.now_ns);
        MU_ASSERT(again == 0);
        b->processes.at[c->boxes[i].place].serial = c->serials[i];
    }
    waiting_drop(b, c->letters_count);
    return c->boxes_count * c->letters_count;
}

void multicast_unsent(struct broker *b)
{
    struct multicast *c = &b->multicast;
    for (uint32_t i = 0; i < c->boxes_count; i++) {
        mailbox_take_back(&b->mailbox, c->boxes[i].agent);
    }
    c->retry_ns = b->clock.now_ns + MULTICAST_PAUSE_NS;
}
