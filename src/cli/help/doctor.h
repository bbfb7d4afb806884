/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file doctor.h
 * What muster doctor finds.
 */
#ifndef MUSTER_CLI_HELP_DOCTOR_H
#define MUSTER_CLI_HELP_DOCTOR_H

#include <stdbool.h>

enum doctor_state {
    DOCTOR_GOOD,
    DOCTOR_WARNING, /* muster runs, but not as one may expect */
    DOCTOR_WRONG    /* muster does not run */
};

struct doctor_finding {
    const char *check;
    enum doctor_state state;
    int code;         /* exit code if it is wrong */
    char found[320];  /* one line */
    const char *from; /* where the value was set; "": nowhere */
    char cure[200];   /* what a person can do, unless it is good */
};

/** Checks in the order in which they are shown. */
enum doctor_step {
    DOCTOR_INTERFACE,
    DOCTOR_LOOPBACK,
    DOCTOR_DOMAINS,
    DOCTOR_RANGE,
    DOCTOR_LEFT,
    DOCTOR_STEPS
};

/** Checks network, ports and processes.  @param interface  NULL: loopback.  @param from  where that
 * was set */
void doctor_network(enum doctor_step step, const char *interface, const char *from, int domain,
                    struct doctor_finding *f);

/** @return how many brokers on this machine have a port of a domain, of any user */
unsigned doctor_brokers(int domain);

/** Reads the number behind a word of a file of the system, or the first.  @return whether there is
 * one */
bool doctor_number(const char *path, const char *word, long *number);

#endif
