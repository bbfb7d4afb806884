/* SPDX-License-Identifier: Apache-2.0 */
/* How a run ends: the report in its folder, and what came out on standard output. */
#include "core/arithmetic.h"
#include "core/exits.h"
#include "core/text.h"
#include "muster/memory.h"
#include "muster/version.h"
#include "run/chaos.h"
#include "run/run.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void undone_add(struct run *r, const char *text)
{
    if (r->undone_count < RUN_UNDONE_MAX) {
        r->undone[r->undone_count++] = mu_startup_string(text);
    }
}

void run_undone_note(struct run *r, const char *format, ...)
{
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    fprintf(stderr, "muster run: %s\n", text);
    undone_add(r, text);
}

/* Monitors and chaos, too: these were told of when it happened. */
static void undone_gather(struct run *r, struct report_input *in)
{
    char text[1024];
    for (size_t i = 0; i < in->monitors_count; i++) {
        if (in->monitors[i].fate) {
            snprintf(text, sizeof text, "the monitor %s %s", in->monitors[i].name,
                     in->monitors[i].fate);
            undone_add(r, text);
        }
    }
    for (unsigned i = 0; in->chaos && i < in->experiment->chaos_count; i++) {
        if (!in->chaos[i].done && in->chaos[i].reason[0]) {
            snprintf(text, sizeof text, "%s: %s", in->experiment->chaos[i].text,
                     in->chaos[i].reason);
            undone_add(r, text);
        }
    }
    in->undone = r->undone;
    in->undone_count = r->undone_count;
}

/* Each has its row, as long as they fit a screen; else they have one together. */
enum { ROWS_MAX = 24 };

static void robot_print(const char *name, const struct report_robot *robot,
                        const struct report_robot_result *result)
{
    printf("  %-12s %7.2f m  %3u stalls  %6" PRIu64 " mails sent  %6" PRIu64 " received\n", name,
           result->distance_m, result->stalls, robot->mail_sent, robot->mail_received);
}

static void robots_print(const struct report_input *in, const struct report_result *out)
{
    char name[32];
    struct report_robot all = {.name = name};
    struct report_robot_result sum = {0};
    for (size_t i = 0; i < in->robots_count; i++) {
        if (in->robots_count <= ROWS_MAX) {
            robot_print(in->robots[i].name, &in->robots[i], &out->robots[i]);
        }
        all.mail_sent += in->robots[i].mail_sent;
        all.mail_received += in->robots[i].mail_received;
        sum.distance_m += out->robots[i].distance_m;
        sum.stalls += out->robots[i].stalls;
    }
    if (in->robots_count > ROWS_MAX) {
        snprintf(name, sizeof name, "%zu robots", in->robots_count);
        robot_print(name, &all, &sum);
    }
}

static void agent_print(const char *name, const struct report_robot *agent)
{
    printf("  %-12s %7" PRIu64 " rule firings  %6" PRIu64 " mails sent  %6" PRIu64 " received\n",
           name, agent->rule_firings, agent->mail_sent, agent->mail_received);
}

static void agents_print(const struct report_input *in)
{
    char name[32];
    struct report_robot all = {.name = name};
    for (size_t i = 0; i < in->agents_count; i++) {
        if (in->agents_count <= ROWS_MAX) {
            agent_print(in->agents[i].name, &in->agents[i]);
        }
        all.rule_firings += in->agents[i].rule_firings;
        all.mail_sent += in->agents[i].mail_sent;
        all.mail_received += in->agents[i].mail_received;
    }
    if (in->agents_count > ROWS_MAX) {
        snprintf(name, sizeof name, "%zu agents", in->agents_count);
        agent_print(name, &all);
    }
}

static void text_print(const struct run *r, const struct report_input *in,
                       const struct report_result *out)
{
    printf("%s, seed %" PRIu64 ": %.1f s simulated in %.2f s, %.0f x real time%s\n",
           in->experiment->name, in->seed, in->sim_time_s, in->wall_time_s,
           in->wall_time_s > 0.0 ? in->sim_time_s / in->wall_time_s : 0.0,
           in->broke_off ? ", where it broke off" : "");
    if (!r->options.quiet) {
        robots_print(in, out);
        agents_print(in);
    }
    for (unsigned i = 0; i < in->experiment->expect_count; i++) {
        const char *word = !out->judged[i] ? "-     " : out->met[i] ? "met   " : "FAILED";
        printf("  %s  %s%s%s\n", word, out->texts[i], out->judged[i] ? ": " : "",
               out->judged[i] ? out->measured[i] : "");
    }
    for (size_t i = 0; i < in->restarts_count; i++) {
        printf("  restarted %s, %" PRIu32 " times\n", in->restarts[i].name, in->restarts[i].count);
    }
    for (unsigned i = 0; in->chaos && i < in->experiment->chaos_count; i++) {
        char when[32] = "not done";
        if (in->chaos[i].done) {
            snprintf(when, sizeof when, "%6.1f s", in->chaos[i].at_s);
        }
        printf("  %s  %s%s%s\n", when, in->experiment->chaos[i].text,
               in->chaos[i].reason[0] ? ": " : "", in->chaos[i].reason);
    }
    for (size_t i = 0; i < in->undone_count; i++) {
        printf("  NOT DONE  %s\n", in->undone[i]);
    }
    if (r->options.free) {
        printf("skipped %" PRIu64 " samples\n", r->skipped);
    }
    printf("hash   %s\nreport %s/report.html\n", in->hash, r->folder);
}

