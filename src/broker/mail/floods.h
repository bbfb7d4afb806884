/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file floods.h
 * Mail that pours into a process does not disturb the others.
 *
 * Sender, broker and receiver of a flood want more processors than there are, and whoever exchanges
 * a mail now and then waits for his turn.  So, while anybody but these two has mail under way, a
 * process that gets many mails at once is handed FLOODS_MAILS every FLOODS_PAUSE_NS at most.  The
 * others wait in its boxes, and with them their sender, who has a bounded number of mails without
 * an answer.  Where nobody else is, nothing is held, nor what other brokers get, who serve many.
 */
#ifndef MUSTER_BROKER_FLOODS_H
#define MUSTER_BROKER_FLOODS_H

#include "muster/limits.h"

#include <stdbool.h>
#include <stdint.h>

struct broker;

enum {
    FLOODS_MANY = 16, /* mails in one Delivery that make a flood */
    FLOODS_MAILS = 64,
    FLOODS_PAUSE_NS = 1000000,
    FLOODS_QUIET_NS = 20000000, /* who has sent nothing for so long has no mail under way */
    FLOODS_SPEAKERS = 3,        /* at both ends of a flood, and one more */
};

struct floods_speaker {
    uint32_t place;
    uint64_t spoke_ns; /* 0: nobody has */
};

struct floods {
    struct floods_speaker speakers[FLOODS_SPEAKERS]; /* each once, who sent last first */
    uint32_t ring[MU_PROCESSES_MAX];                 /* places that are held, each once */
    uint32_t head, count;
};

/** An agent of this place has sent mail. */
void floods_note_speaker(struct broker *b, uint32_t place);

/** @return how many mails the next Delivery to a place may have */
uint32_t floods_room(const struct broker *b, uint32_t place);

/** @return whether a place gets nothing now; it is woken later */
bool floods_hold(struct broker *b, uint32_t place);

/** So many mails have gone out to a place; from: where the last of them came from, or MU_NONE */
void floods_note_delivery(struct broker *b, uint32_t place, uint32_t mails, uint32_t from);

/** Wakes those who were held long enough. */
void floods_tick(struct broker *b);

/** @return when floods_tick is needed next, or UINT64_MAX */
uint64_t floods_deadline_ns(const struct broker *b);

#endif
