/* SPDX-License-Identifier: Apache-2.0 */
/* Mail that waits: stored for somebody who is away, drained, or never taken. */
#include "core/clock.h"
#include "load.h"
#include "peer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static uint64_t drained, first_ns;

static void on_mail(const char *text)
{
    struct load_mail mail;
    load_read(&mail, text);
    if (mail.number != drained + 1) {
        load_die("mail %llu after mail %llu", (unsigned long long)mail.number,
                 (unsigned long long)drained);
    }
    first_ns = drained == 0 ? mu_clock_ns() : first_ns;
    drained = mail.number;
}

static void reader_open(const char *where, const char *name)
{
    struct peer_options options = {.where = where, .name = name, .boxed = true, .on_mail = on_mail};
    peer_open(&options);
}

/* visit WHERE NAME: makes the name known, and leaves. */
void load_visit(char **words)
{
    reader_open(words[0], words[1]);
}

/* store WHERE TO COUNT LEVEL: until the broker has answered for each. */
void load_store(char **words)
{
    uint64_t count = strtoull(words[2], NULL, 10);
    int level = (int)strtol(words[3], NULL, 10);
    struct peer_options options = {.where = words[0], .name = load_me()};
    if (count > LOAD_COUNT_MAX) {
        load_die("store: at most %d", LOAD_COUNT_MAX);
    }
    peer_open(&options);
    uint64_t began_ns = mu_clock_ns();
    for (uint64_t sent = 0; peer_answered() < count;) {
        while (sent < count && sent - peer_answered() < PEER_IN_FLIGHT) {
            char text[LOAD_BYTES + 1];
            load_write(text, "store", ++sent, load_me());
            load_send(words[1], text, level);
        }
        peer_spin(10000000);
        if (mu_clock_ns() - began_ns > 20000000000u) {
            load_die("%llu of %llu answered", (unsigned long long)peer_answered(),
                     (unsigned long long)count);
        }
    }
    printf("{\"mails_s\": %.1f}\n", (double)count * 1e9 / (double)(mu_clock_ns() - began_ns));
}

/* drain WHERE NAME COUNT: all there, none twice, none out of order, or the program fails. */
void load_drain(char **words)
{
    uint64_t count = strtoull(words[2], NULL, 10);
    uint64_t began_ns = mu_clock_ns();
    reader_open(words[0], words[1]);
    load_await(&drained, count);
    uint64_t last_ns = mu_clock_ns();
    for (int i = 0; i < 20; i++) {
        peer_spin(5000000); /* a mail too many fails in on_mail */
    }
    printf("{\"drain_s\": %.5f, \"whole_s\": %.5f}\n", (double)(last_ns - first_ns) * 1e-9,
           (double)(last_ns - began_ns) * 1e-9);
}

/* pour WHERE TO MAILS_S: until it is ended. */
void load_pour(char **words)
{
    uint64_t mails_s = strtoull(words[2], NULL, 10);
    struct peer_options options = {.where = words[0], .name = load_me()};
    peer_open(&options);
    uint64_t began_ns = mu_clock_ns();
    for (uint64_t sent = 0; !load_is_over();) {
        char text[LOAD_BYTES + 1];
        uint64_t due = (mu_clock_ns() - began_ns) / 1000 * mails_s / 1000000;
        for (bool fits = true; fits && sent < due;) {
            load_write(text, "pour", sent + 1, load_me());
            fits = peer_send(words[1], text, MU_LEVEL_RAM);
            sent += fits;
        }
        peer_spin(1000000);
    }
    _exit(0);
}

/* deaf WHERE NAME: is there, and takes nothing. */
void load_deaf(char **words)
{
    struct peer_options options = {.where = words[0], .name = words[1]};
    peer_open(&options);
    puts("{\"ready\": 1}");
    fflush(stdout);
    while (!load_is_over()) {
        pause();
    }
    _exit(0);
}
