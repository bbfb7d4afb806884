/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"

/* --- states of its reader and writer, and of its turn to be served ------------------------------
 */

/* clang-format off */
/* The letters of the tables; X is illegal. */
enum {
    X = 255,
    F = SESSION_FREE, A = SESSION_AWAY, T = SESSION_THERE, H = SESSION_HEARS,
    B = SESSION_AWAY_SILENT, U = SESSION_THERE_SILENT, I = SESSION_HEARS_SILENT,
    D = TURN_IDLE, W = TURN_HELD, N = TURN_REFUSED
};

static const unsigned char next_session[SESSIONS][SESSION_EVENTS] = {
    /*                        enters matched unmatched multicasts heard silent forgotten */
    [SESSION_FREE]         = {A,     X,      X,        X,         X,    X,     X},
    [SESSION_AWAY]         = {X,     T,      A,        X,         A,    B,     F},
    [SESSION_THERE]        = {X,     T,      A,        H,         T,    U,     X},
    [SESSION_HEARS]        = {X,     T,      A,        H,         H,    I,     X},
    [SESSION_AWAY_SILENT]  = {X,     U,      B,        X,         A,    B,     F},
    [SESSION_THERE_SILENT] = {X,     U,      B,        I,         T,    U,     X},
    [SESSION_HEARS_SILENT] = {X,     U,      B,        I,         H,    I,     X},
};

static const unsigned char next_turn[TURNS][TURN_EVENTS] = {
    /*                held round refused retried forgotten */
    [TURN_IDLE]    = {W,   D,    N,      D,      D},
    [TURN_HELD]    = {W,   D,    N,      W,      D},
    [TURN_REFUSED] = {X,   N,    N,      D,      D},
};
/* clang-format on */

/* --- processes -------------------------------------------------------------------------------- */

/* A process that was turned down and never met makes way, but only when its place is wanted. */
static bool process_is_needed(const struct process *at)
{
    return at->agents_count > 0 || at->claims > 0 || at->scope > 0 || processes_is_matched(at) ||
           at->speaks || (at->kind == PROCESS_BROKER && !processes_is_silent(at));
}

void processes_session_on(struct processes *p, uint32_t place, enum session_event event)
{
    struct process *at = &p->at[place];
    bool heard = processes_hears(at);
    unsigned next = next_session[at->session][event];
    MU_ASSERT(next != X);
    at->session = (enum session)next;
    p->hearers += (uint32_t)processes_hears(at) - (uint32_t)heard;
}

void processes_turn_on(struct processes *p, uint32_t place, enum turn_event event)
{
    struct process *at = &p->at[place];
    p->held -= at->turn == TURN_HELD;
    p->refused -= at->turn == TURN_REFUSED;
    unsigned next = next_turn[at->turn][event];
    MU_ASSERT(next != X);
    at->turn = (enum turn_state)next;
    p->held += at->turn == TURN_HELD;
    p->refused += at->turn == TURN_REFUSED;
}

static void process_forget(struct processes *p, uint32_t place)
{
    struct process *at = &p->at[place];
    bool gone = mu_table_remove(&p->names, at->name) == MU_OK;
    MU_ASSERT(gone);
    processes_turn_on(p, place, TURN_IS_FORGOTTEN);
    processes_session_on(p, place, SESSION_FORGOTTEN);
}

static uint32_t process_free(struct processes *p)
{
    if (p->names.count < p->top || p->top == MU_PROCESSES_MAX) {
        for (uint32_t i = 0; i < p->top; i++) {
            if (p->at[i].session == SESSION_FREE) {
                return i;
            }
        }
        for (uint32_t i = 0; i < p->top; i++) {
            if (!process_is_needed(&p->at[i])) {
                process_forget(p, i);
                return i;
            }
        }
        return MU_NONE;
    }
    return p->top++;
}

uint32_t processes_get(struct processes *p, const char *name)
{
    uint32_t place = processes_find(p, name);
    if (place != MU_NONE) {
        return place;
    }
    place = process_free(p);
    if (place == MU_NONE) {
        return MU_NONE;
    }
    struct process *at = &p->at[place];
    /* An earlier process may have left it in the queues: it stays there. */
    *at = (struct process){.turn = at->turn,
                           .queued = at->queued,
                           .flooded = at->flooded,
                           .flood_wake_ns = at->flood_wake_ns,
                           .seat = ++p->seats};
    bool fits = mu_text_copy(at->name, sizeof at->name, name);
    MU_ASSERT(fits && mu_table_put(&p->names, at->name, place) == MU_OK);
    processes_session_on(p, place, SESSION_ENTERS);
    return place;
}

void processes_tidy(struct processes *p, uint32_t place)
{
    struct process *at = &p->at[place];
    if (at->session != SESSION_FREE && !process_is_needed(at) && at->refusals_count == 0) {
        process_forget(p, place);
    }
}

/* What is no UTF-8 would break readers of the answer. */
static void refusal_name(char to[MU_PROCESS_MAX + 1], const char *name)
{
    uint32_t code;
    struct mu_text t = mu_text_in(to, MU_PROCESS_MAX + 1);
    for (size_t len; (len = mu_utf8_next(name, &code)) > 0; name += len) {
        bool broken = code == MU_UTF8_BROKEN && len == 1;
        if (t.len + len > MU_PROCESS_MAX) {
            break;
        }
        mu_text_add_bytes(&t, broken ? "?" : name, len);
    }
}

