/* SPDX-License-Identifier: Apache-2.0 */
/* muster-robot: one robot's controller, with a CLIPS mind between its senses and its motors. */
#include "agent/body.h"
#include "agent/mind.h"
#include "agent/pages.h"
#include "core/attributes.h"
#include "core/exits.h"
#include "core/log.h"
#include "core/name.h"
#include "core/network.h"
#include "core/options.h"
#include "core/paths.h"
#include "muster/muster.h"
#include "runtime/kind.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ANSWER_MAX = MU_CONTENT_MAX / 2, PRINT_MAX = 1024 };

static const uint64_t BROKER_PATIENCE_NS = 2500000000;

struct settings {
    struct mu_network network;
    const char *name, *rules;
    int64_t seed, firings_max;
    struct mu_option_list globals; /* "mate=red" */
    struct mu_option_list groups, services;
    bool verbose, functions;
};

struct robot {
    const char *name;
    const struct mu_option_list *groups, *services;
    struct mind *mind;
    mu_process *process;
    mu_agent *agent;
    bool refused;
    bool box_full;       /* said once */
    uint32_t rules_left; /* it fires so many yet and is suspended then; 0: as many as it wants */
    uint64_t mails;      /* that the rules have seen */
    bool numbered;       /* the mail at hand is among them */
    char answer[ANSWER_MAX];
    char quoted[MU_CONTENT_MAX];
    char print[PRINT_MAX]; /* a line that rules have begun */
    size_t print_len;
};

/* Takes a service's name off "mapper role=scout".  @return its attributes */
static const char *service_name(const char *service, char name[MU_NAME_MAX + 2])
{
    size_t len = strcspn(service, " ");
    snprintf(name, MU_NAME_MAX + 2, "%.*s", (int)(len < MU_NAME_MAX + 1 ? len : MU_NAME_MAX + 1),
             service);
    return service + len + strspn(service + len, " ");
}

static mu_result pages_check(const struct settings *set)
{
    char name[MU_NAME_MAX + 2];
    for (size_t i = 0; i < set->groups.count; i++) {
        if (!mu_name_of_group(set->groups.items[i])) {
            fprintf(stderr, "muster robot --group: expected [A-Za-z_][A-Za-z0-9_.-]{0,30}, and not "
                            "all, robots, special, broker\n");
            return MU_FAULT_USAGE;
        }
    }
    for (size_t i = 0; i < set->services.count; i++) {
        const char *attributes = service_name(set->services.items[i], name);
        if (!mu_name_valid(name) || !mu_attributes_valid(attributes)) {
            fprintf(stderr, "muster robot --service: expected a service and its attributes, such "
                            "as 'mapper role=scout'\n");
            return MU_FAULT_USAGE;
        }
    }
    return MU_OK;
}

static mu_result settings_check(const struct settings *set)
{
    if (!set->name || !set->rules) {
        fprintf(stderr, "muster robot: give it a name and rules, for example: "
                        "muster robot red --rules rules/follower.clp\n");
        return MU_FAULT_USAGE;
    }
    if (!mu_name_valid(set->name) || mu_name_reserved(set->name)) {
        fprintf(stderr,
                "muster robot: '%s' cannot be a robot's name: it must match "
                "[A-Za-z_][A-Za-z0-9_.-]{0,30} and not be reserved\n",
                set->name);
        return MU_FAULT_USAGE;
    }
    return pages_check(set);
}

