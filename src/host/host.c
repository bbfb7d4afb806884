/* SPDX-License-Identifier: Apache-2.0 */
#include "host/host.h"

#include "core/log.h"
#include "core/text.h"
#include "muster/memory.h"
#include "runtime/transfers.h"

#include <stdio.h>
#include <string.h>

/* --- the broker's word ------------------------------------------------------------------------ */

static void word_say(struct host *h, const muster_Trip *to, muster_TripWord word, uint32_t slot,
                     const char *reason)
{
    char cut[MU_FIELD_MAX + 1];
    (void)mu_text_copy(cut, sizeof cut, reason);
    muster_Trip out = {
        .word = word, .agent = to->agent, .epoch = to->epoch, .slot = slot, .reason = cut};
    if (transfers_say(h->group.process, &out) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "name=%s", to->agent);
    }
}

/* @return whether the snapshot is of the agent that the broker names */
static bool header_fits(const muster_Trip *word)
{
    struct snapshot_header p;
    const char *text = word->text;
    return snapshot_header_read(&text, &p) && strcmp(p.name, word->agent) == 0 &&
           p.passage.epoch == word->epoch;
}

/* Takes in an agent that the broker kept and hands over. */
static void arrival_hear(struct host *h, const muster_Trip *word)
{
    char why[MU_FAULT_TEXT_MAX + 1] = "too-large";
    size_t len = strlen(word->text);
    bool fits = len <= (size_t)h->set->bytes;
    struct arrival *launched =
        strcmp(word->asker, h->group.host) == 0 ? host_find_deposited(h, word->agent) : NULL;
    struct arrival a = launched ? *launched : (struct arrival){.used = true};
    a.text = (struct mu_text){.at = word->text, .len = len, .size = len + 1};
    struct robot *r = NULL;
    if (fits && !header_fits(word)) {
        (void)mu_text_copy(why, sizeof why, "another agent's passport");
    } else if (fits) {
        r = host_take_in(h, &a, why);
    }
    if (!r) {
        mu_log(MU_LOG_WARNING, "arrival-refused", "name=%s: %s", word->agent, why);
    }
    word_say(h, word, r ? muster_TRIP_READY : muster_TRIP_REFUSED, r ? transfers_slot(r->agent) : 0,
             r ? "" : why);
}

/* Ends a launch; an agent that lives answers for itself. */
static void launched_end(struct host *h, const muster_Trip *word)
{
    struct arrival *a = host_find_deposited(h, word->agent);
    if (a && word->word == muster_TRIP_REFUSED) {
        host_answer(h, a, "refuse", word->reason);
    }
    if (a) {
        a->used = a->deposited = false;
    }
}

/* Drops a copy that did not get the name. */
static void copy_drop(struct host *h, const muster_Trip *word)
{
    for (uint32_t i = 0; i < h->group.count; i++) {
        struct robot *r = &h->group.robots[i];
        if (robot_state_arrives(r->state) && strcmp(r->name, word->agent) == 0 &&
            mu_agent_passage(r->agent).epoch == word->epoch) {
            group_process_drop(r);
        }
    }
}

void host_hear(void *self, const muster_Trip *word)
{
    struct host *h = self;
    if (word->word == muster_TRIP_ARRIVE) {
        arrival_hear(h, word);
        return;
    }
    if (strcmp(word->asker, h->group.host) == 0) {
        launched_end(h, word);
    } else if (word->word == muster_TRIP_REFUSED && !word->asker[0]) {
        copy_drop(h, word);
    }
    migration_hear(&h->group, word);
}

/* @return whether an agent is on its way back */
static bool agent_restore(struct group_process *g, const char *name,
                          const struct checkpoint_head *head, const char *text)
{
    char why[MU_FAULT_TEXT_MAX + 1] = "cannot be read";
    /* Nothing writes to that text. */
    const struct arrival back = {.text = {.at = (char *)(uintptr_t)text, .len = strlen(text)},
                                 .head = head};
    bool taken = text[0] && host_take_in((struct host *)g, &back, why);
    if (!taken) {
        fprintf(stderr, "muster host: the checkpoint of %s: %s\n", name, why);
    }
    return taken;
}

uint32_t host_restore(struct host *h)
{
    return checkpoint_each(&h->group, agent_restore);
}

/* --- the host itself -------------------------------------------------------------------------- */

/* Answers a sender that waits until the agent has its name. */
static void on_arrived(struct robot *r, bool accepted, const char *reason)
{
    struct host *h = (struct host *)r->group;
    struct arrival *a = &h->waiting[r - h->group.robots];
    char said[2 * MU_NAME_MAX + 16];
    if (!a->used) {
        return;
    }
    a->used = false;
    snprintf(said, sizeof said, "%s at %s", r->name, h->group.host);
    host_answer(h, a, accepted ? a->directive ? "inform" : "agree" : "failure",
                accepted ? said : reason);
}

static enum mu_take take_arrival(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    arrival_take(self, mail);
    return MU_TAKEN;
}

static const struct mu_layer_handler host_handlers[] = {
    {MU_LAYER_SYSTEM, "arrive", take_arrival},
    {0, NULL, NULL},
};
static const struct mu_agent_kind host_kind = {.name = "host", .handlers = host_handlers};

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    struct host *h = self;
    if (accepted) {
        mu_log(MU_LOG_INFO, "registered", "name=%s", mu_agent_name(a));
        return;
    }
    fprintf(
        stderr,
        "muster host: the broker refuses the name %s: %s; muster lookup %s says where that is\n",
        mu_agent_name(a), reason, mu_agent_name(a));
    h->group.refused = true;
    mu_process_stop(h->group.process);
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    struct host *h = self;
    (void)migration_take_answer(&h->group, mail);
}

static void on_directive(void *self, mu_agent *a, const struct mu_mail *mail)
{
    if (strcmp(mail->performative, "launch") == 0) {
        arrival_take(self, mail);
    } else {
        mail_refuse_directive(a, mail);
    }
}

static void on_state(void *self, mu_agent *a, enum mu_state state)
{
    (void)a;
    struct host *h = self;
    if (state == MU_GONE) {
        mu_process_stop(h->group.process);
    }
}

struct host *host_make(const struct host_options *set)
{
    struct host *h = mu_startup_alloc(sizeof *h);
    h->set = set;
    agent_reserve(&h->group, set->robots, (uint32_t)set->agents, set->robots->name);
    h->waiting = mu_startup_array(h->group.count, sizeof *h->waiting);
    h->group.on_arrived = on_arrived;
    for (uint32_t i = 0; i < h->group.count; i++) {
        h->group.robots[i].mind = mind_reserve();
    }
    arrivals_reserve(h);
    return h;
}

mu_result host_join(struct host *h)
{
    struct mu_handlers handlers = {.self = h,
                                   .on_registered = on_registered,
                                   .on_mail = on_mail,
                                   .on_directive = on_directive,
                                   .on_state = on_state};
    MU_TRY(mu_agent_join(h->group.process, &h->agent, h->group.host, MU_KIND_HOST, 0, &handlers));
    mu_agent_be(h->agent, &host_kind);
    mu_agent_decline_broadcasts(h->agent);
    h->group.envoy = h->agent;
    return MU_OK;
}
