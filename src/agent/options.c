/* SPDX-License-Identifier: Apache-2.0 */
#include "agent/options.h"
#include "core/attributes.h"
#include "core/name.h"
#include "core/text.h"

#include <stdio.h>
#include <string.h>

mu_result options_check_checkpoints(const struct checkpoint_options *set, const char *program)
{
    if (set->every_s > 0 && !set->folder) {
        fprintf(stderr, "%s: --checkpoint needs --folder DIR\n", program);
        return MU_FAULT_USAGE;
    }
    return MU_OK;
}

const char *options_service(const char *service, char name[MU_NAME_MAX + 2])
{
    size_t len = strcspn(service, " ");
    snprintf(name, MU_NAME_MAX + 2, "%.*s", (int)(len < MU_NAME_MAX + 1 ? len : MU_NAME_MAX + 1),
             service);
    return service + len + strspn(service + len, " ");
}

static mu_result pages_check(const struct robot_options *set)
{
    char name[MU_NAME_MAX + 2];
    for (size_t i = 0; i < set->groups.count; i++) {
        if (!mu_name_of_group(set->groups.items[i])) {
            fprintf(stderr, "muster robot --group: expected [A-Za-z_][A-Za-z0-9_.-]{0,30}, and not "
                            "all, robots, special, broker\n");
            return MU_FAULT_USAGE;
        }
    }
    for (size_t i = 0; i < set->services.count; i++) {
        const char *attributes = options_service(set->services.items[i], name);
        if (!mu_name_valid(name) || !mu_attributes_valid(attributes)) {
            fprintf(stderr, "muster robot --service: expected a service and its attributes, such "
                            "as 'mapper role=scout'\n");
            return MU_FAULT_USAGE;
        }
    }
    return MU_OK;
}

uint32_t options_robots(const struct robot_options *set)
{
    return set->count > 0 ? (uint32_t)set->count : 1;
}

void options_robot(const struct robot_options *set, uint32_t index, char name[MU_NAME_MAX + 1])
{
    if (set->count > 0) {
        snprintf(name, MU_NAME_MAX + 1, "%s_%lld", set->name, (long long)set->first + index);
    } else {
        mu_text_copy(name, MU_NAME_MAX + 1, set->name);
    }
}

/* The last robot of many has the longest name. */
static bool names_fit(const struct robot_options *set)
{
    int len = snprintf(NULL, 0, "%s_%lld", set->name, (long long)(set->first + set->count - 1));
    return set->count == 0 || len <= MU_NAME_MAX;
}

static mu_result options_check(const struct robot_options *set)
{
    if (!set->name || !set->rules) {
        fprintf(stderr, "muster robot: give it a name and rules, for example: "
                        "muster robot red --rules rules/follower.clp\n");
        return MU_FAULT_USAGE;
    }
    if (!mu_name_valid(set->name) || mu_name_reserved(set->name)) {
        char shown[MU_TEXT_SHOWN];
        fprintf(stderr,
                "muster robot: '%s' cannot be a robot's name: it must match "
                "[A-Za-z_][A-Za-z0-9_.-]{0,30} and not be reserved\n",
                mu_text_show(shown, set->name));
        return MU_FAULT_USAGE;
    }
    if (!names_fit(set)) {
        fprintf(stderr,
                "muster robot --count: the names of so many, such as %s_%lld, are longer "
                "than %d bytes\n",
                set->name, (long long)(set->first + set->count - 1), MU_NAME_MAX);
        return MU_FAULT_USAGE;
    }
    MU_TRY(options_check_checkpoints(&set->checkpoints, "muster robot"));
    if (set->checkpoints.restore && !set->checkpoints.folder) {
        fprintf(stderr, "muster robot: --restore needs --folder DIR\n");
        return MU_FAULT_USAGE;
    }
    return pages_check(set);
}

static struct robot_options options;

