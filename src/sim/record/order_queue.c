/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/record/record.h"

#include "core/text.h"
#include "muster/memory.h"

#include <string.h>

enum { QUEUE_SIZE = MU_ORDERS_MAX + MU_ORDERS_LATER_MAX };

/* A place in the queue. */
struct queued {
    enum { QUEUED_FREE, QUEUED_WAITS, QUEUED_DUE, QUEUED_TAKEN } state;
    bool later;       /* it has a time or a condition */
    uint64_t arrival; /* its number among all orders */
    struct order order;
    struct condition_watch watch; /* if the order has a condition */
};

struct order_queue {
    struct condition_names names;
    struct queued at[QUEUE_SIZE];
    uint64_t arrivals;
    uint32_t watching; /* orders that wait for a condition */
};

void order_copy(struct order *to, const muster_RunCommand *command)
{
    *to = (struct order){.command = *command};
    mu_text_copy(to->source, sizeof to->source, command->source);
    mu_text_copy(to->name, sizeof to->name, command->name);
    mu_text_copy(to->file, sizeof to->file, command->file);
    mu_text_copy(to->when, sizeof to->when, command->when);
    to->command.simulator = NULL;
    to->command.source = to->source;
    to->command.name = to->name;
    to->command.file = to->file;
    to->command.when = to->when;
}

struct order_queue *order_queue_open(const struct condition_names *names)
{
    struct order_queue *q = mu_startup_alloc(sizeof *q);
    q->names = *names;
    return q;
}

/* @return a free place for an order of this kind, or NULL */
static struct queued *place_find(struct order_queue *q, bool later)
{
    struct queued *place = NULL;
    size_t count = 0;
    for (size_t i = 0; i < QUEUE_SIZE; i++) {
        bool is_free = q->at[i].state == QUEUED_FREE;
        place = is_free && !place ? &q->at[i] : place;
        count += !is_free && q->at[i].later == later;
    }
    return count < (later ? MU_ORDERS_LATER_MAX : MU_ORDERS_MAX) ? place : NULL;
}

mu_result order_queue_put(struct order_queue *q, const muster_RunCommand *command, char *why)
{
    struct condition_watch watch = {.was = false};
    bool later = command->due_ns > 0 || command->when[0] != '\0';
    if (command->when[0]) {
        mu_result read = condition_read(&watch.condition, command->when, &q->names, why);
        if (read != MU_OK) {
            return read;
        }
    }
    struct queued *place = place_find(q, later);
    if (!place) {
        (void)mu_text_copy(why, CONDITION_WHY_MAX,
                           later ? "too many orders wait" : "too many orders in one step");
        return MU_FULL;
    }
    order_copy(&place->order, command);
    place->watch = watch;
    place->later = later;
    place->arrival = q->arrivals++;
    place->state = later ? QUEUED_WAITS : QUEUED_DUE;
    q->watching += place->order.when[0] != '\0';
    return MU_OK;
}

void order_queue_note_act(struct order_queue *q, int robot, const muster_Act *act)
{
    for (size_t i = 0; q->watching > 0 && i < QUEUE_SIZE; i++) {
        struct queued *place = &q->at[i];
        if (place->state == QUEUED_WAITS && place->order.when[0]) {
            record_note_act(&place->watch, robot, act);
        }
    }
}

void order_queue_look(struct order_queue *q, uint64_t time_ns, const struct condition_view *view)
{
    for (size_t i = 0; i < QUEUE_SIZE; i++) {
        struct queued *place = &q->at[i];
        if (place->state != QUEUED_WAITS) {
            continue;
        }
        bool conditional = place->order.when[0] != '\0';
        if (conditional) {
            (void)condition_watch_look(&place->watch, view);
        }
        bool due = (!conditional || place->watch.was) && time_ns >= place->order.command.due_ns;
        place->state = due ? QUEUED_DUE : QUEUED_WAITS;
        q->watching -= due && conditional;
    }
}

static bool queued_is_before(const struct queued *a, const struct queued *b)
{
    int order = strcmp(a->order.source, b->order.source);
    uint64_t a_seq = a->order.command.seq, b_seq = b->order.command.seq;
    bool earlier = a_seq != b_seq ? a_seq < b_seq : a->arrival < b->arrival;
    return order < 0 || (order == 0 && earlier);
}

const muster_RunCommand *order_queue_take(struct order_queue *q)
{
    struct queued *next = NULL;
    for (size_t i = 0; i < QUEUE_SIZE; i++) {
        struct queued *place = &q->at[i];
        if (place->state == QUEUED_TAKEN) {
            place->state = QUEUED_FREE;
        } else if (place->state == QUEUED_DUE && (!next || queued_is_before(place, next))) {
            next = place;
        }
    }
    if (!next) {
        return NULL;
    }
    next->state = QUEUED_TAKEN;
    return &next->order.command;
}
