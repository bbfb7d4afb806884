/* SPDX-License-Identifier: Apache-2.0 */
/* How often each rule has failed, and when that is too often. */
#include "mind/engine/engine.h"

#include <stdio.h>
#include <string.h>

void failures_clear(struct mind *m)
{
    m->failing_count = 0;
}

/* @return the line of a rule; NULL: all lines belong to others */
static struct failures_line *failure_line(struct mind *m, const char *rule)
{
    for (size_t i = 0; i < m->failing_count; i++) {
        if (strcmp(m->failing[i].rule, rule) == 0) {
            return &m->failing[i];
        }
    }
    if (m->failing_count == FAILURES_MAX) {
        return NULL;
    }
    struct failures_line *line = &m->failing[m->failing_count++];
    mu_text_copy(line->rule, sizeof line->rule, rule);
    line->count = 0;
    return line;
}

void failures_note(struct mind *m)
{
    const char *rule = m->rule ? m->rule : "?";
    struct failures_line *line = failure_line(m, rule);
    uint32_t most = m->options.failures_max;
    if (m->stopped) {
        m->stops++;
    }
    if (!line || ++line->count != most) {
        return;
    }
    snprintf(m->reason, sizeof m->reason, "rule %.32s failed %u times%s%s", line->rule,
             (unsigned)line->count, m->stopped ? ": " : "", m->stopped ? m->stopped : "");
    m->enough = true;
}
