/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Sends numbered mails and waits until each has been delivered.
 *   mail_sender DOMAIN NAME RECEIVER COUNT [SECONDS [logged|ram [BROKER [INTERFACE PEERS]]]]
 * Prints "delivered N" and ends with 0 when that is all of them.
 */
#include <muster/muster.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static uint64_t count, base, delivered, other;

/* Of each mail from number base on, whether its outcome is known: a broker that was killed may have
 * said it before. */
static bool *told;

static void on_receipt(void *self, mu_agent *a, uint64_t first, uint64_t last,
                       enum mu_outcome outcome)
{
    (void)self;
    (void)a;
    if (outcome != MU_MAIL_DELIVERED && outcome != MU_MAIL_STORED) {
        fprintf(stderr, "mails %llu to %llu: %s\n", (unsigned long long)first,
                (unsigned long long)last, mu_outcome_text(outcome));
    }
    for (uint64_t i = first; i <= last && i - base < count && outcome != MU_MAIL_STORED; i++) {
        *(outcome == MU_MAIL_DELIVERED ? &delivered : &other) += !told[i - base];
        told[i - base] = true;
    }
}

int main(int argc, char **argv)
{
    if (argc < 5) {
        return 2;
    }
    count = strtoull(argv[4], NULL, 10);
    told = calloc(count, sizeof *told);
    time_t until = time(NULL) + (argc > 5 ? atol(argv[5]) : 60);
    mu_process *p;
    mu_agent *a;
    struct mu_process_options options = {.domain = (int)strtol(argv[1], NULL, 10),
                                         .broker = argc > 7 ? argv[7] : NULL,
                                         .interface = argc > 9 ? argv[8] : NULL,
                                         .peer = argc > 9 ? argv[9] : NULL};
    bool logged = argc > 6 && strcmp(argv[6], "logged") == 0;
    struct mu_handlers handlers = {.on_receipt = on_receipt};
    if (!told || mu_process_open(&p, &options) != MU_OK ||
        mu_agent_join(p, &a, argv[2], MU_KIND_AGENT, 0, &handlers) != MU_OK ||
        mu_process_await_broker(p, 5000000000u) != MU_OK) {
        return 4;
    }
    uint64_t sent = 0;
    while (delivered + other < count && time(NULL) < until) {
        char content[64];
        struct mu_mail mail = {.dst = argv[3],
                               .layer = MU_LAYER_SPEECH,
                               .level = logged ? MU_LEVEL_LOGGED : MU_LEVEL_RAM,
                               .content = content};
        for (mu_result r = MU_OK; sent < count && r == MU_OK; sent += r == MU_OK) {
            snprintf(content, sizeof content, "count %llu", (unsigned long long)sent + 1);
            r = mu_agent_send(a, &mail, sent == 0 ? &base : NULL);
        }
        if (mu_process_spin(p, 10000000) != MU_OK) {
            break;
        }
    }
    printf("delivered %llu\n", (unsigned long long)delivered);
    mu_process_close(p);
    return delivered == count ? 0 : 1;
}
