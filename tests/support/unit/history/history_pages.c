/* SPDX-License-Identifier: Apache-2.0 */
/* Groups and services as they ought to be, from the changes that the broker has taken. */
#include "history.h"

#include "core/hash.h"

#include <stdio.h>
#include <string.h>

void book_change(const struct entry *e)
{
    struct book *b = &history.book;
    names one = 1u << e->src;
    struct offer_due *offer = &b->offers[e->key % SERVICES][e->src];
    switch (e->asks) {
    case ASK_CREATE: b->exists[e->key] = true; break;
    case ASK_JOIN:
        b->exists[e->key] = true;
        b->members[e->key] |= one;
        break;
    case ASK_LEAVE:
        if (b->members[e->key] & one) {
            b->members[e->key] &= ~one;
            b->exists[e->key] = b->members[e->key] != 0;
        }
        break;
    case ASK_ADVERTISE:
        *offer = (struct offer_due){
            .offered = true, .until_ns = e->ttl_ns ? history.now_ns + e->ttl_ns : UINT64_MAX};
        break;
    case ASK_WITHDRAW: offer->offered = false; break;
    case ASK_FIND:
    case ASKS: break;
    }
}

void book_expire(void)
{
    for (int i = 0; i < SERVICES * NAMES; i++) {
        struct offer_due *o = &history.book.offers[i / NAMES][i % NAMES];
        o->offered = o->offered && o->until_ns > history.now_ns;
    }
}

names book_group(int group)
{
    return history.book.members[group];
}

names book_shown(int service)
{
    names shown = 0;
    for (int name = 0; name < NAMES; name++) {
        muster_Member m;
        if (history.book.offers[service][name].offered && life_member(name, &m) &&
            m.state != muster_STATE_ABSENT) {
            shown |= 1u << name;
        }
    }
    return shown;
}

uint64_t book_answer(int service)
{
    char text[1024];
    names shown = book_shown(service);
    size_t len = (size_t)snprintf(text, sizeof text, "services");
    for (int name = 0; name < NAMES; name++) {
        if (shown & 1u << name) {
            len += (size_t)snprintf(text + len, sizeof text - len, " s%d %s \"role=x\"", service,
                                    history_name(name));
        }
    }
    return mu_hash_string(text);
}

/* What processes know of pages, groups and services is what holds. */
void book_check_copies(void)
{
    for (int i = 0; i < PROCESSES; i++) {
        const struct history_process *p = &history.processes[i];
        bool serves = false;
        for (int seat = 0; seat < SEATS; seat++) {
            serves = serves || (p->seats[seat].name != NOBODY && p->seats[seat].registered);
        }
        if (!serves) {
            continue;
        }
        for (int name = 0; name < NAMES; name++) {
            muster_Member m;
            bool right = !life_member(name, &m) || p->seen[name] == m.state;
            if (!right) {
                history_note("%s has seen %s in state %d", p->name, history_name(name),
                             (int)p->seen[name]);
            }
            HOLD(right);
        }
        for (int group = 0; group < GROUPS; group++) {
            HOLD(p->members[group] == history.book.members[group]);
        }
        for (int service = 0; service < SERVICES; service++) {
            HOLD(p->offers[service] == book_shown(service));
        }
    }
}
