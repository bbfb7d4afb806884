/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file local_frame.h
 * What both ends of a socket between processes of one host know (local.h).
 */
#ifndef MUSTER_BUS_LOCAL_FRAME_H
#define MUSTER_BUS_LOCAL_FRAME_H

#include "bus/local.h"
#include "muster/result.h"

#include <dds/dds.h>
#include <stddef.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#define LOCAL_HELLO_MARK UINT64_C(0x316f6c6c6568756d) /* "muhello1" */

/* The first bytes of a writer.  The second part follows when it has the answer: only then all that
 * it writes comes by the socket. */
struct local_hello {
    uint64_t mark;
    dds_guid_t writer;   /* on DDS; its participant: whatever that writes to this reader */
    dds_time_t since_ns; /* what DDS has of it of later times comes by the socket, too */
};
enum { LOCAL_HELLO_FIRST = offsetof(struct local_hello, since_ns) };

/* @return memory of DDS's */
static inline void *local_memory(size_t bytes)
{
    void *at = dds_alloc(bytes);
    MU_ASSERT(at);
    return at;
}

/* Has a descriptor waited for; its end is always news. */
static inline void local_watch(struct bus *bus, struct local_source *source, uint32_t events)
{
    struct epoll_event event = {.events = events, .data.ptr = source};
    int added = epoll_ctl(bus->poll_fd, EPOLL_CTL_ADD, source->fd, &event);
    MU_ASSERT(added == 0);
}

/* Has it waited for something else. */
static inline void local_change(struct bus *bus, struct local_source *source, uint32_t events)
{
    struct epoll_event event = {.events = events, .data.ptr = source};
    int changed = epoll_ctl(bus->poll_fd, EPOLL_CTL_MOD, source->fd, &event);
    MU_ASSERT(changed == 0);
}

/* Closes a descriptor.  A child by fork may have it still, and the system would go on telling of
 * it.
 */
static inline void local_unwatch(struct bus *bus, struct local_source *source)
{
    if (source->fd >= 0) {
        (void)epoll_ctl(bus->poll_fd, EPOLL_CTL_DEL, source->fd, NULL);
        close(source->fd);
        source->fd = -1;
    }
}

#endif
