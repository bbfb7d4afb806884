/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Groups and services: an adder offers `sum`, and a client that hears of it asks it: services
 * [DOMAIN]
 *
 * The client watches the yellow pages, so it does not matter which of the two comes first.  Both
 * are in the group `arithmetic`, where the client tells the result.
 */
#include <muster/muster.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t LEASE_NS = 0; /* until it is withdrawn, or the agent leaves */

static void adder_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    (void)self;
    if (!accepted || mu_agent_group_join(a, "arithmetic") != MU_OK ||
        mu_agent_advertise(a, "sum", "digits=9", LEASE_NS) != MU_OK) {
        fprintf(stderr, "no adder: %s\n", reason);
    }
}

/* What the group is told is no question. */
static void adder_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    if (strcmp(mail->performative, "ask-one") != 0) {
        return;
    }
    char *rest = NULL;
    char content[64];
    long left = strtol(mail->content, &rest, 10);
    snprintf(content, sizeof content, "sum %ld", left + strtol(rest, NULL, 10));
    if (mu_agent_reply(a, mail, "tell", content) == MU_FULL) {
        fputs("the sum is lost\n", stderr);
    }
}

static void client_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    (void)self;
    if (!accepted || mu_agent_group_join(a, "arithmetic") != MU_OK ||
        mu_agent_watch_service(a, "sum digits>=3") != MU_OK) {
        fprintf(stderr, "no client: %s\n", reason);
    }
}

static void client_service(void *self, mu_agent *a, const struct mu_service *service, bool came)
{
    (void)self;
    struct mu_mail question = {
        .dst = service->agent, .performative = "ask-one", .reply_with = "sum", .content = "2 40"};
    if (came && mu_agent_send(a, &question, NULL) != MU_OK) {
        fputs("no room for a question\n", stderr);
    }
}

static void client_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    if (mu_agent_group_send(a, "arithmetic", mail->content) == MU_OK) {
        printf("%s says: %s\n", mail->src, mail->content);
        fflush(stdout);
    }
}

int main(int argc, char **argv)
{
    const char *domain = argc > 1 ? argv[1] : getenv("MUSTER_DOMAIN");
    struct mu_process_options options = {.domain = domain ? (int)strtol(domain, NULL, 10) : 0};
    struct mu_handlers adder = {.on_registered = adder_registered, .on_mail = adder_mail};
    struct mu_handlers client = {
        .on_registered = client_registered, .on_mail = client_mail, .on_service = client_service};
    mu_process *process = NULL;
    mu_agent *a;
    int failed = mu_process_open(&process, &options) != MU_OK ||
                 mu_agent_join(process, &a, "client", MU_KIND_AGENT, 0, &client) != MU_OK ||
                 mu_agent_join(process, &a, "adder", MU_KIND_AGENT, 0, &adder) != MU_OK ||
                 mu_process_run(process) != MU_OK;
    mu_process_close(process);
    return failed;
}