/* A newline in it can only be layout. */
void run_summary_print(const char *folder)
{
    char path[PATH_MAX + 32];
    snprintf(path, sizeof path, "%s/summary.json", folder);
    FILE *file = fopen(path, "r");
    bool line_begins = false;
    for (int c; file && (c = fgetc(file)) != EOF;) {
        line_begins = c == '\n' || (line_begins && c == ' ');
        if (!line_begins) {
            putchar(c);
        }
    }
    putchar('\n');
    if (file) {
        fclose(file);
    }
}

static const muster_RobotTotals *totals_find(const struct run *r, const char *name)
{
    for (uint32_t i = 0; i < r->totals_count; i++) {
        if (r->totals[i].robot == name) {
            return &r->totals[i];
        }
    }
    return NULL;
}

static void totals_fill(const struct run *r, struct report_robot *agent)
{
    const muster_RobotTotals *totals = totals_find(r, agent->name);
    if (totals) {
        agent->mail_sent = totals->mails_sent;
        agent->mail_received = totals->mails_received;
        agent->rule_firings = totals->firings;
    }
}

/* The robots of the experiment, in the order of the world; others that stand there are obstacles.
 * @return how many */
static size_t robots_fill(const struct run *r, struct report_robot *robots)
{
    size_t count = 0;
    for (size_t i = 0; i < r->world->robot_count; i++) {
        const struct world_robot *robot = &r->world->robots[i];
        if (experiment_robot_find(r->experiment, robot->name) < 0) {
            continue;
        }
        robots[count] = (struct report_robot){.name = robot->name, .rgb = robot->look.rgb};
        totals_fill(r, &robots[count++]);
    }
    return count;
}

static const struct report_robot *agents_fill(const struct run *r)
{
    const struct experiment *e = r->experiment;
    struct report_robot *agents = mu_startup_array(e->agents_count, sizeof *agents);
    for (unsigned i = 0; i < e->agents_count; i++) {
        agents[i].name = e->agents[i].name;
        totals_fill(r, &agents[i]);
    }
    return agents;
}

/* @return how many processes died and were started again */
static size_t restarts_fill(const struct run *r, const struct report_restarts **out)
{
    struct report_restarts *restarts = mu_startup_array(r->children.count, sizeof *restarts);
    size_t count = 0;
    for (uint32_t i = 0; i < r->children.count; i++) {
        const struct child *child = &r->children.children[i];
        if (child->restarts > 0) {
            restarts[count++] = (struct report_restarts){child->name, child->restarts};
        }
    }
    *out = restarts;
    return count;
}

void run_report_input(const struct run *r, struct report_input *input)
{
    struct report_robot *robots = mu_startup_array(r->world->robot_count, sizeof *robots);
    struct report_object *objects = mu_startup_array(r->objects_count, sizeof *objects);
    size_t robots_count = robots_fill(r, robots);
    for (size_t i = 0; i < r->objects_count; i++) {
        objects[i] = (struct report_object){r->world->objects[i].name, r->objects[i]};
    }
    *input = (struct report_input){.experiment = r->experiment,
                                   .world = r->world,
                                   .seed = r->experiment->seed,
                                   .hash = r->hash,
                                   .sim_time_s = (double)r->time_ns / 1e9,
                                   .wall_time_s = (double)r->wall_ns / 1e9,
                                   .overrides = r->options.set,
                                   .overrides_count = r->options.set_count,
                                   .robots = robots,
                                   .robots_count = robots_count,
                                   .agents = agents_fill(r),
                                   .agents_count = r->experiment->agents_count,
                                   .objects = objects,
                                   .objects_count = r->objects_count};
}

int run_report_write(const struct run *r, const struct report_input *input)
{
    struct report_result *result = mu_startup_alloc(sizeof *result);
    struct mu_fault fault;
    mu_result written = report_write(r->folder, input, result, &fault);
    if (written != MU_OK) {
        mu_fault_print(&fault);
        return mu_exit_for(written);
    }
    if (r->options.json) {
        run_summary_print(r->folder);
    } else {
        text_print(r, input, result);
    }
    return !result->all_met          ? MU_EXIT_EXPECTATION
           : input->undone_count > 0 ? MU_EXIT_UNDONE
                                     : MU_EXIT_DONE;
}

static void files_fill(const struct run *r, struct report_input *input)
{
    struct report_source *files = mu_startup_array(r->files_count, sizeof *files);
    for (size_t i = 0; i < r->files_count; i++) {
        files[i] = (struct report_source){r->files[i].name, r->files[i].hash};
    }
    input->files = files;
    input->files_count = r->files_count;
}

int run_report(struct run *r)
{
    char command[2048], versions[128], processor[MU_PROCESSOR_MAX];
    struct report_input input;
    snprintf(versions, sizeof versions, "muster %s, Cyclone DDS %s, CLIPS %s", MU_VERSION,
             bus_version(), MU_CLIPS_VERSION);
    run_command_write(r, command, sizeof command);
    run_report_input(r, &input);
    input.command = command;
    input.file = r->options.file;
    input.free = r->options.free;
    files_fill(r, &input);
    input.versions = versions;
    mu_processor(processor);
    input.arithmetic = MU_ARITHMETIC;
    input.architecture = mu_architecture();
    input.processor = processor;
    input.mail = run_mail_of(r);
    input.chaos = chaos_fates(r);
    input.packets_struck = chaos_packets(r);
    input.monitors_count = run_monitors_fates(r, &input.monitors);
    input.restarts_count = restarts_fill(r, &input.restarts);
    undone_gather(r, &input);
    int code = run_report_write(r, &input);
    report_folder_release(r->folder);
    return code;
}
