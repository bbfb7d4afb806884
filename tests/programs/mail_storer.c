/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Sends numbered durable mails, at most 200 without an answer, until each is stored or delivered.
 *   mail_storer DOMAIN NAME RECEIVER COUNT ram|logged|synced RECORD [mixed]
 * With `mixed` every third has a high priority, the next a low one.
 * Writes a line for each receipt, "FIRST LAST OUTCOME", with one write.
 */
#include "record.h"

#include <muster/muster.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { IN_FLIGHT = 200, COUNT_MAX = 1000000 };

static bool answered[COUNT_MAX];
static uint64_t answers;
static uint64_t first_seq; /* of ours: an earlier agent of the name may have sent some */
static bool registered;
static int record;

static void on_receipt(void *self, mu_agent *a, uint64_t first, uint64_t last,
                       enum mu_outcome outcome)
{
    (void)self;
    (void)a;
    record_line(record, "%llu %llu %s", (unsigned long long)first, (unsigned long long)last,
                mu_outcome_text(outcome));
    for (uint64_t i = first - first_seq; i <= last - first_seq && i < COUNT_MAX; i++) {
        answers += !answered[i];
        answered[i] = true;
    }
}

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    (void)self;
    (void)a;
    (void)reason;
    registered = registered || accepted;
}

static enum mu_level level_of(const char *word)
{
    if (strcmp(word, "ram") == 0) {
        return MU_LEVEL_RAM;
    }
    return strcmp(word, "synced") == 0 ? MU_LEVEL_SYNCED : MU_LEVEL_LOGGED;
}

int main(int argc, char **argv)
{
    if (argc < 7) {
        return 2;
    }
    uint64_t count = strtoull(argv[4], NULL, 10);
    record = record_open(argv[6]);
    mu_process *p;
    mu_agent *a;
    struct mu_process_options options = {.domain = (int)strtol(argv[1], NULL, 10)};
    struct mu_handlers handlers = {.on_receipt = on_receipt, .on_registered = on_registered};
    if (record < 0 || count > COUNT_MAX || mu_process_open(&p, &options) != MU_OK ||
        mu_agent_join(p, &a, argv[2], MU_KIND_AGENT, 0, &handlers) != MU_OK ||
        mu_process_await_broker(p, 5000000000u) != MU_OK) {
        return 4;
    }
    static const enum mu_priority priorities[] = {MU_PRIORITY_HIGH, MU_PRIORITY_LOW,
                                                  MU_PRIORITY_NORMAL};
    mu_result ran = MU_OK;
    for (uint64_t sent = 0; answers < count && ran == MU_OK;) {
        char content[64];
        struct mu_mail mail = {.dst = argv[3], .level = level_of(argv[5]), .content = content};
        while (registered && sent < count && sent - answers < IN_FLIGHT) {
            if (argc > 7) {
                mail.priority = priorities[(sent + 1) % 3];
            }
            snprintf(content, sizeof content, "count %llu", (unsigned long long)sent + 1);
            if (mu_agent_send(a, &mail, sent == 0 ? &first_seq : NULL) != MU_OK) {
                break;
            }
            sent++;
        }
        ran = mu_process_spin(p, 10000000);
    }
    mu_process_close(p);
    return ran == MU_OK ? 0 : 1;
}
