/* SPDX-License-Identifier: Apache-2.0 */
#include "agent/robot.h"
#include "agent/body.h"

#include "muster/memory.h"
#include "runtime/returns.h"

void robot_reserve_crew(struct crew *c, const struct settings *set, uint32_t count,
                        const char *host)
{
    c->set = set;
    c->host = host;
    c->count = count;
    mu_text_init(&c->listing, c->listing_bytes, sizeof c->listing_bytes);
    mu_text_init(&c->trace, c->trace_bytes, sizeof c->trace_bytes);
    mu_text_init(&c->diary, c->diary_bytes, sizeof c->diary_bytes);
    trip_reserve(c);
    c->robots = mu_startup_array(count, sizeof *c->robots);
    for (uint32_t i = 0; i < count; i++) {
        c->robots[i].crew = c;
        c->robots[i].step = -1;
    }
    checkpoint_reserve(c);
}

static struct mu_handlers robot_handlers_of(struct robot *r)
{
    return (struct mu_handlers){.self = r,
                                .on_registered = robot_on_registered,
                                .on_mail = robot_on_mail,
                                .on_directive = robot_on_directive,
                                .on_state = robot_on_state,
                                .on_step = robot_on_step,
                                .on_beat = robot_on_beat,
                                .on_act = robot_on_act,
                                .on_refusal = robot_on_refusal};
}

static void robot_begin(struct robot *r)
{
    mu_agent_be(r->agent, &robot_kind);
    glances_answer(r->agent, robot_console_look);
    returns_hear(r->agent, robot_on_return);
    body_ask(r->agent, r->mind);
}

mu_result robot_join(struct robot *r)
{
    if (r->returns) {
        return robot_arrive(r, &r->passage, MU_ON_ARRIVE);
    }
    struct mu_handlers handlers = robot_handlers_of(r);
    mu_process *p = r->crew->process;
    mu_result joined = mu_agent_join(p, &r->agent, r->name, MU_KIND_ROBOT, 0, &handlers);
    if (joined != MU_OK) {
        fprintf(stderr, "%s: %s\n", r->name, mu_result_text(joined));
        return joined < 0 ? joined : MU_FAULT_USAGE;
    }
    robot_begin(r);
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
    robot_begin(r);
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
