/* SPDX-License-Identifier: Apache-2.0 */
#include "agent/robot.h"
#include "agent/body.h"

#include "core/fault.h"
#include "muster/memory.h"

#include <stdio.h>
#include <string.h>

void robot_reserve_crew(struct crew *c, const struct settings *set, uint32_t count,
                        const char *host)
{
    c->set = set;
    c->host = host;
    c->count = count;
    mu_text_init(&c->listing, c->listing_bytes, sizeof c->listing_bytes);
    mu_text_init(&c->trace, c->trace_bytes, sizeof c->trace_bytes);
    mu_text_init(&c->diary, c->diary_bytes, sizeof c->diary_bytes);
    trip_reserve(&c->trip);
    c->robots = mu_startup_array(count, sizeof *c->robots);
    for (uint32_t i = 0; i < count; i++) {
        c->robots[i].crew = c;
    }
}

mu_result robot_set_global(struct mind *mind, const char *word)
{
    char name[MU_FIELD_MAX + 1];
    const char *equals = strchr(word, '=');
    size_t len = equals ? (size_t)(equals - word) : 0;
    if (len == 0 || len >= sizeof name) {
        fprintf(stderr, "--global %s: expected NAME=VALUE\n", word);
        return MU_FAULT_USAGE;
    }
    memcpy(name, word, len);
    name[len] = '\0';
    if (mind_set_global(mind, name, equals + 1) != MU_OK) {
        fprintf(stderr, "--global %s: no such global, or not a CLIPS field\n", word);
        return MU_FAULT_USAGE;
    }
    return MU_OK;
}

static mu_result globals_set(struct mind *mind, const struct mu_option_list *globals)
{
    for (size_t i = 0; i < globals->count; i++) {
        MU_TRY(robot_set_global(mind, globals->items[i]));
    }
    return MU_OK;
}

mu_result robot_think(struct robot *r, const char *folder)
{
    const struct settings *set = r->crew->set;
    struct mind_options options = {.name = r->name,
                                   .seed = (uint64_t)set->seed,
                                   .rules_folder = folder,
                                   .rules_file = set->rules,
                                   .firings_max = (uint32_t)set->firings_max,
                                   .failures_max = (uint32_t)set->failures_max,
                                   .diary = set->diary,
                                   .router = r->crew->router,
                                   .half_m = robot_map_half_m(r),
                                   .ports = robot_ports(r)};
    struct mu_fault fault;
    mu_result made = mind_open(&r->mind, &options, &fault);
    made = made == MU_OK ? mind_load(r->mind, set->rules, &fault) : made;
    if (made != MU_OK) {
        mu_fault_print(&fault);
        return made;
    }
    return globals_set(r->mind, &set->globals);
}

static struct mu_handlers robot_handlers_of(struct robot *r)
{
    return (struct mu_handlers){.self = r,
                                .on_registered = robot_on_registered,
                                .on_mail = robot_on_mail,
                                .on_directive = robot_on_directive,
                                .on_state = robot_on_state,
                                .on_step = robot_on_step,
                                .on_act = robot_on_act,
                                .on_refusal = robot_on_refusal};
}

mu_result robot_join(struct robot *r)
{
    struct mu_handlers handlers = robot_handlers_of(r);
    mu_process *p = r->crew->process;
    mu_result joined = mu_agent_join(p, &r->agent, r->name, MU_KIND_ROBOT, 0, &handlers);
    if (joined != MU_OK) {
        fprintf(stderr, "%s: %s\n", r->name, mu_result_text(joined));
        return joined < 0 ? joined : MU_FAULT_USAGE;
    }
    mu_agent_be(r->agent, &robot_kind);
    body_ask(r->agent, r->mind);
    return MU_OK;
}

mu_result robot_arrive(struct robot *r, const struct mu_passage *from, enum mu_event event)
{
    struct mu_handlers handlers = robot_handlers_of(r);
    mu_result joined =
        mu_agent_arrive(r->crew->process, &r->agent, r->name, from, event, &handlers);
    if (joined != MU_OK) {
        return joined;
    }
    r->arrives = true;
    r->out = false;
    mu_agent_be(r->agent, &robot_kind);
    body_ask(r->agent, r->mind);
    return MU_OK;
}

void robot_drop(struct robot *r)
{
    if (mu_agent_state(r->agent) != MU_GONE) {
        mu_agent_leave(r->agent);
    }
    robot_print_rest(r);
    robot_console_flush(r);
    mind_close(r->mind);
    r->arrives = false;
    robot_leave(r);
}
