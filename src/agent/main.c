/* SPDX-License-Identifier: Apache-2.0 */
/* muster-robot: controllers of robots, each with a CLIPS mind between its senses and its motors;
 * and, as muster-agent, agents without a body. */
#include "agent/robot.h"
#include "core/exits.h"
#include "core/log.h"
#include "core/paths.h"
#include "runtime/join.h"
#include "runtime/process.h"
#include "runtime/transfers.h"

#include <limits.h>
#include <stdio.h>

static struct group_process *group_make(const struct robot_options *set)
{
    struct group_process *g = mu_startup_alloc(sizeof *g);
    agent_reserve(g, set, options_robots(set), "");
    for (uint32_t i = 0; i < g->count; i++) {
        options_robot(set, i, g->robots[i].name);
    }
    return g;
}

static mu_result robots_think(struct group_process *g)
{
    char folder[PATH_MAX];
    MU_TRY(mu_path_rules_need(folder, sizeof folder, g->set->program));
    g->rules_folder = mu_startup_string(folder);
    MU_TRY(robot_mind_open_map(g));
    for (uint32_t i = 0; i < g->count; i++) {
        MU_TRY(robot_mind_make(&g->robots[i]));
    }
    return MU_OK;
}

static mu_result robots_join(struct group_process *g)
{
    const struct robot_options *set = g->set;
    struct mu_process_options options = join_options(&set->network, set->name);
    options.agents = g->count + 1; /* an envoy */
    options.with_body = true;
    MU_TRY(mu_process_open(&g->process, &options));
    for (uint32_t i = 0; i < g->count; i++) {
        if (g->robots[i].state != ROBOT_VACANT) {
            MU_TRY(agent_join(&g->robots[i]));
        }
    }
    return join_await(g->process, &set->network, set->program, options.domain);
}

static bool group_is_empty(const struct group_process *g)
{
    bool empty = true;
    for (uint32_t i = 0; i < g->count; i++) {
        empty = empty && g->robots[i].state == ROBOT_VACANT;
    }
    return empty;
}

static void on_word(void *self, const muster_Trip *word)
{
    migration_hear(self, word);
}

static void on_step_end(void *self)
{
    migration_step_end(self);
}

static void on_answered(void *self)
{
    migration_step_answered(self);
    checkpoint_forget(self);
}

static void group_round(void *self)
{
    migration_round(self);
    checkpoint_round(self);
    checkpoint_forget(self);
    group_process_look(self);
}

static int functions_print(void)
{
    static char bytes[32 << 10];
    struct mu_text text = mu_text_in(bytes, sizeof bytes);
    mind_functions(&text);
    fputs(text.at, stdout);
    return MU_EXIT_DONE;
}

int main(int argc, char **argv)
{
    const struct robot_options *set;
    mu_result parsed = options_read(&set, argc, argv);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    if (set->functions) {
        return functions_print();
    }
    mu_log_open(set->name, set->verbose ? MU_LOG_INFO : MU_LOG_WARNING);
    struct group_process *g = group_make(set);
    mu_result ready = robots_think(g);
    if (ready == MU_OK && group_is_empty(g)) {
        return MU_EXIT_DONE; /* all have ended before */
    }
    ready = ready == MU_OK ? robots_join(g) : ready;
    if (ready != MU_OK) {
        return mu_exit_for(ready);
    }
    struct transfers listener = {
        .self = g, .on_word = on_word, .on_step_end = on_step_end, .on_answered = on_answered};
    transfers_listen(g->process, &listener);
    mu_process_each_round(g->process, group_round, g);
    process_before_up(g->process, step_before_up, g);
    robot_mind_watch();
    mu_memory_seal();
    mu_result ran = ticks_run(g);
    mu_process_close(g->process);
    for (uint32_t i = 0; i < g->count; i++) {
        ports_print_rest(&g->robots[i]);
    }
    return g->refused ? MU_EXIT_REFUSED : mu_exit_for(ran);
}
