/* SPDX-License-Identifier: Apache-2.0 */
/* muster run: one run of an experiment, or a series. */
#include "core/exits.h"
#include "core/options.h"
#include "ctl/run.h"
#include "ctl/series.h"
#include "ctl/verbs.h"
#include "muster/memory.h"

#include <stdio.h>
#include <string.h>

/* A negative number: nothing was said. */
static struct run_options chosen = {.seed = -1, .domain = -1, .duration_s = -1.0};
static struct mu_option_list chosen_set;
static const char *chosen_seeds;

static struct mu_option option_table[] = {
    {.name = "seed",
     .kind = MU_OPTION_INTEGER,
     .unit = "N",
     .environment = "MUSTER_SEED",
     .help = "seed of the run (default: the file's, else 1)",
     .target = &chosen.seed,
     .max = 1e15},
    {.name = "seeds",
     .kind = MU_OPTION_STRING,
     .unit = "N..M",
     .help = "a run for each of these seeds, such as 1..30 or 1,3,7..9, with a report each; at the "
             "end a table of means with 95 % intervals",
     .target = &chosen_seeds},
    {.name = "jobs",
     .kind = MU_OPTION_INTEGER,
     .unit = "N",
     .fallback = "0",
     .help = "with --seeds: so many runs at once; 0: one for each processor",
     .target = &chosen.jobs,
     .max = 64},
    {.name = "duration",
     .kind = MU_OPTION_REAL,
     .unit = "S",
     .help = "simulated seconds (default: the file's)",
     .target = &chosen.duration_s,
     .min = 0.02,
     .max = 1e6},
    {.name = "rate",
     .kind = MU_OPTION_REAL,
     .unit = "R",
     .fallback = "0",
     .environment = "MUSTER_RATE",
     .help = "times real time; 0: as fast as it goes",
     .target = &chosen.rate,
     .max = 1e6},
    {.name = "free",
     .kind = MU_OPTION_FLAG,
     .help = "real time without lock step",
     .target = &chosen.free},
    {.name = "set",
     .kind = MU_OPTION_LIST,
     .unit = "KEY=VALUE",
     .help = "override a value of the file, for example robots.red.rules=x.clp",
     .target = &chosen_set},
    {.name = "out",
     .kind = MU_OPTION_STRING,
     .unit = "DIR",
     .help = "folder of the report (default: out/EXPERIMENT-SEED); with --seeds, where the folders "
             "go (default: out)",
     .target = &chosen.out},
    {.name = "record",
     .kind = MU_OPTION_STRING,
     .unit = "none|run|full",
     .environment = "MUSTER_RECORD",
     .help = "what run.mcap has: nothing; poses, commands and mails; what robots sensed and "
             "thought, too (default: full to 64 "
             "robots, run beyond)",
     .target = &chosen.record},
    {.name = "no-diary",
     .kind = MU_OPTION_FLAG,
     .help = "leave what goes on in minds out of the recording",
     .target = &chosen.no_diary},
    {.name = "inputs",
     .kind = MU_OPTION_STRING,
     .unit = "FILE",
     .help = "put in again what came into a recorded run from outside, each at its step",
     .target = &chosen.inputs},
    {.name = "root",
     .kind = MU_OPTION_STRING,
     .unit = "DIR",
     .help = "let absolute paths in the experiment start here",
     .target = &chosen.root},
    {.name = "programs",
     .kind = MU_OPTION_FLAG,
     .help = "start the programs, too, that the experiment names as monitors",
     .target = &chosen.programs},
    {.name = "domain",
     .kind = MU_OPTION_INTEGER,
     .unit = "D",
     .environment = "MUSTER_DOMAIN",
     .help = "DDS domain (default: a free one)",
     .target = &chosen.domain,
     .max = 230},
    {.name = "limit",
     .kind = MU_OPTION_REAL,
     .unit = "S",
     .fallback = "0",
     .help = "end the run after this much wall time, with exit code 124; 0: never",
     .target = &chosen.limit_s,
     .max = 1e9},
    {.name = "no-spread",
     .kind = MU_OPTION_FLAG,
     .help = "let the system move processes between processors; as fast as possible, each "
             "stays on one",
     .target = &chosen.no_spread},
    {.name = "quiet",
     .letter = 'q',
     .kind = MU_OPTION_FLAG,
     .help = "say only what came out",
     .target = &chosen.quiet},
    {.name = "json",
     .kind = MU_OPTION_FLAG,
     .help = "say it as one line of JSON",
     .target = &chosen.json},
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
        .table = option_table,
        .count = sizeof option_table / sizeof option_table[0]};
    mu_result parsed = mu_options_parse(&options, argc, argv);
    if (parsed != MU_OK) {
        return parsed;
    }
    if (options.words_count != 1) {
        fprintf(stderr, "muster run: name one experiment file, for example: "
                        "muster run experiments/follow.yaml\n");
        return MU_FAULT_USAGE;
    }
    if (chosen.record && strcmp(chosen.record, "none") != 0 && strcmp(chosen.record, "run") != 0 &&
        strcmp(chosen.record, "full") != 0) {
        fprintf(stderr, "muster run: --record %s: expected none, run or full\n", chosen.record);
        return MU_FAULT_USAGE;
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
