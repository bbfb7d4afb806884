/* SPDX-License-Identifier: Apache-2.0 */
/* The abilities of every agent: a kind overrides a row by one of its own. */
#include "core/text.h"
#include "muster/directory.h"
#include "runtime/life.h"
#include "runtime/process.h"
#include "runtime/resolver.h"

#include <string.h>

/* Answers a mail, unless it went to many agents and asks for no answer. */
static enum mu_take answered(mu_agent *a, const struct mu_mail *mail, const char *performative,
                             const char *content)
{
    mu_result sent = mail->reply_with[0] || strcmp(mail->dst, a->name) == 0
                         ? mu_agent_reply(a, mail, performative, content)
                         : MU_OK;
    (void)sent; /* a full outbox: the asker's own time limit is the answer */
    return MU_TAKEN;
}

/* --- layer 1: the life of the agent ----------------------------------------------------------- */

static enum mu_take take_life(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    enum life_event event;
    bool known = life_event_named(mail->performative, &event) == MU_OK;
    /* The agents of a run do not suspend the agent that directs it. */
    if (!known || a->kind == MU_KIND_SPECIAL || life_next(a->state, event) != life_wanted(event)) {
        return MU_DECLINE;
    }
    (void)answered(a, mail, "agree", mail->performative);
    agent_live(a, event, mail->src);
    return MU_TAKEN;
}

static enum mu_take take_move(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    char content[MU_FIELD_MAX + 16];
    struct mu_text t;
    mu_text_init(&t, content, sizeof content);
    mu_text_format(&t, "%s no-mobility", mail->performative);
    return answered(a, mail, "refuse", content);
}

/* --- layer 2: questions ----------------------------------------------------------------------- */

static enum mu_take take_state(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    char content[32];
    struct mu_text t;
    mu_text_init(&t, content, sizeof content);
    mu_text_format(&t, "state %s", mu_state_text(a->state));
    return answered(a, mail, "inform", content);
}

/* A list is at most as long as a mail; names that do not fit are left out. */
static char list[MU_CONTENT_MAX + 1];

static enum mu_take take_groups(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    struct mu_text t;
    mu_text_init(&t, list, sizeof list);
    mu_text_add(&t, "groups");
    const char *group;
    for (size_t i = 0; (group = mu_process_group(a->process, i)) != NULL; i++) {
        bool is_in = mu_process_in_group(a->process, group, a->name);
        if (is_in && t.len + 1 + strlen(group) < sizeof list) {
            mu_text_format(&t, " %s", group);
        }
    }
    return answered(a, mail, "inform", list);
}

static enum mu_take take_services(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    struct mu_text t;
    mu_text_init(&t, list, sizeof list);
    mu_text_add(&t, "services");
    const struct mu_service *s;
    for (size_t i = 0; (s = mu_process_find_service(a->process, "*", i)) != NULL; i++) {
        bool is_ours = strcmp(s->agent, a->name) == 0;
        if (is_ours && t.len + 1 + strlen(s->service) < sizeof list) {
            mu_text_format(&t, " %s", s->service);
        }
    }
    return answered(a, mail, "inform", list);
}

static const struct mu_layer_handler base_handlers[] = {
    {MU_LAYER_SYSTEM, "suspend", take_life},
    {MU_LAYER_SYSTEM, "resume", take_life},
    {MU_LAYER_SYSTEM, "dispose", take_life},
    {MU_LAYER_SYSTEM, "dispatch", take_move},
    {MU_LAYER_SYSTEM, "retract", take_move},
    {MU_LAYER_SYSTEM, "clone", take_move},
    {MU_LAYER_QUERY, "state", take_state},
    {MU_LAYER_QUERY, "groups", take_groups},
    {MU_LAYER_QUERY, "services", take_services},
    {MU_LAYER_QUERY, "resolve", resolver_take},
    {0, NULL, NULL},
};

const struct mu_agent_kind mu_base_kind = {.name = "agent", .handlers = base_handlers};
