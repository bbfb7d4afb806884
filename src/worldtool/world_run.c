/* SPDX-License-Identifier: Apache-2.0 */
#include "worldtool/worldtool.h"

#include "bus/bus.h"
#include "core/clock.h"
#include "core/exits.h"
#include "core/json.h"
#include "core/text.h"
#include "muster/limits.h"
#include "operator/operator.h"
#include "wire.h"
#include "world/condition/condition.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const uint64_t SIMULATOR_PATIENCE_NS = 2500000000;
static const int64_t ROUND_NS = 20000000;
static const uint64_t LAST_ANSWER_NS = 500000000;
static const double WAIT_S = 5.0;
static const double WAIT_LONG_S = 1e9;

struct request {
    const char *program; /* "muster world place" */
    const struct world_run_options *set;
    muster_RunCommand command;
};

/* The two ends of a conversation with the simulator. */
struct line {
    struct bus bus;
    struct bus_reader status, answers;
    struct bus_writer commands;
    char simulator[MU_PROCESS_MAX + 1]; /* "": not heard of yet */
    bool over;                          /* its run is */
    bool answered;
    muster_RunOutcome result;
    int64_t step;
    char reason[256];
};

/* --- when it is to be done -------------------------------------------------------------------- */

static bool is_for_later(const struct request *r)
{
    return r->set->at_s >= 0 || r->set->when;
}

/* The body that it names may be there: the simulator knows. */
static int body_any(const void *self, const char *name)
{
    (void)self;
    (void)name;
    return 0;
}

static bool condition_good(const struct request *r)
{
    char why[CONDITION_WHY_MAX];
    struct condition condition;
    const struct condition_names any = {.find = body_any, .robots = 1};
    if (condition_read(&condition, r->set->when, &any, why) == MU_OK) {
        return true;
    }
    fprintf(stderr, "%s: --when: %s\n", r->program, why);
    return false;
}

static bool later_read(struct request *r)
{
    if (is_for_later(r) && r->command.order == muster_RUN_PACE) {
        fprintf(stderr, "%s: the pace goes by the clock on the wall, at once\n", r->program);
        return false;
    }
    if (r->set->at_s >= 0) {
        r->command.due_ns = (uint64_t)llround(r->set->at_s * 1e9);
    }
    if (r->set->when) {
        r->command.when = (char *)(uintptr_t)r->set->when; /* there is no writer */
        return condition_good(r);
    }
    return true;
}

static double patience_s(const struct request *r)
{
    return r->set->wait_s >= 0 ? r->set->wait_s : is_for_later(r) ? WAIT_LONG_S : WAIT_S;
}

/* --- the simulator ---------------------------------------------------------------------------- */

/* @return the exit code, explained */
static int line_open(struct line *l, const struct request *r)
{
    struct mu_network network = r->set->network;
    int domain = (int)network.domain;
    if (domain < 0 && runs_find(&domain) != MU_OK) {
        return MU_EXIT_SEVERAL;
    }
    network.domain = domain;
    if (bus_join(&l->bus, &network, BUS_AGENT, "operator") != MU_OK ||
        bus_reader_open(&l->bus, BUS_RUN_STATUS, NULL, &l->status) != MU_OK ||
        bus_reader_open(&l->bus, BUS_RUN_ANSWER, NULL, &l->answers) != MU_OK ||
        bus_writer_open(&l->bus, BUS_RUN_COMMAND, NULL, NULL, &l->commands) != MU_OK) {
        return MU_EXIT_NETWORK;
    }
    return MU_EXIT_DONE;
}

static void status_take(struct line *l)
{
    enum bus_life life;
    const muster_RunStatus *s;
    while ((s = bus_next(&l->status, &life))) {
        if (life == BUS_DATA) {
            mu_text_copy(l->simulator, sizeof l->simulator, s->simulator);
            l->over = s->state == muster_RUN_DONE || s->state == muster_RUN_FAULT;
        }
    }
}

static void answers_take(struct line *l, const muster_RunCommand *c)
{
    enum bus_life life;
    const muster_RunAnswer *a;
    while ((a = bus_next(&l->answers, &life))) {
        if (life == BUS_DATA && strcmp(a->source, c->source) == 0 && a->seq == c->seq) {
            l->answered = true;
            l->result = a->result;
            l->step = a->step;
            mu_text_copy(l->reason, sizeof l->reason, a->reason);
        }
    }
}

