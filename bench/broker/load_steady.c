/* SPDX-License-Identifier: Apache-2.0 */
/* Mail at a steady pace, and many pairs at once. */
#include "core/clock.h"
#include "load.h"
#include "peer.h"

#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PAIRS_MAX = 100, TRIPS_MAX = 100000 };

/* pace WHERE TO MAILS_S COUNT: a mail each time it is due; the receiver has had all at the end. */
void load_pace(char **words)
{
    uint64_t mails_s = strtoull(words[2], NULL, 10);
    uint64_t count = strtoull(words[3], NULL, 10);
    if (mails_s < 1 || count < LOAD_CREDIT || count % LOAD_CREDIT != 0) {
        load_die("pace: a multiple of %d mails", LOAD_CREDIT);
    }
    load_sender_open(words[0]);
    load_cpu_begin();
    uint64_t began_ns = mu_clock_ns();
    for (uint64_t sent = 0; sent < count; sent++) {
        char text[LOAD_BYTES + 1];
        uint64_t due_ns = began_ns + sent * (1000000000 / mails_s);
        for (uint64_t now_ns = mu_clock_ns(); now_ns < due_ns; now_ns = mu_clock_ns()) {
            peer_spin((int64_t)(due_ns - now_ns));
        }
        load_write(text, "flood", sent + 1, load_me());
        load_send(words[1], text, 0);
        peer_spin(0);
    }
    load_credit_await(count);
    printf("{");
    load_cpu_print(count);
    printf("\"mails_s\": %.1f}\n", (double)count * 1e9 / (double)(mu_clock_ns() - began_ns));
}

/* --- many pairs ------------------------------------------------------------------------------- */

struct pairs {
    _Atomic uint32_t ready, done;
    _Atomic bool go;
    uint64_t trips; /* of each pair */
    uint64_t took_ns[];
};

static void pair_run(const char *where, struct pairs *pairs, int index)
{
    char to[32];
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    snprintf(to, sizeof to, "a%d", index);
    load_sender_open(where);
    load_trip(to, 1);
    atomic_fetch_add(&pairs->ready, 1);
    while (!atomic_load(&pairs->go)) {
        peer_spin(1000000);
    }
    uint64_t *took_ns = pairs->took_ns + (uint64_t)index * pairs->trips;
    for (uint64_t i = 0; i < pairs->trips; i++) {
        took_ns[i] = load_trip(to, i + 2);
    }
    atomic_fetch_add(&pairs->done, 1);
    load_spin_on();
    peer_close();
    _exit(0);
}

static void all_await(const _Atomic uint32_t *count, uint32_t wanted)
{
    uint64_t until_ns = mu_clock_ns() + 120000000000u;
    while (atomic_load(count) < wanted) {
        usleep(500);
        if (mu_clock_ns() > until_ns || waitpid(-1, NULL, WNOHANG) > 0) {
            load_die("%u of %u pairs", atomic_load(count), wanted);
        }
    }
}

/* pairs WHERE PAIRS TRIPS: one process each asks a0, a1, ..., all at once. */
void load_pairs(char **words)
{
    pid_t pids[PAIRS_MAX];
    uint32_t count = (uint32_t)strtoul(words[1], NULL, 10);
    uint64_t trips = strtoull(words[2], NULL, 10);
    if (count < 1 || count > PAIRS_MAX || trips < 1 || trips > TRIPS_MAX) {
        load_die("pairs: at most %d, and %d round trips each", PAIRS_MAX, TRIPS_MAX);
    }
    uint64_t all = count * trips;
    struct pairs *pairs = mmap(NULL, sizeof *pairs + all * sizeof pairs->took_ns[0],
                               PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (pairs == MAP_FAILED) {
        load_die("no memory for %llu times", (unsigned long long)all);
    }
    pairs->trips = trips;
    for (uint32_t i = 0; i < count; i++) {
        pids[i] = fork();
        if (pids[i] == 0) {
            pair_run(words[0], pairs, (int)i);
        }
        load_cpu_watch(pids[i]);
    }
    all_await(&pairs->ready, count);
    load_cpu_begin();
    uint64_t began_ns = mu_clock_ns();
    atomic_store(&pairs->go, true);
    all_await(&pairs->done, count);
    double took_s = (double)(mu_clock_ns() - began_ns) * 1e-9;
    printf("{");
    load_cpu_print(all);
    printf("\"trips_s\": %.1f, \"p50_us\": %.1f, \"p99_us\": %.1f}\n", (double)all / took_s,
           load_quantile(pairs->took_ns, all, 0.5) * 1e-3,
           load_quantile(pairs->took_ns, all, 0.99) * 1e-3);
    fflush(stdout);
    for (uint32_t i = 0; i < count; i++) {
        kill(pids[i], SIGTERM);
    }
    while (wait(NULL) > 0) {
    }
    _exit(0); /* this process has no connection of its own to close */
}
