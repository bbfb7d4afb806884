/* SPDX-License-Identifier: Apache-2.0 */
/* The functions that the runtime calls on a robot, in one table. */
#include "agent/robot.h"
#include "muster/memory.h"

static void on_create(void *self, mu_agent *a)
{
    (void)a;
    mind_event(((struct robot *)self)->mind, MU_ON_CREATE);
}

static void on_run(void *self, mu_agent *a)
{
    (void)a;
    mind_event(((struct robot *)self)->mind, MU_ON_RUN);
}

static void on_arrive(void *self, mu_agent *a)
{
    (void)a;
    struct robot *r = self;
    if (r->state !=
        ROBOT_RETURNED) { /* else the first step decides whether it has missed anything */
        mind_event(r->mind, MU_ON_ARRIVE);
    }
}

static void on_clone(void *self, mu_agent *a)
{
    (void)a;
    mind_event(((struct robot *)self)->mind, MU_ON_CLONE);
}

/* No step follows: the rules fire once more, and their mail still goes out. */
static void fire_last(struct robot *r, mu_agent *a, enum mu_event event)
{
    struct mind_act act;
    percept_settle(r);
    mind_event_now(r->mind, event, &act);
    mu_agent_fired_also(a, act.firings, act.rules);
}

static void on_leave(void *self, mu_agent *a)
{
    fire_last(self, a, MU_ON_LEAVE);
}

static void on_dispose(void *self, mu_agent *a)
{
    fire_last(self, a, MU_ON_DISPOSE);
}

static const struct mu_layer_handler robot_handlers[] = {
    {MU_LAYER_SYSTEM, NULL, mail_take_by_rules},
    {MU_LAYER_QUERY, NULL, mail_take_by_rules},
    {MU_LAYER_SPEECH, NULL, mail_take_by_rules},
    {MU_LAYER_QUERY, "facts", mail_take_facts},
    {MU_LAYER_SPEECH, "ask-one", mail_take_question},
    {MU_LAYER_SPEECH, "ask-all", mail_take_question},
    {MU_LAYER_SYSTEM, "dispatch", mail_take_dispatch},
    {MU_LAYER_SYSTEM, "retract", mail_take_dispatch},
    {MU_LAYER_SYSTEM, "clone", mail_take_clone},
    {0, NULL, NULL},
};

const struct mu_agent_kind handlers_robot_kind = {.name = "robot",
                                                  .handlers = robot_handlers,
                                                  .hooks = {[MU_ON_CREATE] = on_create,
                                                            [MU_ON_RUN] = on_run,
                                                            [MU_ON_ARRIVE] = on_arrive,
                                                            [MU_ON_LEAVE] = on_leave,
                                                            [MU_ON_CLONE] = on_clone,
                                                            [MU_ON_DISPOSE] = on_dispose}};

const struct robot_program handlers_of_robots = {
    .kind = &handlers_robot_kind,
    .handlers = {.on_registered = lifecycle_on_registered,
                 .on_mail = mail_on_mail,
                 .on_directive = mail_on_directive,
                 .on_state = lifecycle_on_state,
                 .on_step = step_on_step,
                 .on_beat = step_on_tick,
                 .on_act = step_on_act,
                 .on_refusal = lifecycle_on_refusal},
    .on_return = lifecycle_on_return};

void agent_reserve(struct group_process *g, const struct robot_options *set, uint32_t count,
                   const char *host)
{
    g->program = &handlers_of_robots;
    g->set = set;
    g->host = host;
    g->count = count;
    mu_text_init(&g->listing, g->listing_bytes, sizeof g->listing_bytes);
    mu_text_init(&g->trace, g->trace_bytes, sizeof g->trace_bytes);
    mu_text_init(&g->step_trace, g->step_trace_bytes, sizeof g->step_trace_bytes);
    migration_reserve(g);
    g->robots = mu_startup_array(count, sizeof *g->robots);
    for (uint32_t i = 0; i < count; i++) {
        g->robots[i].group = g;
        g->robots[i].step = -1;
        g->robots[i].kind = set->kind;
    }
    checkpoint_reserve(g);
}
