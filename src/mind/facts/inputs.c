/* SPDX-License-Identifier: Apache-2.0 */
/* Memory and templates of a mind's inputs. */
#include "mind/facts/facts.h"

#include "muster/memory.h"

void facts_reserve(struct mind *m)
{
    inputs_of(m)->messages = messages_reserve();
    inputs_of(m)->mail_ring = mail_ring_reserve();
    inputs_of(m)->scratch = mu_startup_alloc(MU_CONTENT_MAX + 1);
}

/*
 * Creates a template and marks it as used, so that CLIPS does not remove it under C code's pointer.
 */
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
    inputs_of(m)->position = inputs_hold(m, "position");
    for (size_t i = 0; i < MU_CHANNEL_COUNT; i++) {
        inputs_of(m)->lists[i].relation = inputs_hold(m, mu_channels[i].fact);
    }
    inputs_of(m)->message = inputs_hold(m, "message");
    inputs_of(m)->event = inputs_hold(m, "event");
    inputs_of(m)->time = inputs_hold(m, "time");
    inputs_of(m)->tick = inputs_hold(m, "tick");
    inputs_of(m)->mail = EnvFindDeftemplate(m->env, "mail");
    inputs_of(m)->mail->busyCount++;
    return true;
}
