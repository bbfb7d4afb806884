/* SPDX-License-Identifier: Apache-2.0 */
/*
 * An agent that does in its handler what mail says, and answers: nothing ("greet"), to take that
 * many milliseconds ("work MS"), to have another agent join ("join NAME"), to let that leave
 * ("leave"), to end ("stop").  mail_handler DOMAIN NAME
 */
#include <muster/muster.h>

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static struct {
    mu_process *process;
    mu_agent *other;
    atomic_int inside;
    struct mu_handlers handlers;
} self;

static const char *obey(const char *order)
{
    if (strncmp(order, "work ", 5) == 0) {
        usleep((useconds_t)strtoul(order + 5, NULL, 10) * 1000);
    } else if (strncmp(order, "join ", 5) == 0) {
        mu_result joined =
            mu_agent_join(self.process, &self.other, order + 5, MU_KIND_AGENT, 0, &self.handlers);
        return joined == MU_OK ? "joined" : "refused";
    } else if (strcmp(order, "leave") == 0) {
        mu_agent_leave(self.other);
    } else if (strcmp(order, "stop") == 0) {
        mu_process_stop(self.process);
    }
    return "done";
}

static void on_mail(void *context, mu_agent *a, const struct mu_mail *mail)
{
    (void)context;
    bool alone = atomic_fetch_add(&self.inside, 1) == 0;
    const char *done = obey(mail->content);
    bool spins = mu_process_spin(self.process, 0) != MU_BUSY; /* nobody may, from a handler */
    atomic_fetch_sub(&self.inside, 1);
    if (mu_agent_reply(a, mail, "inform", alone && !spins ? done : "two at a time") != MU_OK) {
        fprintf(stderr, "no answer to %s\n", mail->src);
    }
}

int main(int argc, char **argv)
{
    mu_agent *a;
    struct mu_process_options options = {.domain = argc > 2 ? (int)strtol(argv[1], NULL, 10) : 0};
    self.handlers = (struct mu_handlers){.on_mail = on_mail};
    if (argc < 3 || mu_process_open(&self.process, &options) != MU_OK ||
        mu_agent_join(self.process, &a, argv[2], MU_KIND_AGENT, 0, &self.handlers) != MU_OK) {
        return 4;
    }
    mu_result ran = mu_process_run(self.process);
    mu_process_close(self.process);
    return ran == MU_OK ? 0 : 4;
}
