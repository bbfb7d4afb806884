/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file session.h
 * A run, seen from the simulator: who controls which robot, and one step after the other.
 *
 * docs/lockstep.md has the protocol.  The order of a step is fixed: senses out, answers in,
 * commands in the order of the robots, hash, record, physics.
 */
#ifndef MUSTER_SIM_SESSION_H
#define MUSTER_SIM_SESSION_H

#include "bus/bus.h"
#include "core/options.h"
#include "sim/engine/engine.h"
#include "sim/record/record.h"

#include <signal.h>

struct session; /* one in a process */

struct session_options {
    /* What it works on: all live as long. */
    const struct world *world;
    struct engine *engine;
    struct bus *bus;                     /* open */
    struct tracks *tracks;               /* NULL: no record */
    struct events *events;               /* likewise */
    struct mcap_file *recording;         /* likewise */
    const struct mu_option_list *robots; /* that are controlled; empty: all */
    uint64_t seed;
    uint64_t step_ns;
    uint64_t duration_ns;             /* 0: no end */
    double rate;                      /* times real time; 0: as fast as it goes */
    bool free;                        /* no lock step */
    const char *broker;               /* of the robots of a lock step; NULL: the first robot's */
    bool waits_for_go;                /* the first step waits for a RunCommand, */
    uint32_t watchers;                /* and for so many processes that watch, */
    uint32_t hosts;                   /* and for so many that take in robots */
    const struct mu_network *network; /* how long to wait for the broker */
    int saves;                        /* the open folder that states are saved in */
    uint64_t silence_ns;              /* wall time after which a silent controller is a fault */
    const volatile sig_atomic_t *signal_came; /* not 0: the run is to end */
    uint64_t return_ns; /* wall time that a lock step waits for one that died to be started again;
                           0: that is a fault at once */
};

/**
 * Takes memory at start-up and opens the topics.
 *
 * @return MU_OK, or why a topic cannot be opened
 */
MU_MUST_USE mu_result session_open(struct session **out, const struct session_options *options);

/**
 * Waits until every robot has a controller that is ready and, if asked, for the word to go.
 *
 * @return MU_OK; MU_TIMEOUT: no broker answers; MU_DONE: ended before it began
 */
MU_MUST_USE mu_result session_gather(struct session *s);

/**
 * Runs to the end, and says how it ended.  Who has started the run is waited for until that has
 * come; a signal behind the end says that it has.
 *
 * @return MU_OK; MU_DONE: a signal has ended it before its time; MU_TIMEOUT: a controller or the
 *         broker was silent for too long, and waits_for says which
 */
MU_MUST_USE mu_result session_run(struct session *s);

/** @return why nothing began, or what the run has failed of; good until the next call */
const char *session_waits_for(const struct session *s);

/** @return the hash of a run that has ended: 64 hexadecimal digits */
const char *session_hash(const struct session *s);

#endif
