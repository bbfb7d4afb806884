/* SPDX-License-Identifier: Apache-2.0 */
/*
 * muster run: starts what an experiment names, watches it, ends it, reports.
 *
 * This process is the agent `observer`.  Its commands go to the broker before the first step, each
 * with the time of the run at which it is due, so that no clock of ours decides when they arrive.
 */
#include "run/chaos.h"
#include "run/run.h"
#include "run/run_inputs.h"

#include "core/clock.h"
#include "core/exits.h"
#include "core/network.h"
#include "core/paths.h"
#include "core/text.h"
#include "muster/directory.h"
#include "muster/memory.h"
#include "operator/operator.h"
#include "runtime/process.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

static const uint64_t PROGRESS_NS = 200000000;
static const uint64_t START_PATIENCE_NS = 20000000000u;
static const uint64_t START_PATIENCE_EACH_NS = 60000000; /* a robot: its rules are read */
static const int64_t ROUND_NS = 5000000;
static const int STOP_PATIENCE_MS = 2000;
static const int LAST_PATIENCE_MS = 10000; /* for what the report needs */
/* The simulator says something every second, whatever it waits for. */
static const uint64_t SILENCE_NS = 6000000000u;
/* A round that took longer was not ours alone: the machine slept, or all of us were stopped. */
static const uint64_t ROUND_COUNTS_NS = 100000000;

/* --- files ------------------------------------------------------------------------------------ */

/* Another user's experiment does nothing here but with muster's own programs. */
static mu_result programs_check(const struct run *r, struct mu_fault *fault)
{
    const struct experiment *e = r->experiment;
    bool starts = !r->options.inputs;
    for (unsigned i = 0; i < e->monitors_count && starts && !r->options.programs; i++) {
        const struct experiment_monitor *m = &e->monitors[i];
        if (m->program) {
            return mu_fault_at(fault, e->file, m->mark.line, m->mark.column,
                               "the monitor '%s' is a program of its own, %.120s; muster run "
                               "--programs starts it",
                               m->name, m->program);
        }
    }
    return MU_OK;
}

static mu_result experiment_prepare(struct run *r, struct mu_fault *fault)
{
    char path[PATH_MAX];
    if (r->options.root) {
        experiment_root(r->options.root);
    }
    if (mu_path_experiment(path, sizeof path, r->options.file)) {
        r->options.file = mu_startup_string(path);
    }
    MU_TRY(experiment_load(&r->experiment, r->options.file, r->options.set, r->options.set_count,
                           fault));
    struct experiment *e = r->experiment;
    r->options.free = r->options.free || e->free;
    e->seed = r->options.seed >= 0 ? (uint64_t)r->options.seed : e->seed;
    e->duration = r->options.duration_s >= 0.0 ? r->options.duration_s : e->duration;
    for (unsigned i = 0; i < experiment_members(e) && !r->options.free; i++) {
        if (e->robots[i].broker) {
            *fault = e->robots[i].broker_fault;
            return MU_FAULT_FILE;
        }
    }
    return programs_check(r, fault);
}

static mu_result folder_prepare(struct run *r, struct mu_fault *fault)
{
    if (r->options.out) {
        return report_folder(r->options.out, false, r->folder, sizeof r->folder, fault);
    }
    char wanted[PATH_MAX];
    struct mu_text t = mu_text_in(wanted, sizeof wanted);
    mu_text_format(&t, "out/%s-%llu", r->experiment->name, (unsigned long long)r->experiment->seed);
    return report_folder(wanted, true, r->folder, sizeof r->folder, fault);
}

mu_result run_prepare(struct run *r)
{
    struct mu_fault fault;
    mu_result done = experiment_prepare(r, &fault);
    if (done == MU_OK && r->options.inputs) {
        r->inputs = run_inputs_open(r->options.inputs, &fault);
        done = r->inputs ? MU_OK : MU_FAULT_FILE;
    }
    done = done == MU_OK ? run_place(r, &fault) : done;
    done = done == MU_OK ? chaos_prepare(r, &fault) : done;
    done = done == MU_OK && r->options.seeds_count == 0 ? folder_prepare(r, &fault) : done;
    if (done != MU_OK) {
        mu_fault_print(&fault);
    }
    return done;
}

