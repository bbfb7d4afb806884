/* SPDX-License-Identifier: Apache-2.0 */
#include "host/host.h"

#include "core/log.h"
#include "core/text.h"
#include "muster/memory.h"
#include "runtime/trips.h"

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

/* Who waits for more than that it is here is told when it has its name. */
static void on_arrived(struct robot *r, bool accepted, const char *reason)
{
    struct host *h = (struct host *)r->crew;
    struct arrival *a = &h->waiting[r - h->crew.robots];
    char said[2 * MU_NAME_MAX + 16];
    if (!a->used) {
        return;
    }
    a->used = false;
    snprintf(said, sizeof said, "%s at %s", r->name, h->crew.host);
    host_answer(h, a, accepted ? a->directive ? "inform" : "agree" : "failure",
                accepted ? said : reason);
}

/* --- who comes -------------------------------------------------------------------------------- */

static bool name_is_welcome(const struct host *h, const char *name)
{
    const struct mu_option_list *take = &h->set->take;
    bool welcome = take->count == 0;
    for (size_t i = 0; i < take->count; i++) {
        welcome = welcome || fnmatch(take->items[i], name, 0) == 0;
    }
    return welcome;
}

/* @return the arrival of that name that the broker has, or NULL */
static struct arrival *deposited_find(struct host *h, const char *name)
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
    const struct mu_member *m = mu_process_lookup(h->crew.process, name);
    return m && m->state != MU_GONE;
}

/* @return a free place, or NULL */
static struct robot *place_find(struct host *h)
{
    for (uint32_t i = 0; i < h->crew.count; i++) {
        struct robot *r = &h->crew.robots[i];
        if (r->out && !r->trip) {
            return r;
        }
    }
    return NULL;
}

static const char *objection(struct host *h, const struct arrival *a, const struct passport *p)
{
    if (a->src[0] && (p->purpose == TRIP_LAUNCH) != a->directive) {
        return "launching is for those who may direct this host";
    }
    if (!name_is_welcome(h, p->name)) {
        return "not-welcome";
    }
    if (p->purpose != TRIP_MOVE && name_is_taken(h, p->name)) {
        return "name-taken";
    }
    return NULL;
}

static mu_result mind_make(struct host *h, struct robot *r, const struct passport *p,
                           const char *rest, struct mu_fault *fault)
{
    bool launch = p->purpose == TRIP_LAUNCH;
    struct mind_options options = robot_options(r, launch ? h->folder : NULL);
    options.seed = p->seed; /* a capsule has the state of (random) itself */
    MU_TRY(mind_begin(r->mind, &options, fault));
    if (!launch) {
        return mind_restore(r->mind, rest, strlen(rest), fault);
    }
    MU_TRY(mind_load_text(r->mind, p->name, launch_rules(rest), fault));
    return launch_set_globals(r, rest, fault);
}

static mu_result join(struct robot *r, const struct passport *p)
{
    switch (p->purpose) {
    case TRIP_MOVE: return robot_arrive(r, &p->passage, MU_ON_ARRIVE);
    case TRIP_CLONE: return robot_arrive(r, NULL, MU_ON_CLONE);
    case TRIP_LAUNCH: return robot_arrive(r, NULL, MU_ON_CREATE);
    case TRIP_PURPOSES: break;
    }
    return MU_MALFORMED;
}

/* Nobody is there, nor is who began to be. */
static void place_clear(struct host *h, struct robot *r)
{
    struct mind *mind = r->mind;
    mind_close(mind);
    *r = (struct robot){.crew = &h->crew, .mind = mind, .out = true, .step = -1};
    h->waiting[r - h->crew.robots].used = false;
}

/* The place is a new agent's. */
static void place_take(struct host *h, struct robot *r, const struct passport *p,
                       const struct arrival *a)
{
    checkpoint_leave(r);
    place_clear(h, r);
    r->mails = p->mails;
    r->native = natives_have(h, p->name);
    r->returns_as = p->state;
    r->rules_left = p->rules_left;
    (void)mu_text_copy(r->name, sizeof r->name, p->name);
    struct arrival *waiting = &h->waiting[r - h->crew.robots];
    *waiting = *a;
    waiting->text = (struct mu_text){.at = NULL};
    waiting->head = NULL;
    waiting->used = p->purpose != TRIP_MOVE || p->asker[0];
    if (p->asker[0]) {
        waiting->directive = true;
        (void)mu_text_copy(waiting->src, sizeof waiting->src, p->asker);
        (void)mu_text_copy(waiting->reply_with, sizeof waiting->reply_with, p->reply_with);
    }
}