void processes_refuse(struct processes *p, uint32_t place, const char *name, muster_Refusal code,
                      const char *reason)
{
    struct process *at = &p->at[place];
    char cut[MU_PROCESS_MAX + 1];
    refusal_name(cut, name);
    uint32_t i = 0;
    while (i < at->refusals_count && strcmp(at->refusals[i].name, cut) != 0) {
        i++;
    }
    processes_wake(p, place);
    if (i == PROCESSES_REFUSALS) {
        at->roll_call_due = true; /* it asks again when it has heard of these */
        return;
    }
    memcpy(at->refusals[i].name, cut, sizeof cut);
    at->refusals[i].code = code;
    (void)mu_text_copy(at->refusals[i].reason, sizeof at->refusals[i].reason, reason);
    at->refusals_count += i == at->refusals_count;
}

void processes_accept(struct processes *p, uint32_t place, const char *name)
{
    struct process *at = &p->at[place];
    for (uint32_t i = 0; i < at->refusals_count; i++) {
        if (strcmp(at->refusals[i].name, name) == 0) {
            at->refusals[i] = at->refusals[--at->refusals_count];
            return;
        }
    }
}

void processes_wake(struct processes *p, uint32_t place)
{
    (void)mu_list_append(&p->queue, MU_LINKS(p->at, queued), place);
}

void processes_call_roll(struct processes *p, uint32_t place)
{
    p->at[place].roll_call_due = true;
    processes_wake(p, place);
}

uint32_t processes_next(struct processes *p)
{
    uint32_t place = mu_list_take(&p->queue, MU_LINKS(p->at, queued));
    p->all_awake = p->all_awake && place == MU_NONE;
    return place;
}

/* --- the agents of a process ------------------------------------------------------------------ */

static struct mu_links part_links(const struct broker *b)
{
    return MU_LINKS(b->registry.agents, resident.part);
}

static struct mu_links queue_links(const struct broker *b, enum resident_queue queue)
{
    return MU_LINKS(b->registry.agents, resident.links[queue]);
}

void processes_add_agent(struct broker *b, uint32_t place, uint32_t slot, uint32_t agent)
{
    struct process *at = &b->processes.at[place];
    uint32_t part = slot / MU_PART_AGENTS;
    MU_ASSERT(part < PROCESSES_PARTS);
    b->registry.agents[agent].resident = (struct resident){.slot = slot};
    (void)mu_list_prepend(&at->parts[part], part_links(b), agent);
    at->parts_top = part < at->parts_top ? at->parts_top : part + 1;
    at->agents_count++;
}

static void queue_leave(struct broker *b, enum resident_queue queue, uint32_t agent)
{
    struct process *at = &b->processes.at[b->registry.agents[agent].process];
    (void)mu_list_remove(&at->queues[queue], queue_links(b, queue), agent);
}

void processes_remove_agent(struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    struct process *at = &b->processes.at[a->process];
    queue_leave(b, RESIDENT_READY, agent);
    queue_leave(b, RESIDENT_STIRRED, agent);
    (void)mu_list_remove(&at->parts[a->resident.slot / MU_PART_AGENTS], part_links(b), agent);
    at->agents_count--;
}

uint32_t processes_next_agent_of(const struct broker *b, uint32_t agent)
{
    return mu_list_next(part_links(b), agent);
}

/* The first agent of the parts from this one on. */
static uint32_t first_from(const struct process *at, uint32_t part)
{
    while (part < at->parts_top && at->parts[part].count == 0) {
        part++;
    }
    return part < at->parts_top ? mu_list_first(&at->parts[part]) : MU_NONE;
}

uint32_t processes_first_agent(const struct broker *b, uint32_t place)
{
    return first_from(&b->processes.at[place], 0);
}

uint32_t processes_next_agent(const struct broker *b, uint32_t agent)
{
    const struct agent *a = &b->registry.agents[agent];
    uint32_t next = processes_next_agent_of(b, agent), part = a->resident.slot / MU_PART_AGENTS;
    return next != MU_NONE ? next : first_from(&b->processes.at[a->process], part + 1);
}

void processes_wake_agent(struct broker *b, uint32_t agent)
{
    uint32_t place = b->registry.agents[agent].process;
    if (place == MU_NONE) {
        return;
    }
    for (int queue = 0; queue < RESIDENT_QUEUES; queue++) {
        (void)mu_list_append(&b->processes.at[place].queues[queue], queue_links(b, queue), agent);
    }
    processes_wake(&b->processes, place);
}

uint32_t processes_pop_agent(struct broker *b, uint32_t place)
{
    uint32_t agent = mu_list_first(&b->processes.at[place].queues[RESIDENT_READY]);
    queue_leave(b, RESIDENT_READY, agent);
    queue_leave(b, RESIDENT_STIRRED, agent);
    return agent;
}

void processes_calm_agent(struct broker *b, uint32_t agent)
{
    queue_leave(b, RESIDENT_STIRRED, agent);
}
