/* SPDX-License-Identifier: Apache-2.0 */
/* muster-resolver: an agent that says for which agents addresses of one scheme stand. */
#include "core/exits.h"
#include "core/log.h"
#include "core/network.h"
#include "core/options.h"
#include "resolver/scheme.h"
#include "runtime/join.h"

#include <stdio.h>
#include <string.h>

static const struct scheme *const schemes[] = {&role_scheme, &task_scheme, &near_scheme};

enum { SCHEMES = sizeof schemes / sizeof schemes[0] };
_Static_assert(SCHEMES == sizeof(const char *[]){MU_SCHEMES} / sizeof(const char *),
               "the schemes that an experiment may ask for");

struct settings {
    struct mu_network network;
    const char *name;
    bool verbose;
    const struct scheme *scheme;
};

struct resolver {
    const struct scheme *scheme;
    mu_process *process;
    mu_agent *agent;
    bool refused;
};

static void schemes_print(FILE *to)
{
    for (size_t i = 0; i < SCHEMES; i++) {
        fprintf(to, "  %s:REST  %s\n", schemes[i]->name, schemes[i]->means);
    }
}

static mu_result settings_parse(struct settings *set, int argc, char **argv)
{
    struct mu_option table[] = {
        MU_JOIN_OPTIONS(set->network),
        MU_STRING("name", "NAME", set->name, "name of the agent (default: resolver.SCHEME)"),
        MU_OPTION_VERBOSE(set->verbose),
    };
    static struct mu_options options;
    options = (struct mu_options){
        .program = "muster resolver",
        .usage = "SCHEME [OPTION...]",
        .about = "Says which agents addresses SCHEME:REST mean; SCHEME is role, task or near.",
        MU_OPTION_TABLE(table)};
    mu_result parsed = mu_options_parse(&options, argc, argv);
    if (parsed != MU_OK) {
        return parsed;
    }
    for (size_t i = 0; i < SCHEMES && options.words_count == 1; i++) {
        set->scheme = strcmp(schemes[i]->name, options.words[0]) == 0 ? schemes[i] : set->scheme;
    }
    if (!set->scheme) {
        fprintf(stderr, "muster resolver: name one scheme:\n");
        schemes_print(stderr);
        return MU_FAULT_USAGE;
    }
    return MU_OK;
}

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    struct resolver *r = self;
    if (!accepted) {
        fprintf(stderr, "muster resolver: the broker refuses the name %s: %s\n", mu_agent_name(a),
                reason);
        r->refused = true;
        mu_process_stop(r->process);
    }
}

static void on_world(void *self, mu_agent *a, const struct mu_percept *bodies, size_t count)
{
    (void)a;
    struct resolver *r = self;
    if (r->scheme->see) {
        r->scheme->see(bodies, count);
    }
}

static void on_state(void *self, mu_agent *a, enum mu_state state)
{
    (void)a;
    struct resolver *r = self;
    if (state == MU_GONE) {
        mu_process_stop(r->process);
    }
}

static mu_result resolver_join(struct resolver *r, const struct settings *set)
{
    char name[MU_NAME_MAX + 1];
    snprintf(name, sizeof name, "resolver.%s", set->scheme->name);
    struct mu_process_options options = join_options(&set->network, "resolver");
    options.watches = true;
    MU_TRY(mu_process_open(&r->process, &options));
    struct mu_handlers handlers = {
        .self = r, .on_registered = on_registered, .on_world = on_world, .on_state = on_state};
    mu_result joined = mu_agent_join(r->process, &r->agent, set->name ? set->name : name,
                                     MU_KIND_AGENT, 0, &handlers);
    if (joined == MU_MALFORMED) {
        fprintf(stderr, "muster resolver: '%s' cannot be an agent's name\n", set->name);
        return MU_FAULT_USAGE;
    }
    mu_agent_decline_broadcasts(r->agent);
    MU_ASSERT(mu_agent_resolve(r->agent, set->scheme->name, set->scheme->resolve, r->process) ==
              MU_OK);
    return join_await(r->process, &set->network, "muster resolver", options.domain);
}

int main(int argc, char **argv)
{
    static struct settings set;
    static struct resolver r;
    mu_result parsed = settings_parse(&set, argc, argv);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    mu_log_open("resolver", set.verbose ? MU_LOG_INFO : MU_LOG_WARNING);
    r.scheme = set.scheme;
    mu_result ready = resolver_join(&r, &set);
    if (ready != MU_OK) {
        return mu_exit_for(ready);
    }
    mu_memory_seal();
    mu_result ran = mu_process_run(r.process);
    mu_process_close(r.process);
    return r.refused ? MU_EXIT_REFUSED : mu_exit_for(ran);
}
