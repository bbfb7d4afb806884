/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/bus_arrivals.h"

#include "core/clock.h"

#include <sched.h>
#include <sys/eventfd.h>
#include <time.h>

/* A reader in which nothing has arrived is looked into all the same from time to time: the end of a
 * writer is no sample, and not every listener hears of it. */
static const uint64_t LOOK_NS = 20000000;

static const uint64_t AWAKE_NS = 200000;
static const uint64_t BUSY_MACHINE_NS = 100000000;

void bus_arrivals_init(struct bus *bus)
{
    pthread_condattr_t clock;
    pthread_condattr_init(&clock);
    pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
    pthread_mutex_init(&bus->lock, NULL);
    pthread_cond_init(&bus->arrival, &clock);
    pthread_condattr_destroy(&clock);
}

static bool has_come(const struct bus *bus, uint64_t samples)
{
    return bus->arrived - bus->taken >= samples;
}

/* --- counting --------------------------------------------------------------------------------- */

/* Runs in the thread of DDS that has the turn, for as long as that empties the readers.  As a rule
 * it is the one that receives; the end of a writer is said by others. */
static void turns_take(struct bus *bus)
{
    bool again = true, call = false;
    while (again) {
        uint64_t taken = bus->taken; /* of all threads only this one takes */
        bool plain = bus->turn(bus->turn_self);
        pthread_mutex_lock(&bus->lock);
        bool more = has_come(bus, 1);
        again = plain && more && !bus->called && bus->taken != taken;
        bus->called = bus->called || !plain || (more && !again);
        bus->turning = again;
        call = bus->called && !again;
        pthread_mutex_unlock(&bus->lock);
    }
    if (call) {
        pthread_cond_signal(&bus->arrival);
    }
}

void bus_arrivals_note(int32_t entity, void *reader)
{
    (void)entity;
    struct bus_reader *r = reader;
    struct bus *bus = r->bus;
    pthread_mutex_lock(&bus->lock);
    r->arrived++;
    bus->arrived++;
    bool lent = bus->turn && !bus->turning && !bus->called;
    bus->turning = bus->turning || lent;
    bool enough = bus->wanted > 0 && bus->arrived - bus->taken >= bus->wanted;
    bus->wanted = enough ? 0 : bus->wanted; /* one wake for one wait */
    if (bus->wakes) {
        (void)eventfd_write(bus->wake_fd, 1); /* full is readable, too */
    }
    pthread_mutex_unlock(&bus->lock);
    if (lent) {
        turns_take(bus);
    } else if (enough) {
        pthread_cond_signal(&bus->arrival); /* a thread that wakes finds the lock free */
    }
}

bool bus_arrivals_are_news(struct bus_reader *r, uint64_t *arrived)
{
    pthread_mutex_lock(&r->bus->lock);
    *arrived = r->arrived;
    bool news = r->arrived != r->taken;
    pthread_mutex_unlock(&r->bus->lock);
    uint64_t now_ns = mu_clock_ns();
    news = news || now_ns - r->looked_ns > LOOK_NS;
    if (news) {
        r->looked_ns = now_ns;
    }
    return news;
}

void bus_arrivals_taken(struct bus_reader *r, uint64_t arrived)
{
    pthread_mutex_lock(&r->bus->lock);
    r->bus->taken += arrived - r->taken;
    r->taken = arrived;
    pthread_mutex_unlock(&r->bus->lock);
}

/* --- waiting ---------------------------------------------------------------------------------- */

int bus_wake_fd(struct bus *bus)
{
    pthread_mutex_lock(&bus->lock);
    if (!bus->wakes) {
        bus->wake_fd = eventfd(bus->arrived != bus->taken, EFD_NONBLOCK | EFD_CLOEXEC);
        bus->wakes = bus->wake_fd >= 0;
    }
    int fd = bus->wake_fd;
    pthread_mutex_unlock(&bus->lock);
    return fd;
}

/* Called with the lock.  Yields to other threads. On a busy machine that is the worse way: a
 * sleeping thread is woken at once, a yielding one waits for its turn. When a turn has taken long,
 * the next waits are asleep. */
static void wait_awake(struct bus *bus, uint64_t samples, uint64_t now_ns, uint64_t until_ns)
{
    if (bus->last_wait_ns > AWAKE_NS || now_ns < bus->asleep_until_ns) {
        return;
    }
    uint64_t end_ns = now_ns + AWAKE_NS < until_ns ? now_ns + AWAKE_NS : until_ns;
    while (!has_come(bus, samples) && now_ns < end_ns) {
        pthread_mutex_unlock(&bus->lock);
        sched_yield();
        pthread_mutex_lock(&bus->lock);
        now_ns = mu_clock_ns();
    }
    if (now_ns > end_ns + AWAKE_NS) {
        bus->asleep_until_ns = now_ns + BUSY_MACHINE_NS;
    }
}

static struct timespec instant(uint64_t ns)
{
    return (struct timespec){.tv_sec = (time_t)(ns / 1000000000u),
                             .tv_nsec = (long)(ns % 1000000000u)};
}

/* Called with the lock. */
static void wait_asleep(struct bus *bus, uint64_t samples, uint64_t until_ns)
{
    const struct timespec until = instant(until_ns);
    int waited = 0;
    bus->wanted = samples;
    while (!has_come(bus, samples) && waited == 0) {
        waited = pthread_cond_timedwait(&bus->arrival, &bus->lock, &until);
    }
    bus->wanted = 0;
}

/* Called with the lock: what comes from now on is news to a poll loop. */
static void arrivals_forget(struct bus *bus)
{
    eventfd_t count;
    if (bus->wakes) {
        (void)eventfd_read(bus->wake_fd, &count);
    }
}

static void arrivals_await(struct bus *bus, uint64_t samples, int64_t timeout_ns, bool awake)
{
    uint64_t began_ns = mu_clock_ns();
    uint64_t until_ns = began_ns + (timeout_ns > 0 ? (uint64_t)timeout_ns : 0);
    pthread_mutex_lock(&bus->lock);
    arrivals_forget(bus);
    if (samples == 0) {
        samples = bus->arrived - bus->taken + 1;
    }
    if (awake) {
        wait_awake(bus, samples, began_ns, until_ns);
    }
    wait_asleep(bus, samples, until_ns);
    pthread_mutex_unlock(&bus->lock);
    bus->last_wait_ns = mu_clock_ns() - began_ns;
}

void bus_wait(struct bus *bus, uint64_t samples, int64_t timeout_ns)
{
    arrivals_await(bus, samples, timeout_ns, false);
}

void bus_wait_awake(struct bus *bus, uint64_t samples, int64_t timeout_ns)
{
    arrivals_await(bus, samples, timeout_ns, true);
}

void bus_wait_lending(struct bus *bus, int64_t timeout_ns, bool (*turn)(void *self), void *self)
{
    const struct timespec until = instant(mu_clock_ns() + (uint64_t)timeout_ns);
    int waited = 0;
    pthread_mutex_lock(&bus->lock);
    arrivals_forget(bus);
    bus->turn = turn;
    bus->turn_self = self;
    bus->called = has_come(bus, 1);
    while (!bus->called && waited == 0) {
        waited = pthread_cond_timedwait(&bus->arrival, &bus->lock, &until);
    }
    bus->called = true; /* the thread with the turn gives it back */
    while (bus->turning) {
        pthread_cond_wait(&bus->arrival, &bus->lock);
    }
    bus->turn = NULL;
    pthread_mutex_unlock(&bus->lock);
}