static mu_result settings_parse(struct settings *set, int argc, char **argv)
{
    struct mu_option table[] = {
        MU_JOIN_OPTIONS(set->network),
        {.name = "rules",
         .letter = 'r',
         .kind = MU_OPTION_STRING,
         .unit = "FILE",
         .help = "the robot's behaviour, a CLIPS file",
         .target = &set->rules},
        {.name = "seed",
         .kind = MU_OPTION_INTEGER,
         .unit = "N",
         .fallback = "1",
         .environment = "MUSTER_SEED",
         .help = "seed of (random), together with the name",
         .target = &set->seed},
        {.name = "firings",
         .kind = MU_OPTION_INTEGER,
         .unit = "N",
         .fallback = "200",
         .help = "rules that fire in one control step at most",
         .target = &set->firings_max,
         .min = 1,
         .max = 1000000},
        {.name = "global",
         .kind = MU_OPTION_LIST,
         .unit = "NAME=VALUE",
         .help = "set a global, for example mate=red",
         .target = &set->globals},
        {.name = "group",
         .kind = MU_OPTION_LIST,
         .unit = "G",
         .help = "join a group when the broker knows the robot",
         .target = &set->groups},
        {.name = "service",
         .kind = MU_OPTION_LIST,
         .unit = "'S KEY=VALUE...'",
         .help = "offer a service, likewise, for example 'mapper role=scout'",
         .target = &set->services},
        {.name = "functions",
         .kind = MU_OPTION_FLAG,
         .help = "print the functions that rules may call, and exit",
         .target = &set->functions},
        {.name = "verbose",
         .letter = 'v',
         .kind = MU_OPTION_FLAG,
         .help = "log what happens",
         .target = &set->verbose},
    };
    static struct mu_options options;
    options = (struct mu_options){
        .program = "muster robot",
        .usage = "NAME --rules FILE [OPTION...]",
        .about = "Controls one robot by CLIPS rules; waits in standby until told to start.",
        .table = table,
        .count = sizeof table / sizeof table[0]};
    mu_result parsed = mu_options_parse(&options, argc, argv);
    if (parsed != MU_OK || set->functions) {
        return parsed;
    }
    set->name = options.words_count == 1 ? options.words[0] : NULL;
    return settings_check(set);
}

/* --- what the mind asks for ------------------------------------------------------------------- */

static mu_result port_send(void *self, const struct mind_letter *letter)
{
    struct robot *r = self;
    struct mu_mail mail = {.dst = letter->dst,
                           .directive = letter->directive,
                           .performative = letter->performative,
                           .language = letter->language,
                           .ontology = letter->ontology,
                           .reply_with = letter->reply_with,
                           .in_reply_to = letter->in_reply_to,
                           .conversation = letter->conversation,
                           .content = letter->content,
                           .layer = letter->layer,
                           .priority = letter->priority,
                           .level = letter->level,
                           .reply_by_ns = letter->reply_by_ns,
                           .ttl_ns = letter->ttl_ns};
    return mu_agent_send(r->agent, &mail, NULL);
}

static void member_fill(struct mind_member *to, const struct mu_member *from)
{
    *to = (struct mind_member){.name = from->name,
                               .kind = mu_kind_text(from->kind),
                               .state = mu_state_text(from->state),
                               .host = from->host};
}

static mu_result port_lookup(void *self, const char *name, struct mind_member *out)
{
    struct robot *r = self;
    const struct mu_member *member = mu_process_lookup(r->process, name);
    if (!member) {
        return MU_ABSENT;
    }
    member_fill(out, member);
    return MU_OK;
}

static mu_result port_listing(void *self, size_t index, struct mind_member *out)
{
    struct robot *r = self;
    const struct mu_member *member = mu_process_member(r->process, index);
    if (!member) {
        return MU_DONE;
    }
    member_fill(out, member);
    return MU_OK;
}

static mu_result port_change(void *self, enum mind_change change, const char *name,
                             const char *attributes)
{
    struct robot *r = self;
    return pages_change(r->agent, change, name, attributes);
}

static const char *port_entry(void *self, enum mind_list list, const char *of, size_t index)
{
    struct robot *r = self;
    return pages_entry(r->process, list, of, index);
}

/* One write, so that the lines of robots that share a terminal do not mix. */
static void print_flush(struct robot *r)
{
    r->print[r->print_len++] = '\n';
    ssize_t written = write(STDERR_FILENO, r->print, r->print_len);
    (void)written; /* nobody to tell */
    r->print_len = 0;
}

