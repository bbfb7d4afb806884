/* SPDX-License-Identifier: Apache-2.0 */
/* muster doctor: what muster needs of this machine, where each value comes from, and the cure. */
#include "cli/help/doctor.h"
#include "bus/bus.h"
#include "cli/help/help.h"
#include "core/exits.h"
#include "core/json.h"
#include "core/paths.h"
#include "muster/version.h"
#include "operator/operator.h"

#include <gnu/libc-version.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

enum { FILES_NEEDED = 256, BUFFER_NEEDED = 200000 };

static const char *const state_texts[] = {
    [DOCTOR_GOOD] = "ok", [DOCTOR_WARNING] = "warning", [DOCTOR_WRONG] = "wrong"};

static struct {
    struct mu_network network;
    bool json;
} set = {.network.domain = -1};

static struct mu_option option_table[] = {MU_NETWORK_OPTIONS(set.network),
                                          MU_FLAG("json", set.json, "one object a line")};

static struct mu_options options = {
    .program = "muster doctor",
    .usage = "[OPTION...]",
    .about = "Looks for what may keep muster from running on this machine: network, ports, limits, "
             "processes that were left, files and versions.  A line for each, with its cure.",
    MU_OPTION_TABLE(option_table),
    .no_words = true};

/* The smallest exit code of what is wrong; 0: nothing is. */
static int worst = MU_EXIT_DONE;

static void finding_print(const struct doctor_finding *f)
{
    if (f->state == DOCTOR_WRONG && (worst == MU_EXIT_DONE || f->code < worst)) {
        worst = f->code;
    }
    if (!set.json) {
        printf("%-8s %-14s %s", state_texts[f->state], f->check, f->found);
        printf(f->from[0] ? " (from %s)\n" : "%s\n", f->from);
        if (f->state != DOCTOR_GOOD) {
            printf("%-8s %-14s cure: %s\n", "", "", f->cure);
        }
        return;
    }
    struct mu_json j = mu_json_line(stdout);
    mu_json_string(&j, "check", f->check);
    mu_json_string(&j, "state", state_texts[f->state]);
    mu_json_string(&j, "found", f->found);
    if (f->from[0]) {
        mu_json_string(&j, "from", f->from);
    }
    if (f->state != DOCTOR_GOOD) {
        mu_json_string(&j, "cure", f->cure);
    }
    mu_json_end(&j);
}

/* Where the value of an option was set. */
static const char *origin(const char *name)
{
    const struct mu_option *o = mu_options_find(&options, name);
    return o->place[0] ? o->place : o->source == MU_OPTION_COMMAND_LINE ? "the option" : "default";
}

static void domain_check(struct doctor_finding *f, int *domain)
{
    char name[RUNS_NAME_MAX + 1];
    int live = 0;
    f->check = "domain";
    if (set.network.domain >= 0) {
        *domain = (int)set.network.domain;
        snprintf(f->found, sizeof f->found, "%d", *domain);
        f->from = origin("domain");
        return;
    }
    unsigned count = runs_list(NULL, &live);
    if (count > 1) {
        f->state = DOCTOR_WARNING;
        snprintf(f->found, sizeof f->found, "%u runs live, so verbs do not know which is meant",
                 count);
        snprintf(f->cure, sizeof f->cure, "say --domain D, or export MUSTER_DOMAIN=%d", live);
    } else if (count == 1 && runs_next(&live, name)) {
        snprintf(f->found, sizeof f->found, "%d, of the run %s", live, name);
        f->from = "the one live run";
    } else {
        snprintf(f->found, sizeof f->found, "0; each run takes a free one");
        f->from = "default";
    }
    *domain = count == 1 ? live : 0;
}

