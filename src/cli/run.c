/* SPDX-License-Identifier: Apache-2.0 */
/* muster run: one run of an experiment, or a series. */
#include "run/run.h"
#include "cli/verbs.h"
#include "core/exits.h"
#include "core/options.h"
#include "muster/memory.h"
#include "operator/operator.h"

#include <stdio.h>
#include <string.h>

/* A negative number: nothing was said. */
static struct run_options chosen = {.seed = -1, .domain = -1, .duration_s = -1.0};
static struct mu_option_list chosen_set;
static const char *chosen_seeds;

static struct mu_option option_table[] = {
    MU_INTEGER("seed", "N", chosen.seed, "seed of the run (default: the file's, else 1)",
               .environment = "MUSTER_SEED", .max = 1e15),
    MU_STRING(
        "seeds", "N..M", chosen_seeds,
        "a run for each of these seeds, such as 1..30 or 1,3,7..9, with a report each; at the "
        "end a table of means with 95 % intervals"),
    MU_INTEGER("jobs", "N", chosen.jobs,
               "with --seeds: so many runs at once; 0: one for each processor", .fallback = "0",
               .max = 64),
    MU_REAL("duration", "S", chosen.duration_s, "simulated seconds (default: the file's)",
            .min = 0.02, .max = 1e6),
    MU_REAL("rate", "R", chosen.rate, "times real time; 0: as fast as it goes", .fallback = "0",
            .environment = "MUSTER_RATE", .max = 1e6),
    MU_FLAG("watch", chosen.watch,
            "open the live page in a browser, or say its address; the rate is 1 unless it is said"),
    MU_FLAG("free", chosen.free, "real time without lock step"),
    MU_LIST("set", "KEY=VALUE", chosen_set,
            "override a value of the file, for example robots.red.rules=x.clp"),
    MU_STRING(
        "out", "DIR", chosen.out,
        "folder of the report (default: out/EXPERIMENT-SEED); with --seeds, where the folders "
        "go (default: out)"),
    MU_STRING("record", "none|run|full", chosen.record,
              "what run.mcap has: nothing; poses, commands and mails; what robots sensed and "
              "thought, too (default: full to 64 "
              "robots, run beyond)",
              .environment = "MUSTER_RECORD"),
    MU_FLAG("no-diary", chosen.no_diary, "leave what goes on in minds out of the recording"),
    MU_STRING("inputs", "FILE", chosen.inputs,
              "put in again what came into a recorded run from outside, each at its step"),
    MU_STRING("root", "DIR", chosen.root, "let absolute paths in the experiment start here"),
    MU_FLAG("programs", chosen.programs,
            "start the programs, too, that the experiment names as monitors"),
    MU_INTEGER("domain", "D", chosen.domain, "DDS domain (default: a free one)",
               .environment = "MUSTER_DOMAIN", .max = 230),
    MU_STRING("local", "on|off", chosen.local,
              "sockets beside DDS between processes of one host (default: on)",
              .environment = LOCAL_ENVIRONMENT),
    MU_REAL("limit", "S", chosen.limit_s,
            "end the run after this much wall time, with exit code 124, and let its processes take "
            "so long to begin; 0: never, and 20 s",
            .fallback = "0", .max = 1e9),
    MU_FLAG("no-spread", chosen.no_spread,
            "let the system move processes between processors; as fast as possible, each "
            "stays on one"),
    MU_FLAG("quiet", chosen.quiet, "say only what came out, without a line for each agent",
            .letter = 'q'),
    MU_FLAG("json", chosen.json, "say it as one line of JSON"),
};

static mu_result seeds_parse(void)
{
    static uint64_t seeds[SERIES_RUNS_MAX];
    chosen.seeds = seeds;
    chosen.seeds_count = series_seeds(chosen_seeds, seeds);
    if (chosen.seeds_count == 0) {
        fprintf(stderr,
                "muster run: --seeds %s: expected 1 to %d different seeds, such as 1..30 or "
                "1,3,7..9\n",
                chosen_seeds, SERIES_RUNS_MAX);
        return MU_FAULT_USAGE;
    }
    return MU_OK;
}

static mu_result options_parse(struct run_options *out, int argc, char **argv)
{
    static struct mu_options options = {
        .program = "muster run",
        .usage = "FILE [OPTION...]",
        .about = "Runs an experiment with all its processes and leaves a report.",
        MU_OPTION_TABLE(option_table),
        .one = "experiment file",
        .example = "experiments/follow.yaml"};
    mu_result parsed = mu_options_parse(&options, argc, argv);
    if (parsed != MU_OK) {
        return parsed;
    }
    if (chosen.record && strcmp(chosen.record, "none") != 0 && strcmp(chosen.record, "run") != 0 &&
        strcmp(chosen.record, "full") != 0) {
        fprintf(stderr, "muster run: --record %s: expected none, run or full\n", chosen.record);
        return MU_FAULT_USAGE;
    }
    if (chosen.watch && chosen_seeds) {
        fputs("muster run: --watch is for one run, and --seeds for several\n", stderr);
        return MU_FAULT_USAGE;
    }
    if (chosen.watch && !chosen.free &&
        mu_options_find(&options, "rate")->source == MU_OPTION_DEFAULT) {
        chosen.rate = 1.0;
    }
    chosen.file = options.words[0];
    chosen.set = chosen_set.items;
    chosen.set_count = chosen_set.count;
    parsed = chosen_seeds ? seeds_parse() : MU_OK;
    *out = chosen;
    return parsed;
}

int run_verb(int argc, char **argv)
{
    struct run *r = mu_startup_alloc(sizeof *r);
    mu_result ready = options_parse(&r->options, argc, argv);
    ready = ready == MU_OK ? run_prepare(r) : ready;
    if (ready != MU_OK) {
        return mu_exit_for(ready);
    }
    supervise_signals_note();
    return r->options.seeds_count > 0 ? series_run(&r->options, r->experiment) : run_live(r);
}