/* --- the observer ----------------------------------------------------------------------------- */

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    struct run *r = self;
    r->registered = accepted;
    r->name_refused = !accepted;
    if (!accepted) {
        fprintf(stderr, "muster run: the broker refuses the name %s: %s\n", mu_agent_name(a),
                reason);
    }
}

static void on_receipt(void *self, mu_agent *a, uint64_t first_seq, uint64_t last_seq,
                       enum mu_outcome outcome)
{
    (void)a;
    struct run *r = self;
    uint64_t of_console = run_observer_receipt(r, first_seq, last_seq, outcome);
    if (of_console == last_seq - first_seq + 1) {
        return;
    }
    if (outcome == MU_MAIL_STORED) {
        r->directives_kept += last_seq - first_seq + 1;
    } else if (outcome != MU_MAIL_DELIVERED) {
        run_undone_note(
            r, "a command of the observer is not delivered: %s%s", mu_outcome_text(outcome),
            outcome == MU_MAIL_REFUSED ? "; the policy needs: allow observer direct all" : "");
        r->command_refused = r->command_refused || outcome == MU_MAIL_REFUSED;
        r->command_unknown = r->command_unknown || outcome == MU_MAIL_UNKNOWN_NAME;
    }
}

/* The line of the command that an answer is for; its label is the command's place in the file. */
static const char *line_of(const struct experiment *e, const char *in_reply_to)
{
    char *end;
    unsigned long index = strtoul(in_reply_to, &end, 10);
    if (!in_reply_to[0] || *end || index >= e->observer_count) {
        return "it";
    }
    const struct experiment_command *c = &e->observer[index];
    return c->line ? c->line : c->move ? "the move" : c->launch;
}

/* Robots answer commands; only what went wrong is worth a line. */
static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    struct run *r = self;
    bool fails =
        strcmp(mail->performative, "failure") == 0 || strcmp(mail->performative, "refuse") == 0;
    if (!run_observer_take(r, mail) && !run_pages_take(r, mail) && fails) {
        /* A robot's answer is one CLIPS string; its first line says enough. */
        const char *why = mail->content + (mail->content[0] == '"');
        run_undone_note(r, "%s could not do %s: %.*s", mail->src,
                        line_of(r->experiment, mail->in_reply_to), (int)strcspn(why, "\n"), why);
    }
}

/* An agent that may direct the observer has a console on it. */
static void on_directive(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    run_observer_directive(self, mail);
}

static mu_result network_join(struct run *r)
{
    struct mu_process_options options = {.domain = r->domain ? r->domain : MU_DOMAIN_ZERO,
                                         .name = "observer",
                                         .broker = run_broker(r, 0)};
    MU_TRY(mu_process_open(&r->process, &options));
    struct bus *bus = &r->process->bus;
    MU_TRY(bus_reader_open(bus, BUS_RUN_STATUS, NULL, &r->status));
    MU_TRY(bus_reader_open(bus, BUS_BROKER_STATUS, NULL, &r->broker_status));
    MU_TRY(bus_writer_open(bus, BUS_RUN_COMMAND, NULL, NULL, &r->command));
    MU_TRY(chaos_open(r));
    struct mu_handlers handlers = {.self = r,
                                   .on_registered = on_registered,
                                   .on_receipt = on_receipt,
                                   .on_mail = on_mail,
                                   .on_directive = on_directive};
    run_observer_open(r);
    MU_TRY(mu_agent_join(r->process, &r->observer, "observer", MU_KIND_SPECIAL, 0, &handlers));
    mu_agent_decline_broadcasts(r->observer);
    probes_hear(r->observer, run_observer_glance, r);
    return MU_OK;
}

/* --- what comes in ---------------------------------------------------------------------------- */

