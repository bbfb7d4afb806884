/* SPDX-License-Identifier: Apache-2.0 */
/* With the GNU extensions, glibc declares bind() with a type that ISO C cannot define. */
#undef _GNU_SOURCE
#define _DEFAULT_SOURCE

#include "bus/loopback.h"

#include "bus/traffic.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

static _Thread_local uint32_t loopback_address; /* 0: leave every bind alone */

void loopback_begin(uint32_t address)
{
    loopback_address = address;
}

void loopback_end(void)
{
    loopback_address = 0;
}

static int is_udp(int fd)
{
    int type = 0;
    socklen_t len = sizeof type;
    return getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &len) == 0 && type == SOCK_DGRAM;
}

/* Seen from outside a shared library, too; libmuster.map gives it no version. */
__attribute__((visibility("default"))) int bind(int fd, const struct sockaddr *address,
                                                socklen_t len);

/* Takes the place of the C library's bind in every program that links this file. */
int bind(int fd, const struct sockaddr *address, socklen_t len)
{
    if (loopback_address && address->sa_family == AF_INET && len >= sizeof(struct sockaddr_in)) {
        struct sockaddr_in inet = *(const struct sockaddr_in *)(const void *)address;
        if (inet.sin_addr.s_addr == htonl(INADDR_ANY) && is_udp(fd)) {
            inet.sin_addr.s_addr = htonl(loopback_address);
            int result = (int)syscall(SYS_bind, fd, &inet, sizeof inet);
            traffic_bound(fd);
            return result;
        }
    }
    return (int)syscall(SYS_bind, fd, address, len);
}
