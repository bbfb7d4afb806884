/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/traffic.h"

#include "core/clock.h"
#include "muster/memory.h"

#include <netinet/in.h>
#include <pthread.h>
#include <stdatomic.h>
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
enum { TRAFFIC_LATE_MAX = 256, TRAFFIC_PACKET_MAX = 65536, TRAFFIC_PORTS = 65536 };

#define TRAFFIC_ENVIRONMENT "MUSTER_TRAFFIC"

struct traffic_rule {
    _Atomic uint32_t lost_ppm, late_us;
};

struct traffic {
    uint64_t seed;
    _Atomic uint64_t struck;
    _Atomic uint8_t parts[TRAFFIC_PORTS]; /* whose each port is */
    struct traffic_rule rules[TRAFFIC_PARTS_MAX][TRAFFIC_PARTS_MAX];
};

struct late {
    uint64_t due_ns;
    int fd;
    struct sockaddr_in to;
    size_t len;
    unsigned char bytes[TRAFFIC_PACKET_MAX];
};

static struct {
    struct traffic *table; /* NULL: there is none */
    int shared;            /* its descriptor, in who made it */
    unsigned part;
    _Atomic uint64_t sent; /* packets that the table was asked about */
    pthread_mutex_t lock;
    pthread_cond_t arrival;
    struct late *queue; /* TRAFFIC_LATE_MAX, a ring */
    size_t first, count;
} traffic = {.lock = PTHREAD_MUTEX_INITIALIZER, .arrival = PTHREAD_COND_INITIALIZER};

/* --- who makes the table ---------------------------------------------------------------------- */

mu_result traffic_make(struct traffic **out, uint64_t seed)
{
    int fd = memfd_create("muster-traffic", 0); /* children inherit it */
    bool sized = fd >= 0 && ftruncate(fd, sizeof **out) == 0;
    void *table =
        sized ? mmap(NULL, sizeof **out, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0) : MAP_FAILED;
    if (table == MAP_FAILED) {
        perror("muster: cannot make the table of traffic");
        return MU_FAULT_OS;
    }
    *out = table;
    (*out)->seed = seed;
    traffic.shared = fd;
    traffic_child(0);
    return MU_OK;
}

void traffic_child(unsigned part)
{
    static char variable[64];
    snprintf(variable, sizeof variable, TRAFFIC_ENVIRONMENT "=%d:%u", traffic.shared, part);
    putenv(variable); /* which keeps the buffer */
}

void traffic_set(struct traffic *t, unsigned one, unsigned other, double share, double by_ms)
{
    struct traffic_rule *rules[] = {&t->rules[one][other], &t->rules[other][one]};
    for (size_t i = 0; i < 2; i++) {
        atomic_store(&rules[i]->lost_ppm, (uint32_t)(share * 1e6));
        atomic_store(&rules[i]->late_us, (uint32_t)(by_ms * 1e3));
    }
}

uint64_t traffic_struck(const struct traffic *t)
{
    return atomic_load(&t->struck);
}

/* --- who goes by it --------------------------------------------------------------------------- */

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
        traffic.first = (traffic.first + 1) % TRAFFIC_LATE_MAX;
        traffic.count--;
    }
    return NULL;
}

void traffic_join(void)
{
    const char *variable = getenv(TRAFFIC_ENVIRONMENT);
    int fd;
    unsigned part;
    pthread_t thread;
    if (!variable || traffic.table || traffic.shared > 0 ||
        sscanf(variable, "%d:%u", &fd, &part) != 2 || part >= TRAFFIC_PARTS_MAX) {
        return;
    }
    void *table = mmap(NULL, sizeof(struct traffic), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (table == MAP_FAILED) {
        return;
    }
    traffic.part = part;
    traffic.queue = mu_startup_array(TRAFFIC_LATE_MAX, sizeof *traffic.queue);
    traffic.table = table;
    if (pthread_create(&thread, NULL, late_send, NULL) == 0) {
        pthread_detach(thread);
    }
}

void traffic_bound(int fd)
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
    if (traffic.count < TRAFFIC_LATE_MAX) {
        struct late *p = &traffic.queue[(traffic.first + traffic.count) % TRAFFIC_LATE_MAX];
        for (size_t i = 0; i < message->msg_iovlen; i++) {
            const struct iovec *piece = &message->msg_iov[i];
            size_t room = TRAFFIC_PACKET_MAX - len;
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

/* @return whether a packet was struck: nobody needs to send it any more */
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

/* Takes the place of the C library's sendmsg in every program that links this file. */
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