static void totals_take(struct run *r, const dds_sequence_muster_RobotTotals *totals)
{
    for (uint32_t i = 0; i < totals->_length && r->totals_count < RUN_TOTALS_MAX; i++) {
        muster_RobotTotals *to = &r->totals[r->totals_count++];
        *to = totals->_buffer[i];
        to->robot = run_robot_name(r, totals->_buffer[i].robot);
    }
}

static void status_take(struct run *r, const muster_RunStatus *s)
{
    mu_text_copy(r->simulator, sizeof r->simulator, s->simulator);
    r->silent_ns = 0;
    r->state = s->state;
    r->time_ns = s->time_ns;
    r->wall_ns = s->wall_ns;
    r->skipped = s->skipped;
    mu_text_copy(r->waits_for, sizeof r->waits_for, s->waits_for);
    mu_text_copy(r->hash, sizeof r->hash, s->hash);
    r->totals_count = 0;
    totals_take(r, &s->robots);
    totals_take(r, &s->agents);
    run_objects_take(r, s->objects._buffer, s->objects._length);
}

static void mail_take(struct run *r, const muster_BrokerStatus *status)
{
    for (unsigned i = 0; i < run_brokers(r); i++) {
        if (strcmp(run_broker(r, i), status->broker) == 0) {
            r->mail[i] = *status;
            r->mail[i].broker = NULL;
        }
    }
}

static void statuses_take(struct run *r)
{
    enum bus_life life;
    const muster_RunStatus *s;
    while ((s = bus_next(&r->status, &life))) {
        if (life == BUS_DATA) {
            status_take(r, s);
        }
    }
    const muster_BrokerStatus *b;
    while ((b = bus_next(&r->broker_status, &life))) {
        if (life == BUS_DATA) {
            mail_take(r, b);
        }
    }
}

/* --- what people see -------------------------------------------------------------------------- */

static bool progress_is_wanted(const struct run *r)
{
    return !r->options.quiet && isatty(STDERR_FILENO);
}

/* A line that is wider than the terminal could not be written over. */
static int progress_room(void)
{
    struct winsize size;
    bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
    return known ? size.ws_col - 1 : 79;
}

static void progress_show(struct run *r)
{
    uint64_t now_ns = mu_clock_ns();
    double time_s = (double)r->time_ns * 1e-9;
    double wall_s = (double)r->wall_ns * 1e-9;
    bool due = now_ns - r->progress_wall_ns >= PROGRESS_NS && progress_is_wanted(r);
    if (!due || r->state != muster_RUN_RUNNING || wall_s <= 0.0 || time_s <= 0.0) {
        return;
    }
    char line[128];
    double factor = time_s / wall_s;
    r->progress_wall_ns = now_ns;
    snprintf(line, sizeof line, "%.1f of %.0f s simulated, %.1f x real time, %.0f s to go", time_s,
             r->experiment->duration, factor, (r->experiment->duration - time_s) / factor);
    fprintf(stderr, "\r\033[K%.*s", progress_room(), line);
}

static void progress_clear(const struct run *r)
{
    if (progress_is_wanted(r)) {
        fputs("\r\033[K", stderr);
    }
}

static void broken_tell(const struct run *r)
{
    char recording[PATH_MAX + 16];
    snprintf(recording, sizeof recording, "%s/run.mcap", r->folder);
    if (r->begun && !r->options.quiet && access(recording, F_OK) == 0) {
        fprintf(stderr,
                "muster run: broke off at %.1f of %.0f s; a report as far as it goes: "
                "muster report %s\n",
                (double)r->time_ns * 1e-9, r->experiment->duration, r->folder);
    }
}

/* --- the course of a run ---------------------------------------------------------------------- */

/* What the exit code of a program of the user's means is not ours to know. */
static int crash_explain(const struct run *r, const struct child *child, bool running)
{
    supervise_explain(child);
    int code = WIFEXITED(child->status) ? WEXITSTATUS(child->status) : MU_EXIT_CRASH;
    bool explains_itself = code == MU_EXIT_FILE || code == MU_EXIT_USAGE || code == MU_EXIT_DDS ||
                           code == MU_EXIT_WRITE || code == MU_EXIT_NETWORK;
    return !running && explains_itself && !run_controller(r, child) ? code : MU_EXIT_CRASH;
}

