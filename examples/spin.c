/* SPDX-License-Identifier: Apache-2.0 */
/* The smallest controller: a robot that turns on the spot and says hello: spin [NAME [DOMAIN]] */
#include <muster/muster.h>
#include <stdio.h>
#include <stdlib.h>

static void on_state(void *self, mu_agent *a, enum mu_state state)
{
    (void)self;
    if (state == MU_RUNNING && mu_agent_broadcast(a, "hello from-c") != MU_OK) {
        fputs("no room for a mail\n", stderr);
    }
}

static void on_act(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)self;
    double turn_rad_s = percept->stalled ? -0.5 : 0.5;
    if (mu_agent_drive(a, 0.0, turn_rad_s) != MU_OK) {
        fputs("not a speed\n", stderr);
    }
}

int main(int argc, char **argv)
{
    const char *name = argc > 1 ? argv[1] : "red";
    const char *domain = argc > 2 ? argv[2] : getenv("MUSTER_DOMAIN");
    struct mu_process_options options = {.domain = domain ? (int)strtol(domain, NULL, 10) : 0,
                                         .with_body = true};
    struct mu_handlers handlers = {.on_state = on_state, .on_act = on_act};
    mu_process *process;
    mu_agent *robot;
    if (mu_process_open(&process, &options) != MU_OK ||
        mu_agent_join(process, &robot, name, MU_KIND_ROBOT, 0, &handlers) != MU_OK) {
        return EXIT_FAILURE;
    }
    mu_result ran = mu_process_run(process);
    mu_process_close(process);
    return ran == MU_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
