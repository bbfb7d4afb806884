/* SPDX-License-Identifier: Apache-2.0 */
/* Between two steps: agents answer lines that only look. */
#include "runtime/probes.h"
#include "runtime/process.h"

static enum probe_end due_look(mu_process *p, const struct probes_due *due, const char **text)
{
    mu_agent *a = agent_find(p, due->agent);
    *text = "";
    if (!a || a->state == MU_GONE || a->state == MU_MOVING || !a->probes.look) {
        return PROBE_DECLINED;
    }
    return a->probes.look(a->handlers.self, due->line, text);
}

/* The text is in the Up until that is out; no step is lived, and no agent looks, before. */
static void due_answer(mu_process *p, struct probes_due *due)
{
    struct probes *g = &p->probes;
    const char *text;
    enum probe_end end = due_look(p, due, &text);
    g->out[0] = (muster_Glance){.word = (muster_GlanceWord)end,
                                .asker = due->asker,
                                .number = due->number,
                                .agent = due->agent,
                                .text = (char *)(uintptr_t)text}; /* idlc makes none const */
    p->out = (muster_Up){.process = p->name, .step = muster_STEP_NOW};
    p->out.glances._buffer = g->out;
    p->out.glances._length = p->out.glances._maximum = 1;
    process_up_on(p, UP_GOES);
    (void)step_retry(p);
}

void probes_look(mu_process *p)
{
    struct probes *g = &p->probes;
    while (g->due_count > 0 && step_retry(p)) {
        struct probes_due *due = &g->due[g->due_first];
        g->due_first = (g->due_first + 1) % MU_GLANCES_MAX;
        g->due_count--;
        due_answer(p, due);
    }
}
