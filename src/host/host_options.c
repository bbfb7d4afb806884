/* SPDX-License-Identifier: Apache-2.0 */
#include "host/host_options.h"

#include "core/name.h"

#include <stdio.h>

static struct host_options options;

static struct mu_option own[] = {
    MU_INTEGER("agents", "N", options.agents, "room for so many agents", .fallback = "16", .min = 1,
               .max = 256),
    MU_NAMES("take", "PATTERN", options.take,
             "take in agents of such names alone, for example 'w_*,red'"),
    MU_INTEGER("bytes", "N", options.bytes, "take in snapshots of at most so many bytes",
               .fallback = "1000000", .min = 1000, .max = 1000000),
    MU_LIST("robot", "NAME=FILE", options.natives,
            "a robot that begins here, and its rules; may stand several times"),
    MU_LIST("agent", "NAME=FILE", options.bodiless,
            "likewise an agent without a body, which runs from the start"),
    MU_LIST("global", "NAME.G=VALUE", options.globals,
            "set a global of one of these, for example red.mate=blue"),
};

mu_result host_options_read(const struct host_options **out, int argc, char **argv)
{
    static struct mu_options program = {
        .program = "muster host",
        .usage = "NAME [OPTION...]",
        .about = "A platform: takes in agents that are launched here, or move here.",
        MU_OPTION_TABLE(own)};
    *out = &options;
    mu_result parsed = options_parse(&program, argc, argv, &options.robots);
    if (parsed != MU_OK) {
        return parsed;
    }
    const char *name = options.robots->name;
    if (!name) {
        fprintf(stderr, "muster host: give it a name, for example: muster host north\n");
        return MU_FAULT_USAGE;
    }
    if (!mu_name_check("muster host", "a host", name)) {
        return MU_FAULT_USAGE;
    }
    return options_check_checkpoints(&options.robots->checkpoints, "muster host");
}
