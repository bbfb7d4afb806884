/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A library that the children of a run load before the C library when the run's file has faults of
 * the network: their packets go by a table (bus/traffic.h).
 */
/* With the GNU extensions, glibc declares bind() with a type that ISO C cannot define. */
#undef _GNU_SOURCE
#define _DEFAULT_SOURCE

#include "bus/traffic.h"

#include "core/clock.h"

#include <netinet/in.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

/* A packet that is late waits in a queue of so many; when it is full, the packet is lost. */
enum { PACKETS_LATE_MAX = 256, PACKETS_BYTES_MAX = 65536 };

struct late {
    uint64_t due_ns;
    int fd;
    struct sockaddr_in to;
    size_t len;
    unsigned char bytes[PACKETS_BYTES_MAX];
};

static struct {
    struct traffic *table; /* NULL: there is none */
    unsigned part;
    _Atomic uint64_t sent; /* packets that the table was asked about */
    pthread_mutex_t lock;
    pthread_cond_t arrival;
    struct late queue[PACKETS_LATE_MAX]; /* a ring */
    size_t first, count;
} traffic = {.lock = PTHREAD_MUTEX_INITIALIZER, .arrival = PTHREAD_COND_INITIALIZER};

/* Packets go out in the order in which they came, when the first one's time has come. */
static void *late_send(void *arg)
{
    (void)arg;
    pthread_mutex_lock(&traffic.lock);
    for (;;) {
        while (traffic.count == 0) {
            pthread_cond_wait(&traffic.arrival, &traffic.lock);
        }
        struct late *packet = &traffic.queue[traffic.first];
        pthread_mutex_unlock(&traffic.lock);
        uint64_t now_ns = mu_clock_ns();
        if (packet->due_ns > now_ns) {
            uint64_t wait_ns = packet->due_ns - now_ns;
            const struct timespec wait = {.tv_sec = (time_t)(wait_ns / 1000000000u),
                                          .tv_nsec = (long)(wait_ns % 1000000000u)};
            nanosleep(&wait, NULL);
        }
        (void)syscall(SYS_sendto, packet->fd, packet->bytes, packet->len, MSG_DONTWAIT, &packet->to,
                      sizeof packet->to);
        pthread_mutex_lock(&traffic.lock);
        traffic.first = (traffic.first + 1) % PACKETS_LATE_MAX;
        traffic.count--;
    }
    return NULL;
}

/* Takes the table, if the environment names one. */
__attribute__((constructor)) static void packets_join(void)
{
    const char *variable = getenv(TRAFFIC_ENVIRONMENT);
    int fd;
    unsigned part;
    pthread_t thread;
    if (!variable || sscanf(variable, "%d:%u", &fd, &part) != 2 || part >= TRAFFIC_PARTS_MAX) {
        return;
    }
    void *table = mmap(NULL, sizeof(struct traffic), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (table == MAP_FAILED) {
        return;
    }
    traffic.part = part;
    traffic.table = table;
    if (pthread_create(&thread, NULL, late_send, NULL) == 0) {
        pthread_detach(thread);
    }
}

/* Notes that a socket of this process has a port. */
static void bound_note(int fd)
{
    struct sockaddr_in address;
    socklen_t len = sizeof address;
    if (traffic.table && getsockname(fd, (struct sockaddr *)&address, &len) == 0 &&
        address.sin_family == AF_INET) {
        atomic_store(&traffic.table->parts[ntohs(address.sin_port)], (uint8_t)traffic.part);
    }
}

/* splitmix64's finish: the n-th packet of a part has its chance whatever the others do. */
static uint32_t chance_ppm(void)
{
    uint64_t n = atomic_fetch_add(&traffic.sent, 1);
    uint64_t z = traffic.table->seed + (((uint64_t)traffic.part << 40) + n) * 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (uint32_t)((z ^ (z >> 31)) % 1000000u);
}

/* Puts a packet aside.  @return its length, or 0: it is lost */
static size_t late_put(int fd, const struct msghdr *message, uint32_t late_us)
{
    size_t len = 0;
    pthread_mutex_lock(&traffic.lock);
    if (traffic.count < PACKETS_LATE_MAX) {
        struct late *p = &traffic.queue[(traffic.first + traffic.count) % PACKETS_LATE_MAX];
        for (size_t i = 0; i < message->msg_iovlen; i++) {
            const struct iovec *piece = &message->msg_iov[i];
            size_t room = PACKETS_BYTES_MAX - len;
            size_t take = piece->iov_len < room ? piece->iov_len : room;
            memcpy(p->bytes + len, piece->iov_base, take);
            len += take;
        }
        p->fd = fd;
        p->to = *(const struct sockaddr_in *)message->msg_name;
        p->len = len;
        p->due_ns = mu_clock_ns() + late_us * UINT64_C(1000);
        traffic.count++;
        pthread_cond_signal(&traffic.arrival);
    }
    pthread_mutex_unlock(&traffic.lock);
    return len;
}

/* @return whether a packet was struck: it need not be sent any more */
static bool packet_struck(int fd, const struct msghdr *message)
{
    const struct sockaddr_in *to = message->msg_name;
    if (!to || message->msg_namelen < sizeof *to || to->sin_family != AF_INET) {
        return false;
    }
    unsigned other = atomic_load(&traffic.table->parts[ntohs(to->sin_port)]);
    struct traffic_rule *rule = &traffic.table->rules[traffic.part][other % TRAFFIC_PARTS_MAX];
    uint32_t lost_ppm = atomic_load(&rule->lost_ppm), late_us = atomic_load(&rule->late_us);
    bool struck = (lost_ppm > 0 && chance_ppm() < lost_ppm);
    if (!struck && late_us > 0) {
        (void)late_put(fd, message, late_us);
        struck = true;
    }
    if (struck) {
        atomic_fetch_add(&traffic.table->struck, 1);
    }
    return struck;
}

__attribute__((visibility("default"))) int bind(int fd, const struct sockaddr *address,
                                                socklen_t len);

int bind(int fd, const struct sockaddr *address, socklen_t len)
{
    int bound = (int)syscall(SYS_bind, fd, address, len);
    if (bound == 0) {
        bound_note(fd);
    }
    return bound;
}

__attribute__((visibility("default"))) ssize_t sendmsg(int fd, const struct msghdr *message,
                                                       int flags)
{
    if (traffic.table && packet_struck(fd, message)) {
        size_t len = 0;
        for (size_t i = 0; i < message->msg_iovlen; i++) {
            len += message->msg_iov[i].iov_len;
        }
        return (ssize_t)len;
    }
    return syscall(SYS_sendmsg, fd, message, flags);
}
