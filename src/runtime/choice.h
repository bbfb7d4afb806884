/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file choice.h
 * The brokers that a process has heard of, and the choice of one.  Pure.
 */
#ifndef MUSTER_RUNTIME_CHOICE_H
#define MUSTER_RUNTIME_CHOICE_H

#include "muster/limits.h"
#include "wire.h"

#include <stdbool.h>

struct choice_broker {
    char name[MU_NAME_MAX + 1];
    char host[MU_FIELD_MAX + 1];
    uint64_t incarnation;
    uint32_t index;
    bool there; /* not silent */
    bool takes_agents;
};

struct choice {
    struct choice_broker brokers[MU_BROKERS_MAX];
    uint32_t count;
};

/**
 * Notes a heartbeat.  When the table is full, a broker that is silent makes room; without one the
 * new broker is passed over.
 */
void choice_note(struct choice *c, const muster_Beacon *beacon);

/** A broker is silent, or has left. */
void choice_lose(struct choice *c, const char *name);

/** Another life of a broker was heard before its heartbeat. */
void choice_follow(struct choice *c, const char *name, uint64_t incarnation);

/** @return the broker of that name, silent or not, or NULL */
const struct choice_broker *choice_find(const struct choice *c, const char *name);

/**
 * Chooses among those that are there and take agents.
 *
 * @param host    of this process: its brokers come first, then the lower index, then the name
 * @param wanted  only this one will do; NULL: any
 * @return NULL: there is none
 */
const struct choice_broker *choice_best(const struct choice *c, const char *host,
                                        const char *wanted);

/** @return whether no broker that is heard of later could be better */
bool choice_is_final(const struct choice_broker *b, const char *host, const char *wanted);

#endif