static bool simulator_silent(struct run *r)
{
    uint64_t now_ns = mu_clock_ns();
    uint64_t round_ns = now_ns - r->round_wall_ns;
    r->round_wall_ns = now_ns;
    r->silent_ns += round_ns < ROUND_COUNTS_NS ? round_ns : ROUND_COUNTS_NS;
    return r->simulator[0] && r->silent_ns > SILENCE_NS;
}

/* @return an agent that a child has registered, or NULL */
static const struct mu_member *member_of(const struct run *r, const struct child *child)
{
    const struct mu_member *m;
    for (size_t i = 0; (m = mu_process_member(r->process, i)); i++) {
        if (m->pid == (uint32_t)child->pid && m->state != MU_GONE) {
            return m;
        }
    }
    return NULL;
}

/* @return whether a robot lives in a child, or an agent of the experiment */
static bool child_has_robots(const struct run *r, const struct child *child)
{
    const struct mu_member *m;
    bool has = false;
    for (size_t i = 0; !has && (m = mu_process_member(r->process, i)); i++) {
        bool counts =
            m->kind == MU_KIND_ROBOT || experiment_robot_find(r->experiment, m->name) >= 0;
        has = counts && m->pid == (uint32_t)child->pid && m->state != MU_GONE;
    }
    return has;
}

/* A host that dies with no robot in it, and is not started again, has only ceased to be one. */
static void hosts_excuse(struct run *r)
{
    for (unsigned i = 0; i < r->experiment->hosts_count; i++) {
        struct child *child = supervise_find(&r->children, r->experiment->hosts[i]);
        if (child && child->ended && !child->excused && r->state == muster_RUN_RUNNING &&
            !run_restarts(r, child) && !child_has_robots(r, child)) {
            child->excused = true;
            fprintf(stderr, "muster run: the host %s is no more; the run goes on\n", child->name);
        }
    }
}

/* Looks at everything once.  @return -1: go on; else the exit code */
static int round_live(struct run *r)
{
    mu_result spun = mu_process_spin(r->process, ROUND_NS);
    statuses_take(r);
    run_observer_look(r);
    chaos_look(r);
    supervise_look(&r->children);
    if (r->hurries) {
        supervise_hurry(&r->children);
    }
    hosts_excuse(r);
    run_monitors_look(r);
    progress_show(r);
    if (run_signal) {
        return MU_EXIT_INTERRUPTED;
    }
    const struct child *ended = run_is_over(r) ? NULL : run_restart_look(r);
    if (ended) {
        return crash_explain(r, ended, r->state == muster_RUN_RUNNING);
    }
    if (simulator_silent(r) && !run_is_over(r)) {
        fprintf(stderr, "muster run: the simulator has been silent for %d s\n",
                (int)(SILENCE_NS / 1000000000u));
        return MU_EXIT_CRASH;
    }
    double limit_ns = r->options.limit_s * 1e9;
    if (limit_ns > 0.0 && (double)(mu_clock_ns() - r->began_wall_ns) > limit_ns) {
        fprintf(stderr, "muster run: the time limit of %g s is over\n", r->options.limit_s);
        return MU_EXIT_TIME;
    }
    return r->name_refused || spun < 0 ? MU_EXIT_DDS : -1;
}

/* Says what has become of the agents of controllers that are not there. */
static void controllers_explain(const struct run *r)
{
    const struct experiment *e = r->experiment;
    for (uint32_t i = 0; i < r->children.count; i++) {
        const struct child *child = &r->children.children[i];
        const struct experiment_crew *crew = run_controller(r, child);
        for (unsigned k = 0; crew && k < crew->count; k++) {
            const char *name = e->robots[crew->robot + k].name;
            const struct mu_member *m = mu_process_lookup(r->process, name);
            if (m && m->pid == (uint32_t)child->pid) {
                continue;
            }
            const struct mu_member *other = member_of(r, child);
            fprintf(stderr, "muster run: the controller %s has not registered %s%s%s\n",
                    e->robots[crew->robot].controller.program, name,
                    other ? ", but as " : "; MUSTER_AGENT has the name", other ? other->name : "");
        }
    }
}

