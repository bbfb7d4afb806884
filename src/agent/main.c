/* SPDX-License-Identifier: Apache-2.0 */
/* muster-robot: controllers of robots, each with a CLIPS mind between its senses and its motors. */
#include "agent/robot.h"
#include "core/exits.h"
#include "core/log.h"
#include "core/paths.h"
#include "runtime/join.h"
#include "runtime/process.h"
#include "runtime/trips.h"

#include <limits.h>
#include <stdio.h>

static struct crew *crew_make(const struct settings *set)
{
    struct crew *c = mu_startup_alloc(sizeof *c);
    robot_reserve_crew(c, set, settings_robots(set), "");
    for (uint32_t i = 0; i < c->count; i++) {
        settings_robot(set, i, c->robots[i].name);
    }
    return c;
}

static mu_result robots_think(struct crew *c)
{
    char folder[PATH_MAX];
    if (!mu_path_rules(folder, sizeof folder)) {
        fprintf(stderr, "muster robot: the shared rules are not found; set MUSTER_RULES to the "
                        "folder that has muster.clp\n");
        return MU_FAULT_FILE;
    }
    c->rules_folder = mu_startup_string(folder);
    MU_TRY(robot_map_open(c));
    for (uint32_t i = 0; i < c->count; i++) {
        MU_TRY(robot_think(&c->robots[i]));
    }
    return MU_OK;
}

static mu_result robots_join(struct crew *c)
{
    const struct settings *set = c->set;
    struct mu_process_options options = {.domain = (int)set->network.domain,
                                         .interface = set->network.interface,
                                         .peer = mu_network_peers(&set->network),
                                         .name = set->name,
                                         .broker = set->network.broker,
                                         .agents = c->count + 1, /* an envoy */
                                         .with_body = true};
    MU_TRY(mu_process_open(&c->process, &options));
    for (uint32_t i = 0; i < c->count; i++) {
        if (!c->robots[i].out) {
            MU_TRY(robot_join(&c->robots[i]));
        }
    }
    return join_await(c->process, &set->network, "muster robot", options.domain);
}

static bool crew_is_empty(const struct crew *c)
{
    bool empty = true;
    for (uint32_t i = 0; i < c->count; i++) {
        empty = empty && c->robots[i].out;
    }
    return empty;
}

static void crew_save(void *self)
{
    checkpoint_round(self);
}

static void on_trip(void *self, const muster_Trip *word)
{
    trip_hear(self, word);
}

static void on_step_end(void *self)
{
    trip_step_end(self);
}

static void on_answered(void *self)
{
    trip_step_answered(self);
    checkpoint_forget(self);
}

static void crew_round(void *self)
{
    trip_round(self);
    checkpoint_round(self);
    checkpoint_forget(self);
    robot_crew_look(self);
}

int main(int argc, char **argv)
{
    const struct settings *set;
    mu_result parsed = settings_parse(&set, argc, argv);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    if (set->functions) {
        mind_print_functions();
        return MU_EXIT_DONE;
    }
    mu_log_open(set->name, set->verbose ? MU_LOG_INFO : MU_LOG_WARNING);
    struct crew *c = crew_make(set);
    mu_result ready = robots_think(c);
    if (ready == MU_OK && crew_is_empty(c)) {
        return MU_EXIT_DONE; /* all have ended before */
    }
    ready = ready == MU_OK ? robots_join(c) : ready;
    if (ready != MU_OK) {
        return mu_exit_for(ready);
    }
    struct trips listener = {
        .self = c, .on_trip = on_trip, .on_step_end = on_step_end, .on_answered = on_answered};
    trips_listen(c->process, &listener);
    mu_process_each_round(c->process, crew_round, c);
    process_before_up(c->process, crew_save, c);
    mind_watchdog();
    mu_memory_seal();
    mu_result ran = mu_process_run(c->process);
    mu_process_close(c->process);
    for (uint32_t i = 0; i < c->count; i++) {
        robot_print_rest(&c->robots[i]);
    }
    return c->refused ? MU_EXIT_REFUSED : mu_exit_for(ran);
}
