/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/names/names.h"

#include "core/name.h"
#include "core/text.h"
#include "muster/memory.h"

/* clang-format off */
/* The letters of the table; X is illegal. */
enum {
    X = 255,
    L = NAMED_LASTS, R = NAMED_ENDS_WITH_RUN, E = NAMED_ENDS, D = NAMED_ENDED
};

static const unsigned char next_named[NAMED_STATES][NAMED_EVENTS] = {
    /*                       borne disposed disposed by step cleared */
    [NAMED_LASTS]         = {L,    E,       R,               X},
    [NAMED_ENDS_WITH_RUN] = {L,    R,       R,               D},
    [NAMED_ENDS]          = {L,    E,       R,               D},
    [NAMED_ENDED]         = {L,    X,       X,               X},
};
/* clang-format on */

void registry_named_on(struct registry *r, uint32_t agent, enum name_event event)
{
    struct agent *a = &r->agents[agent];
    unsigned next = next_named[a->named][event];
    MU_ASSERT(next != X);
    a->named = (enum name_state)next;
}

void registry_init(struct registry *r, uint32_t names)
{
    MU_ASSERT(names <= MU_AGENTS_MAX);
    mu_pool_init(&r->ordinary, names + REGISTRY_OWN);
    mu_pool_init(&r->kept, REGISTRY_KEPT);
    r->agents = mu_startup_array(REGISTRY_MAX, sizeof *r->agents);
    mu_table_init(&r->graveyard.names, GRAVES_MAX);
    changelog_init(&r->changes, REGISTRY_MAX);
    mu_table_init(&r->names, REGISTRY_MAX + REGISTRY_OWN);
}

const char *registry_objection(const char *name, muster_Kind kind)
{
    if (!mu_name_valid(name)) {
        return "not a valid name";
    }
    if (!mu_name_reserved(name)) {
        return NULL;
    }
    if (strcmp(name, "observer") != 0 && strcmp(name, "operator") != 0) {
        return "reserved name";
    }
    return kind == muster_KIND_SPECIAL ? NULL : "reserved for a special agent";
}

/* @return the place of a name in the order; it comes and goes so seldom that moving the others is
 * cheap */
static uint32_t order_find(const struct registry *r, const char *name)
{
    uint32_t lo = 0, hi = r->live;
    while (lo < hi) {
        uint32_t mid = lo + (hi - lo) / 2;
        if (strcmp(r->agents[r->order[mid]].name, name) < 0) {
            lo = mid + 1;
        } else {
            hi = mid;
        }
    }
    return lo;
}

static void order_insert(struct registry *r, uint32_t agent)
{
    uint32_t at = order_find(r, r->agents[agent].name);
    memmove(&r->order[at + 1], &r->order[at], (r->live - at) * sizeof *r->order);
    r->order[at] = agent;
    r->live++;
}

static void order_remove(struct registry *r, uint32_t agent)
{
    uint32_t at = order_find(r, r->agents[agent].name);
    MU_ASSERT(r->order[at] == agent);
    array_remove(r->order, sizeof *r->order, &r->live, at);
}

static void agent_clear(struct agent *a)
{
    *a = (struct agent){.process = MU_NONE, .left = MU_NONE};
    a->is.state = muster_STATE_ABSENT;
}

/* @return the index, to which the name has been given; MU_NONE: there was none to give */
static uint32_t index_name(struct registry *r, uint32_t index, const char *name)
{
    if (index == MU_NONE) {
        return MU_NONE;
    }
    struct agent *a = &r->agents[index];
    agent_clear(a);
    bool fits = mu_text_copy(a->name, sizeof a->name, name);
    MU_ASSERT(fits && mu_table_put(&r->names, a->name, index) == MU_OK);
    order_insert(r, index);
    graveyard_raise(&r->graveyard, a);
    r->count = index < r->count ? r->count : index + 1;
    return index;
}

uint32_t registry_add(struct registry *r, const char *name)
{
    return index_name(r, mu_pool_take(&r->ordinary), name);
}

void registry_alias(struct registry *r, uint32_t agent, const char *alias)
{
    mu_result put = alias ? mu_table_put(&r->names, alias, agent) : MU_OK;
    MU_ASSERT(put == MU_OK);
}

uint32_t registry_add_command(struct registry *r, const char *name)
{
    uint32_t kept = mu_pool_take(&r->kept);
    return index_name(r, kept != MU_NONE ? REGISTRY_ORDINARY + kept : MU_NONE, name);
}