/* A run with a time limit waits until that, and says once who it is that it waits for. */
static int start_patience(struct run *r)
{
    if (mu_clock_ns() - r->began_wall_ns < r->patience_ns) {
        return -1;
    }
    char monitors[256];
    run_monitors_missing(r, monitors, sizeof monitors);
    fprintf(stderr,
            "muster run: not everybody is there after %d s (--limit S waits longer); missing: "
            "%.200s%s%s\n",
            (int)(r->patience_ns / 1000000000u), r->waits_for,
            r->waits_for[0] && monitors[0] ? " " : "", monitors);
    controllers_explain(r);
    r->patience_ns = UINT64_MAX;
    return r->options.limit_s > 0.0 ? -1 : MU_EXIT_DDS;
}

/* @return whether every scheme of the experiment has its resolver in the yellow pages */
static bool resolvers_are_in(const struct run *r)
{
    const struct experiment *e = r->experiment;
    bool all = true;
    for (unsigned i = 0; i < e->resolvers_count && all; i++) {
        char query[MU_QUERY_MAX + 1];
        snprintf(query, sizeof query, "resolver scheme=%s", e->resolvers[i]);
        all = mu_process_find_service(r->process, query, 0) != NULL;
    }
    return all;
}

/* @return -1, or the exit code */
static int pages_gather(struct run *r)
{
    int code = -1;
    while (code < 0 && !run_pages_tell(r)) {
        code = round_live(r);
        code = code < 0 && r->command_refused ? MU_EXIT_REFUSED : code;
        code = code < 0 ? start_patience(r) : code;
    }
    return code;
}

/* A monitor of the recorded run is not started: its name is there, and what it said. */
static void inputs_join(struct run *r)
{
    const struct experiment *e = r->experiment;
    run_inputs_join(r->inputs, r->process, r->observer, &r->command, r->simulator);
    for (unsigned i = 0; i < e->monitors_count; i++) {
        if (e->monitors[i].rules) {
            run_inputs_seat(r->inputs, e->monitors[i].name);
        }
    }
}

/* Hands over what a recording has from outside.  @return -1, or the exit code */
static int inputs_gather(struct run *r)
{
    int code = -1;
    if (r->inputs) {
        inputs_join(r);
    }
    while (code < 0 && r->inputs && !run_inputs_tell(r->inputs)) {
        code = round_live(r);
        code = code < 0 ? start_patience(r) : code;
    }
    if (code < 0 && r->inputs && run_inputs_refused(r->inputs)) {
        fprintf(stderr, "muster run: some of what came from outside cannot be put in again\n");
        return MU_EXIT_REFUSED;
    }
    return code;
}

static bool all_are_here(const struct run *r)
{
    return r->registered && r->state == muster_RUN_READY && resolvers_are_in(r) &&
           run_monitors_ready(r);
}

/* Until all are there and the broker has every command. */
static int gather(struct run *r)
{
    int code = -1;
    while (code < 0 && !all_are_here(r)) {
        code = round_live(r);
        code = code < 0 ? start_patience(r) : code;
    }
    code = code < 0 ? pages_gather(r) : code;
    if (code < 0 && run_commands_send(r) != MU_OK) {
        fprintf(stderr, "muster run: more commands than an agent can have under way (%d)\n",
                MU_OUTBOX_MAX);
        return MU_EXIT_FILE;
    }
    while (code < 0 && r->directives_kept < r->directives_sent) {
        code = round_live(r);
        code = code < 0 && r->command_refused ? MU_EXIT_REFUSED : code;
        code = code < 0 && r->command_unknown ? MU_EXIT_NO_AGENT : code;
        code = code < 0 ? start_patience(r) : code;
    }
    return code < 0 ? inputs_gather(r) : code;
}

