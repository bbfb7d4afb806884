/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file files.h
 * The broker's files: the trust policy is read at the start, the audit log is appended to.
 */
#ifndef MUSTER_BROKER_FILES_H
#define MUSTER_BROKER_FILES_H

#include "broker/control/broker.h"

/** The largest policy file, in bytes. */
enum { FILES_POLICY_BYTES = 256 * 1024 };

struct files_audit {
    int fd;      /* -1: there is no audit log */
    bool failed; /* the last record could not be written */
    bool cut;    /* and a part of it stands there */
};

/**
 * Sets the broker's policy from a file.
 *
 * @return MU_OK; MU_FAULT_FILE, explained on standard error as file:line:column: what is expected
 */
MU_MUST_USE mu_result files_policy_load(struct broker *b, const char *path);

/** Opens the audit log; path NULL: none.  @return whether it can be written, explained if not */
bool files_audit_open(struct files_audit *f, const char *path);

/**
 * Writes down all that waits.  What cannot be written is counted and gone; the first time is
 * logged, and the first success after it.
 */
void files_audit_write(struct files_audit *f, struct broker *b);

#endif
