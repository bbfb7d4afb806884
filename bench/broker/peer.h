/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file peer.h
 * What the loads ask of a broker: peer_muster.c, peer_mqtt.c, peer_nats.c and peer_redis.c are one
 * program each, and peer_dds.c, which has none.
 *
 * One connection; one thread, at a time.  What fails ends the program with a word on standard
 * error.
 */
#ifndef BENCH_BROKER_PEER_H
#define BENCH_BROKER_PEER_H

#include "muster/agent.h"

#include <stdbool.h>
#include <stdint.h>

/* How many mails are under way when a load says "in flight". */
enum { PEER_IN_FLIGHT = 200 };

struct peer_options {
    const char *where; /* the DDS domain; the TCP port of a broker on 127.0.0.1 */
    const char *name;  /* mail to it comes to on_mail */
    bool boxed;        /* the broker keeps mail for it while it is away */
    void (*on_mail)(const char *text);
};

/** Connects; returns when mail to the name arrives. */
void peer_open(const struct peer_options *options);

/**
 * Sends to a name, or to `all`.
 *
 * @param level  MU_LEVEL_RAM is MQTT's quality of service 0, the others are 1
 * @return false: no more fits at the moment, spin
 */
bool peer_send(const char *to, const char *text, enum mu_level level);

/** Sends from on_mail, as that broker's clients do it: at once, or when on_mail has returned. */
void peer_answer(const char *to, const char *text);

/** Waits for at most timeout_ns, perhaps less, and handles what is there. */
void peer_spin(int64_t timeout_ns);

/** Handles what comes until the program is told to end. */
void peer_serve(void);

/** @return how many of the mails sent the broker has answered for; of MQTT's with level 1 */
uint64_t peer_answered(void);

void peer_close(void);

#endif
