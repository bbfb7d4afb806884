/* SPDX-License-Identifier: Apache-2.0 */
/* The processes of a run and the words of their command lines. */
#include "core/text.h"
#include "muster/memory.h"
#include "run/chaos.h"
#include "run/run.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { RECORD_FULL_MAX = 64 }; /* robots whose percepts are recorded without being asked for */

/* What the next new child is. */
static void part_note(struct run *r, enum run_kind kind, unsigned index)
{
    MU_ASSERT(r->children.count < SUPERVISE_CHILDREN_MAX);
    r->parts[r->children.count] = (struct run_part){kind, index};
}

/* again: the child that these words are for, which has died; NULL: it is a new one */
static mu_result child_start(struct run *r, struct child *again, const char *name,
                             const char *program)
{
    const char *const *argv = supervise_words_end();
    run_struck_next(r, name);
    return again ? supervise_start_again(&r->children, again, program, argv)
                 : supervise_start(&r->children, name, program, argv);
}

static mu_result broker_start(struct run *r, unsigned index, struct child *again)
{
    char name[RUN_CHILD_MAX];
    run_child_name(r, index, name);
    supervise_words("muster-broker");
    supervise_word("%s", run_broker(r, index));
    supervise_word("--domain=%d", r->domain);
    if (r->experiment->broker.delivery_interval_ms > 0) {
        supervise_word("--delivery-interval=%.17g", r->experiment->broker.delivery_interval_ms);
    }
    if (r->experiment->policy) {
        supervise_word("--policy=%s", r->experiment->policy);
    }
    /* A run repeats from nothing, but for a broker that may be started again. */
    if (r->experiment->broker.store || run_restarts_brokers(r)) {
        supervise_word("--store=%s/%s.db", r->folder, name);
    } else {
        supervise_word("--store=none");
    }
    return child_start(r, again, name, "muster-broker");
}

static void places_add(const struct experiment *e)
{
    for (unsigned i = 0; i < e->agents_count; i++) {
        supervise_word("--agents=%s", e->agents[i].name);
    }
    for (unsigned i = 0; i < e->robots_count; i++) {
        const struct experiment_robot *robot = &e->robots[i];
        char pose[128] = "- - -";
        if (robot->pose) {
            snprintf(pose, sizeof pose, "%.17g %.17g %.17g", robot->pose->x_m, robot->pose->y_m,
                     robot->pose->heading_deg);
        }
        supervise_word("--robots=%s", robot->name);
        if (robot->body || robot->pose) {
            supervise_word("--place=%s %s %s %s", robot->name, robot->body ? robot->body : "-",
                           pose, robot->color ? robot->color : "-");
        }
    }
}

/* Percepts of a large team are most of its recording. */
static bool record_is(const struct run *r, const char *level)
{
    const char *usual = r->experiment->robots_count > RECORD_FULL_MAX ? "run" : "full";
    return strcmp(r->options.record ? r->options.record : usual, level) == 0;
}

/* The simulator splits a name from its path at "=": one in the name is doubled. */
static void file_attach(const struct run_file *file)
{
    char bytes[2 * PATH_MAX];
    struct mu_text name = mu_text_in(bytes, sizeof bytes);
    for (const char *c = file->name; *c; c++) {
        mu_text_add(&name, *c == '=' ? "=" : "");
        mu_text_add_bytes(&name, c, 1);
    }
    supervise_word("--attach=%s=%s", name.at, file->path);
}

static void recording_add(const struct run *r)
{
    char command[2048], here[PATH_MAX];
    if (record_is(r, "none")) {
        return;
    }
    run_command_write(r, command, sizeof command);
    supervise_word("--record=%s/run.mcap", r->folder);
    if (record_is(r, "run")) {
        supervise_word("--without-percepts");
    }
    supervise_word("--note=command=%s", command);
    supervise_word("--note=file=%s", r->options.file);
    supervise_word("--note=experiment=%s", r->experiment->name);
    supervise_word("--note=seed=%lld", (long long)r->experiment->seed);
    supervise_word("--note=duration_s=%.17g", r->experiment->duration);
    supervise_word("--note=rate=%.17g", r->options.rate);
    supervise_word("--note=lockstep=%s", r->options.free ? "no" : "yes");
    supervise_word("--note=clips=%s", MU_CLIPS_VERSION);
    supervise_word("--note=folder=%s", getcwd(here, sizeof here) ? here : "");
    for (size_t i = 0; i < r->options.set_count; i++) {
        supervise_word("--note=set.%zu=%s", i + 1, r->options.set[i]);
    }
    for (size_t i = 0, controllers = 0; i < r->files_count; i++) {
        const struct run_file *file = &r->files[i];
        if (strcmp(file->role, RUN_CONTROLLER) == 0) {
            supervise_word("--note=controller.%zu=%016" PRIx64 " %s", ++controllers, file->hash,
                           file->path);
        } else {
            file_attach(file);
        }
    }
}

