/* SPDX-License-Identifier: Apache-2.0 */
#include "desk/runs.h"

#include "bus/bus.h"
#include "core/text.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <netinet/in.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

/* Names the folder of lock files and makes it.  @return whether it is there and ours alone */
static bool runs_folder(char *folder, size_t size)
{
    const char *runtime = getenv("XDG_RUNTIME_DIR");
    struct mu_text t;
    mu_text_init(&t, folder, size);
    if (runtime && runtime[0] == '/') {
        mu_text_format(&t, "%s/muster", runtime);
    } else {
        mu_text_format(&t, "/tmp/muster-%u", (unsigned)getuid());
    }
    if (mkdir(folder, 0700) != 0 && errno != EEXIST) {
        return false;
    }
    struct stat info;
    return lstat(folder, &info) == 0 && S_ISDIR(info.st_mode) && info.st_uid == getuid();
}

static int lock_open(const char *folder, int domain, int flags)
{
    char path[PATH_MAX];
    struct mu_text t;
    mu_text_init(&t, path, sizeof path);
    mu_text_format(&t, "%s/domain-%d", folder, domain);
    return open(path, flags | O_CLOEXEC | O_NOFOLLOW, 0600);
}

/* @return a socket that has this port on loopback; < 0: somebody else has it */
static int port_bind(int type, int port)
{
    int fd = socket(AF_INET, type | SOCK_CLOEXEC, 0);
    struct sockaddr_in address = {.sin_family = AF_INET,
                                  .sin_port = htons((uint16_t)port),
                                  .sin_addr = {htonl(INADDR_LOOPBACK)}};
    if (fd >= 0 && bind(fd, (const struct sockaddr *)&address, sizeof address) != 0) {
        close(fd);
        fd = -1;
    }
    return fd;
}

/* The lock file is ours; does somebody else's broker or simulator use the ports:
 * indices 0 to 4? */
static bool ports_free(int domain)
{
    for (int index = 0; index < 5; index++) {
        int fd = port_bind(SOCK_DGRAM, bus_port(domain, index));
        if (fd < 0) {
            return false;
        }
        close(fd);
    }
    return true;
}

/* Other users' lock files lie elsewhere, and their broker may not be up yet: who runs in a domain
 * holds a TCP port of it, too, which DDS has no use for.  It comes before the look at the ports of
 * DDS: a look takes each for a moment, and who lives there may want it just then.
 *
 * is_picked: of many; one that the user wants is not refused for a stranger's port.
 * @return whether nobody is there; the TCP port is held for good then */
static bool ports_take(int domain, bool is_picked)
{
    int held = port_bind(SOCK_STREAM, bus_port(domain, 0));
    if (held < 0 && is_picked) {
        return false;
    }
    bool free = ports_free(domain);
    if (held >= 0 && !free) {
        close(held);
    }
    return free;
}

static bool domain_take(const char *folder, int domain, bool is_picked, const char *name)
{
    int fd = lock_open(folder, domain, O_RDWR | O_CREAT);
    if (fd < 0) {
        return false;
    }
    if (flock(fd, LOCK_EX | LOCK_NB) != 0 || !ports_take(domain, is_picked)) {
        close(fd);
        return false;
    }
    char line[128];
    int len = snprintf(line, sizeof line, "%.100s\n", name);
    bool written = ftruncate(fd, 0) == 0 && write(fd, line, (size_t)len) == len;
    (void)written; /* the name is only for people; the lock is what counts */
    return true;   /* fd stays open: the lock lives as long as we do */
}

mu_result runs_take(int wanted, const char *name, int *domain)
{
    char folder[PATH_MAX];
    if (!runs_folder(folder, sizeof folder)) {
        fprintf(stderr, "muster: cannot use %s: %s\n", folder, strerror(errno));
        return MU_FAULT_OS;
    }
    int first = wanted >= 0 ? wanted : RUNS_DOMAIN_FIRST;
    int last = wanted >= 0 ? wanted : RUNS_DOMAIN_LAST;
    for (int d = first; d <= last; d++) {
        if (domain_take(folder, d, wanted < 0, name)) {
            *domain = d;
            return MU_OK;
        }
    }
    return MU_BUSY;
}

/* @return whether a run lives in this domain; name is filled with its experiment's */
static bool domain_lives(const char *folder, int domain, char *name, size_t size)
{
    int fd = lock_open(folder, domain, O_RDONLY);
    if (fd < 0) {
        return false;
    }
    bool lives = flock(fd, LOCK_SH | LOCK_NB) != 0;
    ssize_t len = lives ? read(fd, name, size - 1) : 0;
    close(fd);
    name[len > 0 ? len : 0] = '\0';
    name[strcspn(name, "\n")] = '\0';
    return lives;
}

mu_result runs_find(int *domain)
{
    char folder[PATH_MAX];
    char name[128];
    char buffer[2048];
    struct mu_text list;
    int found = 0;
    *domain = 0;
    mu_text_init(&list, buffer, sizeof buffer);
    if (!runs_folder(folder, sizeof folder)) {
        return MU_OK;
    }
    for (int d = 0; d <= 230; d++) {
        if (domain_lives(folder, d, name, sizeof name)) {
            found++;
            *domain = d;
            mu_text_format(&list, "  --domain %d  %s\n", d, name);
        }
    }
    if (found <= 1) {
        return MU_OK;
    }
    fprintf(stderr, "muster: several runs live; say which one:\n%s", buffer);
    return MU_EXISTS;
}
