/* SPDX-License-Identifier: Apache-2.0 */
/* What every agent can do, whatever its kind: a kind overrides a row by one of its own. */
#include "core/text.h"
#include "runtime/kind.h"
#include "runtime/life.h"
#include "runtime/process.h"

#include <string.h>

/* Answers who wants an answer; for a mail to many that did not ask for one, silence will do. */
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

static enum mu_take change_state(mu_agent *a, const struct mu_mail *mail, enum life_event event,
                                 enum mu_state wanted)
{
    /* Who directs a run is not suspended by those whom it directs. */
    if (a->kind == MU_KIND_SPECIAL || life_next(a->state, event) != wanted) {
        return MU_DECLINE;
    }
    (void)answered(a, mail, "agree", mail->performative);
    mu_agent_set_state(a, wanted);
    return MU_TAKEN;
}

static enum mu_take take_suspend(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    return change_state(a, mail, LIFE_SUSPEND, MU_SUSPENDED);
}

static enum mu_take take_resume(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    return change_state(a, mail, LIFE_RESUME, MU_RUNNING);
}

static enum mu_take take_dispose(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    return change_state(a, mail, LIFE_DISPOSE, MU_GONE);
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

static const struct mu_layer_handler base_handlers[] = {
    {MU_LAYER_SYSTEM, "suspend", take_suspend}, {MU_LAYER_SYSTEM, "resume", take_resume},
    {MU_LAYER_SYSTEM, "dispose", take_dispose}, {MU_LAYER_SYSTEM, "dispatch", take_move},
    {MU_LAYER_SYSTEM, "retract", take_move},    {MU_LAYER_SYSTEM, "clone", take_move},
    {MU_LAYER_QUERY, "state", take_state},      {0, NULL, NULL},
};

const struct mu_agent_kind mu_base_kind = {.name = "agent", .handlers = base_handlers};
