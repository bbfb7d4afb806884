/* SPDX-License-Identifier: Apache-2.0 */
/* muster-sim: one world, its physics and senses, and the clock of the run. */
#include "core/exits.h"
#include "core/log.h"
#include "core/network.h"
#include "core/options.h"
#include "core/signals.h"
#include "core/text.h"
#include "muster/memory.h"
#include "sim/record/record.h"
#include "sim/session/session.h"
#include "world/world_load.h"

#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct settings {
    struct mu_network network;
    int64_t seed;
    double duration_s, rate, step_ms, silence_s, return_s;
    int64_t watchers, hosts, threads;
    bool free, waits_for_go, verbose;
    const char *csv, *restore, *events, *record, *saves;
    bool without_percepts;
    struct mu_option_list files;      /* "NAME=PATH" */
    struct mu_option_list notes;      /* "KEY=VALUE" */
    struct mu_option_list conditions; /* that go into events */
    struct mu_option_list robots;     /* names; none: all of the world */
    struct mu_option_list agents;     /* names of those without a body */
    struct mu_option_list places;     /* "NAME BODY X Y DEG COLOR", - for what is not said */
};

static struct settings set;

static struct mu_option option_table[] = {
    MU_JOIN_OPTIONS(set.network),
    MU_INTEGER("seed", "N", set.seed, "seed of the run", .fallback = "1",
               .environment = "MUSTER_SEED"),
    MU_REAL("duration", "S", set.duration_s, "simulated seconds; 0: until stopped", .fallback = "0",
            .max = 1e9),
    MU_REAL("rate", "R", set.rate, "times real time; 0: as fast as it goes", .fallback = "0",
            .environment = "MUSTER_RATE", .max = 1e6),
    MU_REAL("step", "MS", set.step_ms,
            "length of a control step, a multiple of 20 (default: the world's, else 100)",
            .fallback = "0", .max = 10000),
    MU_REAL("silence", "S", set.silence_s, "wall time after which a silent controller ends the run",
            .fallback = "5", .min = 0.1, .max = 3600),
    MU_REAL("return", "S", set.return_s,
            "wall time that a lock step waits for a controller that died to be started again; 0: "
            "its death ends the run",
            .fallback = "0", .max = 3600),
    MU_FLAG("free", set.free, "real time without lock step"),
    MU_FLAG("wait", set.waits_for_go, "the first step waits for `muster run`"),
    MU_INTEGER("watchers", "N", set.watchers,
               "processes that see all bodies, such as resolvers, for which the first step waits",
               .fallback = "0", .max = MU_PROCESSES_MAX),
    MU_INTEGER("hosts", "N", set.hosts,
               "hosts that robots may move to, for which the first step waits", .fallback = "0",
               .max = MU_PROCESSES_MAX),
    MU_INTEGER("threads", "N", set.threads,
               "threads that read the sensors; of no use below 32 robots", .fallback = "1",
               .environment = "MUSTER_SIM_THREADS", .min = 1, .max = 64),
    MU_STRING("csv", "FILE", set.csv, "record tracks here"),
    MU_STRING("saves", "DIR", set.saves, "muster world save writes below this folder alone",
              .fallback = "."),
    MU_STRING("record", "FILE", set.record, "record the run here, as MCAP: docs/recording.md"),
    MU_FLAG("without-percepts", set.without_percepts, "leave out what the robots sensed"),
    MU_LIST("attach", "NAME=PATH", set.files,
            "put a file that the run was made of into the recording; == is = in its name"),
    MU_LIST("note", "KEY=VALUE", set.notes, "say something about the run in the recording"),
    MU_STRING("events", "FILE", set.events, "record here when each --event comes true"),
    MU_LIST("event", "CONDITION", set.conditions,
            "such as 'red stalled', 'red near blue 0.5', 'red told hello'"),
    MU_NAMES("robots", "NAME", set.robots,
             "robots that have a controller, with commas (default: all)"),
    MU_NAMES(
        "agents", "NAME", set.agents,
        "agents without a body that are part of the run, with commas; the first step waits for "
        "them"),
    MU_LIST("place", "'NAME BODY X Y DEG COLOR'", set.places,
            "put a robot into the world, or elsewhere; - for what the world says"),
    MU_STRING("restore", "FILE", set.restore,
              "let all bodies begin as muster world save found them, in the same world, with the "
              "same seed and step"),
    MU_OPTION_VERBOSE(set.verbose),
};

