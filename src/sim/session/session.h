/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file session.h
 * The simulator's part in a run: its member processes, and one step after the other.
 *
 * docs/lockstep.md has the protocol.  The order of a step is fixed: percepts out, answers in,
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
    /* Borrowed: they must outlive the session. */
    const struct world *world;
    struct engine *engine;
    struct bus *bus;                     /* open */
    struct tracks *tracks;               /* NULL: no record */
    struct events *events;               /* likewise */
    struct mcap_file *recording;         /* likewise */
    const struct mu_option_list *robots; /* names of those with a controller; empty: all */
    const struct mu_option_list *agents; /* names of those without a body, which the first step
                                            waits for, too */
    uint64_t seed;
    uint64_t step_ns;
    uint64_t duration_ns;             /* 0: no end */
    double rate;                      /* times real time; 0: as fast as it goes */
    bool free;                        /* no lock step */
    const char *broker;               /* of a lock step; NULL: the broker of the first robot */
    bool waits_for_go;                /* the first step waits for RUN_GO, */
    uint32_t watchers;                /* and for this many resolvers, */
    uint32_t hosts;                   /* and for this many hosts */
    const struct mu_network *network; /* has the wait for a broker */
    int saves;                        /* an open folder for snapshots of the world */
    uint64_t silence_ns;              /* wall time after which a silent controller is a fault */
    const volatile sig_atomic_t *signal_came; /* not 0: the run ends */
    uint64_t return_ns; /* wall time that a lock step waits for the successor of a process that
                           died; 0: its death is a fault */
};

/**
 * Takes memory at start-up and opens the topics.
 *
 * @return MU_OK, or why a topic cannot be opened
 */
MU_MUST_USE mu_result session_open(struct session **out, const struct session_options *options);

/**
 * Waits until every robot has a controller that is ready and, if an option says so, for RUN_GO.
 *
 * @return MU_OK; MU_TIMEOUT: no broker answers; MU_DONE: the run ended before its first step
 */
MU_MUST_USE mu_result session_gather(struct session *s);

/**
 * Runs to the end, and publishes how it ended.  Then waits until `muster run` has received that, or
 * a signal comes.
 *
 * @return MU_OK; MU_DONE: a signal has ended the run; MU_TIMEOUT: a controller or the broker was
 * silent for too long, and session_waits_for names it
 */
MU_MUST_USE mu_result session_run(struct session *s);

/** @return what the run waits for, or why it failed; good until the next call */
const char *session_waits_for(const struct session *s);

/** @return the hash of a run that has ended: 64 hexadecimal digits */
const char *session_hash(const struct session *s);

#endif
