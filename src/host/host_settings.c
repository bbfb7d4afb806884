/* SPDX-License-Identifier: Apache-2.0 */
#include "host/host_settings.h"

#include "agent/trip.h"
#include "core/name.h"

#include <stdio.h>

static struct host_settings settings;

static struct mu_option table[] = {
    MU_JOIN_OPTIONS(settings.robots.network),
    {.name = "agents",
     .kind = MU_OPTION_INTEGER,
     .unit = "N",
     .fallback = "16",
     .help = "room for so many agents",
     .target = &settings.agents,
     .min = 1,
     .max = 256},
    {.name = "take",
     .kind = MU_OPTION_LIST,
     .unit = "PATTERN",
     .help = "take in agents of such names alone, for example 'w_*'; may stand several times",
     .target = &settings.take},
    {.name = "bytes",
     .kind = MU_OPTION_INTEGER,
     .unit = "N",
     .fallback = "1000000",
     .help = "take in capsules of at most so many bytes",
     .target = &settings.bytes,
     .min = 1000,
     .max = 1000000},
    CHECKPOINT_OPTIONS(settings.robots.checkpoints),
    SETTINGS_MEND_OPTION(settings.robots),
    {.name = "firings",
     .kind = MU_OPTION_INTEGER,
     .unit = "N",
     .fallback = "200",
     .help = "rules that an agent fires in one control step at most",
     .target = &settings.robots.firings_max,
     .min = 1,
     .max = 1000000},
    {.name = "diary",
     .kind = MU_OPTION_FLAG,
     .help = "let recordings have what goes on in its agents' minds",
     .target = &settings.robots.diary},
    {.name = "verbose",
     .letter = 'v',
     .kind = MU_OPTION_FLAG,
     .help = "log what happens",
     .target = &settings.robots.verbose},
};

mu_result host_settings_parse(const struct host_settings **out, int argc, char **argv)
{
    static struct mu_options options = {
        .program = "muster host",
        .usage = "NAME [OPTION...]",
        .about = "A platform: takes in agents that are launched here, or move here.",
        .table = table,
        .count = sizeof table / sizeof table[0]};
    *out = &settings;
    mu_result parsed = mu_options_parse(&options, argc, argv);
    if (parsed != MU_OK) {
        return parsed;
    }
    const char *name = options.words_count == 1 ? options.words[0] : "";
    if (!mu_name_valid(name) || mu_name_reserved(name)) {
        fprintf(stderr, "muster host: give it a name, for example: muster host north\n");
        return MU_FAULT_USAGE;
    }
    settings.robots.name = name;
    return checkpoint_settings_check(&settings.robots.checkpoints, "muster host");
}