static mu_result settings_parse(int argc, char **argv, const char **world)
{
    static struct mu_options options = {
        .program = "muster sim",
        .usage = "WORLD [OPTION...]",
        .about = "Simulates the robots of a world file and keeps the clock of the run.",
        MU_OPTION_TABLE(option_table),
        .one = "world file",
        .example = "worlds/arena.world"};
    mu_result parsed = mu_options_parse(&options, argc, argv);
    if (parsed != MU_OK) {
        return parsed;
    }
    if (fmod(set.step_ms, 20.0) != 0.0) {
        fprintf(stderr, "muster sim: --step %g: expected a multiple of 20 ms\n", set.step_ms);
        return MU_FAULT_USAGE;
    }
    *world = options.words[0];
    return MU_OK;
}

static mu_result world_prepare(struct world *world, const char *path)
{
    struct mu_fault fault;
    struct world_options options = {.seed = (uint64_t)set.seed};
    mu_result loaded = world_open(world, path, &options, &fault);
    for (size_t i = 0; loaded == MU_OK && i < set.places.count; i++) {
        loaded = world_add_placed(world, set.places.items[i], &fault);
    }
    loaded = loaded == MU_OK ? world_check_places(world, NULL, &fault) : loaded;
    if (loaded != MU_OK) {
        mu_fault_print(&fault);
    }
    return loaded;
}

/* The starter of the simulator knows best, then the world. */
static uint64_t step_choose(const struct world *world)
{
    if (set.step_ms > 0) {
        return (uint64_t)llround(set.step_ms) * 1000000u;
    }
    return world->step_ns > 0 ? world->step_ns : MU_STEP_NS;
}

static mu_result robots_check(const struct world *world)
{
    for (size_t i = 0; i < set.robots.count; i++) {
        int body = record_find_body(world, set.robots.items[i]);
        if (body < 0 || (size_t)body >= world->robot_count) {
            fprintf(stderr, "muster sim: the world has no robot named %s\n", set.robots.items[i]);
            return MU_FAULT_USAGE;
        }
    }
    return MU_OK;
}

static int session_live(struct session *s)
{
    mu_result gathered = session_gather(s);
    if (gathered == MU_DONE) {
        return mu_signal_came ? MU_EXIT_INTERRUPTED : MU_EXIT_DONE;
    }
    if (gathered != MU_OK) {
        mu_network_missed(&set.network, "muster sim", (int)set.network.domain);
        return MU_EXIT_DDS;
    }
    mu_result ran = session_run(s);
    if (ran == MU_TIMEOUT) {
        fprintf(stderr, "muster sim: %s\n", session_waits_for(s));
        return MU_EXIT_CRASH;
    }
    return ran == MU_DONE ? MU_EXIT_INTERRUPTED : MU_EXIT_DONE;
}

/* What `muster run` says itself of its runs. */
static void hash_print(const struct session *s)
{
    if (!set.waits_for_go && !set.free && session_hash(s)[0]) {
        printf("hash   %s\n", session_hash(s));
    }
}

/* What the program is made of. */
struct simulator {
    struct bus bus;
    struct world *world;
    struct engine *engine;
    struct session *session;
    struct tracks *tracks;       /* NULL: no tracks are wanted */
    struct events *events;       /* NULL: no events are */
    struct mcap_file *recording; /* NULL: no recording is */
};

/* Ends what the run has written.  @return the exit code; a fault of the run counts more than one of
 * the disk */
static int records_close(struct simulator *sim, int code)
{
    bool tracks = !sim->tracks || tracks_close(sim->tracks) == MU_OK;
    bool events = !sim->events || events_close(sim->events) == MU_OK;
    bool run = !sim->recording || mcap_file_close(sim->recording) == MU_OK;
    bool counts = code == MU_EXIT_DONE || code == MU_EXIT_INTERRUPTED;
    return (tracks && events && run) || !counts ? code : MU_EXIT_WRITE;
}

static int engine_make(struct simulator *sim, uint64_t step_ns)
{
    struct engine_options options = {
        .seed = (uint64_t)set.seed, .step_ns = step_ns, .threads = (size_t)set.threads};
    sim->engine = engine_open(sim->world, &options);
    bool good = !set.restore || snapshot_file_restore(sim->engine, set.restore) == MU_OK;
    return good ? MU_EXIT_DONE : MU_EXIT_FILE;
}

