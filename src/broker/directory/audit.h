/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file audit.h
 * The audit: a record of every directive, carried out or refused, until somebody writes it down.
 *
 * A directive to several receivers makes at most two records: one of those who get it, one of those
 * for whom it is refused.
 */
#ifndef MUSTER_BROKER_AUDIT_H
#define MUSTER_BROKER_AUDIT_H

#include "muster/limits.h"
#include "wire.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { AUDIT_TEXT_MAX = 200, AUDIT_LINE_MAX = 4096 };

struct audit_record {
    bool simulated; /* time_ns is of the run; else since 1970 */
    uint64_t time_ns;
    char sender[MU_NAME_MAX + 1];
    char process[MU_PROCESS_MAX + 1];
    char receiver[AUDIT_TEXT_MAX + 1]; /* names joined by commas, cut */
    uint32_t receivers;                /* how many; 0: the address fits nobody */
    char performative[MU_FIELD_MAX + 1];
    char line[AUDIT_TEXT_MAX + 1]; /* the directive's content, cut */
    bool allowed;
};

struct audit {
    struct audit_record *ring; /* MU_AUDIT_MAX of them; NULL: nothing is recorded */
    uint32_t head, count;
    uint64_t recorded;
    uint64_t lost;   /* for want of room: nobody took the earlier ones */
    uint64_t failed; /* that could not be written */
};

/** Takes the ring's memory, if anything is to be recorded. */
void audit_init(struct audit *a, bool record);

/** Makes room for one record.  @return the record, zeroed; NULL: nobody wants it, or it is lost */
struct audit_record *audit_add(struct audit *a);

/** Adds a receiver's name to a record. */
void audit_receiver(struct audit_record *r, const char *name);

/** Takes the oldest record.  @return false when there is none */
bool audit_next(struct audit *a, struct audit_record *out);

/** Writes a record as one line of JSON with its end.  @return its length in bytes */
size_t audit_line(const struct audit_record *r, char line[AUDIT_LINE_MAX]);

#endif
