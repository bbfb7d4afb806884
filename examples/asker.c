/* SPDX-License-Identifier: Apache-2.0 */
/*
 * An intrusive monitor: asks every robot of a run for its status and its goal by mail, every ten
 * seconds of simulated time, and prints what they answer: asker [DOMAIN]
 *
 * Its mails are mails: they are in the run's hash.
 */
#include <muster/muster.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t PERIOD_NS = 10000000000;

static struct {
    mu_agent *agent;
    mu_watch *watch;
    uint64_t due_ns;
    unsigned long asked, answered;
} self;

static void ask(const char *robot, const char *question)
{
    struct mu_mail mail = {
        .dst = robot, .performative = "ask-one", .reply_with = question, .content = question};
    self.asked += mu_agent_send(self.agent, &mail, NULL) == MU_OK;
}

static void on_step(void *unused, const struct mu_frame *frame)
{
    (void)unused;
    if (frame->time_ns < self.due_ns) {
        return;
    }
    self.due_ns = frame->time_ns + PERIOD_NS;
    for (size_t i = 0; i < frame->robot_count; i++) {
        if (frame->robots[i].state != MU_GONE) {
            ask(frame->robots[i].name, "status");
            ask(frame->robots[i].name, "goal");
        }
    }
}

static void on_mail(void *unused, mu_agent *a, const struct mu_mail *mail)
{
    (void)unused;
    (void)a;
    self.answered += mail->in_reply_to[0] != '\0';
    printf("%s: %s\n", mail->src, mail->content);
}

static void on_end(void *unused, const struct mu_run_result *result)
{
    (void)unused;
    printf("asked %lu, answered %lu, hash %s\n", self.asked, self.answered, result->hash);
    mu_watch_stop(self.watch);
}

int main(int argc, char **argv)
{
    const char *domain = argc > 1 ? argv[1] : getenv("MUSTER_DOMAIN");
    /* The run waits for it, so that what it asks belongs to a step. */
    struct mu_process_options options = {.domain = domain ? (int)strtol(domain, NULL, 10) : 0,
                                         .watches = true};
    struct mu_handlers handlers = {.on_mail = on_mail};
    struct mu_watch_options watch = {.handlers = {.on_step = on_step, .on_end = on_end}};
    mu_process *process;
    if (mu_process_open(&process, &options) != MU_OK ||
        mu_agent_join(process, &self.agent, "asker", MU_KIND_SPECIAL, 0, &handlers) != MU_OK ||
        mu_watch_open(&self.watch, process, &watch) != MU_OK) {
        return EXIT_FAILURE;
    }
    mu_agent_decline_broadcasts(self.agent);
    mu_result ran = mu_watch_run(self.watch);
    mu_watch_close(self.watch);
    mu_process_close(process);
    return ran == MU_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
