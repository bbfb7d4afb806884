/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/bus_arrivals.h"

#include "core/clock.h"

#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <stdio.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

/* A reader in which nothing has arrived is looked into all the same from time to time: the end of a
 * writer is no sample, and not every listener hears of it. */
static const uint64_t LOOK_NS = 20000000;

/* A socket that has brought a sample of so many pairs, one after another, will do so again. */
enum { REGULAR = 8 };

mu_result bus_arrivals_open(struct bus *bus)
{
    pthread_mutex_init(&bus->lock, NULL);
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

void bus_arrivals_note(int32_t entity, void *reader)
{
    (void)entity;
    struct bus_reader *r = reader;
    struct bus *bus = r->bus;
    pthread_mutex_lock(&bus->lock);
    r->arrived++;
    bus->arrived++;
    bool enough = bus->wanted > 0 && bus->arrived - bus->taken >= bus->wanted;
    bus->wanted = enough ? 0 : bus->wanted; /* one wake for one wait */
    bool tells = enough || bus->wakes;
    pthread_mutex_unlock(&bus->lock);
    if (tells) {
        (void)eventfd_write(bus->note_fd, 1); /* full is readable, too */
    }
}

void bus_arrivals_match(dds_entity_t writer, dds_publication_matched_status_t status, void *bus)
{
    (void)writer;
    (void)status;
    atomic_fetch_add(&((struct bus *)bus)->matches, 1);
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

/* --- descriptors ------------------------------------------------------------------------------ */

static struct timespec time_of(uint64_t ns)
{
    return (struct timespec){(time_t)(ns / 1000000000), (long)(ns % 1000000000)};
}

/* By milliseconds, upwards, where the system knows no shorter ones (before Linux 5.11). */
static int events_wait(int fd, struct epoll_event *events, int most, int64_t timeout_ns)
{
    const struct timespec time = time_of((uint64_t)timeout_ns);
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
    for (int i = 0; i < count; i++) {
        struct local_source *source = events[i].data.ptr;
        if (!source) {
            (void)eventfd_read(bus->note_fd, &notes);
        } else if (source->kind == LOCAL_OUTPUT) {
            local_writer_ready(source, events[i].events);
        } else {
            local_reader_ready(bus, source);
        }
    }
}

/* --- waiting ---------------------------------------------------------------------------------- */

int bus_wake_fd(struct bus *bus)
{
    pthread_mutex_lock(&bus->lock);
    bool lie_there = !bus->wakes && bus->arrived != bus->taken;
    bus->wakes = true;
    pthread_mutex_unlock(&bus->lock);
    if (lie_there) {
        (void)eventfd_write(bus->note_fd, 1);
    }
    return bus->poll_fd;
}

/* Says how many samples a listener has to wait for.  @return whether that many are there */
static bool samples_want(struct bus *bus, uint64_t samples)
{
    pthread_mutex_lock(&bus->lock);
    bool come = bus->arrived - bus->taken + bus->local_frames >= samples;
    bus->wanted = come ? 0 : samples - bus->local_frames;
    pthread_mutex_unlock(&bus->lock);
    return come;
}

static uint64_t samples_there(struct bus *bus)
{
    pthread_mutex_lock(&bus->lock);
    uint64_t there = bus->arrived - bus->taken + bus->local_frames;
    pthread_mutex_unlock(&bus->lock);
    return there;
}

/* Waits for the later one of two samples, if that comes by one socket in each step: the other one
 * need wake no thread.  Of more than two, those that are early are better read meanwhile. */
static void later_await(struct bus *bus, uint64_t most_ns)
{
    const struct local_source *later = bus->later;
    if (later && later->regular >= REGULAR && later->pair < bus->pairs) {
        struct pollfd fds[] = {{.fd = later->fd, .events = POLLIN},
                               {.fd = bus->note_fd, .events = POLLIN}};
        const struct timespec time = time_of(most_ns);
        (void)ppoll(fds, sizeof fds / sizeof fds[0], &time, NULL);
    }
}

bool bus_wait(struct bus *bus, uint64_t samples, int64_t timeout_ns)
{
    uint64_t now_ns = mu_clock_ns(),
             until_ns = now_ns + (timeout_ns > 0 ? (uint64_t)timeout_ns : 0);
    samples = samples > 0 ? samples : samples_there(bus) + 1;
    local_match(bus);
    bool come = samples_want(bus, samples);
    if (samples == 2 && !come) {
        later_await(bus, until_ns - now_ns);
        now_ns = mu_clock_ns();
    }
    do {
        bus_arrivals_poll(bus, come || now_ns > until_ns ? 0 : (int64_t)(until_ns - now_ns));
        now_ns = mu_clock_ns();
        come = samples_want(bus, samples);
    } while (!come && now_ns < until_ns);
    (void)samples_want(bus, 0);
    bus->pairs += come && samples == 2;
    return come;
}
