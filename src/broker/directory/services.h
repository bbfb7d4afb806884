/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file services.h
 * The yellow pages: a bounded table of lines (service, agent), each with attributes and a lease.
 *
 * Last word, tombstones and changes are as in groups.h.  A lease counts on the mail clock, which
 * in lock step is simulated; when it is over, the line is as if withdrawn.  Whether an offer is
 * shown depends on its agent, too: that is the caller's to know.
 */
#ifndef MUSTER_BROKER_SERVICES_H
#define MUSTER_BROKER_SERVICES_H

#include "broker/directory/groups.h"

struct service_line {
    bool offered;
    uint64_t stamp_ns;
    uint64_t lease_ns; /* from stamp_ns on; 0: until withdrawn */
    uint64_t until_ns; /* mail clock; UINT64_MAX: until withdrawn */
    char origin[MU_NAME_MAX + 1];
    char attributes[MU_ATTRIBUTES_MAX + 1];
};

struct subscriptions;

struct services {
    struct mu_pairs pairs; /* (service, agent) */
    struct service_line *lines;
    struct mu_pairs by_agent; /* (agent, service) */
    uint32_t *line_of;        /* by index of by_agent */
    struct changes changes;
    struct subscriptions *told_to; /* who has been told of lines; NULL: nobody */
    uint32_t offers_now;           /* for the counters */
    uint64_t soonest_ns;           /* no lease ends before this */
    uint64_t told;                 /* as in groups.h */
};

/* What is offered. */
struct offer {
    const char *attributes;
    uint64_t lease_ns;
    uint64_t mail_ns; /* now */
};

void services_init(struct services *s);

/** @return NULL, or why not: one word */
const char *services_advertise(struct services *s, const char *service, const char *agent,
                               const struct offer *offer, const struct said *said);
const char *services_withdraw(struct services *s, const char *service, const char *agent,
                              const struct said *said);

/**
 * Takes in a line of another broker, or from a disk.
 *
 * @param said     now: what is left of a lease is counted from its stamp to said->stamp_ns
 * @param mail_ns  now
 * @return MU_OK; MU_EXISTS: a younger one, or this one, is there; MU_FULL; MU_MALFORMED
 */
mu_result services_merge(struct services *s, const muster_Offer *line, const struct said *said,
                         uint64_t mail_ns);

/** @return whether a line may have to make room: set `told` before the next change */
bool services_full(const struct services *s);

/** Ends the leases that are over. */
void services_expire(struct services *s, uint64_t mail_ns);

/** Something else about an agent has changed: its lines are news to everybody. */
void services_touch(struct services *s, const char *agent);

/** Fills a line with pointers into the table; shown: the agent is there. */
void services_line(const struct services *s, uint32_t line, bool shown, muster_Offer *out);

#endif
