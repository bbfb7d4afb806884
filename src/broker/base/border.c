/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/base/base.h"

#include "core/address.h"
#include "core/name.h"
#include "core/text.h"
#include "core/utf8.h"
#include "muster/memory.h"

#include <string.h>

bool border_string(const char *s, size_t max)
{
    return s && (s[0] == '\0' || strnlen(s, max + 1) <= max);
}

static bool border_process(const char *name)
{
    return border_string(name, MU_PROCESS_MAX) && border_process_name(name);
}

static bool border_sequence(uint32_t length, const void *buffer, uint32_t max)
{
    return length == 0 || (buffer && length <= max);
}

bool border_registration(const muster_Registration *r)
{
    if (!border_process(r->process) || r->part >= MU_PARTS_MAX ||
        !border_string(r->broker, MU_FIELD_MAX) || !border_string(r->host, 4096) ||
        !border_sequence(r->agents._length, r->agents._buffer, MU_PART_AGENTS)) {
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
static bool border_home(const muster_Entry *e, bool of_a_broker)
{
    if (e->home[0] == '\0') {
        return true;
    }
    return of_a_broker && border_string(e->home, MU_NAME_MAX) && mu_name_valid(e->home);
}

bool border_entry(const muster_Entry *e, bool of_a_broker)
{
    return border_kind_word(e->kind) && border_state_word(e->state) &&
           (unsigned)e->full <= muster_BOX_DROP_LOWEST && border_home(e, of_a_broker);
}

/* Steps are counted and timed in lock step; else they tell the run's time, if they can. */
static bool border_step(const muster_Roster *r)
{
    if (r->step < 0 || r->step_ns == 0) {
        return !r->lockstep;
    }
    return (uint64_t)r->step + 2 <= (uint64_t)INT64_MAX / r->step_ns;
}

bool border_roster(const muster_Roster *r)
{
    if (!border_process(r->simulator) || !border_step(r) ||
        !border_sequence(r->processes._length, r->processes._buffer, MU_PROCESSES_MAX)) {
        return false;
    }
    for (uint32_t i = 0; i < r->processes._length; i++) {
        if (!border_process(r->processes._buffer[i])) {
            return false;
        }
    }
    return true;
}

static bool border_act(const muster_Act *act)
{
    return border_string(act->agent, MU_NAME_MAX) && border_state_word(act->state) &&
           border_sequence(act->mails._length, act->mails._buffer, MU_OUTBOX_MAX);
}

static bool border_trip(const muster_Trip *t)
{
    return border_string(t->agent, MU_NAME_MAX) && border_string(t->host, MU_NAME_MAX) &&
           border_string(t->asker, MU_NAME_MAX) && border_state_word(t->state) &&
           border_string(t->reason, MU_FIELD_MAX) && border_string(t->text, MU_CAPSULE_MAX - 1) &&
           t->slot < MU_LOCAL_AGENTS_MAX;
}

static bool border_glance(const muster_Glance *g)
{
    size_t most = g->word == muster_GLANCE_ASK ? MU_GLANCE_LINE_MAX : MU_GLANCE_BYTES_MAX - 1;
    return (unsigned)g->word <= muster_GLANCE_DECLINED && border_string(g->asker, MU_NAME_MAX) &&
           border_string(g->agent, MU_NAME_MAX) && border_string(g->text, most);
}

bool border_up(const muster_Up *up)
{
    if (!border_process(up->process) ||
        !border_sequence(up->acts._length, up->acts._buffer, MU_LOCAL_AGENTS_MAX) ||
        !border_sequence(up->acks._length, up->acks._buffer, MU_LOCAL_AGENTS_MAX) ||
        !border_sequence(up->trips._length, up->trips._buffer, MU_LOCAL_AGENTS_MAX) ||
        !border_sequence(up->glances._length, up->glances._buffer, MU_GLANCES_MAX)) {
        return false;
    }
    for (uint32_t i = 0; i < up->glances._length; i++) {
        if (!border_glance(&up->glances._buffer[i])) {
            return false;
        }
    }
    for (uint32_t i = 0; i < up->trips._length; i++) {
        if (!border_trip(&up->trips._buffer[i])) {
            return false;
        }
    }
    for (uint32_t i = 0; i < up->acts._length; i++) {
        if (!border_act(&up->acts._buffer[i])) {
            return false;
        }
    }
    for (uint32_t i = 0; i < up->acks._length; i++) {
        if (!border_string(up->acks._buffer[i].box, MU_NAME_MAX)) {
            return false;
        }
    }
    return true;
}

bool border_mail(const muster_Mail *m)
{
    return border_string(m->dst, MU_DST_MAX) && mu_address_valid(m->dst) &&
           border_string(m->performative, MU_FIELD_MAX) &&
           border_string(m->language, MU_FIELD_MAX) && border_string(m->ontology, MU_FIELD_MAX) &&
           border_string(m->reply_with, MU_FIELD_MAX) &&
           border_string(m->in_reply_to, MU_FIELD_MAX) &&
           border_string(m->conversation, MU_FIELD_MAX) && m->priority >= -1 && m->priority <= 1 &&
           (unsigned)m->level <= muster_LEVEL_SYNCED && border_string(m->content, MU_CONTENT_MAX);
}

bool border_process_name(const char *name)
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

const char *border_kind_word(muster_Kind kind)
{
    static const char *const words[] = {"agent", "robot", "host", "special"};
    return (unsigned)kind < sizeof words / sizeof words[0] ? words[kind] : NULL;
}

const char *border_state_word(muster_State state)
{
    static const char *const words[] = {"standby", "running", "suspended", "moving", "absent"};
    return (unsigned)state < sizeof words / sizeof words[0] ? words[state] : NULL;
}
