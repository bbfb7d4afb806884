/* SPDX-License-Identifier: Apache-2.0 */
/* muster wait: until agents, a service, a broker, hosts or a run are there. */
#include "cli/verbs.h"
#include "core/clock.h"
#include "core/exits.h"
#include "core/text.h"
#include "operator/operator.h"
#include "runtime/process.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

enum { WAIT_ROUND_NS = 20000000, WAIT_FIND_NS = 1000000000 };

struct wait {
    struct operator_options options;
    const char *const *names;
    size_t names_count;
    const char *broker; /* "": any; NULL: none is waited for */
    bool run;
    int64_t hosts;
    const char *service;
    double timeout_s;
    uint64_t until_ns;
    struct operator op;
    struct bus_reader status;
    bool runs; /* a run has begun its steps */
};

static struct wait wait;

static struct mu_option wait_table[] = {
    MU_NETWORK_OPTIONS(wait.options.network),
    MU_STRING("broker", "[NAME]", wait.broker, "until a broker answers, or that of this name",
              .alone = ""),
    MU_INTEGER("hosts", "N", wait.hosts, "until so many hosts are there", .min = 0,
               .max = MU_PROCESSES_MAX),
    MU_FLAG("run", wait.run, "until a run has begun its steps"),
    MU_STRING("service", "QUERY", wait.service, "until an agent offers this, such as 'map hz>=1'"),
    MU_REAL("timeout", "S", wait.timeout_s, "wait no longer than this; then the exit code is 124",
            .fallback = "60", .min = 0, .max = 1e9)};

static bool is_late(const struct wait *w)
{
    return mu_clock_ns() >= w->until_ns;
}

/* A run that was just started may not live yet.  @return the exit code */
static int domain_find(struct wait *w)
{
    int domain = (int)w->options.network.domain;
    uint64_t began_ns = mu_clock_ns();
    const struct timespec round = {.tv_nsec = WAIT_ROUND_NS};
    while (domain < 0 && runs_list(NULL, &domain) == 0 && !is_late(w) &&
           (w->run || mu_clock_ns() - began_ns < WAIT_FIND_NS)) {
        nanosleep(&round, NULL);
    }
    if (domain < 0) {
        domain = 0;
    } else if (w->options.network.domain < 0 && runs_find(&domain) != MU_OK) {
        return MU_EXIT_SEVERAL;
    }
    w->options.network.domain = domain;
    return MU_EXIT_DONE;
}

static bool is_there(const struct wait *w, const char *name)
{
    const struct mu_member *m = mu_process_lookup(w->op.process, name);
    return m && m->state != MU_GONE;
}

static int64_t hosts_count(const struct wait *w)
{
    int64_t count = 0;
    const struct mu_member *m;
    for (size_t i = 0; (m = mu_process_member(w->op.process, i)); i++) {
        count += m->kind == MU_KIND_HOST && m->state != MU_GONE;
    }
    return count;
}

static void status_take(struct wait *w)
{
    enum bus_life life;
    const muster_RunStatus *s;
    while ((s = bus_next(&w->status, &life))) {
        w->runs = w->runs || (life == BUS_DATA && s->state == muster_RUN_RUNNING);
    }
}

/* Adds what is not there yet. */
static void missing_add(const struct wait *w, struct mu_text *out)
{
    if (w->hosts > hosts_count(w)) {
        mu_text_format(out, ", %lld of %lld hosts", (long long)(w->hosts - hosts_count(w)),
                       (long long)w->hosts);
    }
    if (w->run && !w->runs) {
        mu_text_add(out, ", a run that has begun");
    }
    if (w->service && !mu_process_find_service(w->op.process, w->service, 0)) {
        mu_text_format(out, ", the service %s", w->service);
    }
    for (size_t i = 0; i < w->names_count; i++) {
        if (!is_there(w, w->names[i])) {
            mu_text_format(out, ", %s", w->names[i]);
        }
    }
}

static int missing_tell(const struct wait *w, const char *missing)
{
    fprintf(stderr, "muster wait: not there after %g s: %s\n", w->timeout_s, missing);
    return MU_EXIT_TIME;
}

static int wait_for_all(struct wait *w)
{
    char bytes[1024];
    struct mu_text missing;
    if (w->run && bus_reader_open(&w->op.process->bus, BUS_RUN_STATUS, NULL, &w->status) != MU_OK) {
        return MU_EXIT_NETWORK;
    }
    for (;;) {
        mu_text_init(&missing, bytes, sizeof bytes);
        missing_add(w, &missing);
        if (missing.len == 0) {
            return MU_EXIT_DONE;
        }
        if (is_late(w)) {
            return missing_tell(w, missing.at + 2);
        }
        mu_result spun = mu_process_spin(w->op.process, WAIT_ROUND_NS);
        if (spun != MU_OK) {
            return mu_exit_for(spun);
        }
        if (w->run) {
            status_take(w);
        }
    }
}

int wait_verb(int argc, char **argv)
{
    static struct mu_options o = {
        .program = "muster wait",
        .usage = "[NAME...] [OPTION...]",
        .about =
            "Waits until agents are there, or a service, a broker, hosts or a run: for scripts.",
        MU_OPTION_TABLE(wait_table)};
    mu_result parsed = operator_parse(&o, argc, argv, &wait.options);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    wait.names = o.words;
    wait.names_count = o.words_count;
    if (wait.names_count == 0 && !wait.broker && !wait.run && wait.hosts == 0 && !wait.service) {
        fputs("muster wait: name agents, or --service, --broker, --hosts N or --run\n", stderr);
        return MU_EXIT_USAGE;
    }
    if (wait.service && !words_query_check("muster wait", wait.service)) {
        return MU_EXIT_USAGE;
    }
    for (size_t i = 0; i < wait.names_count; i++) {
        if (!words_name_check("muster wait", "an agent", wait.names[i])) {
            return MU_EXIT_USAGE;
        }
    }
    wait.until_ns = mu_clock_ns() + (uint64_t)(wait.timeout_s * 1e9);
    int code = domain_find(&wait);
    if (code != MU_EXIT_DONE) {
        return code;
    }
    uint64_t now_ns = mu_clock_ns();
    double left_s = now_ns < wait.until_ns ? (double)(wait.until_ns - now_ns) * 1e-9 : 0;
    wait.options.network.wait_broker_s = left_s > 0.001 ? left_s : 0.001;
    wait.options.network.wait_option = "timeout";
    wait.options.network.broker = wait.broker && wait.broker[0] ? wait.broker : NULL;
    wait.options.only_reads = true;
    code = operator_join(&wait.op, &wait.options, "wait");
    if (code == MU_EXIT_DDS) {
        return MU_EXIT_TIME;
    }
    if (code == MU_EXIT_DONE) {
        code = wait_for_all(&wait);
        operator_leave(&wait.op);
    }
    return code;
}
