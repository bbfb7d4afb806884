/* SPDX-License-Identifier: Apache-2.0 */
/* muster-replay: a recording on DDS again, for programs that look at runs. */
#include "core/clock.h"
#include "core/exits.h"
#include "core/log.h"
#include "core/network.h"
#include "core/options.h"
#include "core/signals.h"
#include "mcap/mcap.h"
#include "muster/limits.h"
#include "muster/memory.h"
#include "replay/channels.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* A reader that has been found has not yet found us. */
static const uint64_t SETTLE_NS = 300000000;
static const uint64_t DRAIN_NS = 5000000000;
static const uint64_t ROUND_NS = 5000000;

static struct {
    struct mu_network network;
    double rate, from_s, to_s, wait_s;
    bool loop, quiet, verbose;
    struct mu_option_list topics;
} set;

static struct mu_option option_table[] = {
    MU_NETWORK_OPTIONS(set.network),
    MU_REAL("rate", "R", set.rate, "times the recording's own time; 0: as fast as readers take it",
            .fallback = "1", .environment = "MUSTER_RATE", .max = 1e6),
    MU_NAMES("topics", "TOPIC", set.topics,
             "only these, with commas, or all (default: those that are for observers of a run, and "
             "those of other programs)"),
    MU_REAL("from", "S", set.from_s, "begin so many seconds after the first message",
            .fallback = "0", .max = 1e9),
    MU_REAL("to", "S", set.to_s, "end so many seconds after the first message; 0: at the last",
            .fallback = "0", .max = 1e9),
    MU_FLAG("loop", set.loop, "begin again at the end"),
    MU_REAL("wait", "S", set.wait_s, "begin when each topic has a reader, or after so many seconds",
            .fallback = "1", .max = 3600),
    MU_OPTION_QUIET(set.quiet),
    MU_OPTION_VERBOSE(set.verbose),
};

struct replay {
    struct bus bus;
    struct mcap_reader *file;
    struct channels channels;
    uint64_t from_ns, to_ns; /* of the recording */
    uint64_t messages, malformed;
};

static mu_result settings_parse(int argc, char **argv, const char **path)
{
    static struct mu_options options = {
        .program = "muster replay",
        .usage = "FILE [OPTION...]",
        .about = "Puts a recording back on DDS, in order, for monitors and tools to look at.",
        MU_OPTION_TABLE(option_table),
        .one = "recording",
        .example = "out/follow-1/run.mcap"};
    mu_result parsed = mu_options_parse(&options, argc, argv);
    if (parsed != MU_OK) {
        return parsed;
    }
    if (set.to_s > 0 && set.to_s <= set.from_s) {
        fprintf(stderr, "muster replay: --to %g: expected more than --from, %g\n", set.to_s,
                set.from_s);
        return MU_FAULT_USAGE;
    }
    *path = options.words[0];
    return MU_OK;
}

/* --- time ------------------------------------------------------------------------------------- */

static void sleep_ns(uint64_t ns)
{
    struct timespec t = {.tv_sec = (time_t)(ns / 1000000000u), .tv_nsec = (long)(ns % 1000000000u)};
    nanosleep(&t, NULL);
}

static void sleep_until(uint64_t due_ns)
{
    for (uint64_t now_ns = mu_clock_ns(); now_ns < due_ns && !mu_signal_came;
         now_ns = mu_clock_ns()) {
        sleep_ns(due_ns - now_ns < ROUND_NS ? due_ns - now_ns : ROUND_NS);
    }
}

static bool all_are_read(const struct replay *r)
{
    for (size_t i = 0; i < MU_RECORD_CHANNELS_MAX; i++) {
        if (r->channels.feeds[i] && bus_writer_matches(&r->channels.feeds[i]->out) == 0) {
            return false;
        }
    }
    return true;
}

static void readers_await(const struct replay *r)
{
    uint64_t until_ns = mu_clock_ns() + (uint64_t)(set.wait_s * 1e9);
    while (!all_are_read(r) && mu_clock_ns() < until_ns && !mu_signal_came) {
        sleep_ns(ROUND_NS);
    }
    sleep_until(mu_clock_ns() + SETTLE_NS);
}

/* --- the replay ------------------------------------------------------------------------------- */

/* Readers that do not keep up are waited for: nothing of a recording is to be lost. */
static mu_result message_write(struct replay *r, const struct mcap_message *m)
{
    mu_result written = MU_BUSY;
    while (!mu_signal_came && written == MU_BUSY) {
        written = channels_write(&r->channels, m);
        if (written == MU_BUSY) {
            sleep_ns(1000000);
        }
    }
    r->messages += written == MU_OK;
    r->malformed += written == MU_MALFORMED;
    return written < 0 ? written : MU_OK;
}

