/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/control/parts.h"
#include "core/fields.h"

/* --- by name ---------------------------------------------------------------------------------- */

void recipients_of_names(struct broker *b, const char *names, uint32_t sender,
                         struct recipients *to)
{
    char name[MU_NAME_MAX + 1];
    uint64_t mark = ++b->registry.mark;
    while (*names && mu_address_next(&names, name)) {
        uint32_t agent = registry_addressee(&b->registry, name);
        if (agent == MU_NONE ||
            !scope_addresses(b->registry.agents[sender].scope, b->registry.agents[agent].scope)) {
            to->unknown++;
        } else if (b->registry.agents[agent].mark != mark) {
            b->registry.agents[agent].mark = mark;
            to->agents[to->count++] = agent;
        }
    }
}

void recipients_of_answer(struct broker *b, const char *names, uint32_t sender,
                          struct recipients *to)
{
    char name[MU_NAME_MAX + 1];
    uint64_t mark = ++b->registry.mark;
    bool open = !clock_collects(&b->clock);
    struct mu_text read = mu_text_in(name, sizeof name);
    to->count = to->refused = 0;
    while (mu_fields_next(&names, &read) || read.cut) {
        uint32_t agent = read.cut ? MU_NONE : registry_addressee(&b->registry, name);
        if (agent != MU_NONE && agent != sender && !registry_is_own(agent) &&
            b->registry.agents[agent].mark != mark && (open || !view_inside(b, agent))) {
            b->registry.agents[agent].mark = mark;
            to->agents[to->count++] = agent;
        }
    }
    to->unknown = to->count == 0 ? 1 : 0;
}

/* --- by group --------------------------------------------------------------------------------- */

/* Members of a group that are inside, or that are not. Which are the former is for those
 * inside to say, whatever another broker has said meanwhile. */
static void recipients_of_members(struct broker *b, const char *group, bool inside, uint32_t sender,
                                  struct recipients *to)
{
    uint32_t place = 0;
    for (const char *name; (name = groups_member(&b->pages.groups, group, inside, &place));) {
        uint32_t agent = registry_addressee(&b->registry, name);
        if (agent != MU_NONE && agent != sender && view_inside(b, agent) == inside) {
            to->agents[to->count++] = agent;
        }
    }
}

/* The members of a group, the absent ones, too.  Members of a run know no other groups than
 * those that are seen inside. */
static void recipients_of_group(struct broker *b, const char *group, uint32_t sender,
                                struct recipients *to)
{
    if (!groups_exists(&b->pages.groups, group, view_inside(b, sender))) {
        to->unknown++;
        return;
    }
    if (clock_by_steps(&b->clock)) {
        recipients_of_members(b, group, true, sender, to);
    }
    recipients_of_members(b, group, false, sender, to);
}

/* --- by kind ------------------------------------------------------------------------------- */

static bool kind_is_addressed(enum mu_address_kind kind, muster_Kind of)
{
    return kind == MU_ADDRESS_ALL || (kind == MU_ADDRESS_ROBOTS && of == muster_KIND_ROBOT) ||
           (kind == MU_ADDRESS_SPECIAL && of == muster_KIND_SPECIAL);
}

void recipients_of_letter(struct broker *b, const muster_Mail *letter, uint32_t sender,
                          struct recipients *to)
{
    to->count = to->unknown = to->refused = 0;
    enum mu_address_kind kind = mu_address_kind(letter->dst);
    if (kind == MU_ADDRESS_NAMES) {
        recipients_of_names(b, letter->dst, sender, to);
        return;
    }
    if (kind == MU_ADDRESS_GROUP) {
        recipients_of_group(b, mu_address_rest(letter->dst), sender, to);
        return;
    }
    if (kind == MU_ADDRESS_SCHEME) {
        to->unknown += view_resolver(b, letter->dst) == MU_NONE;
        return;
    }
    /* A broadcast from inside does not go beyond the broker: agents there are known by the wall
     * clock. */
    bool inside = view_inside(b, sender);
    for (uint32_t i = 0; i < b->registry.live; i++) {
        uint32_t agent = b->registry.order[i];
        const struct agent *a = &b->registry.agents[agent];
        if (!registry_is_own(agent) && agent != sender && a->process != MU_NONE &&
            kind_is_addressed(kind, a->is.kind) &&
            !(kind == MU_ADDRESS_ALL && a->is.no_broadcasts && letter->layer != 0) &&
            !(inside && names_is_beyond(&b->registry, &b->processes, agent))) {
            to->agents[to->count++] = agent;
        }
    }
}

/* Changes that may name an agent: in which of their fields, from 1. */
static const struct {
    const char *performative;
    unsigned field;
} changes[] = {{"group-join", 2}, {"group-leave", 2}, {"advertise", 4}, {"withdraw", 2}};

static unsigned field_of_agent(const struct mail *question)
{
    for (size_t i = 0; i < sizeof changes / sizeof changes[0]; i++) {
        if (question->letter.layer == 2 &&
            strcmp(question->letter.performative, changes[i].performative) == 0) {
            return changes[i].field;
        }
    }
    return 0;
}

/* @return the agent in whose name it is to change something, if it names one; else MU_NONE */
static uint32_t agent_named(const struct broker *b, const struct mail *question)
{
    unsigned field = field_of_agent(question);
    const char *content = question->letter.content;
    char name[MU_NAME_MAX + 1];
    bool whole = false;
    struct mu_text read = mu_text_in(name, sizeof name);
    for (unsigned i = 0; i < field; i++) {
        whole = mu_fields_next(&content, &read);
        if (!whole && !read.cut) {
            return MU_NONE;
        }
    }
    return whole ? registry_find(&b->registry, name) : MU_NONE;
}

/* Whether one agent may speak for another is for the broker of the other to say: a change in the
 * name of an agent beyond another broker goes there, as its mail does. @return the receiver */
static uint32_t handler_of(const struct broker *b, const struct mail *m)
{
    uint32_t agent = agent_named(b, m);
    bool is_elsewhere = agent != MU_NONE && agent != m->sender &&
                        names_is_beyond(&b->registry, &b->processes, agent) &&
                        !view_inside(b, m->sender);
    return is_elsewhere ? agent : REGISTRY_BROKER;
}

void recipients_of_mail(struct broker *b, const struct mail *m, struct recipients *to)
{
    bool is_question = m->letter.layer == 2 && strcmp(m->letter.dst, "broker") == 0;
    if (m->only == MU_NONE && !is_question) {
        recipients_of_letter(b, &m->letter, m->sender, to);
        return;
    }
    to->unknown = to->refused = 0;
    to->count = 1;
    to->agents[0] = is_question ? handler_of(b, m) : m->only;
}

bool recipients_has_member_change(const struct broker *b, const struct mail *question)
{
    uint32_t agent = agent_named(b, question);
    return agent != MU_NONE && view_inside(b, agent);
}
