/* SPDX-License-Identifier: Apache-2.0 */
/* muster world: of files, and of a run that lives. */
#include "cli/verbs.h"
#include "core/exits.h"
#include "core/sensors.h"
#include "worldtool/worldtool.h"

static struct world_files_options files;
static struct world_run_options run = {.wait_s = -1.0, .at_s = -1.0};
static bool json;

static struct mu_option option_table[] = {
    MU_NETWORK_OPTIONS(run.network),
    MU_REAL("wait", "S", run.wait_s,
            "of a run: how long to wait for the simulator's answer (default: 5; with --at or "
            "--when: until it is done, or the run is over)",
            .max = 3600),
    MU_REAL("for", "S", run.push_s,
            "push: simulated time that it lasts; 0: FX, FY are an impulse in N s",
            .fallback = "0.1", .max = 3600),
    MU_REAL("at", "S", run.at_s,
            "place, push, reset, sensor, save: not before this time of the run", .max = 1e9),
    MU_STRING("when", "CONDITION", run.when,
              "likewise: not before this has come true, such as 'red near blue 0.5' "
              "(docs/experiments.md)"),
    MU_STRING("out", "FILE", files.out, "draw, import: write here instead of standard output"),
    MU_INTEGER("seed", "N", files.seed, "check, draw: of random places, where the world has none",
               .fallback = "1", .max = 1e15),
    MU_FLAG("json", json, "check, and of a run: one object a line"),
};

int world_verb(int argc, char **argv)
{
    static struct mu_options o = {
        .program = "muster world",
        .usage = "check FILE | draw FILE | import FILE | properties | place NAME X Y [DEG] | "
                 "push NAME FX FY [TORQUE] | reset [NAME] | sensor NAME SENSOR on|off | pace R | "
                 "save FILE [OPTION...]",
        .about =
            "World files: check names every mistake with its place, or says what the world "
            "holds; draw makes a picture (SVG); import makes a world of a map of ROS's "
            "map_server (.yaml) or one file of a world of Stage with all that it includes; "
            "properties lists all that a world file can say.  The world of a run that lives, at "
            "the end of the step at hand: place puts a robot or an object elsewhere (m, deg), "
            "push pushes it (N, N m), reset puts it or all back to where they began, sensor "
            "switches sensors (all" MU_SENSOR_COMMAS ") of a robot off or on, pace sets the "
            "rate (times real time; 0: as fast as it goes), save writes the state of all bodies "
            "for muster sim --restore into a file that is not there yet.",
        MU_OPTION_TABLE(option_table)};
    run.network.domain = -1;
    mu_result parsed = mu_options_parse(&o, argc, argv);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    files.json = run.json = json;
    return o.words_count > 0 && world_run_knows(o.words[0]) ? world_run(&o, &run)
                                                            : world_files_run(&o, &files);
}
