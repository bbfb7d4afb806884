/* SPDX-License-Identifier: Apache-2.0 */
/* Memory and templates of what a mind is told. */
#include "mind/facts/facts.h"

#include "muster/memory.h"

void facts_reserve(struct mind *m)
{
    m->inputs = mu_startup_alloc(sizeof *m->inputs);
    m->inputs->messages = messages_reserve();
    m->inputs->mail_ring = mail_ring_reserve();
    m->inputs->scratch = mu_startup_alloc(MU_CONTENT_MAX + 1);
}

void facts_clear(struct mind *m)
{
    const struct mind_inputs before = {.messages = m->inputs->messages,
                                       .mail_ring = m->inputs->mail_ring,
                                       .scratch = m->inputs->scratch};
    *m->inputs = before;
}

/* What C code keeps pointers to is in use: CLIPS does not let it be removed. */
static struct deftemplate *inputs_hold(struct mind *m, const char *name)
{
    struct deftemplate *t = CreateImpliedDeftemplate(m->env, EnvAddSymbol(m->env, name), TRUE);
    t->busyCount++;
    return t;
}

bool facts_build(struct mind *m)
{
    if (!EnvBuild(m->env, "(deftemplate mail (slot id) (slot from) (slot to) (slot performative)"
                          " (slot language) (slot ontology) (slot reply-with) (slot in-reply-to)"
                          " (slot conversation) (multislot content) (slot layer))")) {
        return false;
    }
    m->inputs->position = inputs_hold(m, "position");
    for (size_t i = 0; i < MU_CHANNEL_COUNT; i++) {
        m->inputs->lists[i].relation = inputs_hold(m, mu_channels[i].fact);
    }
    m->inputs->message = inputs_hold(m, "message");
    m->inputs->event = inputs_hold(m, "event");
    m->inputs->mail = EnvFindDeftemplate(m->env, "mail");
    m->inputs->mail->busyCount++;
    return true;
}