/* Rules print in pieces; whole lines go out, each with the robot's name. */
static void port_print(void *self, const char *text)
{
    struct robot *r = self;
    for (const char *c = text; *c; c++) {
        if (*c != '\n' && r->print_len == PRINT_MAX - 1) {
            print_flush(r);
        }
        if (r->print_len == 0) {
            r->print_len = (size_t)snprintf(r->print, sizeof r->print, "%s: ", r->name);
        }
        if (*c == '\n') {
            print_flush(r);
        } else {
            r->print[r->print_len++] = *c;
        }
    }
}

/* --- what happens to the agent ---------------------------------------------------------------- */

static void pages_enter(const struct robot *r, mu_agent *a)
{
    char name[MU_NAME_MAX + 2];
    mu_result done = MU_OK;
    for (size_t i = 0; i < r->groups->count && done == MU_OK; i++) {
        done = mu_agent_group_join(a, r->groups->items[i]);
    }
    for (size_t i = 0; i < r->services->count && done == MU_OK; i++) {
        const char *attributes = service_name(r->services->items[i], name);
        done = mu_agent_advertise(a, name, attributes, 0);
    }
    if (done != MU_OK) {
        mu_log(MU_LOG_WARNING, "pages-refused", "why=%s", mu_result_text(done));
    }
}

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    struct robot *r = self;
    if (accepted) {
        mu_log(MU_LOG_INFO, "registered", "name=%s", mu_agent_name(a));
        pages_enter(r, a);
        return;
    }
    fprintf(stderr, "muster robot: the broker refuses the name %s: %s\n", mu_agent_name(a), reason);
    r->refused = true;
    mu_process_stop(r->process);
}

/* The mind's queue is full: who wrote to this robot in person hears of it. */
static void mail_refuse(struct robot *r, const struct mu_mail *refused)
{
    if (!r->box_full) {
        mu_log(MU_LOG_WARNING, "box-full", "name=%s from=%s: the rules take no mail",
               mu_agent_name(r->agent), refused->src);
        r->box_full = true;
    }
    /* never a failure for a failure: two full boxes would write to each other for ever */
    if (strcmp(refused->dst, mu_agent_name(r->agent)) != 0 ||
        strcmp(refused->performative, "failure") == 0) {
        return;
    }
    struct mu_mail mail = {.dst = refused->src,
                           .layer = refused->layer,
                           .performative = "failure",
                           .in_reply_to = refused->reply_with,
                           .conversation = refused->conversation,
                           .content = "box-full"};
    if (mu_agent_send(r->agent, &mail, NULL) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", refused->src);
    }
}

/* Numbers of a box go on from one life of a broker to the next; rules count from 1. */
static struct mind_mail letter_of(const struct mu_mail *mail, uint64_t id)
{
    return (struct mind_mail){.id = id,
                              .src = mail->src,
                              .performative = mail->performative,
                              .language = mail->language,
                              .ontology = mail->ontology,
                              .reply_with = mail->reply_with,
                              .in_reply_to = mail->in_reply_to,
                              .conversation = mail->conversation,
                              .content = mail->content,
                              .layer = mail->layer};
}

/* What rules have said of a layer comes before what a robot does by itself. */
static enum mu_take take_by_rules(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    struct robot *r = self;
    r->numbered = mind_has_layer(r->mind, mail->layer);
    if (!r->numbered) {
        return MU_PASS;
    }
    struct mind_mail letter = letter_of(mail, ++r->mails);
    return mind_handle(r->mind, &letter) ? MU_TAKEN : MU_PASS;
}