/* Rows of every program that has robots. */
static struct mu_option shared[] = {
    MU_JOIN_OPTIONS(options.network),
    {.name = "world",
     .letter = 'w',
     .kind = MU_OPTION_STRING,
     .unit = "FILE",
     .help = "the world's file: the map for (plan x y)",
     .target = &options.world},
    {.name = "seed",
     .kind = MU_OPTION_INTEGER,
     .unit = "N",
     .fallback = "1",
     .environment = "MUSTER_SEED",
     .help = "seed of (random), together with the name",
     .target = &options.seed},
    {.name = "firings",
     .kind = MU_OPTION_INTEGER,
     .unit = "N",
     .fallback = "200",
     .help = "rules that an agent fires in one control step at most",
     .target = &options.firings_max,
     .min = 1,
     .max = 1000000},
    {.name = "failures",
     .kind = MU_OPTION_INTEGER,
     .unit = "N",
     .fallback = "100",
     .help = "a rule that fails so often suspends its agent; 0: none does",
     .target = &options.failures_max,
     .max = 1000000},
    {.name = "mend",
     .kind = MU_OPTION_INTEGER,
     .unit = "N",
     .fallback = "0",
     .help = "make a mind that broke, for want of memory, anew of its checkpoint or its rules, so "
             "often at most; then the robot is suspended",
     .target = &options.mends_max,
     .max = 1000},
    {.name = "checkpoint",
     .kind = MU_OPTION_REAL,
     .unit = "S",
     .fallback = "0",
     .help = "write each agent to the folder every S seconds, when it comes, and when its state "
             "changes; 0: never",
     .target = &options.checkpoints.every_s,
     .max = 1e6},
    {.name = "folder",
     .kind = MU_OPTION_STRING,
     .unit = "DIR",
     .help = "where checkpoints are",
     .target = &options.checkpoints.folder},
    {.name = "restore",
     .kind = MU_OPTION_FLAG,
     .help = "bring back the agents that have a checkpoint there",
     .target = &options.checkpoints.restore},
    {.name = "diary",
     .kind = MU_OPTION_FLAG,
     .environment = "MUSTER_DIARY",
     .help = "let recordings have what goes on in its mind: facts, rules, causes",
     .target = &options.diary},
    MU_OPTION_VERBOSE(options.verbose),
};
enum { SHARED = sizeof shared / sizeof shared[0], OWN_MAX = 16 };

mu_result options_parse(struct mu_options *program, int argc, char **argv,
                        const struct robot_options **out)
{
    static struct mu_option rows[SHARED + OWN_MAX];
    MU_ASSERT(program->count <= OWN_MAX);
    memcpy(rows, shared, sizeof shared);
    memcpy(rows + SHARED, program->table, program->count * sizeof rows[0]);
    program->table = rows;
    program->count += SHARED;
    mu_result parsed = mu_options_parse(program, argc, argv);
    options.name = program->words_count == 1 ? program->words[0] : NULL;
    *out = &options;
    return parsed;
}

static struct mu_option own[] = {
    {.name = "rules",
     .letter = 'r',
     .kind = MU_OPTION_STRING,
     .unit = "FILE",
     .help = "the robot's behaviour, a CLIPS file",
     .target = &options.rules},
    {.name = "count",
     .kind = MU_OPTION_INTEGER,
     .unit = "N",
     .fallback = "0",
     .help = "robots in one process, NAME_0 to NAME_(N-1); 0: one robot, NAME",
     .target = &options.count,
     .max = MU_ROBOTS_MAX},
    {.name = "first",
     .kind = MU_OPTION_INTEGER,
     .unit = "K",
     .fallback = "0",
     .help = "with --count: the number of the first, for one of several processes",
     .target = &options.first,
     .max = MU_ROBOTS_MAX},
    {.name = "global",
     .kind = MU_OPTION_LIST,
     .unit = "NAME=VALUE",
     .help = "set a global, for example mate=red",
     .target = &options.globals},
    {.name = "group",
     .kind = MU_OPTION_LIST,
     .unit = "G",
     .help = "join a group when the broker knows the robot",
     .target = &options.groups},
    {.name = "service",
     .kind = MU_OPTION_LIST,
     .unit = "'S KEY=VALUE...'",
     .help = "offer a service, likewise, for example 'mapper role=scout'",
     .target = &options.services},
    {.name = "functions",
     .kind = MU_OPTION_FLAG,
     .help = "print the functions that rules may call, and exit",
     .target = &options.functions},
};

mu_result options_read(const struct robot_options **out, int argc, char **argv)
{
    static struct mu_options program = {
        .program = "muster robot",
        .usage = "NAME --rules FILE [OPTION...]",
        .about = "Controls robots by CLIPS rules; they wait in standby until told to start.",
        .table = own,
        .count = sizeof own / sizeof own[0]};
    mu_result parsed = options_parse(&program, argc, argv, out);
    return parsed != MU_OK || options.functions ? parsed : options_check(&options);
}