bool host_deposit(struct host *h, struct arrival *a, char why[MU_FAULT_TEXT_MAX + 1])
{
    struct passport p;
    const char *rest = a->text.at;
    bool read = passport_read(&rest, &p);
    const char *wrong = read ? objection(h, a, &p) : "expected a passport";
    wrong = !wrong && p.purpose != TRIP_LAUNCH ? "lock-step" : wrong;
    wrong = !wrong && deposited_find(h, p.name) ? "name-taken" : wrong;
    char host[MU_NAME_MAX + 1];
    (void)mu_text_copy(host, sizeof host, h->crew.host);
    muster_Trip word = {.word = muster_TRIP_NEW,
                        .agent = p.name,
                        .asker = host,
                        .state = (muster_State)p.state,
                        .host = host,
                        .text = a->text.at};
    if (!wrong && trips_say(h->crew.process, &word) != MU_OK) {
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

/* Who comes is written down before the source lets go; who comes back is already.  One that came
 * and lived through no step here comes once more. */
static void host_save_first(const struct host *h, struct robot *r, const struct arrival *a,
                            enum mu_state state)
{
    if (a->head) {
        checkpoint_own(r);
    } else if (h->set->robots.checkpoints.every_s > 0) {
        (void)checkpoint_write(r, state);
    }
    if (a->head && a->head->step >= 0) {
        robot_take_up(r, a->head);
    }
}

/* An older copy that waits for the name has been overtaken. */
static void older_drop(struct host *h, const struct passport *p)
{
    for (uint32_t i = 0; i < h->crew.count && p->purpose == TRIP_MOVE; i++) {
        struct robot *r = &h->crew.robots[i];
        if (r->arrives && strcmp(r->name, p->name) == 0 &&
            mu_agent_passage(r->agent).epoch < p->passage.epoch) {
            robot_on_registered(r, r->agent, false, "out of date");
        }
    }
}

/* Lets who has come ask for the name.  @return whether that went well; else nobody is there */
static bool agent_begin(struct host *h, struct robot *r, const struct passport *p, const char *rest,
                        char why[MU_FAULT_TEXT_MAX + 1])
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
    } else if (p->purpose == TRIP_LAUNCH) {
        joined = launch_join_groups(r, rest);
        if (joined != MU_OK) {
            robot_drop(r);
        }
    }
    (void)mu_text_copy(why, MU_FAULT_TEXT_MAX + 1, joined != MU_OK ? mu_result_text(joined) : "");
    return joined == MU_OK;
}

struct robot *host_take_in(struct host *h, const struct arrival *a, char why[MU_FAULT_TEXT_MAX + 1])
{
    struct passport p;
    const char *rest = a->text.at;
    bool read = passport_read(&rest, &p);
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
    if (p.purpose == TRIP_MOVE) {
        host_answer(h, a, "agree", p.name); /* it waits for the name, which is let go now */
    }
    return r;
}

/* --- the broker's word ------------------------------------------------------------------------ */

static void word_say(struct host *h, const muster_Trip *to, muster_TripWord word, uint32_t slot,
                     const char *reason)
{
    char cut[MU_FIELD_MAX + 1];
    (void)mu_text_copy(cut, sizeof cut, reason);
    muster_Trip out = {
        .word = word, .agent = to->agent, .epoch = to->epoch, .slot = slot, .reason = cut};
    if (trips_say(h->crew.process, &out) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "name=%s", to->agent);
    }
}

/* @return whether what is handed over is of whom the broker says */
static bool passport_fits(const muster_Trip *word)
{
    struct passport p;
    const char *text = word->text;
    return passport_read(&text, &p) && strcmp(p.name, word->agent) == 0 &&
           p.passage.epoch == word->epoch;
}