/* What no kind takes: layers 1 to 3 have asked the rules already, higher ones have not. */
static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    struct robot *r = self;
    if (mail->layer > MU_LAYER_SPEECH && take_by_rules(self, a, mail) != MU_PASS) {
        return;
    }
    struct mind_mail letter = letter_of(mail, r->mails);
    if (!mind_understands(r->mind, &letter)) {
        kind_not_understood(a, mail);
        return;
    }
    letter.id = r->numbered ? r->mails : ++r->mails;
    if (mind_take_mail(r->mind, &letter) == MU_FULL) {
        mail_refuse(r, mail);
    }
}

/* Answers who asked, with the output of a line as one CLIPS string. */
static void line_answer(struct robot *r, const struct mu_mail *asked, bool done)
{
    struct mu_text quoted;
    mu_text_init(&quoted, r->quoted, sizeof r->quoted);
    mu_text_add(&quoted, "\"");
    for (const char *c = r->answer; *c && quoted.len < sizeof r->quoted - 3; c++) {
        if (*c == '"' || *c == '\\') {
            mu_text_add(&quoted, "\\");
        }
        mu_text_add_bytes(&quoted, c, 1);
    }
    mu_text_add(&quoted, "\"");
    if (mu_agent_reply(r->agent, asked, done ? "inform" : "failure", r->quoted) != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", asked->src);
    }
}

/* What this robot knows, for whoever asks: all facts, or those of the relation that is named. */
static enum mu_take take_facts(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    struct robot *r = self;
    struct mu_text answer;
    mu_text_init(&answer, r->answer, sizeof r->answer);
    bool done = mind_facts(r->mind, mail->content, &answer) == MU_OK;
    line_answer(r, mail, done);
    return MU_TAKEN;
}

/* --- its life --------------------------------------------------------------------------------- */

static void on_create(void *self, mu_agent *a)
{
    (void)a;
    mind_event(((struct robot *)self)->mind, MU_ON_CREATE);
}

static void on_run(void *self, mu_agent *a)
{
    (void)a;
    mind_event(((struct robot *)self)->mind, MU_ON_RUN);
}

static void on_arrive(void *self, mu_agent *a)
{
    (void)a;
    mind_event(((struct robot *)self)->mind, MU_ON_ARRIVE);
}

static void on_clone(void *self, mu_agent *a)
{
    (void)a;
    mind_event(((struct robot *)self)->mind, MU_ON_CLONE);
}

/* There is no next step: the rules fire once more, and what they send still goes out. */
static void fire_last(struct robot *r, mu_agent *a, enum mu_event event)
{
    struct mind_act act;
    mind_event_now(r->mind, event, &act);
    mu_agent_fired(a, act.firings, act.rules);
}

static void on_leave(void *self, mu_agent *a)
{
    fire_last(self, a, MU_ON_LEAVE);
}

static void on_dispose(void *self, mu_agent *a)
{
    fire_last(self, a, MU_ON_DISPOSE);
}

static const struct mu_layer_handler robot_handlers[] = {
    {MU_LAYER_SYSTEM, NULL, take_by_rules},
    {MU_LAYER_QUERY, NULL, take_by_rules},
    {MU_LAYER_SPEECH, NULL, take_by_rules},
    {MU_LAYER_QUERY, "facts", take_facts},
    {0, NULL, NULL},
};
static const struct mu_agent_kind robot_kind = {.name = "robot",
                                                .handlers = robot_handlers,
                                                .hooks = {[MU_ON_CREATE] = on_create,
                                                          [MU_ON_RUN] = on_run,
                                                          [MU_ON_ARRIVE] = on_arrive,
                                                          [MU_ON_LEAVE] = on_leave,
                                                          [MU_ON_CLONE] = on_clone,
                                                          [MU_ON_DISPOSE] = on_dispose}};

static void on_refusal(void *self, mu_agent *a, const char *change, const char *reason)
{
    struct robot *r = self;
    mu_log(MU_LOG_WARNING, "change-refused", "name=%s change=%s reason=%s", mu_agent_name(a),
           change, reason);
    mind_refused(r->mind, change, reason);
}

