/* SPDX-License-Identifier: Apache-2.0 */
/* Takes agents in: checks the header of a snapshot, and gives a place, a mind and a name. */
#include "core/log.h"
#include "core/text.h"
#include "host/host.h"
#include "runtime/transfers.h"

#include <fnmatch.h>
#include <stdio.h>
#include <string.h>

/* --- answers ---------------------------------------------------------------------------------- */

void host_answer(struct host *h, const struct arrival *a, const char *performative,
                 const char *text)
{
    char content[MU_FAULT_TEXT_MAX + 1];
    struct mu_mail mail = {.dst = a->src,
                           .performative = performative,
                           .in_reply_to = a->reply_with,
                           .conversation = a->id,
                           .content = content};
    (void)mu_text_copy(content, sizeof content, text);
    if (a->reply_with[0] && mu_agent_send(h->agent, &mail, NULL) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", a->src);
    }
}

/* --- arrivals -----------------------------------------------------------------------------------
 * */

static bool name_is_welcome(const struct host *h, const char *name)
{
    const struct mu_option_list *take = &h->set->take;
    bool welcome = take->count == 0;
    for (size_t i = 0; i < take->count; i++) {
        welcome = welcome || fnmatch(take->items[i], name, 0) == 0;
    }
    return welcome;
}

struct arrival *host_find_deposited(struct host *h, const char *name)
{
    for (size_t i = 0; i < HOST_ARRIVALS; i++) {
        struct arrival *a = &h->arrivals[i];
        if (a->used && a->deposited && strcmp(a->name, name) == 0) {
            return a;
        }
    }
    return NULL;
}

static bool name_is_taken(const struct host *h, const char *name)
{
    const struct mu_member *m = mu_process_lookup(h->group.process, name);
    return m && m->state != MU_GONE;
}

/* @return a free place, or NULL */
static struct robot *place_find(struct host *h)
{
    for (uint32_t i = 0; i < h->group.count; i++) {
        struct robot *r = &h->group.robots[i];
        if (r->state == ROBOT_VACANT && !r->migration) {
            return r;
        }
    }
    return NULL;
}

static const char *objection(struct host *h, const struct arrival *a,
                             const struct snapshot_header *p)
{
    if (a->src[0] && (p->purpose == MIGRATION_LAUNCH) != a->directive) {
        return "launching is for agents that may direct this host";
    }
    if (!name_is_welcome(h, p->name)) {
        return "not-welcome";
    }
    if (p->purpose != MIGRATION_MOVE && name_is_taken(h, p->name)) {
        return "name-taken";
    }
    return NULL;
}

static mu_result mind_make(struct host *h, struct robot *r, const struct snapshot_header *p,
                           const char *rest, struct mu_fault *fault)
{
    bool launch = p->purpose == MIGRATION_LAUNCH;
    struct mind_options options = robot_mind_options(r, launch ? h->folder : NULL);
    options.seed = p->seed; /* a snapshot has the state of (random) itself */
    MU_TRY(mind_begin(r->mind, &options, fault));
    if (!launch) {
        return mind_restore(r->mind, rest, strlen(rest), fault);
    }
    MU_TRY(mind_load_text(r->mind, p->name, launch_rules(rest), fault));
    return launch_set_globals(r, rest, fault);
}

static mu_result join(struct robot *r, const struct snapshot_header *p)
{
    switch (p->purpose) {
    case MIGRATION_MOVE: return agent_arrive(r, &p->passage, MU_ON_ARRIVE);
    case MIGRATION_CLONE: return agent_arrive(r, &p->passage, MU_ON_CLONE);
    case MIGRATION_LAUNCH: return agent_arrive(r, &p->passage, MU_ON_CREATE);
    case MIGRATION_PURPOSES: break;
    }
    return MU_MALFORMED;
}

/* Frees a place, with what had begun there. */
static void place_clear(struct host *h, struct robot *r)
{
    struct mind *mind = r->mind;
    mind_close(mind);
    *r = (struct robot){.group = &h->group, .mind = mind, .step = -1};
    h->waiting[r - h->group.robots].used = false;
}

/* Gives the place to a new agent. */
static void place_take(struct host *h, struct robot *r, const struct snapshot_header *p,
                       const struct arrival *a)
{
    checkpoint_leave(r);
    place_clear(h, r);
    r->mails = p->mails;
    checkpoint_set_native(r, natives_have(h, p->name));
    r->returns_as = p->state;
    r->rules_left = p->rules_left;
    (void)mu_text_copy(r->name, sizeof r->name, p->name);
    struct arrival *waiting = &h->waiting[r - h->group.robots];
    *waiting = *a;
    waiting->text = (struct mu_text){.at = NULL};
    waiting->head = NULL;
    waiting->used = p->purpose != MIGRATION_MOVE || p->asker[0];
    if (p->asker[0]) {
        waiting->directive = true;
        (void)mu_text_copy(waiting->src, sizeof waiting->src, p->asker);
        (void)mu_text_copy(waiting->reply_with, sizeof waiting->reply_with, p->reply_with);
    }
}