static int watch(struct run *r)
{
    if (chaos_send(r) != MU_OK || run_go_send(r, 1) != MU_OK) {
        return MU_EXIT_DDS;
    }
    r->begun = true;
    int code = -1;
    while (code < 0 && !run_is_over(r)) {
        code = round_live(r);
    }
    progress_clear(r);
    if (code < 0 && r->state == muster_RUN_FAULT) {
        fprintf(stderr, "muster run: %s\n", r->waits_for);
        return MU_EXIT_CRASH;
    }
    return code;
}

/* The broker goes first: its last words are the final counters. */
static void counters_await(struct run *r)
{
    for (unsigned i = 0; i < run_brokers(r); i++) {
        char name[RUN_CHILD_MAX];
        run_child_name(r, i, name);
        supervise_stop(&r->children, supervise_find(&r->children, name), LAST_PATIENCE_MS);
    }
    if (mu_process_spin(r->process, ROUND_NS) >= 0) {
        statuses_take(r);
    }
}

/* The simulator need not wait for us any longer, and ends when its record is on the disk.
 * @return -1, or why it is not */
static int record_await(struct run *r)
{
    struct child *simulator = supervise_find(&r->children, "simulator");
    supervise_signal(simulator, SIGTERM);
    supervise_await(&r->children, simulator, LAST_PATIENCE_MS);
    if (simulator->ended && WIFEXITED(simulator->status) && WEXITSTATUS(simulator->status) == 0) {
        return -1;
    }
    return crash_explain(r, simulator, false);
}

static int live_through(struct run *r)
{
    r->began_wall_ns = mu_clock_ns();
    r->patience_ns = START_PATIENCE_NS + experiment_members(r->experiment) * START_PATIENCE_EACH_NS;
    if (run_start(r) != MU_OK) {
        return MU_EXIT_DDS;
    }
    mu_result joined = network_join(r);
    if (joined != MU_OK) {
        return mu_exit_for(joined);
    }
    int code = gather(r);
    code = code < 0 ? watch(r) : code;
    if (code < 0) {
        run_monitors_await(r);
        counters_await(r);
        code = record_await(r);
    }
    return code;
}

static int domain_explain(mu_result why, int wanted)
{
    if (wanted < 0) {
        fputs("muster run: no DDS domain is free: too many runs live\n", stderr);
    } else if (why == MU_EXISTS) {
        fprintf(stderr,
                "muster run: another run has domain %d; without --domain and MUSTER_DOMAIN a free "
                "one is found\n",
                wanted);
    } else {
        fprintf(stderr,
                "muster run: other programs have the DDS ports of domain %d; start a DDS tool when "
                "the run lives\n",
                wanted);
    }
    return MU_EXIT_DDS;
}

int run_live(struct run *r)
{
    mu_result taken = runs_take((int)r->options.domain, r->experiment->name, &r->domain);
    if (taken != MU_OK) {
        return taken == MU_FAULT_OS ? MU_EXIT_WRITE : domain_explain(taken, (int)r->options.domain);
    }
    runs_note(r->experiment->name, r->folder);
    setenv(MU_NETWORK_WAIT, "1e9", 1); /* children end with us */
    /* In lock step all processes work in turns; at leisure the machine may place them. */
    r->hurries = !r->options.free && r->options.rate <= 0.0;
    supervise_init(&r->children, r->options.quiet, r->hurries && !r->options.no_spread);
    int code = live_through(r);
    supervise_stop_all(&r->children, STOP_PATIENCE_MS);
    if (r->process) {
        bus_close(&r->process->bus);
    }
    /* A disk that is full ends the recording, not the report. */
    bool reports = code < 0 || (code == MU_EXIT_WRITE && r->state == muster_RUN_DONE);
    int reported = reports ? run_report(r) : code;
    if (!reports) {
        broken_tell(r);
    }
    runs_note(r->experiment->name, r->folder);
    return code < 0 ? reported : code;
}