static void configuration_check(struct doctor_finding *f)
{
    f->check = "configuration";
    const char *uri = getenv("CYCLONEDDS_URI");
    if (uri && uri[0]) {
        f->state = DOCTOR_WARNING;
        snprintf(f->found, sizeof f->found, "CYCLONEDDS_URI is set and replaces muster's own");
        snprintf(f->cure, sizeof f->cure, "unset CYCLONEDDS_URI");
    } else {
        snprintf(f->found, sizeof f->found, "of DDS: muster's own");
    }
}

static void peers_check(struct doctor_finding *f)
{
    f->check = "peers";
    f->from = origin("peer");
    snprintf(f->found, sizeof f->found, "%zu other hosts%s%s", set.network.peers.count,
             set.network.peers.count > 0 ? ", the first is " : "",
             set.network.peers.count > 0 ? set.network.peers.items[0] : "");
    if (set.network.peers.count > 0 && !set.network.interface) {
        f->state = DOCTOR_WARNING;
        snprintf(f->cure, sizeof f->cure,
                 "say --interface ADDRESS, too: without it everything stays on loopback");
    }
}

/* Both ends of a connection have the name of the reader's socket, but the writer's is not shown. */
static void sockets_check(struct doctor_finding *f)
{
    char line[512];
    unsigned connected = 0;
    FILE *sockets = fopen("/proc/net/unix", "re");
    f->check = "sockets";
    f->from = origin("local");
    while (sockets && fgets(line, sizeof line, sockets)) {
        connected += strstr(line, " 0001 03 ") && strstr(line, " @mulocal1");
    }
    if (sockets) {
        fclose(sockets);
    }
    const char *local = set.network.local ? set.network.local : "on";
    bool off = strcmp(local, "off") == 0;
    if (!off && strcmp(local, "on") != 0) {
        f->state = DOCTOR_WRONG;
        f->code = MU_EXIT_USAGE;
        snprintf(f->found, sizeof f->found, "'%.100s' says neither on nor off", local);
        snprintf(f->cure, sizeof f->cure, "--local on, or MUSTER_LOCAL=on; or off");
        return;
    }
    snprintf(f->found, sizeof f->found, "%s; %u connections between processes of this host",
             off ? "off: all goes by DDS" : "on, beside DDS", connected);
}

static void files_check(struct doctor_finding *f)
{
    struct rlimit limit = {0};
    getrlimit(RLIMIT_NOFILE, &limit);
    f->check = "open files";
    f->code = MU_EXIT_CRASH;
    snprintf(f->found, sizeof f->found, "%llu at a time", (unsigned long long)limit.rlim_cur);
    if (limit.rlim_cur < FILES_NEEDED) {
        f->state = DOCTOR_WRONG;
        snprintf(f->cure, sizeof f->cure, "ulimit -n 1024");
    }
}

static void processes_check(struct doctor_finding *f)
{
    struct rlimit limit = {0};
    getrlimit(RLIMIT_NPROC, &limit);
    f->check = "processes";
    if (limit.rlim_cur == RLIM_INFINITY) {
        snprintf(f->found, sizeof f->found, "no limit");
        return;
    }
    snprintf(f->found, sizeof f->found, "%llu of this user", (unsigned long long)limit.rlim_cur);
    if (limit.rlim_cur < FILES_NEEDED) {
        f->state = DOCTOR_WARNING;
        snprintf(f->cure, sizeof f->cure, "ulimit -u 4096: a process of a run has about 8 threads");
    }
}

static void buffer_check(struct doctor_finding *f)
{
    long bytes = 0;
    f->check = "receive buffer";
    if (!doctor_number("/proc/sys/net/core/rmem_max", "", &bytes)) {
        snprintf(f->found, sizeof f->found, "the system does not tell");
        return;
    }
    snprintf(f->found, sizeof f->found, "%ld bytes at most for a socket", bytes);
    if (bytes < BUFFER_NEEDED) {
        f->state = DOCTOR_WARNING;
        snprintf(f->cure, sizeof f->cure, "sudo sysctl net.core.rmem_max=4194304");
    }
}

