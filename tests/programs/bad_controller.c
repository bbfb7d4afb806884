/* SPDX-License-Identifier: Apache-2.0 */
/* A controller that drives straight on and, at a step, does what one should not:
 *
 *   bad_controller DEED STEP [FILE]     segfault, hang, end, babble, flood, mute, fork
 *   bad_controller DEED                 silent, alias, early, none
 *
 * fork writes the process id of its child into FILE.  With MUSTER_STATE it keeps the number of its
 * step there, and misbehaves in its first life alone.
 */
#include <muster/muster.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *deed = "none", *file, *state;
static long at_step;
static bool first_life = true;

static void babble(void)
{
    static char line[4096];
    memset(line, 'x', sizeof line - 1);
    for (int i = 0; i < 2000; i++) {
        puts(line);
    }
    fflush(stdout);
}

static void fork_and_go_on(void)
{
    pid_t child = fork();
    if (child == 0) {
        for (;;) {
            pause();
        }
    }
    FILE *out = fopen(file, "w");
    if (out) {
        fprintf(out, "%ld\n", (long)child);
        fclose(out);
    }
}

static void misbehave(mu_agent *a)
{
    if (strcmp(deed, "segfault") == 0) {
        puts("about to fall");
        fflush(stdout);
        raise(SIGSEGV);
    } else if (strcmp(deed, "hang") == 0) {
        for (;;) {
            pause();
        }
    } else if (strcmp(deed, "end") == 0) {
        exit(4);
    } else if (strcmp(deed, "babble") == 0) {
        babble();
    } else if (strcmp(deed, "mute") == 0) {
        fclose(stdout);
        fclose(stderr);
        close(STDOUT_FILENO);
        close(STDERR_FILENO);
    } else if (strcmp(deed, "fork") == 0) {
        fork_and_go_on();
    }
    for (int i = 0; strcmp(deed, "flood") == 0 && i < 10000; i++) {
        if (mu_agent_broadcast(a, "flood") != MU_OK) {
            return;
        }
    }
}

static void step_keep(int64_t step)
{
    FILE *out = state ? fopen(state, "w") : NULL;
    if (out) {
        fprintf(out, "%lld\n", (long long)step);
        fclose(out);
    }
}

static void on_act(void *self, mu_agent *a, const struct mu_percept *percept)
{
    (void)self;
    step_keep(percept->step);
    if (first_life && percept->step == at_step) {
        misbehave(a);
    }
    if (mu_agent_drive(a, 0.1, 0.0) != MU_OK) {
        exit(5);
    }
}

int main(int argc, char **argv)
{
    deed = argc > 1 ? argv[1] : deed;
    at_step = argc > 2 ? strtol(argv[2], NULL, 10) : -1;
    file = argc > 3 ? argv[3] : NULL;
    state = getenv("MUSTER_STATE");
    first_life = !state || access(state, F_OK) != 0;
    if (strcmp(deed, "early") == 0) {
        fputs("no licence to drive\n", stderr);
        return 9;
    }
    struct mu_process_options options = {.with_body = true};
    struct mu_handlers handlers = {.on_act = on_act};
    mu_process *process;
    mu_agent *robot;
    const char *name = strcmp(deed, "alias") == 0 ? "somebody" : NULL;
    if (strcmp(deed, "silent") == 0 || mu_process_open(&process, &options) != MU_OK ||
        mu_agent_join(process, &robot, name, MU_KIND_ROBOT, 0, &handlers) != MU_OK) {
        for (;;) {
            pause();
        }
    }
    mu_result ran = mu_process_run(process);
    mu_process_close(process);
    return ran == MU_OK || ran == MU_DONE ? EXIT_SUCCESS : EXIT_FAILURE;
}
