/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file watch.h
 * Reads what a run tells observers, and puts it on the board.
 */
#ifndef MUSTER_WEB_WATCH_H
#define MUSTER_WEB_WATCH_H

#include "bus/bus.h"
#include "muster/agent.h"
#include "web/board.h"
#include "web/pages.h"
#include "web/run_json.h"

struct watch {
    struct board *board;
    struct bus_reader scenes, frames, statuses, brokers, beacons, whites;
    char simulator[MU_PROCESS_MAX + 1]; /* whose scene it is; "": none has come */
    uint64_t scenes_count;
    struct run_json run;
    int domain;
    struct pages *pages;
    struct mu_text totals; /* of the last frame */
    uint64_t slow_ns;      /* when what changes slowly was looked at last */
};

/** Opens the readers, and takes the memory.  @return MU_OK or a fault */
MU_MUST_USE mu_result watch_open(struct watch *w, mu_process *process, int domain,
                                 struct board *board);

/** Takes what is there. */
void watch_round(struct watch *w, uint64_t now_ns);

#endif
