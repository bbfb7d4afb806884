/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/record/record.h"

#include "core/text.h"

#include <string.h>

void order_queue_copy(struct order *to, const muster_RunCommand *command)
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

mu_result order_queue_put(struct order_queue *o, const muster_RunCommand *command)
{
    if (o->count == MU_ORDERS_MAX) {
        return MU_FULL;
    }
    order_queue_copy(&o->at[o->count++], command);
    return MU_OK;
}

static bool order_is_before(const struct order *a, const struct order *b)
{
    int order = strcmp(a->source, b->source);
    return order < 0 || (order == 0 && a->command.seq < b->command.seq);
}

const muster_RunCommand *order_queue_take(struct order_queue *o)
{
    struct order *next = NULL;
    for (size_t i = 0; i < o->count; i++) {
        struct order *order = &o->at[i];
        if (!order->taken && (!next || order_is_before(order, next))) {
            next = order;
        }
    }
    if (!next) {
        o->count = 0;
        return NULL;
    }
    next->taken = true;
    return &next->command;
}