bool host_deposit(struct host *h, struct arrival *a, char why[MU_FAULT_TEXT_MAX + 1])
{
    struct snapshot_header p;
    const char *rest = a->text.at;
    bool read = snapshot_header_read(&rest, &p);
    const char *wrong = read ? objection(h, a, &p) : "expected a passport";
    wrong = !wrong && p.purpose != MIGRATION_LAUNCH ? "lock-step" : wrong;
    wrong = !wrong && host_find_deposited(h, p.name) ? "name-taken" : wrong;
    char host[MU_NAME_MAX + 1];
    (void)mu_text_copy(host, sizeof host, h->group.host);
    muster_Trip word = {.word = muster_TRIP_NEW,
                        .agent = p.name,
                        .asker = host,
                        .state = (muster_State)p.state,
                        .host = host,
                        .text = a->text.at};
    if (!wrong && transfers_say(h->group.process, &word) != MU_OK) {
        wrong = "busy";
    }
    (void)mu_text_copy(why, MU_FAULT_TEXT_MAX + 1, wrong ? wrong : "");
    (void)mu_text_copy(a->name, sizeof a->name, wrong ? "" : p.name);
    a->deposited = !wrong;
    return !wrong;
}

/* @return NULL; and why is set */
static struct robot *not_taken(char why[MU_FAULT_TEXT_MAX + 1], const char *reason)
{
    (void)mu_text_copy(why, MU_FAULT_TEXT_MAX + 1, reason);
    return NULL;
}

/* Writes an agent that arrives to disk before its source releases it; one from a checkpoint is
 * there.  One that took part in no step here arrives once more. */
static void host_save_first(const struct host *h, struct robot *r, const struct arrival *a,
                            enum mu_state state)
{
    if (a->head) {
        checkpoint_own(r);
    } else if (h->set->robots->checkpoints.every_s > 0) {
        (void)checkpoint_write(r, state);
    }
    if (a->head && a->head->step >= 0) {
        robot_mind_take_up(r, a->head);
    }
}

/* Drops an older copy that waits for the name. */
static void older_drop(struct host *h, const struct snapshot_header *p)
{
    for (uint32_t i = 0; i < h->group.count && p->purpose == MIGRATION_MOVE; i++) {
        struct robot *r = &h->group.robots[i];
        if (robot_state_arrives(r->state) && strcmp(r->name, p->name) == 0 &&
            mu_agent_passage(r->agent).epoch < p->passage.epoch) {
            lifecycle_on_registered(r, r->agent, false, "out of date");
        }
    }
}

/* Lets an agent ask for its name.  @return false: the place is free again */
static bool agent_begin(struct host *h, struct robot *r, const struct snapshot_header *p,
                        const char *rest, char why[MU_FAULT_TEXT_MAX + 1])
{
    struct mu_fault fault;
    if (mind_make(h, r, p, rest, &fault) != MU_OK) {
        snprintf(why, MU_FAULT_TEXT_MAX + 1, "%.63s:%d: %.400s", fault.file, fault.line,
                 fault.text);
        place_clear(h, r);
        return false;
    }
    mu_result joined = join(r, p);
    if (joined != MU_OK) {
        place_clear(h, r);
    } else if (p->purpose == MIGRATION_LAUNCH) {
        joined = launch_join_groups(r, rest);
        if (joined != MU_OK) {
            group_process_drop(r);
        }
    }
    (void)mu_text_copy(why, MU_FAULT_TEXT_MAX + 1, joined != MU_OK ? mu_result_text(joined) : "");
    return joined == MU_OK;
}

struct robot *host_take_in(struct host *h, const struct arrival *a, char why[MU_FAULT_TEXT_MAX + 1])
{
    struct snapshot_header p;
    const char *rest = a->text.at;
    bool read = snapshot_header_read(&rest, &p);
    const char *wrong = read ? objection(h, a, &p) : "expected a passport";
    if (!wrong) {
        older_drop(h, &p);
    }
    struct robot *r = wrong ? NULL : place_find(h);
    wrong = wrong || r ? wrong : "full";
    if (wrong) {
        return not_taken(why, wrong);
    }
    place_take(h, r, &p, a);
    if (!agent_begin(h, r, &p, rest, why)) {
        return NULL;
    }
    host_save_first(h, r, a, p.state);
    if (p.purpose == MIGRATION_MOVE) {
        host_answer(h, a, "agree", p.name); /* the source releases the name now */
    }
    return r;
}
