/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Sends numbered mails, one after the other at intervals, and stays.
 *   mail_caller DOMAIN NAME RECEIVERS COUNT EVERY_MS [BROKER]
 * Says "sent N" when the last one has gone out.
 */
#include <muster/muster.h>

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static uint64_t now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000u + (uint64_t)now.tv_nsec / 1000000u;
}

/* Sends what is due.  @return how many have been sent; a full outbox takes them later */
static uint64_t call(mu_agent *a, const char *to, uint64_t sent, uint64_t due)
{
    char content[64];
    struct mu_mail mail = {
        .dst = to, .layer = MU_LAYER_SPEECH, .level = MU_LEVEL_RAM, .content = content};
    while (sent < due) {
        snprintf(content, sizeof content, "count %llu", (unsigned long long)sent + 1);
        if (mu_agent_send(a, &mail, NULL) != MU_OK) {
            break;
        }
        sent++;
    }
    return sent;
}

int main(int argc, char **argv)
{
    if (argc < 6) {
        return 2;
    }
    static const struct mu_handlers none;
    uint64_t count = strtoull(argv[4], NULL, 10), every_ms = strtoull(argv[5], NULL, 10);
    struct mu_process_options options = {.domain = (int)strtol(argv[1], NULL, 10),
                                         .broker = argc > 6 ? argv[6] : NULL};
    mu_process *p;
    mu_agent *a;
    if (every_ms == 0 || mu_process_open(&p, &options) != MU_OK ||
        mu_agent_join(p, &a, argv[2], MU_KIND_AGENT, 0, &none) != MU_OK ||
        mu_process_await_broker(p, 5000000000u) != MU_OK) {
        return 4;
    }
    uint64_t sent = 0, began_ms = now_ms();
    while (mu_process_spin(p, 1000000) == MU_OK) {
        uint64_t due = 1 + (now_ms() - began_ms) / every_ms;
        uint64_t had = sent;
        sent = call(a, argv[3], sent, due < count ? due : count);
        if (had < count && sent == count) {
            printf("sent %llu\n", (unsigned long long)sent);
            fflush(stdout);
        }
    }
    return 1;
}
