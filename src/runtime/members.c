/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/members.h"

#include "core/text.h"
#include "muster/memory.h"

#include <string.h>

void members_init(struct members *m)
{
    *m = (struct members){0};
    m->lines = mu_startup_array(MEMBERS_MAX, sizeof *m->lines);
    m->absences = mu_startup_array(MEMBERS_MAX, sizeof *m->absences);
    m->order = mu_startup_array(MEMBERS_MAX, sizeof *m->order);
    m->spare = mu_startup_array(MEMBERS_MAX, sizeof *m->spare);
    mu_table_init(&m->names, MEMBERS_MAX);
}

void members_clear(struct members *m)
{
    for (size_t i = 0; i < m->count; i++) {
        (void)mu_table_remove(&m->names, m->lines[m->order[i]].name);
    }
    m->count = m->spare_count = 0;
}

/* @return the index in the order of the first line whose name is not before this one */
static size_t members_place(const struct members *m, const char *name)
{
    size_t low = 0;
    size_t high = m->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (strcmp(m->lines[m->order[middle]].name, name) < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

const struct mu_member *members_find(const struct members *m, const char *name)
{
    uint32_t line = mu_table_find(&m->names, name);
    return line == MU_NONE ? NULL : &m->lines[line];
}

const struct mu_member *members_at(const struct members *m, size_t index)
{
    return index < m->count ? &m->lines[m->order[index]] : NULL;
}

static void line_remove(struct members *m, uint32_t line)
{
    size_t at = members_place(m, m->lines[line].name);
    (void)mu_table_remove(&m->names, m->lines[line].name);
    m->count--;
    memmove(&m->order[at], &m->order[at + 1], (m->count - at) * sizeof *m->order);
    m->spare[m->spare_count++] = line;
}

/* Removes the line whose agent is absent longest.  @return whether there is one */
static bool line_yield(struct members *m)
{
    uint32_t longest = MU_NONE;
    for (size_t i = 0; i < m->count; i++) {
        uint32_t line = m->order[i];
        if (m->absences[line] > 0 &&
            (longest == MU_NONE || m->absences[line] < m->absences[longest])) {
            longest = line;
        }
    }
    if (longest != MU_NONE) {
        line_remove(m, longest);
    }
    return longest != MU_NONE;
}

/* Enters a name that is not there.  @return its line, or MU_NONE */
static uint32_t line_add(struct members *m, const muster_Member *from)
{
    bool absent = from->state == muster_STATE_ABSENT;
    if (m->count == MEMBERS_MAX && (absent || !line_yield(m))) {
        return MU_NONE;
    }
    uint32_t line = m->spare_count > 0 ? m->spare[--m->spare_count] : (uint32_t)m->count;
    mu_text_copy(m->lines[line].name, sizeof m->lines[line].name, from->name);
    m->absences[line] = 0;
    size_t at = members_place(m, m->lines[line].name);
    memmove(&m->order[at + 1], &m->order[at], (m->count - at) * sizeof *m->order);
    m->order[at] = line;
    m->count++;
    (void)mu_table_put(&m->names, m->lines[line].name, line);
    return line;
}

void members_set(struct members *m, const muster_Member *from)
{
    uint32_t line = mu_table_find(&m->names, from->name);
    line = line == MU_NONE ? line_add(m, from) : line;
    if (line == MU_NONE) {
        return;
    }
    struct mu_member *to = &m->lines[line];
    to->kind = (enum mu_kind)from->kind;
    to->state = (enum mu_state)from->state;
    to->pid = from->pid;
    to->since_wall_ns = from->since_wall_ns;
    to->busy_since_wall_ns = from->busy_since_wall_ns;
    mu_text_copy(to->broker, sizeof to->broker, from->broker);
    mu_text_copy(to->host, sizeof to->host, from->host);
    mu_text_copy(to->reason, sizeof to->reason, from->reason ? from->reason : "");
    if (to->state != MU_GONE) {
        m->absences[line] = 0;
    } else if (m->absences[line] == 0) {
        m->absences[line] = ++m->absences_count;
    }
}
