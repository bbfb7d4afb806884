/* SPDX-License-Identifier: Apache-2.0 */
/* muster-host: a platform for agents that are launched, move and are cloned. */
#include "core/clock.h"
#include "core/exits.h"
#include "core/log.h"
#include "core/paths.h"
#include "core/text.h"
#include "host/host.h"
#include "runtime/join.h"
#include "runtime/process.h"
#include "runtime/transfers.h"

static mu_result host_connect(struct host *h)
{
    const struct mu_network *network = &h->set->robots->network;
    struct mu_process_options options = join_options(network, h->group.host);
    options.agents = h->group.count + 1; /* itself */
    options.with_body = true;
    MU_TRY(mu_process_open(&h->group.process, &options));
    MU_TRY(host_join(h));
    MU_TRY(natives_begin(h));
    return join_await(h->group.process, network, "muster host", options.domain);
}

/* Asks again and again for agents without a process: their process may die at any time. */
static void orphans_ask(struct host *h)
{
    static const uint64_t ASK_NS = 1000000000;
    char name[MU_NAME_MAX + 1];
    muster_Trip wanted = {.word = muster_TRIP_WANTED, .host = name};
    uint64_t now_ns = mu_clock_ns();
    (void)mu_text_copy(name, sizeof name, h->group.host);
    if (h->set->robots->checkpoints.restore && now_ns - h->asked_ns > ASK_NS &&
        transfers_say(h->group.process, &wanted) == MU_OK) {
        h->asked_ns = now_ns;
    }
}

static void step_end(void *self)
{
    struct host *h = self;
    migration_step_end(&h->group);
}

static void step_answered(void *self)
{
    struct host *h = self;
    migration_step_answered(&h->group);
    checkpoint_forget(&h->group);
}

static void host_round(void *self)
{
    struct host *h = self;
    migration_round(&h->group);
    checkpoint_round(&h->group);
    checkpoint_forget(&h->group);
    orphans_ask(h);
}

int main(int argc, char **argv)
{
    const struct host_options *set;
    mu_result parsed = host_options_read(&set, argc, argv);
    if (parsed != MU_OK) {
        return mu_exit_for(parsed);
    }
    mu_log_open(set->robots->name, set->robots->verbose ? MU_LOG_INFO : MU_LOG_WARNING);
    struct host *h = host_make(set);
    h->group.rules_folder = h->folder;
    mu_result ready = mu_path_rules_need(h->folder, sizeof h->folder, "muster host");
    ready = ready == MU_OK ? robot_mind_open_map(&h->group) : ready;
    ready = ready == MU_OK ? host_connect(h) : ready;
    if (ready != MU_OK) {
        return mu_exit_for(ready);
    }
    struct transfers listener = {.prompt = true,
                                 .self = h,
                                 .on_word = host_hear,
                                 .on_step_end = step_end,
                                 .on_answered = step_answered};
    transfers_listen(h->group.process, &listener);
    if (set->robots->checkpoints.restore && set->robots->checkpoints.folder) {
        mu_log(MU_LOG_INFO, "restored", "agents=%u", host_restore(h));
    }
    mu_process_each_round(h->group.process, host_round, h);
    process_before_up(h->group.process, step_before_up, &h->group);
    robot_mind_watch();
    mu_memory_seal();
    mu_result ran = ticks_run(&h->group);
    mu_process_close(h->group.process);
    for (uint32_t i = 0; i < h->group.count; i++) {
        ports_print_rest(&h->group.robots[i]);
    }
    return h->group.refused ? MU_EXIT_REFUSED : mu_exit_for(ran);
}