/* What one processor is enough for, is kept on one. */
static bool simulator_is_wide(const struct experiment *e)
{
    uint64_t threads = e->simulator.threads;
    return threads > 1 || (threads == 0 && getenv("MUSTER_SIM_THREADS"));
}

static mu_result simulator_start(struct run *r)
{
    const struct experiment *e = r->experiment;
    supervise_words("muster-sim");
    supervise_word("%s", e->world);
    supervise_word("--domain=%d", r->domain);
    supervise_word("--seed=%lld", (long long)e->seed);
    supervise_word("--duration=%.17g", e->duration);
    supervise_word("--step=%.17g", e->step_ms);
    supervise_word("--csv=%s/run.csv", r->folder);
    supervise_word("--rate=%.17g", r->options.rate);
    supervise_word("--saves=%s", r->folder);
    supervise_word("--wait");
    if (r->options.free) {
        supervise_word("--free");
    }
    if (e->simulator.threads > 0) {
        supervise_word("--threads=%llu", (unsigned long long)e->simulator.threads);
    }
    if (e->resolvers_count > 0) {
        supervise_word("--watchers=%u", e->resolvers_count);
    }
    if (run_restarts_any(r) || (chaos_restarts_any(r) && !r->options.free)) {
        supervise_word("--return=%.17g", e->return_within_s);
    }
    if (e->hosts_count > 0) {
        supervise_word("--hosts=%u", e->hosts_count);
    }
    places_add(e);
    recording_add(r);
    if (e->events_count > 0) {
        supervise_word("--events=%s/events.csv", r->folder);
    }
    for (unsigned i = 0; i < e->events_count; i++) {
        supervise_word("--event=%s", e->events[i]);
    }
    if (simulator_is_wide(e)) {
        run_struck_next(r, "simulator");
        return supervise_start_wide(&r->children, "simulator", "muster-sim", supervise_words_end());
    }
    return child_start(r, NULL, "simulator", "muster-sim");
}

/* Without checkpoints the folder has the agents that have ended. Each host has one of its own,
 * since it brings back the agents that it finds there. */
static void checkpoints_add(const struct run *r, enum experiment_on_crash on_crash,
                            double checkpoint_s, const char *host)
{
    if (on_crash != EXPERIMENT_RESTART) {
        return;
    }
    supervise_word("--mend=%u", r->experiment->restarts);
    supervise_word("--checkpoint=%.17g", checkpoint_s);
    supervise_word("--folder=%s/" RUN_CHECKPOINTS "%s%s", r->folder, host ? "/" : "",
                   host ? host : "");
}

static void mind_add(const struct run *r)
{
    supervise_word("--wait");
    if (record_is(r, "full") && !r->options.no_diary) {
        supervise_word("--diary");
    }
}

/* What a program of the user's joins by, as our own have it from their command lines. */
static void network_name(const struct run *r, const char *broker)
{
    char domain[16];
    snprintf(domain, sizeof domain, "%d", r->domain);
    setenv("MUSTER_DOMAIN", domain, 1);
    setenv("MUSTER_BROKER", broker, 1);
    if (r->options.local) {
        setenv(LOCAL_ENVIRONMENT, r->options.local, 1);
    }
}

/* The agents of a controller, and where it may keep what it needs to go on after its death. */
static void controller_name(const struct run *r, const struct experiment_crew *crew)
{
    static char bytes[MU_ROBOTS_MAX * (MU_NAME_MAX + 1)];
    const struct experiment_robot *robot = &r->experiment->robots[crew->robot];
    char state[PATH_MAX + MU_NAME_MAX + 32], seed[32];
    struct mu_text names = mu_text_in(bytes, sizeof bytes);
    for (unsigned i = 0; i < crew->count; i++) {
        mu_text_format(&names, "%s%s", i > 0 ? "," : "", robot[i].name);
    }
    snprintf(state, sizeof state, "%s/" RUN_CHECKPOINTS "/%s.state", r->folder, robot->name);
    snprintf(seed, sizeof seed, "%lld", (long long)r->experiment->seed);
    setenv("MUSTER_AGENT", robot->name, 1);
    setenv("MUSTER_AGENTS", names.at, 1);
    setenv("MUSTER_SEED", seed, 1);
    setenv("MUSTER_WORLD", r->experiment->world, 1);
    if (robot->on_crash == EXPERIMENT_RESTART) {
        setenv("MUSTER_STATE", state, 1);
    }
}

static void controller_unname(void)
{
    static const char *const names[] = {"MUSTER_AGENT", "MUSTER_AGENTS", "MUSTER_SEED",
                                        "MUSTER_WORLD", "MUSTER_STATE"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        unsetenv(names[i]);
    }
}

