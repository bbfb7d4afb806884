/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"

#include "bus/bus.h"
#include "core/text.h"
#include "muster/limits.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <netinet/in.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { RUNS_RECENT_S = 600 };

/* @return whether a folder of ours alone is there now; errno says why not */
static bool folder_make(char *folder, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static bool folder_make(char *folder, size_t size, const char *format, ...)
{
    struct stat info;
    va_list args;
    va_start(args, format);
    int len = vsnprintf(folder, size, format, args);
    va_end(args);
    if (len < 0 || (size_t)len >= size) {
        errno = ENAMETOOLONG;
        return false;
    }
    if (mkdir(folder, 0700) != 0 && errno != EEXIST) {
        return false;
    }
    bool ours = lstat(folder, &info) == 0 && S_ISDIR(info.st_mode) && info.st_uid == getuid() &&
                (info.st_mode & 0022) == 0;
    errno = ours ? 0 : EPERM;
    return ours;
}

/* Names the folder of lock files and makes it: batch jobs and containers have an XDG_RUNTIME_DIR
 * that names no folder. */
static bool runs_folder(char *folder, size_t size)
{
    const char *runtime = getenv("XDG_RUNTIME_DIR");
    bool made = runtime && runtime[0] == '/' && folder_make(folder, size, "%s/muster", runtime);
    return made || folder_make(folder, size, "/tmp/muster-%u", (unsigned)getuid());
}

static int lock_open(const char *folder, int domain, int flags)
{
    char path[PATH_MAX];
    struct mu_text t = mu_text_in(path, sizeof path);
    mu_text_format(&t, "%s/domain-%d", folder, domain);
    return open(path, flags | O_CLOEXEC | O_NOFOLLOW, 0600);
}

/* @return a socket that has this port on loopback; < 0: another process has it */
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

/* The lock file is ours; does another user's broker or simulator use the ports:
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

/* Other users' lock files lie elsewhere, and their broker may not be up yet: a run holds a TCP port
 * of its domain, too, which DDS has no use for.  It comes before the look at the ports of
 * DDS: a look takes each for a moment, and a process there may want it just then.
 *
 * is_picked: of many; one that the user wants is not refused for a stranger's port.
 * @return whether no run is there; the TCP port is held for good then */
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

static int held = -1; /* our lock */

/* What it says is only for people; the lock is what counts. */
static void held_write(const char *format, ...) __attribute__((format(printf, 1, 2)));

static void held_write(const char *format, ...)
{
    char line[PATH_MAX + 256];
    va_list args;
    va_start(args, format);
    int len = vsnprintf(line, sizeof line, format, args);
    va_end(args);
    bool written = held >= 0 && len > 0 && (size_t)len < sizeof line && ftruncate(held, 0) == 0 &&
                   pwrite(held, line, (size_t)len, 0) == len;
    (void)written;
}

static mu_result domain_take(const char *folder, int domain, bool is_picked, const char *name)
{
    int fd = lock_open(folder, domain, O_RDWR | O_CREAT);
    bool locked = fd >= 0 && flock(fd, LOCK_EX | LOCK_NB) == 0;
    if (!locked || !ports_take(domain, is_picked)) {
        if (fd >= 0) {
            close(fd);
        }
        return locked ? MU_BUSY : MU_EXISTS;
    }
    held = fd; /* it stays open: the lock lives as long as we do */
    held_write("%.100s\n", name);
    return MU_OK;
}

mu_result runs_take(int wanted, const char *name, int *domain)
{
    char folder[PATH_MAX];
    if (!runs_folder(folder, sizeof folder)) {
        bool foreign = errno == EPERM;
        fprintf(stderr, "muster: cannot keep the list of runs in %s: %s\n", folder,
                foreign ? "it is another user's, or others may write to it" : strerror(errno));
        return MU_FAULT_OS;
    }
    int first = wanted >= 0 ? wanted : RUNS_DOMAIN_FIRST;
    int last = wanted >= 0 ? wanted : RUNS_DOMAIN_LAST;
    mu_result taken = MU_BUSY;
    for (*domain = first; *domain <= last; ++*domain) {
        taken = domain_take(folder, *domain, wanted < 0, name);
        if (taken == MU_OK) {
            break;
        }
    }
    return taken;
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

void runs_note(const char *name, const char *folder)
{
    char path[PATH_MAX];
    held_write("%.100s\n%s\n", name, realpath(folder, path) ? path : folder);
}

/* What the run in a domain has noted: its name, and its report's folder.
 * @return when; 0: nothing */
static time_t note_read(int domain, char *name, size_t size, char *report, size_t report_size)
{
    char folder[PATH_MAX], text[PATH_MAX + 256];
    struct stat info;
    int fd = runs_folder(folder, sizeof folder) ? lock_open(folder, domain, O_RDONLY) : -1;
    ssize_t len = fd >= 0 ? read(fd, text, sizeof text - 1) : 0;
    bool there = fd >= 0 && fstat(fd, &info) == 0;
    if (fd >= 0) {
        close(fd);
    }
    text[len > 0 ? len : 0] = '\0';
    char *second = strchr(text, '\n');
    if (!there || !second || !second[1]) {
        return 0;
    }
    *second++ = '\0';
    second[strcspn(second, "\n")] = '\0';
    return mu_text_copy(name, size, text) && mu_text_copy(report, report_size, second)
               ? info.st_mtime
               : 0;
}

bool runs_folder_of(int domain, char *folder, size_t size)
{
    char name[128];
    return note_read(domain, name, sizeof name, folder, size) != 0;
}

void runs_tell_last(const char *program, int domain)
{
    char name[128], report[PATH_MAX];
    int last = -1, lives;
    time_t last_s = time(NULL) - RUNS_RECENT_S;
    if (runs_list(NULL, &lives) > 0) {
        fprintf(stderr, "%s: runs that live:\n", program);
        (void)runs_list(stderr, &lives);
        return;
    }
    for (int d = domain < 0 ? 0 : domain; d <= (domain < 0 ? MU_DOMAIN_MAX : domain); d++) {
        time_t at_s = note_read(d, name, sizeof name, report, sizeof report);
        last = at_s > last_s ? d : last;
        last_s = at_s > last_s ? at_s : last_s;
    }
    if (last >= 0 && note_read(last, name, sizeof name, report, sizeof report)) {
        fprintf(stderr, "%s: the run %s ended %lld s ago; its report is in %s\n", program, name,
                (long long)(time(NULL) - last_s), report);
    } else {
        fprintf(stderr, "%s: a whole run starts with: muster run FILE\n", program);
    }
}

bool runs_next(int *domain, char name[RUNS_NAME_MAX + 1])
{
    char folder[PATH_MAX];
    bool found = false;
    bool listed = runs_folder(folder, sizeof folder);
    for (; listed && !found && *domain <= MU_DOMAIN_MAX; *domain += !found) {
        found = domain_lives(folder, *domain, name, RUNS_NAME_MAX + 1);
    }
    return found;
}

unsigned runs_list(FILE *to, int *domain)
{
    char name[RUNS_NAME_MAX + 1];
    unsigned found = 0;
    for (int d = 0; runs_next(&d, name); d++) {
        found++;
        *domain = d;
        if (to) {
            fprintf(to, "  --domain %d  %s\n", d, name);
        }
    }
    return found;
}

mu_result runs_find(int *domain)
{
    *domain = 0;
    if (runs_list(NULL, domain) <= 1) {
        return MU_OK;
    }
    fputs("muster: several runs live; say which one:\n", stderr);
    (void)runs_list(stderr, domain);
    return MU_EXISTS;
}
