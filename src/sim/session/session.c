/* SPDX-License-Identifier: Apache-2.0 */
/* How a run begins and ends. */
#include "sim/session/parts.h"

#include "core/clock.h"
#include "core/log.h"
#include "core/network.h"
#include "muster/memory.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const int64_t IMPATIENT_NS = 2000000;
static const int64_t RETRY_NS = 1000000;
static const int64_t STATUS_DRAIN_NS = 500000000;
static const int64_t STATUS_ROUND_NS = 20000000;
static const uint64_t STARTER_PATIENCE_NS = 10000000000;

static mu_result topics_open(struct session *s)
{
    MU_TRY(bus_writer_open(s->bus, BUS_ROSTER, NULL, NULL, &s->roster));
    MU_TRY(bus_writer_open(s->bus, BUS_RUN_STATUS, NULL, NULL, &s->status.writer));
    MU_TRY(bus_writer_open(s->bus, BUS_RUN_ANSWER, NULL, NULL, &s->answers));
    MU_TRY(bus_reader_open(s->bus, BUS_REGISTRATION, NULL, &s->registrations));
    MU_TRY(bus_reader_open(s->bus, BUS_UP, "simulator", &s->ups));
    MU_TRY(bus_reader_open(s->bus, BUS_DELIVERY, s->name, &s->deliveries));
    MU_TRY(bus_reader_open(s->bus, BUS_RUN_COMMAND, NULL, &s->commands));
    return MU_OK;
}

/* A robot that is not chosen has no controller and stands as an obstacle. */
static void robots_choose(struct session_agents *agents, const struct mu_option_list *names)
{
    for (uint32_t r = 0; names->count > 0 && r < agents->robots; r++) {
        struct session_agent *robot = &agents->at[r];
        robot->controlled = false;
        for (size_t i = 0; i < names->count; i++) {
            robot->controlled |= strcmp(names->items[i], robot->name) == 0;
        }
    }
}

/* Robots first, in the order of the world, then agents without a body, in that of their options. */
static void totals_open(struct session *s, const struct mu_option_list *agents)
{
    s->totals_count = s->robot_count + agents->count;
    s->totals = mu_startup_array(s->totals_count, sizeof *s->totals);
    for (size_t i = 0; i < s->robot_count; i++) {
        s->totals[i].told.robot = s->world->robots[i].name;
    }
    for (size_t i = 0; i < agents->count; i++) {
        s->totals[s->robot_count + i].told.robot = (char *)(uintptr_t)agents->items[i]; /* read */
        agents_expect(&s->agents, agents->items[i], (int32_t)(s->robot_count + i));
    }
}

mu_result session_open(struct session **out, const struct session_options *options)
{
    struct session *s = mu_startup_alloc(sizeof *s);
    s->options = *options;
    s->world = options->world;
    s->engine = options->engine;
    s->bus = options->bus;
    s->hash = run_hash_open();
    s->phase = PHASE_GATHERING;
    s->step = s->sent_step = -1;
    s->mail_step = muster_STEP_NOW;
    snprintf(s->name, sizeof s->name, "simulator.%ld", (long)getpid());
    s->robot_count = s->world->robot_count;
    s->robots = mu_startup_array(s->robot_count, sizeof *s->robots);
    agents_open(&s->agents, s->world);
    robots_choose(&s->agents, options->robots);
    totals_open(s, options->agents);
    const struct condition_names names = record_names(s->world, options->agents);
    s->orders = order_queue_open(&names);
    s->snapshot = mu_startup_alloc(engine_save_size(s->engine));
    mu_table_init(&s->process_names, MU_PROCESSES_MAX);
    s->processes = mu_startup_array(MU_PROCESSES_MAX, sizeof *s->processes);
    s->wanted = mu_startup_array(s->robot_count, sizeof *s->wanted);
    s->percepts = mu_startup_array(s->robot_count, sizeof *s->percepts);
    for (int i = 0; i < 2; i++) {
        s->bodies[i] = mu_startup_array(s->robot_count, sizeof *s->bodies[i]);
    }
    status_open(s);
    MU_TRY(observe_open(s));
    *out = s;
    return topics_open(s);
}

