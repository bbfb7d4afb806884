/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/bus_arrivals.h"

#include "core/clock.h"

#include <errno.h>
#include <limits.h>
#include <sched.h>
#include <stdio.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

/* A reader in which nothing has arrived is looked into all the same from time to time: the end of a
 * writer is no sample, and not every listener hears of it. */
static const uint64_t LOOK_NS = 20000000;

/* A program that has written and does not wait need not ask the system again so soon after nothing
 * was there: one that spins after each mail of many would be as busy with that as with the mail.
 * One with a poll loop of its own comes because something is there. */
static const uint64_t QUIET_NS = 20000;

/* A wake of a processor that has halted takes some 25 us: that of the other side, and then one's
 * own; by DDS twice as many.  So a thread whose waits have been as short on average stays awake for
 * so long, and spares its own. */
static const uint64_t SOON_NS = 80000, SOON_BY_DDS_NS = 300000;

/* A wait counts as so long at most, and as that if it brings nothing, or not while awake. */
static const uint64_t LONG_NS = 600000;

/* A thread that stays awake, yields the processor and gets it back so late is not alone with it. It
 * has lost a slice of time to the other one, and does not stay awake for so many times that. */
static const uint64_t BUSY_NS = 60000;
enum { BUSY_REST = 30 };

mu_result bus_arrivals_open(struct bus *bus)
{
    bus->usual_ns = LONG_NS;
    bus->poll_fd = epoll_create1(EPOLL_CLOEXEC);
    bus->note_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    struct epoll_event note = {.events = EPOLLIN, .data.ptr = NULL};
    if (epoll_ctl(bus->poll_fd, EPOLL_CTL_ADD, bus->note_fd, &note) != 0) {
        perror("muster: no descriptor is left to wait with");
        return MU_FAULT_OS;
    }
    return MU_OK;
}

void bus_arrivals_close(struct bus *bus)
{
    close(bus->poll_fd);
    close(bus->note_fd);
}

/* --- counting --------------------------------------------------------------------------------- */

/* Each side writes first and then reads what the other one has written: either the listener sees
 * what is wanted, or the thread that waits sees what has come.  The bus counts before the reader:
 * never are more taken than have arrived. */
void bus_arrivals_note(int32_t entity, void *reader)
{
    (void)entity;
    struct bus_reader *r = reader;
    struct bus *bus = r->bus;
    uint64_t there = atomic_fetch_add(&bus->arrived, 1) + 1 - atomic_load(&bus->taken);
    atomic_fetch_add(&r->arrived, 1);
    uint64_t wanted = atomic_load(&bus->wanted);
    bool enough =
        wanted > 0 && there >= wanted &&
        atomic_compare_exchange_strong(&bus->wanted, &wanted, 0); /* one wake for one wait */
    if (enough || atomic_load(&bus->wakes)) {
        (void)eventfd_write(bus->note_fd, 1); /* full is readable, too */
    }
}

void bus_arrivals_meet(dds_entity_t entity, dds_subscription_matched_status_t status, void *reader)
{
    (void)entity;
    struct bus_reader *r = reader;
    atomic_store(&r->writers, status.current_count);
    atomic_store(&r->writers_ever, status.total_count);
}

bool bus_arrivals_are_news(struct bus_reader *r, uint64_t *arrived)
{
    *arrived = atomic_load(&r->arrived);
    bool news = *arrived != r->taken || r->bus->waited_ns - r->looked_ns > LOOK_NS;
    if (news) {
        r->looked_ns = r->bus->waited_ns;
    }
    return news;
}

void bus_arrivals_taken(struct bus_reader *r, uint64_t arrived)
{
    if (arrived != r->taken) {
        atomic_fetch_add(&r->bus->taken, arrived - r->taken);
        r->taken = arrived;
    }
}

/* --- descriptors ------------------------------------------------------------------------------ */

/* By milliseconds, upwards, where the system knows no shorter ones (before Linux 5.11). */
static int events_wait(int fd, struct epoll_event *events, int most, int64_t timeout_ns)
{
    const struct timespec time = {(time_t)(timeout_ns / 1000000000), timeout_ns % 1000000000};
    int count = epoll_pwait2(fd, events, most, &time, NULL);
    if (count < 0 && errno == ENOSYS) {
        int64_t ms = (timeout_ns + 999999) / 1000000;
        count = epoll_wait(fd, events, most, ms < INT_MAX ? (int)ms : INT_MAX);
    }
    return count;
}