void registry_remove(struct registry *r, uint32_t agent)
{
    struct agent *a = &r->agents[agent];
    MU_ASSERT(a->process == MU_NONE && a->claims.count == 0 && !a->unsaved);
    graveyard_bury(&r->graveyard, a);
    order_remove(r, agent);
    (void)mu_table_remove(&r->names, a->name);
    changelog_remove(&r->changes, agent);
    (void)changelog_gone(
        &r->changes); /* a process that knew the name knows that its bearer has left */
    agent_clear(a);
    if (agent < REGISTRY_ORDINARY) {
        mu_pool_give(&r->ordinary, agent);
    } else {
        mu_pool_give(&r->kept, agent - REGISTRY_ORDINARY);
    }
    registry_mark_page(r, agent / REGISTRY_PAGE);
}

bool registry_is_crowded(const struct registry *r)
{
    return r->live >= r->ordinary.size - (r->ordinary.size - REGISTRY_OWN) / 8;
}

static struct mu_links page_links(struct registry *r)
{
    return (struct mu_links){r->pages, sizeof r->pages[0]};
}

void registry_mark_page(struct registry *r, uint32_t page)
{
    (void)mu_list_append(&r->news, page_links(r), page);
}

void registry_touch(struct registry *r, uint32_t agent)
{
    changelog_touch(&r->changes, agent);
    registry_mark_page(r, agent / REGISTRY_PAGE);
}

uint64_t registry_last_seq(const struct agent *a)
{
    uint64_t earlier = a->seq.seen ? 0 : a->seq.earlier;
    uint64_t last = a->seq.seen > a->seq.durable ? a->seq.seen : a->seq.durable;
    last = last > a->seq.elsewhere ? last : a->seq.elsewhere;
    return last > earlier ? last : earlier;
}

uint32_t registry_next_page(struct registry *r)
{
    return mu_list_take(&r->news, page_links(r));
}

void registry_seat(struct registry *r, uint32_t agent, uint32_t process, const char *place,
                   const struct presence *presence, uint64_t wall_ns)
{
    struct agent *a = &r->agents[agent];
    r->present += a->process == MU_NONE && !registry_is_own(agent);
    a->process = process;
    (void)mu_text_copy(a->place, sizeof a->place, place);
    a->is = *presence;
    a->since_wall_ns = wall_ns;
    if (process != MU_NONE) {
        names_bearer_on(r, agent, BEARER_SEATS);
    }
    a->report = REPORT_THERE;
    registry_named_on(r, agent, NAMED_BORNE);
    registry_touch(r, agent);
}

void registry_unseat(struct registry *r, uint32_t agent, uint64_t wall_ns)
{
    struct agent *a = &r->agents[agent];
    MU_ASSERT(a->process != MU_NONE);
    r->present--;
    a->process = MU_NONE;
    a->is.state = muster_STATE_ABSENT;
    a->since_wall_ns = wall_ns;
    names_bearer_on(r, agent, BEARER_UNSEATS);
    a->report = REPORT_THERE;
    registry_touch(r, agent);
}

bool registry_update(struct registry *r, uint32_t agent, const struct presence *presence,
                     uint64_t wall_ns)
{
    struct agent *a = &r->agents[agent];
    bool same_state = a->is.state == presence->state;
    bool same = same_state && a->is.kind == presence->kind && a->is.pid == presence->pid &&
                strcmp(a->is.host, presence->host) == 0 &&
                strcmp(a->is.home, presence->home) == 0 &&
                a->is.busy_since_wall_ns == presence->busy_since_wall_ns &&
                strcmp(a->is.reason, presence->reason) == 0;
    a->is = *presence;
    a->report = REPORT_THERE;
    registry_named_on(r, agent, NAMED_BORNE);
    if (same) {
        return false;
    }
    if (!same_state) {
        a->since_wall_ns = wall_ns;
    }
    registry_touch(r, agent);
    return true;
}

int registry_compare(const void *x, const void *y, const void *registry)
{
    const uint32_t *one = x, *other = y;
    const struct registry *r = registry;
    return strcmp(r->agents[*one].name, r->agents[*other].name);
}

void registry_line(const struct registry *r, uint32_t agent, const char *broker, muster_Member *out)
{
    struct agent *a = &r->agents[agent];
    *out = (muster_Member){.name = a->name,
                           .kind = a->is.kind,
                           .state = a->is.state,
                           .process = a->place,
                           .host = a->is.host,
                           .pid = a->is.pid,
                           .since_wall_ns = a->since_wall_ns,
                           .busy_since_wall_ns = a->is.busy_since_wall_ns,
                           .reason = a->is.reason};
    out->broker = a->is.home[0] ? a->is.home : sample_text(broker);
}
