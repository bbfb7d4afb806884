/* SPDX-License-Identifier: Apache-2.0 */
/* muster-monitor: an agent without a body; its rules get a whole run as facts. */
#include "agent/robot.h"
#include "core/exits.h"
#include "core/log.h"
#include "core/name.h"
#include "core/paths.h"
#include "core/signals.h"
#include "core/text_file.h"
#include "monitor/facts.h"
#include "muster/memory.h"
#include "runtime/join.h"
#include "runtime/returns.h"

#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

enum { WORLD_MAX = 64 };
static const int64_t ROUND_NS = 50000000;

static struct monitor {
    struct robot_options set;
    bool latest, stays;
    struct group_process *group;
    struct robot *self; /* the only one of its process */
    mu_watch *watch;
    mu_stats *stats;
    char world[WORLD_MAX];
    uint64_t seed;
    uint64_t missed;
    bool ended;
} monitor;

/* --- steps of the run ---------------------------------------------------------------------------
 * */

static bool may_act(void)
{
    return mu_agent_state(monitor.self->agent) == MU_RUNNING;
}

/* Speeds that rules set move nothing: there is no body. */
static void rules_fire(void)
{
    struct mind_act act;
    struct robot *r = monitor.self;
    mind_fire(r->mind, &act);
    if (act.end == MIND_STOPPED) {
        mu_log(MU_LOG_WARNING, "rules-stopped", "name=%s guard=%s rules=%s", r->name, act.why,
               act.rules);
    }
    if (act.enough) {
        mu_log(MU_LOG_WARNING, "suspended", "name=%s why=%s", r->name, act.enough);
        mu_agent_suspend(r->agent, act.enough);
    }
    lifecycle_do_wish(r, r->agent);
    if (mind_travel(r->mind).kind == MIND_DISPOSES) {
        mu_agent_set_state(r->agent, MU_GONE);
    }
    console_offer(r);
}

static void step_tell(const struct mu_frame *f)
{
    char fact[MU_CONTENT_MAX];
    struct mu_text t = mu_text_in(fact, sizeof fact);
    mu_text_format(&t,
                   "(step (number %" PRId64 ") (time %.9f) (missed %" PRIu64 ") (seed %" PRIu64
                   ") (world ",
                   f->step, (double)f->time_ns / 1e9, f->missed, monitor.seed);
    facts_add_word(&t, monitor.world);
    mu_text_add(&t, "))");
    (void)mind_tell(monitor.self->mind, fact);
}

static void on_scene(void *self, const struct mu_scene *scene)
{
    (void)self;
    (void)mu_text_copy(monitor.world, sizeof monitor.world, scene->world);
    monitor.seed = scene->seed;
    mu_stats_begin(monitor.stats, scene);
}

static void on_step(void *self, const struct mu_frame *frame)
{
    (void)self;
    mu_stats_take(monitor.stats, frame);
    monitor.missed += frame->missed;
    if (!may_act()) {
        return; /* a suspended mind keeps still, so that a person can look at it */
    }
    mind_observe(monitor.self->mind, frame->time_ns, facts_of_a_step);
    step_tell(frame);
    facts_tell(monitor.self->mind, monitor.stats, frame);
    rules_fire();
}

static void on_end(void *self, const struct mu_run_result *result)
{
    (void)self;
    static const char *const ended[] = {"run-ended", NULL};
    static const char *const nothing[] = {NULL};
    char fact[MU_ATTRIBUTES_MAX * 2];
    struct mu_text t = mu_text_in(fact, sizeof fact);
    facts_write_end(&t, result);
    if (may_act()) {
        mind_observe(monitor.self->mind, result->time_ns, nothing);
        (void)mind_tell(monitor.self->mind, fact);
        rules_fire();
        mind_observe(monitor.self->mind, result->time_ns, ended);
    }
    if (monitor.missed > 0) {
        fprintf(stderr, "muster monitor: %" PRIu64 " steps were not seen\n", monitor.missed);
    }
    monitor.missed = 0;
    monitor.ended = true;
}

/* --- its life as an agent --------------------------------------------------------------------- */

static enum mu_take take_journey(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    (void)a;
    (void)mail;
    return MU_DECLINE; /* the run is seen from here */
}

static const struct mu_layer_handler monitor_handlers[] = {
    {MU_LAYER_SYSTEM, "dispatch", take_journey},
    {MU_LAYER_SYSTEM, "retract", take_journey},
    {MU_LAYER_SYSTEM, "clone", take_journey},
    {0, NULL, NULL},
};
static const struct mu_agent_kind monitor_kind = {
    .name = "monitor", .parent = &handlers_robot_kind, .handlers = monitor_handlers};

static void on_directive(void *self, mu_agent *a, const struct mu_mail *mail)
{
    bool journey =
        strcmp(mail->performative, "move") == 0 || strcmp(mail->performative, "clone") == 0;
    if (!journey) {
        mail_on_directive(self, a, mail);
    } else {
        mail_refuse_directive(a, mail);
    }
}

static mu_result monitor_join(void)
{
    struct robot *r = monitor.self;
    struct mu_handlers handlers = {.self = r,
                                   .on_registered = lifecycle_on_registered,
                                   .on_mail = mail_on_mail,
                                   .on_directive = on_directive,
                                   .on_state = lifecycle_on_state,
                                   .on_refusal = lifecycle_on_refusal};
    MU_TRY(mu_agent_join(r->group->process, &r->agent, r->name, MU_KIND_SPECIAL, 0, &handlers));
    mu_agent_be(r->agent, &monitor_kind);
    returns_hear(r->agent, lifecycle_on_return);
    mu_agent_decline_broadcasts(r->agent); /* it sees them anyway */
    return MU_OK;
}

