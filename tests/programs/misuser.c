/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Calls in a handler what must not be called there: misuser DOMAIN [close]
 * Sends itself mails that come together, spins in the handler of each, and prints "N mails, N times
 * busy"; with close, the first one closes the process.
 */
#include <muster/muster.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MAILS = 20 };

static mu_process *process;
static bool closes;
static unsigned taken, busy;

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    (void)a;
    (void)mail;
    taken++;
    if (closes) {
        mu_process_close(process);
    }
    busy += mu_process_spin(process, 10000000) == MU_BUSY && mu_process_run(process) == MU_BUSY;
}

int main(int argc, char **argv)
{
    struct mu_process_options options = {.domain = argc > 1 ? (int)strtol(argv[1], NULL, 10) : 0};
    struct mu_handlers handlers = {.on_mail = on_mail};
    mu_agent *a;
    closes = argc > 2 && strcmp(argv[2], "close") == 0;
    if (mu_process_open(&process, &options) != MU_OK ||
        mu_agent_join(process, &a, "misuser", MU_KIND_AGENT, 0, &handlers) != MU_OK ||
        mu_process_await_broker(process, 5000000000u) != MU_OK) {
        return 4;
    }
    mu_result going = MU_OK;
    for (int i = 0; i < MAILS && going == MU_OK; i++) {
        going = mu_agent_send(a, &(struct mu_mail){.dst = "misuser"}, NULL);
    }
    for (time_t until = time(NULL) + 20; going == MU_OK && taken < MAILS && time(NULL) < until;) {
        going = mu_process_spin(process, 10000000);
    }
    mu_process_close(process);
    printf("%u mails, %u times busy\n", taken, busy);
    return going == MU_OK ? 0 : 1;
}