/* The command by which the run was begun by hand. */
static const char *command_make(const struct simulator *sim)
{
    static char bytes[PATH_MAX + 128];
    struct mu_text t = mu_text_in(bytes, sizeof bytes);
    mu_text_format(&t, "muster sim %s --seed %" PRId64 " --duration %g", sim->world->file, set.seed,
                   set.duration_s);
    mu_text_add(&t, set.free ? " --free" : "");
    return t.at;
}

static int records_open(struct simulator *sim)
{
    struct mcap_file_options options = {.path = set.record,
                                        .world = sim->world,
                                        .files = &set.files,
                                        .notes = &set.notes,
                                        .places = &set.places,
                                        .without_percepts = set.without_percepts,
                                        .command = set.waits_for_go ? NULL : command_make(sim),
                                        .free = set.free,
                                        .seed = (uint64_t)set.seed,
                                        .duration_s = set.duration_s};
    const struct condition_names names = record_names(sim->world, &set.agents);
    mu_result events =
        set.events ? events_open(&sim->events, set.events, &set.conditions, &names) : MU_OK;
    if (events == MU_FAULT_USAGE) {
        return MU_EXIT_USAGE;
    }
    bool good = events == MU_OK && (!set.csv || tracks_open(&sim->tracks, set.csv) == MU_OK) &&
                (!set.record || mcap_file_open(&sim->recording, &options) == MU_OK);
    return good ? MU_EXIT_DONE : MU_EXIT_WRITE;
}

static int network_join(struct bus *bus)
{
    mu_result opened = bus_join(bus, &set.network, BUS_SIMULATOR, "simulator");
    if (opened == MU_BUSY) {
        fprintf(stderr, "muster sim: domain %d has a simulator already\n", (int)set.network.domain);
    }
    return mu_exit_for(opened);
}

static int session_make(struct simulator *sim, uint64_t step_ns)
{
    struct session_options options = {.world = sim->world,
                                      .engine = sim->engine,
                                      .bus = &sim->bus,
                                      .tracks = sim->tracks,
                                      .events = sim->events,
                                      .recording = sim->recording,
                                      .robots = &set.robots,
                                      .agents = &set.agents,
                                      .seed = (uint64_t)set.seed,
                                      .step_ns = step_ns,
                                      .broker = set.network.broker,
                                      .duration_ns = (uint64_t)llround(set.duration_s * 1e9),
                                      .rate = set.rate,
                                      .free = set.free,
                                      .waits_for_go = set.waits_for_go,
                                      .watchers = (uint32_t)set.watchers,
                                      .hosts = (uint32_t)set.hosts,
                                      .network = &set.network,
                                      .saves = open(set.saves, O_PATH | O_DIRECTORY | O_CLOEXEC),
                                      .signal_came = &mu_signal_came,
                                      .silence_ns = (uint64_t)(set.silence_s * 1e9),
                                      .return_ns = (uint64_t)(set.return_s * 1e9)};
    return session_open(&sim->session, &options) == MU_OK ? MU_EXIT_DONE : MU_EXIT_DDS;
}

static int simulator_make(struct simulator *sim)
{
    uint64_t step_ns = step_choose(sim->world);
    int code = engine_make(sim, step_ns);
    code = code == MU_EXIT_DONE ? records_open(sim) : code;
    code = code == MU_EXIT_DONE ? network_join(&sim->bus) : code;
    return code == MU_EXIT_DONE ? session_make(sim, step_ns) : code;
}

int main(int argc, char **argv)
{
    const char *path;
    static struct simulator sim;
    mu_result parsed = settings_parse(argc, argv, &path);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    mu_log_open("sim", set.verbose ? MU_LOG_INFO : MU_LOG_WARNING);
    sim.world = mu_startup_alloc(sizeof *sim.world);
    mu_result prepared = world_prepare(sim.world, path);
    prepared = prepared == MU_OK ? robots_check(sim.world) : prepared;
    if (prepared != MU_OK) {
        return mu_exit_for(prepared);
    }
    int code = simulator_make(&sim);
    if (code != MU_EXIT_DONE) {
        return code;
    }
    mu_signals_note();
    mu_memory_seal();
    code = records_close(&sim, session_live(sim.session));
    if (code == MU_EXIT_DONE || code == MU_EXIT_INTERRUPTED) {
        hash_print(sim.session);
    }
    bus_close(&sim.bus);
    return code;
}
