/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

#include "core/address.h"
#include "core/name.h"

#include <string.h>

static bool validate_process(const char *name)
{
    return validate_string(name, MU_PROCESS_MAX) && validate_process_name(name);
}

static bool validate_sequence(uint32_t length, const void *buffer, uint32_t max)
{
    return length == 0 || (buffer && length <= max);
}

bool validate_registration(const muster_Registration *r)
{
    if (!validate_process(r->process) || r->part >= MU_PARTS_MAX ||
        !validate_string(r->broker, MU_FIELD_MAX) || !validate_string(r->host, 4096) ||
        !validate_sequence(r->agents._length, r->agents._buffer, MU_PART_AGENTS)) {
        return false;
    }
    for (uint32_t i = 0; i < r->agents._length; i++) {
        if (!r->agents._buffer[i].name || !r->agents._buffer[i].home) {
            return false;
        }
    }
    return true;
}

/* Only a broker speaks for agents that live elsewhere. */
static bool validate_home(const muster_Entry *e, bool of_a_broker)
{
    if (e->home[0] == '\0') {
        return true;
    }
    return of_a_broker && validate_string(e->home, MU_NAME_MAX) && mu_name_valid(e->home);
}

bool validate_entry(const muster_Entry *e, bool of_a_broker)
{
    return validate_kind_word(e->kind) && validate_state_word(e->state) &&
           (unsigned)e->full <= muster_BOX_DROP_LOWEST && validate_home(e, of_a_broker);
}

bool validate_step(int64_t step, uint64_t step_ns, bool by_steps)
{
    if (step < 0 || step_ns == 0) {
        return !by_steps;
    }
    return (uint64_t)step + 2 <= (uint64_t)INT64_MAX / step_ns;
}

bool validate_members(const char *simulator, char *const *processes, uint32_t count)
{
    if (!validate_process(simulator) || !validate_sequence(count, processes, MU_PROCESSES_MAX)) {
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        if (!validate_process(processes[i]) || strcmp(processes[i], simulator) == 0) {
            return false;
        }
    }
    return true;
}

static bool validate_act(const muster_Act *act)
{
    return validate_string(act->agent, MU_NAME_MAX) && validate_state_word(act->state) &&
           validate_sequence(act->mails._length, act->mails._buffer, MU_OUTBOX_MAX);
}

static bool validate_trip(const muster_Trip *t)
{
    return validate_string(t->agent, MU_NAME_MAX) && validate_string(t->host, MU_NAME_MAX) &&
           validate_string(t->asker, MU_NAME_MAX) && validate_state_word(t->state) &&
           validate_string(t->reason, MU_FIELD_MAX) &&
           validate_string(t->text, MU_CAPSULE_MAX - 1) && t->slot < MU_LOCAL_AGENTS_MAX;
}

static bool validate_glance(const muster_Glance *g)
{
    size_t most = g->word == muster_GLANCE_ASK ? MU_GLANCE_LINE_MAX : MU_GLANCE_BYTES_MAX - 1;
    return (unsigned)g->word <= muster_GLANCE_DECLINED && validate_string(g->asker, MU_NAME_MAX) &&
           validate_string(g->agent, MU_NAME_MAX) && validate_string(g->text, most);
}

bool validate_up(const muster_Up *up)
{
    if (!validate_process(up->process) ||
        !validate_sequence(up->acts._length, up->acts._buffer, MU_LOCAL_AGENTS_MAX) ||
        !validate_sequence(up->acks._length, up->acks._buffer, MU_LOCAL_AGENTS_MAX) ||
        !validate_sequence(up->trips._length, up->trips._buffer, MU_LOCAL_AGENTS_MAX) ||
        !validate_sequence(up->glances._length, up->glances._buffer, MU_GLANCES_MAX)) {
        return false;
    }
    for (uint32_t i = 0; i < up->glances._length; i++) {
        if (!validate_glance(&up->glances._buffer[i])) {
            return false;
        }
    }
    for (uint32_t i = 0; i < up->trips._length; i++) {
        if (!validate_trip(&up->trips._buffer[i])) {
            return false;
        }
    }
    for (uint32_t i = 0; i < up->acts._length; i++) {
        if (!validate_act(&up->acts._buffer[i])) {
            return false;
        }
    }
    for (uint32_t i = 0; i < up->acks._length; i++) {
        if (!validate_string(up->acks._buffer[i].box, MU_NAME_MAX)) {
            return false;
        }
    }
    return true;
}

bool validate_mail(const muster_Mail *m)
{
    return validate_string(m->dst, MU_DST_MAX) && mu_address_valid(m->dst) &&
           validate_string(m->performative, MU_FIELD_MAX) &&
           validate_string(m->language, MU_FIELD_MAX) &&
           validate_string(m->ontology, MU_FIELD_MAX) &&
           validate_string(m->reply_with, MU_FIELD_MAX) &&
           validate_string(m->in_reply_to, MU_FIELD_MAX) &&
           validate_string(m->conversation, MU_FIELD_MAX) && m->priority >= -1 &&
           m->priority <= 1 && (unsigned)m->level <= muster_LEVEL_SYNCED &&
           validate_string(m->content, MU_CONTENT_MAX);
}

bool validate_process_name(const char *name)
{
    size_t len = 0;
    while (len <= MU_PROCESS_MAX && name[len] != '\0') {
        char c = name[len];
        if (c <= ' ' || c > '~' || c == '*' || c == '?') { /* wildcards of DDS partitions */
            return false;
        }
        len++;
    }
    return len >= 1 && len <= MU_PROCESS_MAX;
}

const char *validate_kind_word(muster_Kind kind)
{
    static const char *const words[] = {"agent", "robot", "host", "special"};
    return (unsigned)kind < sizeof words / sizeof words[0] ? words[kind] : NULL;
}

const char *validate_state_word(muster_State state)
{
    static const char *const words[] = {"standby", "running", "suspended", "moving", "absent"};
    return (unsigned)state < sizeof words / sizeof words[0] ? words[state] : NULL;
}