static void directive_do(struct robot *r, mu_agent *a, const struct mu_mail *mail)
{
    struct mu_text answer;
    mu_text_init(&answer, r->answer, sizeof r->answer);
    bool done = mind_line(r->mind, mail->content, &answer) == MU_OK;
    if (!done) {
        mu_log(MU_LOG_WARNING, "line-refused", "from=%s line=%s answer=%s", mail->src,
               mail->content, r->answer);
    }
    if (mail->reply_with[0]) {
        line_answer(r, mail, done);
    }
    body_ask(a, r->mind);
    if (mind_wants_to_run(r->mind) && mu_agent_state(a) == MU_STANDBY) {
        mu_agent_set_state(a, MU_RUNNING);
    }
}

/* N rules, in as many control steps as that takes. */
static void directive_step(struct robot *r, mu_agent *a, const struct mu_mail *mail)
{
    char *end;
    long long rules = strtoll(mail->content, &end, 10);
    bool good = end != mail->content && *end == '\0' && rules >= 1 && rules <= UINT32_MAX;
    if (good) {
        mu_agent_set_state(a, MU_RUNNING);
        r->rules_left = (uint32_t)rules;
    } else {
        mu_log(MU_LOG_WARNING, "step-refused", "from=%s rules=%s", mail->src, mail->content);
    }
    mu_result sent = MU_OK;
    if (mail->reply_with[0]) {
        sent = mu_agent_reply(a, mail, good ? "agree" : "refuse", "step");
    }
    if (sent != MU_OK) {
        mu_log(MU_LOG_WARNING, "answer-lost", "to=%s", mail->src);
    }
}

static void on_directive(void *self, mu_agent *a, const struct mu_mail *mail)
{
    static const struct {
        const char *performative;
        void (*carry_out)(struct robot *r, mu_agent *a, const struct mu_mail *mail);
    } directives[] = {{"do", directive_do}, {"step", directive_step}};
    for (size_t i = 0; i < sizeof directives / sizeof directives[0]; i++) {
        if (strcmp(mail->performative, directives[i].performative) == 0) {
            directives[i].carry_out(self, a, mail);
            return;
        }
    }
    mu_log(MU_LOG_WARNING, "unknown-directive", "verb=%s from=%s", mail->performative, mail->src);
}

static void on_state(void *self, mu_agent *a, enum mu_state state)
{
    struct robot *r = self;
    r->rules_left = 0;
    mu_log(MU_LOG_INFO, "state", "name=%s state=%s", mu_agent_name(a), mu_state_text(state));
    if (state == MU_GONE) {
        mu_process_stop(r->process);
    }
}

/* A suspended mind keeps still, so that a person can look at it. */
static void on_step(void *self, mu_agent *a, const struct mu_percept *p)
{
    struct robot *r = self;
    if (mu_agent_state(a) == MU_SUSPENDED) {
        return;
    }
    struct mind_percept percept = body_percept(p);
    mind_percept(r->mind, &percept);
}

static void on_act(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)percept;
    struct robot *r = self;
    struct mind_act act;
    uint32_t left = r->rules_left;
    mind_fire_some(r->mind, left > 0 ? left : UINT32_MAX, &act);
    if (act.end == MIND_STOPPED) {
        mu_log(MU_LOG_WARNING, "rules-stopped", "name=%s guard=%s", mu_agent_name(a), act.why);
    }
    body_act(a, &act);
    body_ask(a, r->mind);
    mu_agent_fired(a, act.firings, act.rules);
    if (left > 0 && act.firings < left) {
        r->rules_left = left - act.firings;
    } else if (left > 0) {
        mu_agent_set_state(a, MU_SUSPENDED);
    }
}

/* --- the life of the process ------------------------------------------------------------------ */