void bus_arrivals_poll(struct bus *bus, int64_t timeout_ns)
{
    enum { AT_ONCE = 64 };
    struct epoll_event events[AT_ONCE];
    eventfd_t notes;
    int count = events_wait(bus->poll_fd, events, AT_ONCE, timeout_ns);
    bus->quiet_ns = count > 0 ? 0 : bus->waited_ns;
    for (int i = 0; i < count; i++) {
        struct local_source *source = events[i].data.ptr;
        if (!source) {
            (void)eventfd_read(bus->note_fd, &notes);
        } else if (source->kind == LOCAL_OUTPUT) {
            local_pair_ready(source, events[i].events);
        } else {
            local_reader_ready(bus, source);
        }
    }
}

/* --- waiting ---------------------------------------------------------------------------------- */

/* @return how many samples lie in the readers and in what sockets have brought */
static uint64_t samples_there(struct bus *bus)
{
    return atomic_load(&bus->arrived) - atomic_load(&bus->taken) + bus->local_frames;
}

int bus_wake_fd(struct bus *bus)
{
    if (!atomic_exchange(&bus->wakes, true) && samples_there(bus) > bus->local_frames) {
        (void)eventfd_write(bus->note_fd, 1);
    }
    return bus->poll_fd;
}

/* Says how many samples a listener has to wait for.  @return whether that many are there */
static bool samples_want(struct bus *bus, uint64_t samples)
{
    if (samples_there(bus) >= samples) {
        return true;
    }
    atomic_store(&bus->wanted, samples - bus->local_frames);
    return samples_there(bus) >= samples;
}

/* Asleep, as long as there is time.  @return whether so many samples are there */
static bool samples_sleep(struct bus *bus, uint64_t samples, uint64_t until_ns)
{
    uint64_t now_ns = bus->waited_ns;
    bool come = samples_want(bus, samples);
    do {
        bus_arrivals_poll(bus, come || now_ns > until_ns ? 0 : (int64_t)(until_ns - now_ns));
        now_ns = mu_clock_ns();
        come = samples_want(bus, samples);
    } while (!come && now_ns < until_ns);
    atomic_store(&bus->wanted, 0);
    bus->waited_ns = now_ns;
    return come;
}

/* Awake, for a moment, where samples usually come so soon.  @return as samples_sleep */
static bool samples_watch(struct bus *bus, uint64_t samples, uint64_t until_ns)
{
    const uint64_t soon_ns = bus->local ? SOON_NS : SOON_BY_DDS_NS;
    const uint64_t enough_ns = bus->waited_ns + soon_ns;
    if (bus->usual_ns > soon_ns || bus->waited_ns < bus->rested_ns) {
        return false;
    }
    while (bus->waited_ns < enough_ns && bus->waited_ns < until_ns) {
        bus_arrivals_poll(bus, 0);
        if (samples_there(bus) >= samples) {
            return true;
        }
        sched_yield();
        uint64_t late_ns = mu_clock_ns() - bus->waited_ns;
        bus->waited_ns += late_ns;
        if (late_ns > BUSY_NS) {
            bus->rested_ns = bus->waited_ns + BUSY_REST * late_ns;
            return false;
        }
    }
    return false;
}

static bool samples_await(struct bus *bus, uint64_t samples, uint64_t until_ns)
{
    const uint64_t began_ns = bus->waited_ns;
    bool come = samples_watch(bus, samples, until_ns);
    bool in_vain = !come && bus->waited_ns > began_ns;
    come = come || samples_sleep(bus, samples, until_ns);
    uint64_t took_ns = bus->waited_ns - began_ns;
    took_ns = samples_there(bus) > 0 && !in_vain && took_ns < LONG_NS ? took_ns : LONG_NS;
    bus->usual_ns += took_ns / 8 - bus->usual_ns / 8;
    return come;
}

bool bus_wait(struct bus *bus, uint64_t samples, int64_t timeout_ns)
{
    bool wrote = bus->wrote;
    bus->wrote = false;
    samples = samples > 0 ? samples : samples_there(bus) + 1;
    local_match(bus);
    bus->waited_ns = mu_clock_ns();
    if (timeout_ns > 0) {
        return samples_await(bus, samples, bus->waited_ns + (uint64_t)timeout_ns);
    }
    if (!wrote || bus->wakes || bus->waited_ns - bus->quiet_ns > QUIET_NS) {
        bus_arrivals_poll(bus, 0);
    }
    return samples_there(bus) >= samples;
}