const char *session_waits_for(const struct session *s)
{
    return s->waits_for;
}

const char *session_hash(const struct session *s)
{
    return s->hash_text;
}

mu_result session_gather(struct session *s)
{
    uint64_t began_ns = mu_clock_ns();
    observe_scene(s);
    while (!phase_has_begun(s)) {
        inbox_take(s);
        if (phase_ends(s)) {
            return MU_DONE;
        }
        if (bus_writer_matches(&s->roster) == 0 &&
            mu_clock_ns() - began_ns > mu_network_wait_ns(s->options.network)) {
            return MU_TIMEOUT;
        }
        muster_RunState before = phase_word(s);
        (void)phase_on(s, roster_is_complete(s) ? PHASE_COMPLETE : PHASE_INCOMPLETE);
        (void)status_tell(s, phase_word(s) != before);
        if (s->phase == PHASE_READY && !s->options.waits_for_go) {
            (void)phase_on(s, PHASE_GO);
        }
        bus_wait(s->bus, 1, IMPATIENT_NS);
    }
    roster_prune(s);
    for (uint32_t i = 0; i < s->process_count; i++) {
        (void)member_on(&s->processes[i], MEMBER_JOINS);
    }
    roster_lay_out(s);
    s->step = 0;
    s->first_step_wall_ns = s->last_step_wall_ns = s->pace_wall_ns = mu_clock_ns();
    mu_log(MU_LOG_INFO, "run-begins", "robots=%zu processes=%u lockstep=%d", s->robot_count,
           s->process_count, !s->options.free);
    mu_result told = roster_tell(s, !s->options.free);
    return told < 0 ? told : MU_OK;
}

/* Repeats until it is sent: how the run ended, and that its steps are over. */
static void last_words(struct session *s)
{
    bool told = false;
    bool released = false;
    for (int i = 0; i < 1000 && !(told && released); i++) {
        told = told || status_tell(s, true);
        released = released || roster_tell(s, false) == MU_OK;
        bus_wait(s->bus, 1, told && released ? 0 : RETRY_NS);
    }
    (void)bus_drain(&s->roster, 200000000);
}

/* Observers get half a second to receive the last status.  `muster run` must receive it, and may be
 * slow on a busy machine, so it gets longer. */
static void status_drain(struct session *s)
{
    bool heard = bus_drain(&s->status.writer, STATUS_DRAIN_NS);
    uint64_t until_ns = mu_clock_ns() + STARTER_PATIENCE_NS;
    while (!heard && s->options.waits_for_go && !*s->options.signal_came &&
           mu_clock_ns() < until_ns) {
        heard = bus_drain(&s->status.writer, STATUS_ROUND_NS);
    }
}

static void refusals_say(const struct session *s)
{
    uint32_t of_members = 0;
    for (uint32_t i = 0; i < s->process_count; i++) {
        of_members += s->processes[i].refused;
    }
    if (s->refused + of_members > 0) {
        mu_log(MU_LOG_INFO, "events-refused", "phase=%u members=%u", s->refused, of_members);
    }
}

mu_result session_run(struct session *s)
{
    mu_result ran = s->options.free ? lockstep_run_free(s) : lockstep_run(s);
    bool interrupted = *s->options.signal_came != 0;
    (void)phase_on(s, ran == MU_OK ? PHASE_END : PHASE_FAILS);
    percepts_read(s);
    if (ran == MU_OK) {
        s->waits_for[0] = '\0';
        step_record(s);
        observe_begin(s, true);
        step_fold_outside(s);
        observe_finish(s);
    }
    percepts_send(s, true);
    run_hash_end(s->hash, s->hash_text);
    if (ran == MU_OK) {
        (void)phase_on(s, PHASE_FINISHES);
    }
    last_words(s);
    for (uint32_t i = 0; i < s->process_count; i++) {
        (void)bus_drain(&s->processes[i].sense, 200000000);
    }
    (void)bus_drain(&s->answers, 200000000);
    observe_close(s);
    refusals_say(s);
    status_drain(s);
    return ran == MU_OK && interrupted ? MU_DONE : ran;
}