static mu_result controller_start(struct run *r, const struct experiment_crew *crew,
                                  struct child *again)
{
    const struct experiment_robot *robot = &r->experiment->robots[crew->robot];
    network_name(r, run_broker(r, 0));
    controller_name(r, crew);
    supervise_words(robot->controller.program);
    for (unsigned i = 0; i < robot->controller.args_count; i++) {
        supervise_word("%s", robot->controller.args[i]);
    }
    mu_result started = child_start(r, again, robot->name, robot->controller.program);
    controller_unname();
    return started;
}

/* What robots bear that share an entry of the experiment, they share here, too. */
static mu_result crew_start(struct run *r, const struct experiment_crew *crew, struct child *again)
{
    const struct experiment_robot *robot = &r->experiment->robots[crew->robot];
    if (robot->controller.program) {
        return controller_start(r, crew, again);
    }
    bool has_body = crew->robot < r->experiment->robots_count;
    const char *program = has_body ? "muster-robot" : "muster-agent";
    supervise_words(program);
    supervise_word("%s", crew->name);
    if (robot->standby) {
        supervise_word("--standby");
    }
    if (crew->numbered) {
        supervise_word("--count=%u", crew->count);
        supervise_word("--first=%u", crew->first);
    }
    supervise_word("--rules=%s", robot->rules);
    if (has_body) {
        supervise_word("--world=%s", r->experiment->world);
    }
    supervise_word("--domain=%d", r->domain);
    supervise_word("--broker=%s", robot->broker ? robot->broker : run_broker(r, 0));
    supervise_word("--seed=%lld", (long long)r->experiment->seed);
    mind_add(r);
    for (unsigned i = 0; i < robot->globals_count; i++) {
        supervise_word("--global=%s=%s", robot->globals[i].name, robot->globals[i].value);
    }
    for (unsigned i = 0; run_pages_own(r, robot) && i < robot->groups_count; i++) {
        supervise_word("--group=%s", robot->groups[i]);
    }
    for (unsigned i = 0; run_pages_own(r, robot) && i < robot->services_count; i++) {
        supervise_word("--service=%s", robot->services[i]);
    }
    checkpoints_add(r, robot->on_crash, robot->checkpoint_s, NULL);
    if (again && robot->on_crash == EXPERIMENT_RESTART) {
        supervise_word("--restore");
    }
    MU_TRY(child_start(r, again, robot->name, program));
    struct child *child = again ? again : &r->children.children[r->children.count - 1];
    /* In free running a robot may move to a host, or be disposed of: its process ends.  In lock
     * step it goes on; started again, it finds that none of its robots is to come back. */
    child->may_leave = r->options.free || again;
    return MU_OK;
}

/* The robots that begin on a host, with their rules and globals. */
static void natives_add(const struct run *r, const char *host)
{
    for (unsigned i = 0; i < experiment_members(r->experiment); i++) {
        const struct experiment_robot *robot = &r->experiment->robots[i];
        if (!robot->host || strcmp(robot->host, host) != 0) {
            continue;
        }
        bool has_body = i < r->experiment->robots_count;
        supervise_word("--%s=%s=%s", has_body ? "robot" : "agent", robot->name, robot->rules);
        for (unsigned k = 0; k < robot->globals_count; k++) {
            supervise_word("--global=%s.%s=%s", robot->name, robot->globals[k].name,
                           robot->globals[k].value);
        }
    }
}

static mu_result host_start(struct run *r, const char *host, struct child *again)
{
    const struct experiment *e = r->experiment;
    unsigned robots = experiment_members(r->experiment);
    supervise_words("muster-host");
    supervise_word("%s", host);
    supervise_word("--agents=%u", robots < 16 ? 16 : robots < 256 ? robots : 256);
    supervise_word("--world=%s", r->experiment->world);
    supervise_word("--domain=%d", r->domain);
    supervise_word("--broker=%s", run_broker(r, 0));
    supervise_word("--seed=%lld", (long long)r->experiment->seed);
    checkpoints_add(r, e->on_crash, e->checkpoint_s, host);
    if (r->options.free || again) {
        supervise_word("--restore");
    }
    mind_add(r);
    natives_add(r, host);
    return child_start(r, again, host, "muster-host");
}

static mu_result resolver_start(struct run *r, const char *scheme, struct child *again)
{
    char name[RUN_CHILD_MAX];
    snprintf(name, sizeof name, EXPERIMENT_RESOLVER "%s", scheme);
    supervise_words("muster-resolver");
    supervise_word("%s", scheme);
    supervise_word("--domain=%d", r->domain);
    supervise_word("--broker=%s", run_broker(r, 0));
    return child_start(r, again, name, "muster-resolver");
}

