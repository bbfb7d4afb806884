/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file run_json.h
 * How the run goes, as the page reads it.
 */
#ifndef MUSTER_WEB_RUN_JSON_H
#define MUSTER_WEB_RUN_JSON_H

#include "core/json.h"
#include "muster/limits.h"
#include "wire.h"

enum { RUN_JSON_WAITS_MAX = 255 };

/* What is kept of RunStatus and BrokerStatus, whose samples go back to the bus. */
struct run_json {
    bool simulator; /* there is one, or there was and its run has ended */
    muster_RunState state;
    int64_t step;
    uint64_t time_ns, wall_ns, duration_ns, skipped;
    char hash[65];
    char waits_for[RUN_JSON_WAITS_MAX + 1];
    char broker[MU_NAME_MAX + 1];                        /* "": none is there */
    uint64_t sent, delivered, waiting, expired, refused; /* mails, of that broker */
};

/** @return whether a simulator is there whose run has not ended */
bool run_json_lives(const struct run_json *r);

/** Keeps what a status says. */
void run_json_take(struct run_json *r, const muster_RunStatus *status);

/** Its simulator is gone; how the run has ended is still to be seen. */
void run_json_lose(struct run_json *r);

/** Writes one object. */
void run_json_write(struct mu_json *j, const struct run_json *r);

#endif
