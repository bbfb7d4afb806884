/* SPDX-License-Identifier: Apache-2.0 */
/* muster-web: the live page of a run, for browsers on this machine. */
#include "core/clock.h"
#include "core/exits.h"
#include "core/log.h"
#include "core/network.h"
#include "core/options.h"
#include "core/signals.h"
#include "muster/memory.h"
#include "operator/operator.h"
#include "runtime/join.h"
#include "runtime/process.h"
#include "web/web.h"

#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>

/* Heartbeats go out from our loop. */
enum { ROUND_MS = 50 };

struct settings {
    struct mu_network network;
    int64_t port;
    bool read_only, open, verbose;
    const char *recording; /* NULL: a run is shown */
};

struct web {
    mu_process *process; /* NULL: a recording is shown */
    struct past past;
    struct guard guard;
    struct board board;
    struct viewers viewers;
    struct consoles *consoles;
    struct hands hands;
    struct watch watch;
    struct server *server;
};

static mu_result settings_parse(struct settings *set, int argc, char **argv)
{
    struct mu_option table[] = {
        MU_JOIN_OPTIONS(set->network),
        MU_INTEGER("port", "N", set->port, "listen on this port of 127.0.0.1; 0: on any free one",
                   .letter = 'p', .fallback = "8642", .environment = "MUSTER_WEB_PORT",
                   .max = 65535),
        MU_FLAG("open", set->open, "open the page in a browser: $BROWSER, else by xdg-open"),
        MU_FLAG("read-only", set->read_only, "the page only shows, also to a user with the token"),
        MU_OPTION_VERBOSE(set->verbose),
    };
    static struct mu_options options;
    options = (struct mu_options){
        .program = "muster web",
        .usage = "[OPTION...] [RECORDING]",
        .about = "Shows a run in a browser on this machine: the world, robots, mail, statistics, "
                 "a console for each robot.  Prints the page's address, with the token that "
                 "is needed to act.  A recording is shown with a slider over its time.",
        MU_OPTION_TABLE(table)};
    set->network.domain = -1;
    mu_result parsed = mu_options_parse(&options, argc, argv);
    if (parsed == MU_OK && options.words_count > 1) {
        fprintf(stderr, "muster web: expected options and one recording at most\n");
        return MU_FAULT_USAGE;
    }
    set->recording = parsed == MU_OK && options.words_count == 1 ? options.words[0] : NULL;
    return parsed;
}

/* @return MU_OK, or MU_FAULT_OS: there is no randomness */
static mu_result secrets_make(struct web *w, bool read_only)
{
    uint8_t token[GUARD_TOKEN_DIGITS / 2];
    uint64_t seed;
    if (getrandom(token, sizeof token, 0) != sizeof token ||
        getrandom(&seed, sizeof seed, 0) != sizeof seed) {
        return MU_FAULT_OS;
    }
    guard_init(&w->guard, token, read_only);
    viewers_init(&w->viewers, seed);
    return MU_OK;
}

/* The run's, if none was named.  @return whether there is one that it can be */
static bool domain_choose(struct settings *set)
{
    int domain = (int)set->network.domain;
    bool chosen = set->recording || domain >= 0 || runs_find(&domain) == MU_OK;
    set->network.domain = domain;
    return chosen;
}

static mu_result network_join(struct web *w, struct settings *set)
{
    struct mu_process_options options = join_options(&set->network, "web");
    MU_TRY(mu_process_open(&w->process, &options));
    MU_TRY(watch_open(&w->watch, w->process, options.domain, &w->board));
    w->consoles = consoles_open(w->process, &w->viewers);
    return hands_open(&w->hands, &w->process->bus, &w->viewers, &w->watch);
}

static mu_result recording_show(struct web *w, const char *path)
{
    struct mu_fault fault;
    mu_result opened = past_open(&w->past, path, &fault);
    if (opened != MU_OK) {
        mu_fault_print(&fault);
        return opened;
    }
    past_show(&w->past, &w->board);
    return MU_OK;
}

/* @return the exit code, explained */
static int page_open(struct web *w, const struct settings *set)
{
    struct server_parts parts = {.guard = &w->guard,
                                 .board = &w->board,
                                 .viewers = &w->viewers,
                                 .consoles = w->consoles,
                                 .hands = &w->hands,
                                 .past = set->recording ? &w->past : NULL,
                                 .domain = (int)set->network.domain};
    mu_result opened = server_open(&w->server, &parts, (uint16_t)set->port);
    if (opened == MU_BUSY) {
        fprintf(stderr, "muster web: port %d is taken; --port 0 takes a free one\n",
                (int)set->port);
        return MU_EXIT_DDS;
    }
    if (opened != MU_OK) {
        return mu_exit_for(opened);
    }
    char address[64 + GUARD_TOKEN_DIGITS];
    snprintf(address, sizeof address, "http://127.0.0.1:%u/%s%s", (unsigned)server_port(w->server),
             w->guard.read_only ? "" : "#token=", w->guard.read_only ? "" : w->guard.token);
    puts(address);
    fflush(stdout);
    if (set->open) {
        browser_open(address);
    }
    return MU_EXIT_DONE;
}

static void round_wait(const struct web *w)
{
    int wake_fd = w->process ? mu_process_wake_fd(w->process) : -1;
    struct pollfd fds[] = {{.fd = server_fd(w->server), .events = POLLIN},
                           {.fd = wake_fd, .events = POLLIN}};
    int server_ms = server_timeout_ms(w->server);
    (void)poll(fds, 2, server_ms >= 0 && server_ms < ROUND_MS ? server_ms : ROUND_MS);
}

static mu_result run_round(struct web *w)
{
    mu_result spun = mu_process_spin(w->process, 0);
    watch_round(&w->watch, mu_clock_ns());
    consoles_round(w->consoles);
    hands_round(&w->hands, mu_clock_ns());
    return spun;
}

static void sources_close(struct web *w)
{
    if (w->process) {
        mu_process_close(w->process);
    } else {
        past_close(&w->past);
    }
}

/* @return the exit code */
static int web_run(struct web *w)
{
    mu_result spun = MU_OK;
    while (!mu_signal_came && spun >= 0) {
        round_wait(w);
        spun = w->process ? run_round(w) : MU_OK;
        server_run(w->server, mu_clock_ns());
    }
    return spun < 0 ? mu_exit_for(spun) : MU_EXIT_DONE;
}

int main(int argc, char **argv)
{
    static struct settings set;
    static struct web w;
    mu_result ready = settings_parse(&set, argc, argv);
    if (ready != MU_OK) {
        return mu_exit_for(ready);
    }
    mu_log_open("web", set.verbose ? MU_LOG_INFO : MU_LOG_WARNING);
    if (!domain_choose(&set)) {
        return MU_EXIT_SEVERAL;
    }
    board_init(&w.board);
    ready = secrets_make(&w, set.read_only || set.recording);
    if (ready == MU_OK) {
        ready = set.recording ? recording_show(&w, set.recording) : network_join(&w, &set);
    }
    if (ready != MU_OK) {
        return mu_exit_for(ready);
    }
    mu_signals_note();
    signal(SIGPIPE, SIG_IGN);
    int code = page_open(&w, &set);
    if (code == MU_EXIT_DONE) {
        mu_memory_seal();
        code = web_run(&w);
        server_close(w.server);
        browser_close();
    }
    sources_close(&w);
    return code;
}
