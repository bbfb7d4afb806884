/* SPDX-License-Identifier: Apache-2.0 */
/* muster-record: what goes over topics, as bytes, into one file. */
#include "core/clock.h"
#include "core/exits.h"
#include "core/log.h"
#include "core/network.h"
#include "core/options.h"
#include "core/signals.h"
#include "core/text.h"
#include "muster/memory.h"
#include "record/tape.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const uint64_t LOOK_NS = 100000000;
static const struct timespec ROUND = {.tv_nsec = 2000000};

static struct {
    struct mu_network network;
    const char *out;
    double duration_s;
    bool all, quiet, verbose;
    const char *const *topics; /* none: all of ours */
    size_t topics_count;
} set = {.network = {.domain = -1}};

static struct mu_option option_table[] = {
    MU_NETWORK_OPTIONS(set.network),
    MU_STRING("out", "FILE", set.out, "the recording (default: record-DATE-TIME.mcap)",
              .letter = 'o'),
    MU_FLAG("all", set.all,
            "every topic in the domain, of whatever DDS program, not muster's alone",
            .letter = 'a'),
    MU_REAL("duration", "S", set.duration_s, "end after so many seconds; 0: until interrupted",
            .fallback = "0", .max = 1e9),
    MU_OPTION_QUIET(set.quiet),
    MU_OPTION_VERBOSE(set.verbose),
};

static bool is_wanted(const char *topic)
{
    for (size_t i = 0; i < set.topics_count; i++) {
        if (strcmp(set.topics[i], topic) == 0) {
            return true;
        }
    }
    return set.topics_count == 0 && set.all;
}

/* muster has looked which run lives; a domain that is named is meant. */
static void domain_choose(void)
{
    const char *live = getenv("MUSTER_LIVE_DOMAIN");
    if (set.network.domain < 0) {
        set.network.domain = live ? strtol(live, NULL, 10) : 0;
    }
}

static mu_result settings_parse(int argc, char **argv)
{
    static struct mu_options options = {
        .program = "muster record",
        .usage = "[TOPIC...] [OPTION...]",
        .about = "Records the topics of a domain until it is interrupted: those that are named, "
                 "or all of muster.",
        MU_OPTION_TABLE(option_table)};
    mu_result parsed = mu_options_parse(&options, argc, argv);
    set.topics = options.words;
    set.topics_count = options.words_count;
    domain_choose();
    return parsed;
}

static const char *path_choose(void)
{
    static char path[64];
    time_t now = time(NULL);
    struct tm local;
    if (set.out) {
        return set.out;
    }
    strftime(path, sizeof path, "record-%Y%m%d-%H%M%S.mcap", localtime_r(&now, &local));
    return path;
}

struct recorder {
    struct bus bus;
    struct tap_watch watch;
    struct tap taps[MU_RECORD_CHANNELS_MAX];
    size_t tap_count;
    struct tape *tape;
    uint64_t looked_ns;
};

static size_t samples_take(struct recorder *r)
{
    size_t count = 0;
    for (size_t i = 0; i < r->tap_count; i++) {
        count += tap_take(&r->taps[i], tape_take, r->tape);
    }
    return count;
}

/* @return whether the disk is in order */
static bool record_live(struct recorder *r)
{
    uint64_t until_ns =
        set.duration_s > 0 ? mu_clock_ns() + (uint64_t)(set.duration_s * 1e9) : UINT64_MAX;
    bool good = true;
    while (!mu_signal_came && good && mu_clock_ns() < until_ns) {
        bool looks = set.all || set.topics_count > 0; /* our topics are open already */
        if (looks && mu_clock_ns() - r->looked_ns >= LOOK_NS) {
            (void)samples_take(r); /* a tap that asks for less begins anew */
            r->tap_count =
                tap_watch_look(&r->watch, r->taps, r->tap_count, MU_RECORD_CHANNELS_MAX, is_wanted);
            r->looked_ns = mu_clock_ns();
        }
        if (samples_take(r) == 0) {
            nanosleep(&ROUND, NULL);
        }
        good = tape_look(r->tape);
    }
    (void)samples_take(r);
    return good;
}

static void result_print(const struct recorder *r, const char *path)
{
    if (r->tape->lost > 0) {
        fprintf(stderr,
                "muster record: %" PRIu64 " samples are not in the file: too long, or more "
                "topics than there is room for\n",
                r->tape->lost);
    }
    for (size_t i = 0; i < set.topics_count && r->tape->messages == 0; i++) {
        char shown[MU_TEXT_SHOWN];
        fprintf(stderr, "muster record: nothing of the topic %s in domain %d\n",
                mu_text_show(shown, set.topics[i]), (int)set.network.domain);
    }
    if (!set.quiet) {
        printf("%" PRIu64 " messages of %zu topics: %s\n", r->tape->messages, tape_topics(r->tape),
               path);
    }
}

static mu_result recorder_open(struct recorder *r)
{
    MU_TRY(bus_join(&r->bus, &set.network, BUS_OBSERVER, "recorder"));
    return tap_watch_open(&r->watch, &r->bus);
}

/* Our own topics are known before a process writes them, so that nothing is missed. */
static mu_result taps_open(struct recorder *r)
{
    bool ours = set.topics_count == 0 && !set.all;
    for (int i = 0; i < BUS_TOPICS; i++) {
        enum bus_topic topic = (enum bus_topic)i;
        if (ours || is_wanted(bus_topic_name(topic))) {
            MU_TRY(tap_open(&r->taps[r->tap_count++], &r->bus, topic));
        }
    }
    return MU_OK;
}

int main(int argc, char **argv)
{
    mu_result parsed = settings_parse(argc, argv);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    mu_log_open("record", set.verbose ? MU_LOG_INFO : MU_LOG_WARNING);
    struct recorder *r = mu_startup_alloc(sizeof *r);
    const char *path = path_choose();
    r->tape = tape_create();
    if (tape_open(r->tape, path, (int)set.network.domain) != MU_OK) {
        return MU_EXIT_WRITE;
    }
    if (recorder_open(r) != MU_OK || taps_open(r) != MU_OK) {
        return MU_EXIT_NETWORK;
    }
    mu_signals_note();
    mu_memory_seal();
    (void)record_live(r);
    bus_close(&r->bus);
    mu_result closed = tape_close(r->tape);
    result_print(r, path);
    return closed == MU_OK ? MU_EXIT_DONE : MU_EXIT_WRITE;
}
