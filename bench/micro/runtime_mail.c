/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Mail by name, through a broker that runs already.
 *   runtime_mail echo DOMAIN           the agent `echo`: answers every mail that says ping
 *   runtime_mail ping DOMAIN COUNT     prints the median round trip in microseconds
 *   runtime_mail pace DOMAIN COUNT     a mail each millisecond from one agent to another;
 *                                            prints their mean delay in microseconds
 *   runtime_mail flood DOMAIN COUNT    prints mails a second, from first send to last receipt
 */
#include "core/clock.h"
#include "muster/muster.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { COUNT_MAX = 1000000 };

static const char flood_content[] = "mate-pos red 1234.5678 -2345.6789";
static const uint64_t PATIENCE_NS = 20000000000;

struct caller {
    mu_process *process;
    mu_agent *agent;
    char conversation[32]; /* of this process alone */
    uint64_t answers, delivered, failed;
};

/* An answer to an earlier life, which left before its acknowledgement was out, comes again. */
static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    struct caller *c = self;
    c->answers += strcmp(mail->conversation, c->conversation) == 0;
    struct mu_mail answer = {.dst = mail->src,
                             .layer = MU_LAYER_SPEECH,
                             .content = "pong",
                             .conversation = mail->conversation};
    if (strncmp(mail->content, "ping", 4) == 0 && mu_agent_send(a, &answer, NULL) != MU_OK) {
        c->failed++;
    }
}

static void on_receipt(void *self, mu_agent *a, uint64_t first_seq, uint64_t last_seq,
                       enum mu_outcome outcome)
{
    (void)a;
    struct caller *c = self;
    uint64_t count = last_seq - first_seq + 1;
    c->delivered += outcome == MU_MAIL_DELIVERED ? count : 0;
    c->failed += outcome != MU_MAIL_DELIVERED && outcome != MU_MAIL_STORED ? count : 0;
}

/* Spins until a count is reached; ends the program when that takes too long. */
static void await(struct caller *c, const uint64_t *count, uint64_t wanted)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (*count < wanted) {
        if (c->failed > 0 || mu_clock_ns() > until_ns ||
            mu_process_spin(c->process, 10000000) != MU_OK) {
            fprintf(stderr, "bench: %llu of %llu, %llu failed\n", (unsigned long long)*count,
                    (unsigned long long)wanted, (unsigned long long)c->failed);
            exit(1);
        }
    }
}

static mu_result say(struct caller *c, const char *content)
{
    struct mu_mail mail = {.dst = "echo",
                           .layer = MU_LAYER_SPEECH,
                           .content = content,
                           .conversation = c->conversation};
    return mu_agent_send(c->agent, &mail, NULL);
}

static int compare(const void *a, const void *b)
{
    const uint64_t *x = a;
    const uint64_t *y = b;
    return (*x > *y) - (*x < *y);
}

static void ping(struct caller *c, uint64_t count)
{
    static uint64_t took_ns[COUNT_MAX];
    for (uint64_t i = 0; i < count; i++) {
        uint64_t began_ns = mu_clock_ns();
        if (say(c, "ping red 1234.5678 -2345.6789") != MU_OK) {
            exit(1);
        }
        await(c, &c->answers, i + 1);
        took_ns[i] = mu_clock_ns() - began_ns;
    }
    qsort(took_ns, (size_t)count, sizeof took_ns[0], compare);
    printf("%.3f\n", (double)took_ns[count / 2] * 1e-3);
}

static void flood(struct caller *c, uint64_t count)
{
    uint64_t began_ns = mu_clock_ns();
    for (uint64_t sent = 0; sent < count;) {
        while (sent < count && say(c, flood_content) == MU_OK) {
            sent++;
        }
        await(c, &c->delivered, sent > MU_OUTBOX_MAX / 2 ? sent - MU_OUTBOX_MAX / 2 : 0);
        if (mu_process_spin(c->process, 0) != MU_OK) {
            exit(1);
        }
    }
    await(c, &c->delivered, count);
    printf("%.1f\n", (double)count * 1e9 / (double)(mu_clock_ns() - began_ns));
}

/* --- one way ---------------------------------------------------------------------------------- */

struct taker {
    uint64_t taken, late_ns;
};

static void taker_on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    struct taker *t = self;
    t->taken++;
    t->late_ns += mu_clock_ns() - strtoull(mail->content, NULL, 10);
}

static const uint64_t PACE_NS = 1000000;

static void pace(struct caller *c, uint64_t count)
{
    static struct taker taker;
    mu_agent *a;
    struct mu_handlers handlers = {.self = &taker, .on_mail = taker_on_mail};
    if (mu_agent_join(c->process, &a, "taker", MU_KIND_AGENT, 0, &handlers) != MU_OK) {
        exit(1);
    }
    while (!mu_process_lookup(c->process, "taker")) {
        if (mu_process_spin(c->process, 10000000) != MU_OK) {
            exit(1);
        }
    }
    struct mu_mail first = {.dst = "taker", .content = "0"}; /* until then paths are made */
    if (mu_agent_send(c->agent, &first, NULL) != MU_OK) {
        exit(1);
    }
    await(c, &taker.taken, 1);
    taker.late_ns = 0;
    uint64_t next_ns = mu_clock_ns();
    for (uint64_t sent = 0; sent < count;) {
        uint64_t now_ns = mu_clock_ns();
        if (now_ns >= next_ns) {
            char content[24];
            snprintf(content, sizeof content, "%llu", (unsigned long long)now_ns);
            struct mu_mail mail = {.dst = "taker", .content = content};
            sent += mu_agent_send(c->agent, &mail, NULL) == MU_OK;
            next_ns += PACE_NS;
        }
        int64_t wait_ns = (int64_t)(next_ns - mu_clock_ns());
        if (mu_process_spin(c->process, wait_ns > 0 ? wait_ns : 0) != MU_OK) {
            exit(1);
        }
    }
    await(c, &taker.taken, count + 1);
    printf("%.3f\n", (double)taker.late_ns * 1e-3 / (double)count);
}

int main(int argc, char **argv)
{
    static struct caller c;
    uint64_t count = argc > 3 ? strtoull(argv[3], NULL, 10) : 0;
    bool echoes = argc == 3 && strcmp(argv[1], "echo") == 0;
    if (!echoes && (argc != 4 || count < 1 || count > COUNT_MAX)) {
        return 2;
    }
    snprintf(c.conversation, sizeof c.conversation, "bench-%ld", (long)getpid());
    struct mu_process_options options = {.domain = (int)strtol(argv[2], NULL, 10)};
    struct mu_handlers handlers = {.self = &c, .on_mail = on_mail, .on_receipt = on_receipt};
    if (mu_process_open(&c.process, &options) != MU_OK ||
        mu_agent_join(c.process, &c.agent, echoes ? "echo" : argv[1], MU_KIND_AGENT, 0,
                      &handlers) != MU_OK ||
        mu_process_await_broker(c.process, PATIENCE_NS) != MU_OK) {
        return 4;
    }
    if (echoes) {
        return mu_process_run(c.process) == MU_OK ? 0 : 1;
    }
    if (strcmp(argv[1], "ping") == 0) {
        ping(&c, count);
    } else if (strcmp(argv[1], "pace") == 0) {
        pace(&c, count);
    } else {
        flood(&c, count);
    }
    mu_process_close(c.process);
    return 0;
}
