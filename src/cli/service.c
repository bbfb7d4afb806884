/* SPDX-License-Identifier: Apache-2.0 */
/* muster service: the yellow pages. */
#include "cli/verbs.h"
#include "core/attributes.h"
#include "core/exits.h"
#include "core/json.h"
#include "muster/directory.h"
#include "operator/operator.h"

#include <stdio.h>
#include <string.h>

struct request {
    const char *program;
    const char *const *words; /* behind the one that says what is wanted */
    size_t count;
    double lease_s;
    const struct operator_options *options;
};

/* --- questions -------------------------------------------------------------------------------- */

static void attributes_print(struct mu_json *j, const char *attributes)
{
    char key[MU_ATTRIBUTES_MAX + 1], value[MU_ATTRIBUTES_MAX + 1];
    int len = 0;
    mu_json_object(j, "attributes");
    for (; sscanf(attributes, " %255[^= ]=%255s%n", key, value, &len) == 2; attributes += len) {
        mu_json_string(j, key, value);
    }
    mu_json_end(j);
}

static void service_print(const mu_process *p, const struct mu_service *s, bool json)
{
    const struct mu_member *m = mu_process_lookup(p, s->agent);
    const char *state = mu_state_text(m ? m->state : MU_GONE);
    if (!json) {
        printf("%-31s %-31s %-10s %s\n", s->service, s->agent, state, s->attributes);
        return;
    }
    struct mu_json j = mu_json_line(stdout);
    mu_json_string(&j, "service", s->service);
    mu_json_string(&j, "agent", s->agent);
    attributes_print(&j, s->attributes);
    mu_json_string(&j, "state", state);
    mu_json_end(&j);
}

static int query_ask(const struct request *r, const char *query)
{
    struct operator op;
    struct operator_options own = *r->options;
    const struct mu_service *s;
    own.as = NULL;
    own.only_reads = true;
    int code = operator_join(&op, &own, r->program + strlen("muster "));
    if (code != MU_EXIT_DONE) {
        return code;
    }
    if (!r->options->json) {
        printf("%-31s %-31s %-10s %s\n", "SERVICE", "AGENT", "STATE", "ATTRIBUTES");
    }
    for (size_t i = 0; (s = mu_process_find_service(op.process, query, i)); i++) {
        service_print(op.process, s, r->options->json);
    }
    operator_leave(&op);
    return MU_EXIT_DONE;
}

static int services_list(const struct request *r)
{
    return query_ask(r, "*");
}

static int service_find(const struct request *r)
{
    char query[MU_QUERY_MAX + 1];
    bool joined = words_join(query, sizeof query, r->words, r->count);
    if (!words_query_check(r->program, joined ? query : "")) {
        return MU_EXIT_USAGE;
    }
    return query_ask(r, query);
}

/* --- changes ---------------------------------------------------------------------------------- */

static int service_change(const struct request *r, const char *performative, const char *content)
{
    struct operator op;
    struct change c = {.program = r->program, .performative = performative, .content = content};
    int code = change_make(&op, r->options, &c);
    if (code == MU_EXIT_DONE && strcmp(performative, "advertise") == 0) {
        const char *agent = r->options->as ? r->options->as : "operator";
        const struct mu_member *m = mu_process_lookup(op.process, agent);
        if (!r->options->as || !m || m->state == MU_GONE || m->state == MU_MOVING) {
            fprintf(stderr, "%s: shown only while %s is there\n", r->program, agent);
        }
    }
    operator_leave(&op);
    return code;
}

static int service_add(const struct request *r)
{
    char attributes[MU_ATTRIBUTES_MAX + 1], content[2 * MU_ATTRIBUTES_MAX + 2 * MU_NAME_MAX];
    if (!words_name_check(r->program, "a service", r->words[0])) {
        return MU_EXIT_USAGE;
    }
    if (!words_join(attributes, sizeof attributes, r->words + 1, r->count - 1) ||
        !mu_attributes_valid(attributes) || !words_are_utf8(attributes)) {
        fprintf(stderr, "%s: expected words KEY=VALUE, each key once, at most %d bytes\n",
                r->program, MU_ATTRIBUTES_MAX);
        return MU_EXIT_USAGE;
    }
    struct mu_text t = mu_text_in(content, sizeof content);
    change_add_offer(&t, r->words[0], attributes, r->lease_s);
    MU_ASSERT(!t.cut);
    return service_change(r, "advertise", content);
}

static int service_remove(const struct request *r)
{
    return words_name_check(r->program, "a service", r->words[0])
               ? service_change(r, "withdraw", r->words[0])
               : MU_EXIT_USAGE;
}

/* --- the verb --------------------------------------------------------------------------------- */

static const struct {
    const char *word;
    size_t min, max; /* words behind it */
    int (*run)(const struct request *r);
} requests[] = {
    {"list", 0, 0, services_list},
    {"find", 1, MU_OPTION_WORDS_MAX, service_find},
    {"add", 1, MU_OPTION_WORDS_MAX, service_add},
    {"remove", 1, 1, service_remove},
};

static int service_run(const struct mu_options *o, const struct operator_options *options,
                       double lease_s)
{
    char program[64];
    size_t behind = o->words_count - (o->words_count > 0);
    for (size_t i = 0; i < sizeof requests / sizeof requests[0]; i++) {
        if (o->words_count == 0 || strcmp(o->words[0], requests[i].word) != 0 ||
            behind < requests[i].min || behind > requests[i].max) {
            continue;
        }
        snprintf(program, sizeof program, "muster service %s", requests[i].word);
        struct request r = {.program = program,
                            .words = o->words + 1,
                            .count = behind,
                            .lease_s = lease_s,
                            .options = options};
        return change_name_check(program, options->as) ? requests[i].run(&r) : MU_EXIT_USAGE;
    }
    fprintf(stderr,
            "muster service: expected list, find QUERY..., add S [KEY=VALUE...] or remove S, "
            "for example: muster service add mapper role=scout --as red\n");
    return MU_EXIT_USAGE;
}

int service_verb(int argc, char **argv)
{
    static struct operator_options options;
    static double lease_s;
    struct mu_option table[] = {
        OPERATOR_OPTIONS(options),
        MU_REAL("lease", "S", lease_s,
                "add: how long it is offered; until it is removed unless said", .max = 3.2e9),
        MU_FLAG("json", options.json, "one object a line"),
    };
    static struct mu_options o;
    o = (struct mu_options){
        .program = "muster service",
        .usage = "list | find QUERY... | add S [KEY=VALUE...] | remove S [OPTION...]",
        .about =
            "The yellow pages.  A query is a service, or * for any, and constraints on its "
            "attributes: mapper role=scout 'battery>=0.5' near=2.5,-1,3 (X, Y, RADIUS in m).  A "
            "service is shown only while its agent is there, so add is of use with --as and an "
            "agent that stays; the trust policy must let the operator direct that agent.",
        MU_OPTION_TABLE(table)};
    mu_result parsed = operator_parse(&o, argc, argv, &options);
    return parsed == MU_OK ? service_run(&o, &options, lease_s) : mu_exit_for(parsed);
}
