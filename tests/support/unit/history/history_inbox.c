/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A process takes what came by either way in the order in which the broker sent it, as well as it
 * can: multicasts may be lost, and come before or after what was sent earlier.
 */
#include "history.h"

#include <string.h>

#define PATIENCE_NS (100 * MS)

static uint64_t late_ns(void)
{
    bool is_late = history.loses && !history.is_quiet && history_chance(3);
    return is_late ? history_roll(300) * MS : 0;
}

/* Deliveries to one process stay in their order. */
struct delivery *inbox_add(struct history_process *p, bool is_circular)
{
    if (p->deliveries_count == INBOX) {
        return NULL;
    }
    struct delivery *d = &p->deliveries[p->deliveries_count++];
    memset(d, 0, sizeof *d);
    d->is_circular = is_circular;
    d->life = history.life.number;
    d->incarnation = history.life.incarnation;
    d->comes_ns = history.now_ns + late_ns();
    if (!is_circular) {
        d->comes_ns = d->comes_ns > p->comes_ns ? d->comes_ns : p->comes_ns;
        p->comes_ns = d->comes_ns;
    }
    return d;
}

static void inbox_remove(struct history_process *p, uint32_t index)
{
    struct delivery *d = &p->deliveries[index];
    memmove(d, d + 1, (--p->deliveries_count - index) * sizeof *d);
}

static bool is_counted(const struct history_process *p, const struct delivery *d)
{
    return d->chair == p->inbox.chair && d->incarnation == p->inbox.incarnation;
}

static bool is_too_early(const struct history_process *p, const struct delivery *d)
{
    return is_counted(p, d) && d->serial > p->inbox.serial + 1;
}

/* Who does not know his chair takes no multicast for his; nor anything of an earlier life of the
 * broker than he has heard of. */
static bool is_strange(const struct history_process *p, const struct delivery *d)
{
    return (d->is_circular && !is_counted(p, d)) || d->incarnation < p->inbox.incarnation;
}

static void inbox_receive(struct history_process *p)
{
    for (uint32_t i = 0; i < p->deliveries_count;) {
        struct delivery *d = &p->deliveries[i];
        d->has_come = d->has_come || d->comes_ns <= history.now_ns || history.is_quiet;
        if (d->has_come && is_strange(p, d)) {
            history_note("%s does not know chair %lu", p->name, (unsigned long)d->chair);
            history.seen.lost += d->is_circular;
            inbox_remove(p, i);
        } else {
            i++;
        }
    }
}

void inbox_orphan(struct history_process *p)
{
    for (uint32_t i = 0; i < p->deliveries_count;) {
        const struct delivery *d = &p->deliveries[i];
        if (!d->has_come || is_too_early(p, d)) {
            inbox_remove(p, i);
        } else {
            i++;
        }
    }
}

/* @return the earliest by its serial of what has come among the first few; their count: nothing has
 */
static uint32_t earliest_of(const struct history_process *p, uint32_t count)
{
    uint32_t earliest = count;
    for (uint32_t i = 0; i < count; i++) {
        const struct delivery *d = &p->deliveries[i];
        bool before = earliest == count || d->serial < p->deliveries[earliest].serial;
        earliest = d->has_come && before ? i : earliest;
    }
    return earliest;
}

/* @return what came first of what is not too early, but nothing of a new count of the same broker
 * before what is left of the old one; or the count: nothing is */
static uint32_t next_in_order(const struct history_process *p)
{
    for (uint32_t i = 0; i < p->deliveries_count; i++) {
        const struct delivery *d = &p->deliveries[i];
        if (d->has_come && !is_too_early(p, d)) {
            bool begins_anew = !is_counted(p, d) && d->incarnation == p->inbox.incarnation;
            uint32_t before = begins_anew ? earliest_of(p, i) : i;
            return before < i ? before : i;
        }
    }
    return p->deliveries_count;
}

/* @return what is next, or the earliest of all after a while, or the count: nothing is */
static uint32_t inbox_next(struct history_process *p)
{
    uint32_t next = next_in_order(p), earliest = earliest_of(p, p->deliveries_count);
    if (next < p->deliveries_count || earliest == p->deliveries_count) {
        p->inbox.lacks_ns = 0;
        return next;
    }
    p->inbox.lacks_ns = p->inbox.lacks_ns ? p->inbox.lacks_ns : history.now_ns;
    if (history.now_ns - p->inbox.lacks_ns < PATIENCE_NS) {
        return p->deliveries_count;
    }
    history.seen.early++;
    p->inbox.lacks_ns = 0;
    return earliest;
}

static void inbox_count(struct history_process *p, const struct delivery *d)
{
    if (!is_counted(p, d)) {
        p->inbox.chair = d->chair;
        p->inbox.incarnation = d->incarnation;
        p->inbox.serial = d->serial;
    } else if (d->serial > p->inbox.serial) {
        p->inbox.serial = d->serial;
    } else {
        history.seen.late++;
    }
}

bool inbox_take(struct history_process *p)
{
    static struct delivery d;
    inbox_receive(p);
    uint32_t index = inbox_next(p);
    if (index == p->deliveries_count) {
        return false;
    }
    d = p->deliveries[index];
    inbox_remove(p, index);
    inbox_count(p, &d);
    process_take(p, &d);
    return true;
}
