/* SPDX-License-Identifier: Apache-2.0 */
/*
 * How long bystanders wait while others misbehave, through a broker that runs already.
 *   runtime_flood echo DOMAIN NAME          answers every mail
 *   runtime_flood ask DOMAIN NAME PEER COUNT
 *                       prints the median and the 99th percentile of the round trip, microseconds
 *   runtime_flood flood DOMAIN NAME RECEIVER RATE
 *                       sends that many mails a second, 0: as fast as it can, until it is ended
 */
#include "core/clock.h"
#include "muster/muster.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT_MAX = 100000 };

static const uint64_t PATIENCE_NS = 20000000000;
/* Between two questions: bystanders have something else to do, too. */
static const int64_t PAUSE_NS = 1000000;

struct party {
    mu_process *process;
    mu_agent *agent;
    uint64_t answers;
    bool echoes;
};

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    struct party *party = self;
    party->answers++;
    struct mu_mail answer = {.dst = mail->src, .content = "pong"};
    if (party->echoes && mu_agent_send(a, &answer, NULL) != MU_OK) {
        exit(1);
    }
}

static int compare(const void *a, const void *b)
{
    const uint64_t *x = a;
    const uint64_t *y = b;
    return (*x > *y) - (*x < *y);
}

static void spin(struct party *party, int64_t timeout_ns)
{
    if (mu_process_spin(party->process, timeout_ns) != MU_OK) {
        exit(1);
    }
}

static void ask(struct party *party, const char *peer, uint64_t count)
{
    static uint64_t took_ns[COUNT_MAX];
    struct mu_mail mail = {.dst = peer, .content = "ping red 1234.5678 -2345.6789"};
    for (uint64_t i = 0; i < count; i++) {
        uint64_t began_ns = mu_clock_ns();
        if (mu_agent_send(party->agent, &mail, NULL) != MU_OK) {
            exit(1);
        }
        while (party->answers <= i) {
            spin(party, 10000000);
            if (mu_clock_ns() - began_ns > PATIENCE_NS) {
                fprintf(stderr, "bench: no answer to question %llu\n", (unsigned long long)i);
                exit(1);
            }
        }
        took_ns[i] = mu_clock_ns() - began_ns;
        spin(party, PAUSE_NS);
    }
    qsort(took_ns, (size_t)count, sizeof took_ns[0], compare);
    printf("%.3f %.3f\n", (double)took_ns[count / 2] * 1e-3,
           (double)took_ns[count * 99 / 100] * 1e-3);
}

static void flood(struct party *party, const char *receiver, uint64_t rate)
{
    struct mu_mail mail = {.dst = receiver, .content = "mate-pos red 1234.5678 -2345.6789"};
    uint64_t began_ns = mu_clock_ns();
    for (uint64_t sent = 0;;) {
        double passed_s = (double)(mu_clock_ns() - began_ns) * 1e-9;
        uint64_t allowed = rate ? (uint64_t)((double)rate * passed_s) : UINT64_MAX;
        while (sent < allowed && mu_agent_send(party->agent, &mail, NULL) == MU_OK) {
            sent++;
        }
        spin(party, PAUSE_NS);
    }
}

int main(int argc, char **argv)
{
    static struct party party;
    const char *verb = argc > 3 ? argv[1] : "";
    uint64_t number = argc > 5 ? strtoull(argv[5], NULL, 10) : 0;
    bool asks = strcmp(verb, "ask") == 0 && number >= 1 && number <= COUNT_MAX;
    bool floods = strcmp(verb, "flood") == 0 && argc == 6;
    party.echoes = strcmp(verb, "echo") == 0 && argc == 4;
    if (!party.echoes && !asks && !floods) {
        return 2;
    }
    struct mu_process_options options = {.domain = (int)strtol(argv[2], NULL, 10)};
    struct mu_handlers handlers = {.self = &party, .on_mail = on_mail};
    if (mu_process_open(&party.process, &options) != MU_OK ||
        mu_agent_join(party.process, &party.agent, argv[3], MU_KIND_AGENT, 0, &handlers) != MU_OK ||
        mu_process_await_broker(party.process, PATIENCE_NS) != MU_OK) {
        return 4;
    }
    if (party.echoes) {
        return mu_process_run(party.process) == MU_OK ? 0 : 1;
    }
    if (floods) {
        flood(&party, argv[4], number);
    }
    ask(&party, argv[4], number);
    mu_process_close(party.process);
    return 0;
}
