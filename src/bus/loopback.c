/* SPDX-License-Identifier: Apache-2.0 */
#include "bus/loopback.h"

#include <dirent.h>
#include <errno.h>
#include <net/if.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

static bool is_udp(int fd)
{
    int type = 0, family = 0;
    socklen_t len = sizeof type, family_len = sizeof family;
    return getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &len) == 0 && type == SOCK_DGRAM &&
           getsockopt(fd, SOL_SOCKET, SO_DOMAIN, &family, &family_len) == 0 && family == AF_INET;
}

static bool is_in(const struct loopback *l, int fd)
{
    return l->bits[fd / 64] >> (fd % 64) & 1;
}

/* @return false: the system does not say which descriptors there are */
static bool sockets_look(struct loopback *l)
{
    DIR *folder = opendir("/proc/self/fd");
    memset(l, 0, sizeof *l);
    for (struct dirent *e = folder ? readdir(folder) : NULL; e; e = readdir(folder)) {
        int fd = (int)strtol(e->d_name, NULL, 10);
        if (fd > 0 && fd < LOOPBACK_FDS_MAX && is_udp(fd)) {
            l->bits[fd / 64] |= UINT64_C(1) << (fd % 64);
        }
    }
    if (folder) {
        closedir(folder);
    }
    return folder != NULL;
}

void loopback_note(struct loopback *before)
{
    (void)sockets_look(before);
}

/* @return whether the socket hears loopback alone now */
static bool socket_hold(int fd)
{
    static const char lo[] = "lo";
    char device[IFNAMSIZ] = "";
    socklen_t len = sizeof device;
    /* qemu's user mode binds, too, and cannot say to what: it hands on too small a buffer for a
     * name, which Linux refuses. */
    return setsockopt(fd, SOL_SOCKET, SO_BINDTODEVICE, lo, sizeof lo) == 0 &&
           (getsockopt(fd, SOL_SOCKET, SO_BINDTODEVICE, device, &len) == 0 ? strcmp(device, lo) == 0
                                                                           : errno == EINVAL);
}

bool loopback_hold(const struct loopback *before)
{
    static struct loopback now;
    bool held = sockets_look(&now);
    for (int fd = 0; held && fd < LOOPBACK_FDS_MAX; fd++) {
        held = !is_in(&now, fd) || is_in(before, fd) || socket_hold(fd);
    }
    if (!held) {
        fprintf(stderr,
                "cannot keep DDS on loopback: its sockets cannot be bound to the device lo: %s; "
                "Linux 5.7 or later is needed\n",
                strerror(errno));
    }
    return held;
}
