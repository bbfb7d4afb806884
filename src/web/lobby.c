/* SPDX-License-Identifier: Apache-2.0 */
#include "web/web.h"

#include <sys/socket.h>

static const uint64_t LOBBY_PATIENCE_NS = 10000000000;

static void place_free(struct lobby *l, size_t index)
{
    l->places[index] = l->places[--l->count];
}

void lobby_leave(struct lobby *l, int fd)
{
    for (size_t i = 0; i < l->count; i++) {
        if (l->places[i].fd == fd) {
            place_free(l, i);
            return;
        }
    }
}

/* The library finds that out, and closes it. */
static void place_end(struct lobby *l, size_t index)
{
    (void)shutdown(l->places[index].fd, SHUT_RDWR);
    place_free(l, index);
}

void lobby_enter(struct lobby *l, int fd, uint64_t now_ns)
{
    lobby_leave(l, fd);
    if (l->count == LOBBY_MAX) {
        size_t oldest = 0;
        for (size_t i = 1; i < l->count; i++) {
            oldest = l->places[i].since_ns < l->places[oldest].since_ns ? i : oldest;
        }
        place_end(l, oldest);
    }
    l->places[l->count++] = (struct lobby_place){fd, now_ns};
}

void lobby_round(struct lobby *l, uint64_t now_ns)
{
    for (size_t i = l->count; i-- > 0;) {
        if (now_ns - l->places[i].since_ns > LOBBY_PATIENCE_NS) {
            place_end(l, i);
        }
    }
}
