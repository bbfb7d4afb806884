/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file guard.h
 * Which requests the page answers, decided before anything is done about them.
 *
 * Only this machine reaches the port; what is kept out here is the rest of the browser: other sites
 * that resolve their own name to 127.0.0.1 (Host), that write to us from elsewhere (Origin,
 * Sec-Fetch-Site), and everybody who was not given the token, as soon as something is to be done.
 * Pure.
 */
#ifndef MUSTER_WEB_GUARD_H
#define MUSTER_WEB_GUARD_H

#include "muster/limits.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Hexadecimal digits of the token: 128 bits. */
enum { GUARD_TOKEN_DIGITS = 32, GUARD_BODY_MAX = MU_CONTENT_MAX };

enum guard_verdict {
    GUARD_PASSED,
    GUARD_HOST,      /* it is for a site of another name */
    GUARD_ORIGIN,    /* a page of another site asks */
    GUARD_METHOD,    /* neither GET, HEAD nor POST, or not here */
    GUARD_PATH,      /* there is no such page */
    GUARD_TOKEN,     /* it wants to act, and has not got the token */
    GUARD_READ_ONLY, /* nobody may act here */
    GUARD_SIZE,      /* more to say than a line may have */
    GUARD_VERDICTS
};

/* What a path is good for; two are for who acts. */
enum guard_use { GUARD_NOTHING, GUARD_LOOK, GUARD_ACT };

/* The parts of a request that count; a header that is not there is NULL. */
struct guard_request {
    const char *method;
    enum guard_use use; /* of its path */
    const char *host;
    unsigned hosts; /* headers of that name */
    const char *origin;
    const char *site; /* Sec-Fetch-Site */
    bool is_entry;    /* the page itself, which a link elsewhere may lead to */
    const char *token;
    uint64_t body_bytes; /* that it announces, or has sent so far */
};

struct guard {
    char token[GUARD_TOKEN_DIGITS + 1];
    bool read_only;
    uint64_t refused[GUARD_VERDICTS]; /* requests, by why */
};

/** Begins with a token made of 16 random bytes. */
void guard_init(struct guard *g, const uint8_t random[GUARD_TOKEN_DIGITS / 2], bool read_only);

/** Decides, and counts what is refused. */
enum guard_verdict guard_judge(struct guard *g, const struct guard_request *r);

/** @return the HTTP status of a verdict */
unsigned guard_status(enum guard_verdict verdict);

/** @return what is wrong, as a line for people */
const char *guard_text(enum guard_verdict verdict);

#endif