/* The broker has kept an agent, and hands it over. */
static void arrival_hear(struct host *h, const muster_Trip *word)
{
    char why[MU_FAULT_TEXT_MAX + 1] = "too-large";
    size_t len = strlen(word->text);
    bool fits = len <= (size_t)h->set->bytes;
    struct arrival *launched =
        strcmp(word->asker, h->crew.host) == 0 ? deposited_find(h, word->agent) : NULL;
    struct arrival a = launched ? *launched : (struct arrival){.used = true};
    a.text = (struct mu_text){.at = word->text, .len = len, .size = len + 1};
    struct robot *r = NULL;
    if (fits && !passport_fits(word)) {
        r = not_taken(why, "another agent's passport");
    } else if (fits) {
        r = host_take_in(h, &a, why);
    }
    if (!r) {
        mu_log(MU_LOG_WARNING, "arrival-refused", "name=%s: %s", word->agent, why);
    }
    word_say(h, word, r ? muster_TRIP_READY : muster_TRIP_REFUSED, r ? trips_slot(r->agent) : 0,
             r ? "" : why);
}

/* What has become of one that was launched: if it lives, it answers itself. */
static void launched_end(struct host *h, const muster_Trip *word)
{
    struct arrival *a = deposited_find(h, word->agent);
    if (a && word->word == muster_TRIP_REFUSED) {
        host_answer(h, a, "refuse", word->reason);
    }
    if (a) {
        a->used = a->deposited = false;
    }
}

/* It was not given the name: somebody else is the agent. */
static void copy_drop(struct host *h, const muster_Trip *word)
{
    for (uint32_t i = 0; i < h->crew.count; i++) {
        struct robot *r = &h->crew.robots[i];
        if (r->arrives && strcmp(r->name, word->agent) == 0 &&
            mu_agent_passage(r->agent).epoch == word->epoch) {
            robot_drop(r);
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
    if (strcmp(word->asker, h->crew.host) == 0) {
        launched_end(h, word);
    } else if (word->word == muster_TRIP_REFUSED && !word->asker[0]) {
        copy_drop(h, word);
    }
    trip_hear(&h->crew, word);
}

/* @return whether an agent is on its way back */
static bool agent_restore(struct crew *c, const char *name, const struct checkpoint_head *head,
                          const char *text)
{
    char why[MU_FAULT_TEXT_MAX + 1] = "cannot be read";
    /* Nobody writes there. */
    const struct arrival back = {.text = {.at = (char *)(uintptr_t)text, .len = strlen(text)},
                                 .head = head};
    bool taken = text[0] && host_take_in((struct host *)c, &back, why);
    if (!taken) {
        fprintf(stderr, "muster host: the checkpoint of %s: %s\n", name, why);
    }
    return taken;
}

uint32_t host_restore(struct host *h)
{
    return checkpoint_each(&h->crew, agent_restore);
}

/* --- the host itself -------------------------------------------------------------------------- */

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
    h->crew.refused = true;
    mu_process_stop(h->crew.process);
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    struct host *h = self;
    (void)trip_take_answer(&h->crew, mail);
}

static void on_directive(void *self, mu_agent *a, const struct mu_mail *mail)
{
    if (strcmp(mail->performative, "launch") == 0) {
        arrival_take(self, mail);
    } else {
        robot_refuse_directive(a, mail);
    }
}

static void on_state(void *self, mu_agent *a, enum mu_state state)
{
    (void)a;
    struct host *h = self;
    if (state == MU_GONE) {
        mu_process_stop(h->crew.process);
    }
}

struct host *host_make(const struct host_settings *set)
{
    struct host *h = mu_startup_alloc(sizeof *h);
    h->set = set;
    robot_reserve_crew(&h->crew, &set->robots, (uint32_t)set->agents, set->robots.name);
    h->waiting = mu_startup_array(h->crew.count, sizeof *h->waiting);
    h->crew.on_arrived = on_arrived;
    for (uint32_t i = 0; i < h->crew.count; i++) {
        h->crew.robots[i].out = true;
        h->crew.robots[i].mind = mind_reserve();
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
    MU_TRY(mu_agent_join(h->crew.process, &h->agent, h->crew.host, MU_KIND_HOST, 0, &handlers));
    mu_agent_be(h->agent, &host_kind);
    mu_agent_decline_broadcasts(h->agent);
    h->crew.envoy = h->agent;
    return MU_OK;
}
