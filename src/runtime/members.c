/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/members.h"

#include "core/text.h"
#include "muster/memory.h"

#include <string.h>

void members_init(struct members *m)
{
    m->lines = mu_startup_array(MEMBERS_MAX, sizeof *m->lines);
    m->count = 0;
}

void members_clear(struct members *m)
{
    m->count = 0;
}

/* @return the index of the first line whose name is not before this one */
static size_t members_place(const struct members *m, const char *name)
{
    size_t low = 0;
    size_t high = m->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (strcmp(m->lines[middle].name, name) < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

const struct mu_member *members_find(const struct members *m, const char *name)
{
    size_t at = members_place(m, name);
    bool found = at < m->count && strcmp(m->lines[at].name, name) == 0;
    return found ? &m->lines[at] : NULL;
}

void members_set(struct members *m, const muster_Member *line)
{
    size_t at = members_place(m, line->name);
    if (at == m->count || strcmp(m->lines[at].name, line->name) != 0) {
        if (m->count == MEMBERS_MAX) {
            return;
        }
        memmove(&m->lines[at + 1], &m->lines[at], (m->count - at) * sizeof *m->lines);
        m->count++;
    }
    struct mu_member *to = &m->lines[at];
    *to = (struct mu_member){.kind = (enum mu_kind)line->kind,
                             .state = (enum mu_state)line->state,
                             .pid = line->pid,
                             .since_wall_ns = line->since_wall_ns};
    mu_text_copy(to->name, sizeof to->name, line->name);
    mu_text_copy(to->broker, sizeof to->broker, line->broker);
    mu_text_copy(to->host, sizeof to->host, line->host);
}
