/* SPDX-License-Identifier: Apache-2.0 */
/* Message facts: mail as states that senders repeat, and how long these facts stay. */
#include "mind/facts/facts.h"
#include "muster/memory.h"

struct messages *messages_reserve(void)
{
    return mu_startup_alloc(sizeof(struct messages));
}

void messages_install(struct mind *m)
{
    struct messages *all = inputs_of(m)->messages;
    *all = (struct messages){.free = 0};
    for (uint16_t i = 1; i < MESSAGES_MAX; i++) {
        all->at[i].newer = i + 1; /* free entries are chained through newer */
    }
    all->free = 1;
}

static size_t message_chain(const SYMBOL_HN *from, const void *first)
{
    return (((uintptr_t)from >> 4) * 31 + ((uintptr_t)first >> 4)) % MESSAGES_CHAINS;
}

static void message_unchain(struct messages *all, uint16_t index)
{
    struct message *e = &all->at[index];
    uint16_t *link = &all->chains[message_chain(e->from, e->first)];
    while (*link != index) {
        link = &all->at[*link].chain;
    }
    *link = e->chain;
    *(e->older ? &all->at[e->older].newer : &all->oldest) = e->newer;
    *(e->newer ? &all->at[e->newer].older : &all->newest) = e->older;
}

static void message_remove(struct mind *m, uint16_t index)
{
    struct messages *all = inputs_of(m)->messages;
    struct message *e = &all->at[index];
    message_unchain(all, index);
    fact_retract(m, &e->fact);
    DecrementSymbolCount(m->env, e->from);
    if (e->first) {
        AtomDeinstall(m->env, e->first_type, e->first);
    }
    *e = (struct message){.newer = all->free};
    all->free = index;
}

void messages_age(struct mind *m)
{
    struct messages *all = inputs_of(m)->messages;
    while (all->oldest && inputs_of(m)->step - all->at[all->oldest].step >= MESSAGES_STEPS) {
        trace_cause(m, 'E', "age", "");
        message_remove(m, all->oldest);
    }
}

/* Drops the facts of this sender of earlier steps that have the same first field. */
static void message_supersede(struct mind *m, const SYMBOL_HN *from, const void *first)
{
    uint16_t next;
    for (uint16_t i = inputs_of(m)->messages->chains[message_chain(from, first)]; i; i = next) {
        const struct message *e = &inputs_of(m)->messages->at[i];
        next = e->chain;
        if (e->from == from && e->first == first && e->step < inputs_of(m)->step) {
            message_remove(m, i);
        }
    }
}

bool messages_enter(struct mind *m, const struct message *entry)
{
    struct messages *all = inputs_of(m)->messages;
    uint16_t index = all->free;
    if (index == 0) {
        return false;
    }
    struct message *e = &all->at[index];
    all->free = e->newer;
    IncrementSymbolCount(entry->from);
    if (entry->first) {
        AtomInstall(m->env, entry->first_type, entry->first);
    }
    uint16_t *chain = &all->chains[message_chain(entry->from, entry->first)];
    *e = *entry;
    e->older = all->newest;
    e->newer = 0;
    e->chain = *chain;
    *chain = index;
    *(all->newest ? &all->at[all->newest].newer : &all->oldest) = index;
    all->newest = index;
    return true;
}

void messages_add(struct mind *m, uint64_t id, SYMBOL_HN *from, struct multifield *fields)
{
    struct messages *all = inputs_of(m)->messages;
    bool some = fields->multifieldLength > 0;
    struct message e = {.from = from, .first_type = SYMBOL, .id = id, .step = inputs_of(m)->step};
    if (some) {
        e.first = fields->theFields[0].value;
        e.first_type = fields->theFields[0].type;
    }
    message_supersede(m, from, e.first);
    if (!all->free) {
        message_remove(m, all->oldest);
    }
    /* one fact for each mail, even when two senders say the same */
    EnvSetFactDuplication(m->env, TRUE);
    e.fact = fact_assert(m, inputs_of(m)->message, fields);
    EnvSetFactDuplication(m->env, FALSE);
    if (e.fact) {
        (void)messages_enter(m, &e);
    }
}

void messages_forget(struct mind *m, uint64_t id)
{
    for (uint16_t i = inputs_of(m)->messages->oldest; i; i = inputs_of(m)->messages->at[i].newer) {
        if (inputs_of(m)->messages->at[i].id == id) {
            message_remove(m, i);
            return;
        }
    }
}
