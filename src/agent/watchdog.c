/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A timer for minds whose engine does not come back.  Time is the processor's, of this thread:
 * neither a machine that has much to do nor a process that was stopped is taken for an engine that
 * hangs.
 */
#include "agent/robot.h"

#include <signal.h>
#include <time.h>
#include <unistd.h>

/* glibc 2.36 has no name for it. */
#ifndef sigev_notify_thread_id
#define sigev_notify_thread_id _sigev_un._tid
#endif

enum { WATCHDOG_LOOK_MS = 250 };

static void watchdog_look(int number)
{
    (void)number;
    char bytes[320];
    struct mu_text why;
    mu_text_init(&why, bytes, sizeof bytes);
    int code = mind_look(WATCHDOG_LOOK_MS, &why);
    if (code != MIND_WAITS) {
        ssize_t written = write(STDERR_FILENO, why.at, why.len);
        (void)written; /* nobody to tell */
        _exit(code);
    }
}

void watchdog_start(void)
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
