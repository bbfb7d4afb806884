/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The last resort, outside of the engine: one call into it has been at work for seconds and has
 * come to hardly any of the places where guards count.  Time is the processor's, of this thread:
 * neither a machine that has much to do nor a process that was stopped is taken for an engine that
 * hangs.
 */
#include "mind/clips_mind.h"

#include <signal.h>
#include <time.h>
#include <unistd.h>

/* glibc 2.36 has no name for it. */
#ifndef sigev_notify_thread_id
#define sigev_notify_thread_id _sigev_un._tid
#endif

enum {
    WATCHDOG_LOOK_MS = 250,
    WATCHDOG_UNITS = 1000 * BUDGET_UNITS_A_TICK /* an engine at work counts a thousand times that */
};

static struct {
    struct mind *mind;        /* that called into the engine last */
    uint64_t entries;         /* such calls */
    uint64_t looked_at, seen; /* of them, and the units that it had counted at the last look */
    unsigned looks;           /* since it has come to a guard */
} watchdog;

void watchdog_enter(struct mind *m)
{
    watchdog.mind = m;
    watchdog.entries++;
}

static void watchdog_end(struct mind *m, int code)
{
    budget_say(m);
    char bytes[sizeof m->lost + sizeof m->name + 8];
    struct mu_text t;
    mu_text_init(&t, bytes, sizeof bytes);
    mu_text_format(&t, "%s: %s\n", m->name, m->lost);
    ssize_t written = write(STDERR_FILENO, t.at, t.len);
    (void)written; /* nobody to tell */
    _exit(code);
}

static void watchdog_look(int number)
{
    (void)number;
    struct mind *m = watchdog.mind;
    if (!m || !m->sheltered || !m->options.ports.stuck) {
        return;
    }
    bool hangs =
        watchdog.looked_at == watchdog.entries && m->cost.units - watchdog.seen < WATCHDOG_UNITS;
    watchdog.looks = hangs ? watchdog.looks + 1 : 0;
    watchdog.looked_at = watchdog.entries;
    watchdog.seen = m->cost.units;
    if (!hangs) {
        return;
    }
    int code = m->options.ports.stuck(m->options.ports.self, watchdog.looks * WATCHDOG_LOOK_MS);
    if (code == MIND_BREAKS) {
        watchdog.looks = 0;
        budget_leave(m, "time");
    } else if (code != MIND_WAITS) {
        watchdog_end(m, code);
    }
}

void mind_watchdog(void)
{
    timer_t timer;
    /* No mask: from a look the way may lead out of the engine. */
    struct sigaction look = {.sa_handler = watchdog_look, .sa_flags = SA_RESTART | SA_NODEFER};
    struct sigevent event = {.sigev_notify = SIGEV_THREAD_ID, .sigev_signo = SIGPROF};
    struct itimerspec every = {.it_interval.tv_nsec = WATCHDOG_LOOK_MS * 1000000,
                               .it_value.tv_nsec = WATCHDOG_LOOK_MS * 1000000};
    event.sigev_notify_thread_id = gettid();
    bool set = sigaction(SIGPROF, &look, NULL) == 0 &&
               timer_create(CLOCK_THREAD_CPUTIME_ID, &event, &timer) == 0 &&
               timer_settime(timer, 0, &every, NULL) == 0;
    MU_ASSERT(set);
}
