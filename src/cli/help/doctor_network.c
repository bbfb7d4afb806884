/* SPDX-License-Identifier: Apache-2.0 */
/* Network, ports and processes, as muster doctor sees them. */
#include "cli/help/doctor.h"

#include "bus/bus.h"
#include "core/exits.h"
#include "core/text.h"
#include "muster/limits.h"
#include "operator/operator.h"

#include <arpa/inet.h>
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <net/if.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

/* Participants of a domain have an even port each, those from FIRST on are shared out. */
enum { PARTICIPANT_FIRST = 10, PARTICIPANTS = 109, PARTICIPANTS_MANY = 90, INDICES = 120 };

static bool port_used[65536]; /* by UDP sockets of this machine, of any user */

static void ports_read(void)
{
    char line[512];
    FILE *from = fopen("/proc/net/udp", "re");
    while (from && fgets(line, sizeof line, from)) {
        unsigned port;
        if (sscanf(line, " %*d: %*8X:%4X", &port) == 1) {
            port_used[port & 0xffff] = true;
        }
    }
    if (from) {
        fclose(from);
    }
}

static unsigned participants_count(int domain, int first, int last)
{
    unsigned count = 0;
    for (int index = first; index <= last; index++) {
        int port = bus_port(domain, index);
        count += port < 65536 && port_used[port];
    }
    return count;
}

unsigned doctor_brokers(int domain)
{
    ports_read();
    return participants_count(domain, 0, 0) + participants_count(domain, 2, 4);
}

static void interface_check(const char *interface, const char *from, struct doctor_finding *f)
{
    f->check = "interface";
    f->from = from;
    f->code = MU_EXIT_NETWORK;
    struct sockaddr_in address = {.sin_family = AF_INET};
    const char *shown = interface ? interface : "127.0.0.1";
    char device[IFNAMSIZ];
    bool valid = inet_pton(AF_INET, shown, &address.sin_addr) == 1;
    int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (bus_device_is_down(interface, device)) {
        f->state = DOCTOR_WRONG;
        snprintf(f->found, sizeof f->found, "%.100s: its device %s is down", shown, device);
        snprintf(f->cure, sizeof f->cure, "sudo ip link set %s up", device);
    } else if (valid && bind(fd, (const struct sockaddr *)&address, sizeof address) == 0) {
        snprintf(f->found, sizeof f->found, "%s%s", shown, interface ? "" : ", loopback alone");
    } else {
        f->state = DOCTOR_WRONG;
        snprintf(f->found, sizeof f->found, "%.100s: this machine has no such IPv4 address", shown);
        snprintf(f->cure, sizeof f->cure, "ip -4 -brief address lists those that it has");
    }
    close(fd);
}

/* A datagram to ourselves over the device lo.  @return whether it came */
static bool loopback_try(void)
{
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}};
    socklen_t len = sizeof address;
    const struct timeval patience = {.tv_usec = 500000};
    char byte = 0;
    int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    bool came = fd >= 0 && setsockopt(fd, SOL_SOCKET, SO_BINDTODEVICE, "lo", sizeof "lo") == 0 &&
                setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) == 0 &&
                bind(fd, (const struct sockaddr *)&address, sizeof address) == 0 &&
                getsockname(fd, (struct sockaddr *)&address, &len) == 0 &&
                sendto(fd, &byte, 1, 0, (const struct sockaddr *)&address, len) == 1 &&
                recv(fd, &byte, 1, 0) == 1;
    int fault = errno;
    if (fd >= 0) {
        close(fd);
    }
    errno = fault;
    return came;
}

static void loopback_check(struct doctor_finding *f)
{
    f->check = "loopback";
    f->code = MU_EXIT_NETWORK;
    if (loopback_try()) {
        snprintf(f->found, sizeof f->found, "a datagram arrives over the device lo");
    } else {
        f->state = DOCTOR_WRONG;
        snprintf(f->found, sizeof f->found, "no datagram arrives over the device lo: %s",
                 strerror(errno));
        snprintf(f->cure, sizeof f->cure,
                 "sudo ip link set lo up; Linux 5.7 or later is needed, and no filter on lo");
    }
}

static void domains_check(struct doctor_finding *f)
{
    char name[RUNS_NAME_MAX + 1];
    struct mu_text found = mu_text_in(f->found, sizeof f->found);
    unsigned used = 0;
    f->check = "domains";
    f->code = MU_EXIT_NETWORK;
    for (int domain = 0; domain <= RUNS_DOMAIN_LAST; domain++) {
        int live = domain;
        unsigned there = participants_count(domain, 0, INDICES - 1);
        used += there > 0;
        if (there > 0 && found.len < 200) {
            bool ours = runs_next(&live, name) && live == domain;
            mu_text_format(&found, "%s%d (%.40s)", used > 1 ? ", " : "in use: ", domain,
                           ours ? name : "not a run of yours");
        }
    }
    if (used == 0) {
        mu_text_add(&found, "none in use");
    }
    if (used > RUNS_DOMAIN_LAST - RUNS_DOMAIN_FIRST) {
        f->state = DOCTOR_WRONG;
        snprintf(f->cure, sizeof f->cure, "end a program that uses DDS: a run needs a free domain");
    }
}

