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
            fprintf(stderr,
                    "%s --group: expected [A-Za-z_][A-Za-z0-9_.-]{0,30}, and not "
                    "all, robots, special, broker\n",
                    set->program);
            return MU_FAULT_USAGE;
        }
    }
    for (size_t i = 0; i < set->services.count; i++) {
        const char *attributes = options_service(set->services.items[i], name);
        if (!mu_name_valid(name) || !mu_attributes_valid(attributes)) {
            fprintf(stderr,
                    "%s --service: expected a service and its attributes, such "
                    "as 'mapper role=scout'\n",
                    set->program);
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
    const char *kind = mu_kind_text(set->kind);
    if (!set->name || !set->rules) {
        fprintf(stderr,
                "%s: give it a name and rules, for example: "
                "%s red --rules rules/follower.clp\n",
                set->program, set->program);
        return MU_FAULT_USAGE;
    }
    char one[16];
    snprintf(one, sizeof one, set->kind == MU_KIND_ROBOT ? "a %s" : "an %s", kind);
    if (!mu_name_check(set->program, one, set->name)) {
        return MU_FAULT_USAGE;
    }
    if (!names_fit(set)) {
        fprintf(stderr,
                "%s --count: the names of so many, such as %s_%lld, are longer "
                "than %d bytes\n",
                set->program, set->name, (long long)(set->first + set->count - 1), MU_NAME_MAX);
        return MU_FAULT_USAGE;
    }
    MU_TRY(options_check_checkpoints(&set->checkpoints, set->program));
    if (set->checkpoints.restore && !set->checkpoints.folder) {
        fprintf(stderr, "%s: --restore needs --folder DIR\n", set->program);
        return MU_FAULT_USAGE;
    }
    return pages_check(set);
}

static struct robot_options options = {.kind = MU_KIND_ROBOT};

/* Rows of every program that has robots. */
static struct mu_option shared[] = {
    MU_JOIN_OPTIONS(options.network),
    MU_STRING("world", "FILE", options.world, "the world's file: the map for (plan x y)",
              .letter = 'w'),
    MU_INTEGER("seed", "N", options.seed, "seed of (random), together with the name",
               .fallback = "1", .environment = "MUSTER_SEED"),
    MU_INTEGER("firings", "N", options.firings_max,
               "rules that an agent fires in one control step at most", .fallback = "200", .min = 1,
               .max = 1000000),
    MU_INTEGER("failures", "N", options.failures_max,
               "a rule that fails so often suspends its agent; 0: none does", .fallback = "100",
               .max = 1000000),
    MU_INTEGER("mend", "N", options.mends_max,
               "make a mind that broke, for want of memory, anew of its checkpoint or its rules, "
               "so often at most; then the robot is suspended",
               .fallback = "0", .max = 1000),
    MU_REAL("checkpoint", "S", options.checkpoints.every_s,
            "write each agent to the folder every S seconds, when it comes, and when its state "
            "changes; 0: never",
            .fallback = "0", .max = 1e6),
    MU_STRING("folder", "DIR", options.checkpoints.folder, "where checkpoints are"),
    MU_FLAG("restore", options.checkpoints.restore,
            "bring back the agents that have a checkpoint there"),
    MU_FLAG("wait", options.awaits_run,
            "agents without a body wait for a simulator's steps; else they have steps of the "
            "wall's time where no simulator is"),
    MU_FLAG("diary", options.diary,
            "let recordings have what goes on in its mind: facts, rules, causes",
            .environment = "MUSTER_DIARY"),
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
    options.program = program->program;
    mu_result parsed = mu_options_parse(program, argc, argv);
    options.name = program->words_count == 1 ? program->words[0] : NULL;
    *out = &options;
    return parsed;
}

static struct mu_option own[] = {
    MU_STRING("rules", "FILE", options.rules, "the agent's behaviour, a CLIPS file", .letter = 'r'),
    MU_INTEGER("count", "N", options.count,
               "agents in one process, NAME_0 to NAME_(N-1); 0: one, NAME", .fallback = "0",
               .max = MU_ROBOTS_MAX),
    MU_INTEGER("first", "K", options.first,
               "with --count: the number of the first, for one of several processes",
               .fallback = "0", .max = MU_ROBOTS_MAX),
    MU_LIST("global", "NAME=VALUE", options.globals, "set a global, for example mate=red"),
    MU_NAMES("group", "G", options.groups,
             "join groups, with commas, when the broker knows the agent"),
    MU_LIST("service", "'S KEY=VALUE...'", options.services,
            "offer a service, likewise, for example 'mapper role=scout'"),
    MU_FLAG("functions", options.functions, "print the functions that rules may call, and exit"),
    MU_FLAG("standby", options.standby, "begin in standby, and run when told to start"),
};
enum { OWN = sizeof own / sizeof own[0] };

/* One program, in two files.  A robot is in standby anyway. */
static struct mu_options program_robot = {
    .program = "muster robot",
    .usage = "NAME --rules FILE [OPTION...]",
    .about = "Controls robots by CLIPS rules; they wait in standby until told to start.",
    .table = own,
    .count = OWN - 1};
static struct mu_options program_agent = {
    .program = "muster agent",
    .usage = "NAME --rules FILE [OPTION...]",
    .about = "Agents without a body, with CLIPS rules; they run from the start.",
    .table = own,
    .count = OWN};

/* @return whether the program was called by its name for agents: agent, muster-agent, and what
 * follows that where the file was renamed */
static bool is_for_agents(const char *called)
{
    const char *slash = strrchr(called, '/');
    return strstr(slash ? slash : called, "agent") != NULL;
}

mu_result options_read(const struct robot_options **out, int argc, char **argv)
{
    bool agents = argc > 0 && is_for_agents(argv[0]);
    options.kind = agents ? MU_KIND_AGENT : MU_KIND_ROBOT;
    mu_result parsed = options_parse(agents ? &program_agent : &program_robot, argc, argv, out);
    return parsed != MU_OK || options.functions ? parsed : options_check(&options);
}