static mu_result globals_set(struct mind *mind, const struct mu_option_list *globals)
{
    for (size_t i = 0; i < globals->count; i++) {
        char name[MU_FIELD_MAX + 1];
        const char *equals = strchr(globals->items[i], '=');
        size_t len = equals ? (size_t)(equals - globals->items[i]) : 0;
        if (len == 0 || len >= sizeof name) {
            fprintf(stderr, "--global %s: expected NAME=VALUE\n", globals->items[i]);
            return MU_FAULT_USAGE;
        }
        memcpy(name, globals->items[i], len);
        name[len] = '\0';
        if (mind_set_global(mind, name, equals + 1) != MU_OK) {
            fprintf(stderr, "--global %s: no such global, or not a CLIPS field\n",
                    globals->items[i]);
            return MU_FAULT_USAGE;
        }
    }
    return MU_OK;
}

static mu_result mind_make(struct robot *r, const struct settings *set)
{
    char folder[PATH_MAX];
    if (!mu_path_rules(folder, sizeof folder)) {
        fprintf(stderr, "muster robot: the shared rules are not found; set MUSTER_RULES to the "
                        "folder that has muster.clp\n");
        return MU_FAULT_FILE;
    }
    struct mind_options options = {.name = set->name,
                                   .seed = (uint64_t)set->seed,
                                   .rules_folder = mu_startup_string(folder),
                                   .firings_max = (uint32_t)set->firings_max,
                                   .ports = {.self = r,
                                             .send = port_send,
                                             .lookup = port_lookup,
                                             .listing = port_listing,
                                             .change = port_change,
                                             .entry = port_entry,
                                             .print = port_print}};
    struct mu_fault fault;
    mu_result made = mind_open(&r->mind, &options, &fault);
    made = made == MU_OK ? mind_load(r->mind, set->rules, &fault) : made;
    if (made != MU_OK) {
        mu_fault_print(&fault);
        return made;
    }
    return globals_set(r->mind, &set->globals);
}

static mu_result robot_join(struct robot *r, const struct settings *set)
{
    struct mu_process_options options = {.domain = (int)set->network.domain,
                                         .interface = set->network.interface,
                                         .peer = mu_network_peers(&set->network),
                                         .name = set->name,
                                         .broker = set->network.broker,
                                         .with_body = true};
    MU_TRY(mu_process_open(&r->process, &options));
    struct mu_handlers handlers = {.self = r,
                                   .on_registered = on_registered,
                                   .on_mail = on_mail,
                                   .on_directive = on_directive,
                                   .on_state = on_state,
                                   .on_step = on_step,
                                   .on_act = on_act,
                                   .on_refusal = on_refusal};
    MU_TRY(mu_agent_join(r->process, &r->agent, set->name, MU_KIND_ROBOT, 0, &handlers));
    mu_agent_be(r->agent, &robot_kind);
    body_ask(r->agent, r->mind);
    return mu_process_await_broker(r->process, BROKER_PATIENCE_NS);
}

int main(int argc, char **argv)
{
    struct settings set = {0};
    mu_result parsed = settings_parse(&set, argc, argv);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    if (set.functions) {
        mind_print_functions();
        return MU_EXIT_DONE;
    }
    mu_log_open(set.name, set.verbose ? MU_LOG_INFO : MU_LOG_WARNING);
    struct robot *r = mu_startup_alloc(sizeof *r);
    r->name = set.name;
    r->groups = &set.groups;
    r->services = &set.services;
    mu_result ready = mind_make(r, &set);
    ready = ready == MU_OK ? robot_join(r, &set) : ready;
    if (ready == MU_TIMEOUT) {
        fprintf(stderr,
                "muster robot: no broker answers in domain %d; start one with: "
                "muster broker %s --domain %d\n",
                (int)set.network.domain, set.network.broker ? set.network.broker : "NAME",
                (int)set.network.domain);
    }
    if (ready != MU_OK) {
        return mu_exit_for(ready);
    }
    mu_memory_seal();
    mu_result ran = mu_process_run(r->process);
    mu_process_close(r->process);
    if (r->print_len > 0) {
        print_flush(r);
    }
    return r->refused ? MU_EXIT_REFUSED : mu_exit_for(ran);
}