static void range_check(int domain, struct doctor_finding *f)
{
    unsigned used =
        participants_count(domain, PARTICIPANT_FIRST, PARTICIPANT_FIRST + PARTICIPANTS - 1);
    f->check = "participants";
    snprintf(f->found, sizeof f->found, "%u of %d processes are in domain %d", used, PARTICIPANTS,
             domain);
    if (used >= PARTICIPANTS_MANY) {
        f->state = DOCTOR_WARNING;
        snprintf(f->cure, sizeof f->cure,
                 "put several robots into one process: count and processes of an experiment");
    }
}

/* @return the domain that a process was started with; 0: none was said */
static int process_domain(const char *pid)
{
    char path[64], text[4096];
    snprintf(path, sizeof path, "/proc/%.20s/cmdline", pid);
    FILE *from = fopen(path, "re");
    size_t len = from ? fread(text, 1, sizeof text - 1, from) : 0;
    if (from) {
        fclose(from);
    }
    text[len] = '\0';
    for (const char *word = text; word < text + len; word += strlen(word) + 1) {
        const char *value = word + strlen("--domain");
        if (strncmp(word, "--domain", strlen("--domain")) == 0) {
            value += *value == '=' || value + 1 < text + len;
            return (int)strtol(value, NULL, 10);
        }
    }
    return 0;
}

/* @return whether that is a process of this user that needs a broker, and has none */
static bool process_is_left(const char *pid)
{
    char path[64], name[32] = "";
    struct stat info;
    snprintf(path, sizeof path, "/proc/%.20s/comm", pid);
    FILE *from = isdigit((unsigned char)pid[0]) ? fopen(path, "re") : NULL;
    bool ours = from && fgets(name, sizeof name, from) && fstat(fileno(from), &info) == 0 &&
                info.st_uid == getuid();
    if (from) {
        fclose(from);
    }
    static const char *const kinds[] = {"muster-sim\n", "muster-robot\n", "muster-agent\n",
                                        "muster-host\n", "muster-resolver\n"};
    bool needs = false;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        needs = needs || strcmp(name, kinds[i]) == 0;
    }
    int domain = ours && needs ? process_domain(pid) : -1;
    return domain >= 0 && domain <= MU_DOMAIN_MAX && participants_count(domain, 0, 0) == 0 &&
           participants_count(domain, 2, 4) == 0;
}

static void left_check(struct doctor_finding *f)
{
    struct mu_text found = mu_text_in(f->found, sizeof f->found);
    struct mu_text cure = mu_text_in(f->cure, sizeof f->cure);
    const struct dirent *e;
    unsigned count = 0;
    DIR *folder = opendir("/proc");
    f->check = "left processes";
    mu_text_add(&cure, "start a broker in their domain, or kill");
    while (folder && (e = readdir(folder))) {
        if (process_is_left(e->d_name)) {
            count++;
            mu_text_format(&cure, " %.20s", e->d_name);
        }
    }
    if (folder) {
        closedir(folder);
    }
    f->state = count > 0 ? DOCTOR_WARNING : DOCTOR_GOOD;
    if (count > 0) {
        mu_text_format(&found, "%u processes of yours wait for a broker", count);
    } else {
        mu_text_add(&found, "none waits for a broker that has gone");
    }
}

void doctor_network(enum doctor_step step, const char *interface, const char *from, int domain,
                    struct doctor_finding *f)
{
    switch (step) {
    case DOCTOR_INTERFACE:
        ports_read();
        interface_check(interface, from, f);
        break;
    case DOCTOR_LOOPBACK: loopback_check(f); break;
    case DOCTOR_DOMAINS: domains_check(f); break;
    case DOCTOR_RANGE: range_check(domain, f); break;
    case DOCTOR_LEFT: left_check(f); break;
    case DOCTOR_STEPS: break;
    }
}

bool doctor_number(const char *path, const char *word, long *number)
{
    char line[256];
    bool found = false;
    FILE *from = fopen(path, "re");
    while (from && !found && fgets(line, sizeof line, from)) {
        found = strncmp(line, word, strlen(word)) == 0 &&
                sscanf(line + strlen(word), " %ld", number) == 1;
    }
    if (from) {
        fclose(from);
    }
    return found;
}