static void memory_check(struct doctor_finding *f)
{
    long kib = 0;
    f->check = "memory";
    if (!doctor_number("/proc/meminfo", "MemAvailable:", &kib)) {
        snprintf(f->found, sizeof f->found, "the system does not tell");
        return;
    }
    snprintf(f->found, sizeof f->found, "%ld MiB available", kib / 1024);
    if (kib < 200L * 1024) {
        f->state = DOCTOR_WARNING;
        snprintf(f->cure, sizeof f->cure, "end other programs: a small run takes 200 MiB");
    }
}

static void folder_check(struct doctor_finding *f)
{
    f->check = "folder";
    f->code = MU_EXIT_WRITE;
    if (access(".", W_OK | X_OK) == 0) {
        snprintf(f->found, sizeof f->found, "reports go to out/ in this folder");
    } else {
        f->state = DOCTOR_WRONG;
        snprintf(f->found, sizeof f->found, "this folder cannot be written; reports go to out/");
        snprintf(f->cure, sizeof f->cure, "cd to another folder, or muster run FILE --out DIR");
    }
}

static void programs_check(struct doctor_finding *f)
{
    static const char *const programs[] = {"broker", "sim",    "robot", "host",
                                           "record", "replay", "web",   "monitor"};
    char name[64], path[PATH_MAX];
    f->check = "programs";
    f->code = MU_EXIT_FILE;
    for (size_t i = 0; i < sizeof programs / sizeof programs[0]; i++) {
        snprintf(name, sizeof name, "muster-%s", programs[i]);
        if (!mu_path_program(path, sizeof path, name) || access(path, X_OK) != 0) {
            f->state = DOCTOR_WRONG;
            snprintf(f->found, sizeof f->found, "%s is not beside muster", name);
            snprintf(f->cure, sizeof f->cure, "make, or make install: programs stand in a folder");
            return;
        }
    }
    snprintf(f->found, sizeof f->found, "all beside muster");
}

static void rules_check(struct doctor_finding *f)
{
    char path[PATH_MAX];
    f->check = "rules";
    f->code = MU_EXIT_FILE;
    f->from = getenv("MUSTER_RULES") ? "MUSTER_RULES" : "";
    if (mu_path_rules(path, sizeof path)) {
        snprintf(f->found, sizeof f->found, "%.200s", path);
    } else {
        f->state = DOCTOR_WRONG;
        snprintf(f->found, sizeof f->found, "the shared rules are not found");
        snprintf(f->cure, sizeof f->cure,
                 "export MUSTER_RULES=FOLDER that has muster.clp, or unset it");
    }
}

static void versions_check(struct doctor_finding *f)
{
    struct utsname system = {0};
    uname(&system);
    f->check = "versions";
    snprintf(f->found, sizeof f->found, "muster %s, Cyclone DDS %s, glibc %s, Linux %.40s",
             MU_VERSION, bus_version(), gnu_get_libc_version(), system.release);
}

int doctor_verb(int argc, char **argv)
{
    static void (*const checks[])(struct doctor_finding * f) = {
        configuration_check, peers_check,  sockets_check, files_check,
        processes_check,     buffer_check, memory_check,  folder_check,
        programs_check,      rules_check,  versions_check};
    mu_result parsed = mu_options_parse(&options, argc, argv);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    int domain = 0;
    struct doctor_finding f = {.from = ""};
    domain_check(&f, &domain);
    finding_print(&f);
    for (enum doctor_step step = 0; step < DOCTOR_STEPS; step++) {
        f = (struct doctor_finding){.from = ""};
        doctor_network(step, set.network.interface, origin("interface"), domain, &f);
        finding_print(&f);
    }
    for (size_t i = 0; i < sizeof checks / sizeof checks[0]; i++) {
        f = (struct doctor_finding){.from = ""};
        checks[i](&f);
        finding_print(&f);
    }
    return worst;
}
