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

enum { RUN_JSON_WAITS_MAX = 255, RUN_JSON_REPORT_MAX = 1023 };

/* One of a run's brokers, and its mails.  Of one that has died they count on. */
struct run_broker {
    char name[MU_NAME_MAX + 1]; /* "": free */
    bool there;
    uint64_t sent, delivered, waiting, expired, refused;
};

/* What is kept of RunStatus, BrokerStatus and Beacon, whose samples go back to the bus. */
struct run_json {
    char simulator[MU_PROCESS_MAX + 1]; /* "": none, or it is gone and its run had not ended */
    muster_RunState state;
    int64_t step;
    uint64_t time_ns, wall_ns, duration_ns, skipped;
    char hash[65];
    char waits_for[RUN_JSON_WAITS_MAX + 1];
    char report[RUN_JSON_REPORT_MAX + 1]; /* the folder of its report; "": it has not ended, or
                                             was not ours */
    struct run_broker brokers[MU_BROKERS_MAX];
};

/** @return whether a simulator is there whose run has not ended */
bool run_json_lives(const struct run_json *r);

/** @return whether the last run that was heard of has ended */
bool run_json_has_ended(const struct run_json *r);

/** Keeps what a status says. */
void run_json_take(struct run_json *r, const muster_RunStatus *status);

/** A simulator is gone; how its run has ended is still to be seen. */
void run_json_lose(struct run_json *r, const char *simulator);

/** Keeps what a broker says of its mails. */
void run_json_mails(struct run_json *r, const muster_BrokerStatus *status);

/** A broker is there, or no longer. */
void run_json_broker(struct run_json *r, const char *name, bool there);

/** Another run begins: brokers that are gone were those of the one before. */
void run_json_begin(struct run_json *r);

/** Writes one object; broker is one that is there, mails are those of all. */
void run_json_write(struct mu_json *j, const struct run_json *r);

#endif