static mu_result replay_once(struct replay *r)
{
    struct mcap_message m;
    mu_result got;
    uint64_t began_ns = mu_clock_ns();
    mcap_reader_seek(r->file, r->from_ns, r->to_ns);
    while (!mu_signal_came && (got = mcap_reader_next(r->file, &m)) != MU_DONE) {
        MU_TRY(got);
        if (set.rate > 0) {
            double due_ns = (double)(m.log_ns - r->from_ns) / set.rate;
            sleep_until(began_ns + (uint64_t)fmin(due_ns, 1e18));
        }
        MU_TRY(message_write(r, &m));
    }
    return MU_OK;
}

static void feeds_drain(const struct replay *r)
{
    for (size_t i = 0; i < MU_RECORD_CHANNELS_MAX && !mu_signal_came; i++) {
        if (r->channels.feeds[i]) {
            (void)bus_drain(&r->channels.feeds[i]->out, (int64_t)DRAIN_NS);
        }
    }
}

static mu_result replay_live(struct replay *r)
{
    readers_await(r);
    do {
        MU_TRY(replay_once(r));
    } while (set.loop && !mu_signal_came && r->messages > 0);
    feeds_drain(r);
    return MU_OK;
}

static mu_result span_choose(struct replay *r, const char *path)
{
    uint64_t first_ns, last_ns;
    (void)mcap_reader_span(r->file, &first_ns, &last_ns);
    r->from_ns = first_ns + (uint64_t)(set.from_s * 1e9);
    r->to_ns = set.to_s > 0 ? first_ns + (uint64_t)(set.to_s * 1e9) : last_ns;
    if (r->from_ns > last_ns) {
        fprintf(stderr, "muster replay: --from %g: %s has %.1f s\n", set.from_s, path,
                (double)(last_ns - first_ns) * 1e-9);
        return MU_FAULT_USAGE;
    }
    return MU_OK;
}

static mu_result file_open(struct replay *r, const char *path)
{
    struct mu_fault fault;
    r->file = mcap_reader_create();
    if (mcap_reader_open(r->file, path, &fault) != MU_OK) {
        mu_fault_print(&fault);
        return MU_FAULT_FILE;
    }
    if (!mcap_reader_whole(r->file)) {
        fprintf(stderr, "muster replay: %s has no end; it is replayed as far as it goes\n", path);
    }
    return span_choose(r, path);
}

static int network_open(struct replay *r)
{
    mu_result opened = bus_join(&r->bus, &set.network, BUS_SIMULATOR, "replay");
    if (opened == MU_BUSY) {
        fprintf(stderr,
                "muster replay: a simulator or another replay is in domain %d; choose "
                "another one with --domain\n",
                (int)set.network.domain);
        return MU_EXIT_DDS;
    }
    r->channels.bus = &r->bus;
    r->channels.file = r->file;
    r->channels.topics = &set.topics;
    if (opened != MU_OK || channels_open(&r->channels) != MU_OK) {
        return MU_EXIT_NETWORK;
    }
    return MU_EXIT_DONE;
}

static int result_print(const struct replay *r)
{
    uint64_t bad = r->malformed + mcap_reader_broken(r->file);
    if (bad > 0) {
        fprintf(stderr, "muster replay: %" PRIu64 " messages or chunks are damaged\n", bad);
    }
    if (!set.quiet) {
        printf("%" PRIu64 " messages of %zu topics\n", r->messages, r->channels.count);
    }
    return mu_signal_came ? MU_EXIT_INTERRUPTED : bad > 0 ? MU_EXIT_FILE : MU_EXIT_DONE;
}

int main(int argc, char **argv)
{
    const char *path;
    mu_result parsed = settings_parse(argc, argv, &path);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    mu_log_open("replay", set.verbose ? MU_LOG_INFO : MU_LOG_WARNING);
    struct replay *r = mu_startup_alloc(sizeof *r);
    mu_result opened = file_open(r, path);
    if (opened != MU_OK) {
        return mu_exit_for(opened);
    }
    int code = network_open(r);
    if (code != MU_EXIT_DONE) {
        return code;
    }
    if (r->channels.count == 0) {
        fprintf(stderr, "muster replay: nothing in %s is to be replayed; --topics names what is\n",
                path);
        return MU_EXIT_FILE;
    }
    mu_signals_note();
    mu_memory_seal();
    mu_result lived = replay_live(r);
    bus_close(&r->bus);
    return lived < 0 ? mu_exit_for(lived) : result_print(r);
}