/* Where the capsules and stores of those are that may be started again. */
static mu_result checkpoints_make(const struct run *r)
{
    const struct experiment *e = r->experiment;
    char path[PATH_MAX + sizeof "/" RUN_CHECKPOINTS "/" + MU_NAME_MAX];
    snprintf(path, sizeof path, "%s/" RUN_CHECKPOINTS, r->folder);
    bool made = mkdir(path, 0777) == 0;
    for (unsigned i = 0; made && i < e->hosts_count; i++) {
        snprintf(path, sizeof path, "%s/" RUN_CHECKPOINTS "/%s", r->folder, e->hosts[i]);
        made = mkdir(path, 0777) == 0;
    }
    if (made) {
        return MU_OK;
    }
    fprintf(stderr, "muster run: cannot create %s: %s\n", path, strerror(errno));
    return MU_FAULT_OS;
}

mu_result run_start_again(struct run *r, struct child *child)
{
    const struct experiment *e = r->experiment;
    struct run_part part = run_part_of(r, child);
    switch (part.kind) {
    case RUN_BROKER: return broker_start(r, part.index, child);
    case RUN_RESOLVER: return resolver_start(r, e->resolvers[part.index], child);
    case RUN_HOST: return host_start(r, e->hosts[part.index], child);
    case RUN_CREW: return crew_start(r, &e->crews[part.index], child);
    case RUN_SIMULATOR:
    case RUN_MONITOR:
    case RUN_PAGE: break;
    }
    return MU_REFUSED;
}

static mu_result program_start(struct run *r, const struct experiment_monitor *m, const char *log)
{
    network_name(r, run_broker(r, 0));
    supervise_words(m->program);
    return supervise_start_aside(&r->children, m->name, m->program, supervise_words_end(), log);
}

static mu_result monitor_start(struct run *r, const struct experiment_monitor *m)
{
    char log[PATH_MAX + MU_NAME_MAX + 8];
    snprintf(log, sizeof log, "%s/%s.log", r->folder, m->name);
    run_struck_next(r, m->name);
    if (m->program) {
        return program_start(r, m, log);
    }
    supervise_words("muster-monitor");
    supervise_word("--rules=%s", m->rules);
    supervise_word("--name=%s", m->name);
    supervise_word("--domain=%d", r->domain);
    supervise_word("--broker=%s", run_broker(r, 0));
    supervise_word("--seed=%lld", (long long)r->experiment->seed);
    return supervise_start_aside(&r->children, m->name, "muster-monitor", supervise_words_end(),
                                 log);
}

static mu_result monitors_start(struct run *r)
{
    for (unsigned i = 0; run_monitors_start(r) && i < r->experiment->monitors_count; i++) {
        part_note(r, RUN_MONITOR, i);
        MU_TRY(monitor_start(r, &r->experiment->monitors[i]));
    }
    return MU_OK;
}

/* The page's end, however it comes, is none that matters.  No agent's name has a space. */
static mu_result page_start(struct run *r)
{
    const char *port = getenv("MUSTER_WEB_PORT");
    part_note(r, RUN_PAGE, 0);
    supervise_words("muster-web");
    supervise_word("--open");
    supervise_word("--domain=%d", r->domain);
    supervise_word("--port=%s", port && port[0] ? port : "0");
    MU_TRY(supervise_start_wide(&r->children, "the page", "muster-web", supervise_words_end()));
    supervise_find(&r->children, "the page")->excused = true;
    return MU_OK;
}

mu_result run_start(struct run *r)
{
    r->parts = mu_startup_array(SUPERVISE_CHILDREN_MAX, sizeof *r->parts);
    if (run_restarts_any(r)) {
        MU_TRY(checkpoints_make(r));
    }
    for (unsigned i = 0; i < run_brokers(r); i++) {
        part_note(r, RUN_BROKER, i);
        MU_TRY(broker_start(r, i, NULL));
    }
    part_note(r, RUN_SIMULATOR, 0);
    run_files_find(r);
    MU_TRY(simulator_start(r));
    for (unsigned i = 0; i < r->experiment->resolvers_count; i++) {
        part_note(r, RUN_RESOLVER, i);
        MU_TRY(resolver_start(r, r->experiment->resolvers[i], NULL));
    }
    for (unsigned i = 0; i < r->experiment->hosts_count; i++) {
        part_note(r, RUN_HOST, i);
        MU_TRY(host_start(r, r->experiment->hosts[i], NULL));
    }
    for (unsigned i = 0; i < r->experiment->crews_count; i++) {
        if (!r->experiment->robots[r->experiment->crews[i].robot].host) {
            part_note(r, RUN_CREW, i);
            MU_TRY(crew_start(r, &r->experiment->crews[i], NULL));
        }
    }
    MU_TRY(monitors_start(r));
    return r->options.watch ? page_start(r) : MU_OK;
}
