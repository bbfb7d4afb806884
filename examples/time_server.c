/* SPDX-License-Identifier: Apache-2.0 */
/* Answers every mail with the time of the wall clock: time_server [DOMAIN] */
#include <muster/muster.h>
#include <stdlib.h>
#include <time.h>

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    *(mu_result *)self = mu_agent_reply(a, mail, "inform", ctime(&(time_t){time(NULL)}));
}

int main(int argc, char **argv)
{
    const char *domain = argc > 1 ? argv[1] : getenv("MUSTER_DOMAIN");
    struct mu_process_options options = {.domain = domain ? (int)strtol(domain, NULL, 10) : 0};
    struct mu_handlers handlers = {.self = &(mu_result){MU_OK}, .on_mail = on_mail};
    mu_process *process = NULL;
    mu_agent *clock;
    int failed = mu_process_open(&process, &options) != MU_OK ||
                 mu_agent_join(process, &clock, "clock", MU_KIND_AGENT, 0, &handlers) != MU_OK ||
                 mu_process_run(process) != MU_OK;
    mu_process_close(process);
    return failed;
}