/* @return the exit code, explained */
static int simulator_find(struct line *l, const struct request *r)
{
    uint64_t until_ns = mu_clock_ns() + SIMULATOR_PATIENCE_NS;
    while ((l->simulator[0] == '\0' || bus_writer_matches(&l->commands) == 0) &&
           mu_clock_ns() < until_ns) {
        bus_wait(&l->bus, 1, ROUND_NS);
        status_take(l);
    }
    if (l->simulator[0] != '\0' && !l->over) {
        return MU_EXIT_DONE;
    }
    fprintf(stderr, "%s: %s\n", r->program,
            l->over ? "the run is over" : "no simulator answers; muster run FILE starts one");
    return MU_EXIT_DDS;
}

/* @return the exit code */
static int answer_tell(const struct line *l, const struct request *r)
{
    static const int exits[] = {[muster_ORDER_DONE] = MU_EXIT_DONE,
                                [muster_ORDER_NO_NAME] = MU_EXIT_NO_AGENT,
                                [muster_ORDER_REFUSED] = MU_EXIT_UNDELIVERED,
                                [muster_ORDER_NOT_WRITTEN] = MU_EXIT_WRITE};
    if (l->result != muster_ORDER_DONE) {
        fprintf(stderr, "%s: %s\n", r->program, l->reason);
    } else if (r->set->json) {
        struct mu_json j = mu_json_line(stdout);
        mu_json_string(&j, "result", "done");
        mu_json_int(&j, "step", l->step);
        mu_json_end(&j);
    } else {
        printf("done at step %lld\n", (long long)l->step);
    }
    return exits[l->result];
}

/* The answer may come a little behind the end of its run. */
static void answer_await(struct line *l, const struct request *r)
{
    uint64_t until_ns = mu_clock_ns() + (uint64_t)(patience_s(r) * 1e9);
    while (!l->answered && mu_clock_ns() < until_ns) {
        bool was_over = l->over;
        bus_wait(&l->bus, 1, ROUND_NS);
        answers_take(l, &r->command);
        status_take(l);
        uint64_t last_ns = mu_clock_ns() + LAST_ANSWER_NS;
        until_ns = l->over && !was_over && last_ns < until_ns ? last_ns : until_ns;
    }
}

/* The simulator has it, and does it when its time has come, with or without a waiter. */
static int waits_tell(const struct request *r)
{
    if (r->set->json) {
        struct mu_json j = mu_json_line(stdout);
        mu_json_string(&j, "result", "waits");
        mu_json_end(&j);
    } else {
        puts("waits for its time");
    }
    return MU_EXIT_DONE;
}

static int order_send(struct line *l, struct request *r)
{
    static char source[] = "operator";
    r->command.simulator = l->simulator;
    r->command.source = source;
    r->command.seq = mu_clock_wall_ns(); /* higher than that of every verb before */
    if (bus_write(&l->commands, &r->command) != MU_OK) {
        return MU_EXIT_DDS;
    }
    answer_await(l, r);
    if (l->answered) {
        return answer_tell(l, r);
    }
    bool arrived = bus_drain(&l->commands, (int64_t)SIMULATOR_PATIENCE_NS);
    if (is_for_later(r) && arrived && !l->over) {
        return waits_tell(r);
    }
    fprintf(stderr, "%s: %s\n", r->program,
            l->over    ? "the run has ended"
            : !arrived ? "the simulator has not taken the order; it is stopped, or was killed"
                       : "no answer yet: the run makes no steps");
    return MU_EXIT_TIME;
}

static int request_run(struct request *r)
{
    static struct line line;
    int code = line_open(&line, r);
    code = code == MU_EXIT_DONE ? simulator_find(&line, r) : code;
    code = code == MU_EXIT_DONE ? order_send(&line, r) : code;
    bus_close(&line.bus);
    return code;
}

/* --- the verb --------------------------------------------------------------------------------- */

bool world_run_knows(const char *word)
{
    return world_words_know(word);
}

int world_run(const struct mu_options *o, const struct world_run_options *set)
{
    static struct request r;
    char program[64], wrong[WORLD_WORDS_WRONG];
    snprintf(program, sizeof program, "muster world %s", o->words_count > 0 ? o->words[0] : "");
    r = (struct request){.program = program, .set = set};
    if (world_words_read(o->words, o->words_count, set->push_s, &r.command, wrong) != MU_OK) {
        fprintf(stderr, "%s: %s\n", program, wrong);
        return MU_EXIT_USAGE;
    }
    bool good = later_read(&r);
    return good ? request_run(&r) : MU_EXIT_USAGE;
}
