/* SPDX-License-Identifier: Apache-2.0 */
/* The agents of a run, and which process each lives in. */
#include "sim/session/parts.h"

#include "core/text.h"
#include "muster/memory.h"

#include <string.h>

void agents_open(struct session_agents *a, const struct world *world)
{
    a->at = mu_startup_array(world->robot_count + MU_AGENTS_MAX, sizeof *a->at);
    a->coming = mu_startup_array(MU_CAPSULES_MAX, sizeof *a->coming);
    a->robots = a->count = (uint32_t)world->robot_count;
    mu_table_init(&a->robot_names, a->robots > 0 ? a->robots : 1);
    for (uint32_t i = 0; i < a->robots; i++) {
        struct session_agent *agent = &a->at[i];
        *agent = (struct session_agent){.controlled = true,
                                        .body = (int32_t)i,
                                        .totals = (int32_t)i,
                                        .process = -1,
                                        .next_process = -1};
        mu_text_copy(agent->name, sizeof agent->name, world->robots[i].name);
        (void)mu_table_put(&a->robot_names, agent->name, i);
    }
}

/* @return the index of the first one without a body whose name is not before this one */
static uint32_t place_of(const struct session_agents *a, const char *name)
{
    uint32_t low = a->robots, high = a->count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (strcmp(a->at[middle].name, name) < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

struct session_agent *agents_find(const struct session_agents *a, const char *name)
{
    uint32_t at = mu_table_find(&a->robot_names, name);
    if (at != MU_NONE && a->at[at].controlled) {
        return &a->at[at];
    }
    at = place_of(a, name);
    return at < a->count && strcmp(a->at[at].name, name) == 0 ? &a->at[at] : NULL;
}

mu_result agents_seat(struct session_agents *a, const char *name, int32_t process)
{
    struct session_agent *known = agents_find(a, name);
    if (known && (known->body >= 0 || known->state != muster_STATE_ABSENT)) {
        bool stays = known->process >= 0 && process >= 0; /* until the step ends */
        known->next_process = stays ? process : -1;
        known->process = stays ? known->process : process;
        return MU_OK;
    }
    uint32_t bodiless = a->count - a->robots;
    if (a->coming_count == MU_CAPSULES_MAX || bodiless + a->coming_count >= MU_AGENTS_MAX) {
        return MU_FULL;
    }
    struct session_agent *coming = &a->coming[a->coming_count++];
    *coming = (struct session_agent){
        .controlled = true, .body = -1, .totals = -1, .process = process, .next_process = -1};
    mu_text_copy(coming->name, sizeof coming->name, name);
    return MU_OK;
}

static void agent_renumber(struct session_agent *agent, int32_t from, int32_t to)
{
    if (to < 0 && agents_home(agent) == from) {
        agent->process = agent->next_process = -1;
        return;
    }
    if (to < 0 && agent->process == from) {
        agent->process = agent->next_process;
    }
    agent->process = agent->process == from ? to : agent->process;
    agent->next_process = agent->next_process == from ? to : agent->next_process;
}

void agents_renumber(struct session_agents *a, int32_t from, int32_t to)
{
    for (uint32_t i = 0; i < a->count; i++) {
        agent_renumber(&a->at[i], from, to);
    }
    for (uint32_t i = 0; i < a->coming_count; i++) {
        agent_renumber(&a->coming[i], from, to);
    }
}

int32_t agents_home(const struct session_agent *agent)
{
    return agent->next_process >= 0 ? agent->next_process : agent->process;
}

bool agents_live_in(const struct session_agents *a, int32_t process)
{
    bool any = false;
    for (uint32_t i = 0; i < a->count; i++) {
        const struct session_agent *agent = &a->at[i];
        bool counts = agent->body >= 0 || agent->state != muster_STATE_ABSENT;
        any = any || (counts && (agent->process == process || agent->next_process == process));
    }
    for (uint32_t i = 0; i < a->coming_count; i++) {
        any = any || a->coming[i].process == process;
    }
    return any;
}

static void agent_insert(struct session_agents *a, const struct session_agent *coming)
{
    uint32_t at = place_of(a, coming->name);
    memmove(&a->at[at + 1], &a->at[at], (a->count - at) * sizeof *a->at);
    a->at[at] = *coming;
    a->count++;
}

void agents_expect(struct session_agents *a, const char *name, int32_t totals)
{
    struct session_agent agent = {
        .controlled = true, .body = -1, .totals = totals, .process = -1, .next_process = -1};
    mu_text_copy(agent.name, sizeof agent.name, name);
    agent_insert(a, &agent);
}

static void agent_move(struct session_agent *agent)
{
    agent->process = agents_home(agent);
    agent->next_process = -1;
}

void agents_move_robots(struct session_agents *a)
{
    for (uint32_t i = 0; i < a->robots; i++) {
        agent_move(&a->at[i]);
    }
}

void agents_settle(struct session_agents *a)
{
    uint32_t kept = a->robots;
    for (uint32_t i = a->robots; i < a->count; i++) {
        agent_move(&a->at[i]);
        if (a->at[i].state != muster_STATE_ABSENT) {
            a->at[kept++] = a->at[i];
        }
    }
    a->count = kept;
    for (uint32_t i = 0; i < a->coming_count; i++) {
        agent_insert(a, &a->coming[i]);
    }
    a->coming_count = 0;
}
