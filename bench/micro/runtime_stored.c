/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Mail that waits for an absent agent, through a broker that runs already.
 *   runtime_stored put DOMAIN ram|logged|synced COUNT   mails stored a second: 128 bytes
 * each, 200 without an answer; ends when all are runtime_stored drain DOMAIN COUNT   ms from
 * the first of COUNT mails to the last, for the agent that comes back; each checked, once, in order
 */
#include "core/clock.h"
#include "muster/muster.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { IN_FLIGHT = 200, CONTENT = 128 };

static const uint64_t PATIENCE_NS = 60000000000;

struct bench {
    mu_process *process;
    mu_agent *agent;
    uint64_t answers, failed;
    uint64_t taken, wrong, began_ns, ended_ns;
};

static void on_receipt(void *self, mu_agent *a, uint64_t first_seq, uint64_t last_seq,
                       enum mu_outcome outcome)
{
    (void)a;
    struct bench *b = self;
    b->answers += last_seq - first_seq + 1;
    b->failed += outcome != MU_MAIL_STORED ? last_seq - first_seq + 1 : 0;
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    struct bench *b = self;
    b->ended_ns = mu_clock_ns();
    b->began_ns = b->taken == 0 ? b->ended_ns : b->began_ns;
    b->wrong += strtoull(mail->content, NULL, 10) != ++b->taken;
}

static bool join(struct bench *b, const char *name, int domain)
{
    struct mu_process_options options = {.domain = domain};
    struct mu_handlers handlers = {.self = b, .on_mail = on_mail, .on_receipt = on_receipt};
    return mu_process_open(&b->process, &options) == MU_OK &&
           mu_agent_join(b->process, &b->agent, name, MU_KIND_AGENT, 0, &handlers) == MU_OK &&
           mu_process_await_broker(b->process, PATIENCE_NS) == MU_OK;
}

static bool put(struct bench *b, enum mu_level level, uint64_t count)
{
    char content[CONTENT + 1];
    struct mu_mail mail = {.dst = "stored", .level = level, .content = content};
    uint64_t began_ns = mu_clock_ns(), until_ns = began_ns + PATIENCE_NS;
    for (uint64_t sent = 0; b->answers < count && mu_clock_ns() < until_ns;) {
        for (; sent < count && sent - b->answers < IN_FLIGHT; sent++) {
            snprintf(content, sizeof content, "%-*llu", CONTENT, (unsigned long long)sent + 1);
            if (mu_agent_send(b->agent, &mail, NULL) != MU_OK) {
                return false;
            }
        }
        if (mu_process_spin(b->process, 10000000) != MU_OK) {
            return false;
        }
    }
    printf("%.0f\n", (double)count * 1e9 / (double)(mu_clock_ns() - began_ns));
    return b->answers == count && b->failed == 0;
}

static bool drain(struct bench *b, uint64_t count)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (b->taken < count && mu_clock_ns() < until_ns &&
           mu_process_spin(b->process, 10000000) == MU_OK) {
    }
    printf("%.1f\n", (double)(b->ended_ns - b->began_ns) * 1e-6);
    return b->taken == count && b->wrong == 0;
}

int main(int argc, char **argv)
{
    static const char *const levels[] = {"ram", "logged", "synced"};
    static struct bench b;
    bool puts = argc == 5 && strcmp(argv[1], "put") == 0;
    if (!puts && (argc != 4 || strcmp(argv[1], "drain") != 0)) {
        return 2;
    }
    uint64_t count = strtoull(argv[argc - 1], NULL, 10);
    enum mu_level level = MU_LEVEL_RAM;
    while (puts && level < MU_LEVEL_SYNCED && strcmp(levels[level], argv[3]) != 0) {
        level++;
    }
    if (!join(&b, puts ? "storer" : "stored", (int)strtol(argv[2], NULL, 10))) {
        return 4;
    }
    bool good = puts ? put(&b, level, count) : drain(&b, count);
    mu_process_close(b.process);
    if (!good) {
        fprintf(stderr, "bench: %llu answers, %llu failed, %llu taken, %llu out of place\n",
                (unsigned long long)b.answers, (unsigned long long)b.failed,
                (unsigned long long)b.taken, (unsigned long long)b.wrong);
    }
    return good ? 0 : 1;
}
