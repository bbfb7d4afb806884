/* SPDX-License-Identifier: Apache-2.0 */
/* muster group: the members of groups. */
#include "cli/verbs.h"
#include "core/exits.h"
#include "core/json.h"
#include "muster/directory.h"
#include "operator/operator.h"

#include <stdio.h>
#include <string.h>

struct request {
    const char *program;
    const char *group; /* NULL: list */
    const char *performative;
    const struct operator_options *options;
};

/* --- questions -------------------------------------------------------------------------------- */

static size_t members_count(const mu_process *p, const char *group)
{
    size_t count = 0;
    while (mu_process_group_member(p, group, count)) {
        count++;
    }
    return count;
}

static void group_print(const mu_process *p, const char *group, bool json)
{
    size_t members = members_count(p, group);
    if (!json) {
        printf("%-31s %zu\n", group, members);
        return;
    }
    struct mu_json j = mu_json_line(stdout);
    mu_json_string(&j, "group", group);
    mu_json_uint(&j, "members", members);
    mu_json_end(&j);
}

static int groups_list(struct operator* op, const struct request *r)
{
    const char *group;
    if (!r->options->json) {
        printf("%-31s %s\n", "GROUP", "MEMBERS");
    }
    for (size_t i = 0; (group = mu_process_group(op->process, i)); i++) {
        group_print(op->process, group, r->options->json);
    }
    return MU_EXIT_DONE;
}

static void member_print(const mu_process *p, const char *group, const char *agent, bool json)
{
    const struct mu_member *m = mu_process_lookup(p, agent);
    const char *state = mu_state_text(m ? m->state : MU_GONE);
    if (!json) {
        printf("%-31s %-31s %s\n", group, agent, state);
        return;
    }
    struct mu_json j = mu_json_line(stdout);
    mu_json_string(&j, "group", group);
    mu_json_string(&j, "agent", agent);
    mu_json_string(&j, "state", state);
    mu_json_end(&j);
}

static int members_list(struct operator* op, const struct request *r)
{
    const char *agent;
    if (!receivers_are_group(op->process, r->group)) {
        fprintf(stderr, "%s: no group named %s; muster group list lists them\n", r->program,
                r->group);
        return MU_EXIT_NO_AGENT;
    }
    if (!r->options->json) {
        printf("%-31s %-31s %s\n", "GROUP", "AGENT", "STATE");
    }
    for (size_t i = 0; (agent = mu_process_group_member(op->process, r->group, i)); i++) {
        member_print(op->process, r->group, agent, r->options->json);
    }
    return MU_EXIT_DONE;
}

/* --- the verb --------------------------------------------------------------------------------- */

static int group_ask(const struct request *r)
{
    struct operator op;
    struct operator_options own = *r->options;
    own.as = NULL;
    own.only_reads = true;
    int code = operator_join(&op, &own, r->program + strlen("muster "));
    if (code == MU_EXIT_DONE) {
        code = r->group ? members_list(&op, r) : groups_list(&op, r);
        operator_leave(&op);
    }
    return code;
}

static int group_change(const struct request *r)
{
    struct operator op;
    struct change c = {.program = r->program,
                       .performative = r->performative,
                       .content = r->group,
                       .of_nobody = strcmp(r->performative, "group-create") == 0};
    int code = change_make(&op, r->options, &c);
    operator_leave(&op);
    return code;
}

static const struct {
    const char *word;
    size_t words; /* with this one */
    const char *performative;
    int (*run)(const struct request *r);
} requests[] = {
    {"list", 1, NULL, group_ask},
    {"members", 2, NULL, group_ask},
    {"create", 2, "group-create", group_change},
    {"join", 2, "group-join", group_change},
    {"leave", 2, "group-leave", group_change},
};

static int group_run(const struct mu_options *o, const struct operator_options *options)
{
    char program[64];
    for (size_t i = 0; i < sizeof requests / sizeof requests[0]; i++) {
        if (o->words_count == 0 || strcmp(o->words[0], requests[i].word) != 0 ||
            o->words_count != requests[i].words) {
            continue;
        }
        snprintf(program, sizeof program, "muster group %s", requests[i].word);
        struct request r = {.program = program,
                            .group = requests[i].words > 1 ? o->words[1] : NULL,
                            .performative = requests[i].performative,
                            .options = options};
        bool good = (!r.group || words_group_check(program, r.group)) &&
                    change_name_check(program, options->as);
        return good ? requests[i].run(&r) : MU_EXIT_USAGE;
    }
    fprintf(stderr, "muster group: expected list, members G, create G, join G, leave G or send G "
                    "WORD..., for example: muster group join scouts --as red\n");
    return MU_EXIT_USAGE;
}

int group_verb(int argc, char **argv)
{
    static struct operator_options options;
    if (argc > 1 && strcmp(argv[1], "send") == 0) {
        static char send[] = "group send";
        argv[1] = send;
        return post_verb(argc - 1, argv + 1);
    }
    struct mu_option table[] = {
        OPERATOR_OPTIONS(options),
        MU_FLAG("json", options.json, "one object a line"),
    };
    static struct mu_options o;
    o = (struct mu_options){
        .program = "muster group",
        .usage = "list | members G | create G | join G | leave G | send G WORD... [OPTION...]",
        .about =
            "Groups of agents: mail to group:G goes to all members.  An agent that joins makes "
            "a group that is not there, and stays a member when it is absent.  The last member "
            "that leaves ends it.  With --as, the operator does it for another agent, if the trust "
            "policy lets it direct that one.  muster group send --help has the options of send.",
        MU_OPTION_TABLE(table)};
    mu_result parsed = operator_parse(&o, argc, argv, &options);
    return parsed == MU_OK ? group_run(&o, &options) : mu_exit_for(parsed);
}