static mu_result monitor_open(void)
{
    struct mu_process_options process = join_options(&monitor.set.network, monitor.set.name);
    process.watches = mind_speaks(monitor.self->mind) && !monitor.latest;
    struct mu_watch_options watch = {
        .latest = monitor.latest,
        .handlers = {.on_scene = on_scene, .on_step = on_step, .on_end = on_end}};
    monitor.stats = mu_stats_open();
    MU_TRY(mu_process_open(&monitor.group->process, &process));
    MU_TRY(monitor_join());
    return mu_watch_open(&monitor.watch, monitor.group->process, &watch);
}

/* Its rules follow the templates of its facts. */
static mu_result monitor_think(void)
{
    char folder[PATH_MAX], path[PATH_MAX];
    struct robot *r = monitor.self;
    struct mu_fault fault;
    MU_TRY(mu_path_rules_need(folder, sizeof folder, "muster monitor"));
    if (!mu_path_join(path, sizeof path, folder, "monitor.clp")) {
        fprintf(stderr, "muster monitor: the path of the shared rules is too long\n");
        return MU_FAULT_FILE;
    }
    struct mind_options options = {.read = mu_text_file_read,
                                   .name = r->name,
                                   .seed = (uint64_t)monitor.set.seed,
                                   .rules_folder = folder,
                                   .rules_file = monitor.set.rules,
                                   .firings_max = (uint32_t)monitor.set.firings_max,
                                   .failures_max = (uint32_t)monitor.set.failures_max,
                                   .ports = ports_of(r)};
    mu_result made = mind_open(&r->mind, &options, &fault);
    made = made == MU_OK ? mind_load(r->mind, path, &fault) : made;
    made = made == MU_OK ? mind_load(r->mind, monitor.set.rules, &fault) : made;
    if (made != MU_OK) {
        mu_fault_print(&fault);
    }
    return made;
}

/* --- the program ------------------------------------------------------------------------------ */

static struct mu_option option_table[] = {
    MU_JOIN_OPTIONS(monitor.set.network),
    MU_STRING("rules", "FILE", monitor.set.rules, "what it makes of what it sees, a CLIPS file",
              .letter = 'r'),
    MU_STRING("name", "NAME", monitor.set.name, "name of the agent", .fallback = "monitor"),
    MU_FLAG("latest", monitor.latest,
            "25 steps in a second of wall time at most, instead of every one"),
    MU_FLAG("stay", monitor.stays, "wait for the next run when one has ended"),
    MU_INTEGER("seed", "N", monitor.set.seed, "seed of (random), together with the name",
               .fallback = "1"),
    MU_INTEGER("firings", "N", monitor.set.firings_max, "rules that fire in one step at most",
               .fallback = "10000", .min = 1, .max = 1000000),
    MU_INTEGER("failures", "N", monitor.set.failures_max,
               "a rule that fails so often suspends the monitor; 0: none does", .fallback = "100",
               .max = 1000000),
    MU_OPTION_VERBOSE(monitor.set.verbose),
};

static mu_result command_line_parse(int argc, char **argv)
{
    static struct mu_options options = {
        .program = "muster monitor",
        .usage = "--rules FILE [OPTION...]",
        .about = "Looks at a run by CLIPS rules: each step is facts, what rules print goes to "
                 "standard output.  It changes nothing in the run unless its rules send mail.",
        MU_OPTION_TABLE(option_table),
        .no_words = true};
    mu_result parsed = mu_options_parse(&options, argc, argv);
    if (parsed != MU_OK) {
        return parsed;
    }
    if (!monitor.set.rules || options.words_count > 0) {
        fprintf(stderr, "muster monitor: give it rules, for example: "
                        "muster monitor --rules rules/monitor_stalls.clp\n");
        return MU_FAULT_USAGE;
    }
    return mu_name_check("muster monitor", "an agent", monitor.set.name) ? MU_OK : MU_FAULT_USAGE;
}

static mu_result monitor_run(void)
{
    mu_signals_note();
    mu_result spun = MU_OK;
    while (spun >= 0 && !mu_signal_came && monitor.self->state != ROBOT_VACANT &&
           (!monitor.ended || monitor.stays)) {
        spun = mu_watch_spin(monitor.watch, ROUND_NS);
    }
    return spun < 0 ? spun : MU_OK;
}

int main(int argc, char **argv)
{
    mu_result parsed = command_line_parse(argc, argv);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    mu_log_open(monitor.set.name, monitor.set.verbose ? MU_LOG_INFO : MU_LOG_WARNING);
    monitor.group = mu_startup_alloc(sizeof *monitor.group);
    agent_reserve(monitor.group, &monitor.set, 1, "");
    monitor.group->prints = true;
    monitor.self = &monitor.group->robots[0];
    robot_state_enter(&monitor.self->state, ROBOT_BEGINS);
    (void)mu_text_copy(monitor.self->name, sizeof monitor.self->name, monitor.set.name);
    mu_result ready = monitor_think();
    ready = ready == MU_OK ? monitor_open() : ready;
    if (ready != MU_OK) {
        return mu_exit_for(ready);
    }
    mu_memory_seal();
    mu_result ran = monitor_run();
    mu_watch_close(monitor.watch);
    mu_process_close(monitor.group->process);
    ports_print_rest(monitor.self);
    return monitor.group->refused ? MU_EXIT_REFUSED : mu_exit_for(ran);
}
