/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mailbags.h
 * The writers of Deliveries: one into the partition of each process that the broker serves.
 */
#ifndef MUSTER_BROKER_MAILBAGS_H
#define MUSTER_BROKER_MAILBAGS_H

#include "broker/control/broker.h"
#include "bus/bus.h"
#include "core/table.h"

struct mailbag {
    char process[MU_PROCESS_MAX + 1];
    struct bus_writer writer;
    bool matched;
    bool hears;        /* circulars */
    uint32_t hearers;  /* how many of them there were when it was last asked whether it does */
    uint32_t readers;  /* it has ever had */
    uint64_t heard_ns; /* when its last Up came, by the machine's clock; 0: none has */
};

struct mailbags {
    struct bus *bus;
    struct bus_writer circulars;
    bool once; /* they are used */
    const struct bus_reader *ups;
    struct mailbag at[MU_PROCESSES_MAX];
    uint32_t order[MU_PROCESSES_MAX]; /* of at: [0, count) in use, then those that are free */
    uint32_t count;
    struct mu_table names;
};

/**
 * Takes the memory for the index, at start-up.
 *
 * @param ups   the broker's reader of Ups; stays the caller's
 * @param once  what is for many goes out in circulars.  They have a line for each receiver, which
 *              on loopback costs nothing, and on a network several packets where one was enough
 */
MU_MUST_USE mu_result mailbags_open(struct mailbags *m, struct bus *bus,
                                    const struct bus_reader *ups, bool once);

/** @return the writer to a process, or to all (BUS_TO_ALL); NULL: there is none */
const struct bus_writer *mailbags_writer(struct mailbags *m, const char *process);

/** @return whether all circulars that were written have arrived */
bool mailbags_circulars_drained(const struct mailbags *m);

/** @return the bag of a process, or NULL: it has none */
struct mailbag *mailbags_find(struct mailbags *m, const char *process);

/** @return when that process spoke that has been silent for the longest, 0: one never has, or there
 *          is none */
uint64_t mailbags_spoke_ns(const struct mailbags *m);

/** Closes the bags of processes that are gone for good, and opens one for every new process. */
void mailbags_follow(struct mailbags *m, const struct broker *b);

/**
 * Tells the broker which processes have matched, or have not any more.
 *
 * @param mute  a process that gets mail and sends none
 * @param all   false: only those that had not matched are looked at
 * @return whether any has not
 */
bool mailbags_look(struct mailbags *m, struct broker *b, const char *mute, bool all,
                   uint64_t now_ns);

#endif
