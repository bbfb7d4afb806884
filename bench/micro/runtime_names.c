/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Many agents in one process, through a broker that runs already.
 *   runtime_names register DOMAIN AGENTS        prints registrations a second, all confirmed
 *   runtime_names lookup DOMAIN AGENTS COUNT    prints the median microseconds of a question
 *                                                     to the broker's white pages
 *   runtime_names cached DOMAIN AGENTS COUNT    prints nanoseconds of a look at the copy
 *   runtime_names stay DOMAIN AGENTS            prints registrations a second, and stays
 */
#include "core/clock.h"
#include "muster/muster.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT_MAX = 10000000, OUTBOX = 8, NAMES_EACH = 997 };

static const uint64_t PATIENCE_NS = 20000000000;

struct crowd {
    mu_process *process;
    mu_agent *first;
    uint32_t agents;
    uint64_t confirmed, refused, answers;
};

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    (void)a;
    (void)reason;
    struct crowd *c = self;
    c->confirmed += accepted;
    c->refused += !accepted;
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    struct crowd *c = self;
    c->answers += strcmp(mail->performative, "inform") == 0;
}

/* Spins until a count is reached; ends the program when that takes too long. */
static void await(struct crowd *c, const uint64_t *count, uint64_t wanted)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (*count < wanted) {
        if (c->refused > 0 || mu_clock_ns() > until_ns ||
            mu_process_spin(c->process, 10000000) != MU_OK) {
            fprintf(stderr, "bench: %llu of %llu, %llu refused\n", (unsigned long long)*count,
                    (unsigned long long)wanted, (unsigned long long)c->refused);
            exit(1);
        }
    }
}

static void agent_name(char name[MU_NAME_MAX + 1], uint64_t index)
{
    snprintf(name, MU_NAME_MAX + 1, "n%llu", (unsigned long long)index);
}

static mu_agent *agent_join(struct crowd *c, uint32_t index)
{
    const struct mu_handlers handlers = {
        .self = c, .on_registered = on_registered, .on_mail = on_mail};
    char name[MU_NAME_MAX + 1];
    mu_agent *a = NULL;
    agent_name(name, index);
    if (mu_agent_join(c->process, &a, name, MU_KIND_AGENT, 0, &handlers) != MU_OK) {
        exit(1);
    }
    return a;
}

/* @return registrations a second; the first agent, which finds the broker, is not counted */
static double crowd_join(struct crowd *c)
{
    c->first = agent_join(c, 0);
    await(c, &c->confirmed, 1);
    uint64_t began_ns = mu_clock_ns();
    for (uint32_t i = 1; i < c->agents; i++) {
        mu_agent_decline_broadcasts(agent_join(c, i));
    }
    await(c, &c->confirmed, c->agents);
    return (double)(c->agents - 1) * 1e9 / (double)(mu_clock_ns() - began_ns);
}

static int compare(const void *a, const void *b)
{
    const uint64_t *x = a;
    const uint64_t *y = b;
    return (*x > *y) - (*x < *y);
}

static void lookup(struct crowd *c, uint64_t count)
{
    static uint64_t took_ns[COUNT_MAX];
    char name[MU_NAME_MAX + 1];
    for (uint64_t i = 0; i < count; i++) {
        agent_name(name, i * NAMES_EACH % c->agents);
        uint64_t began_ns = mu_clock_ns();
        struct mu_mail question = {
            .dst = "broker", .layer = MU_LAYER_QUERY, .performative = "lookup", .content = name};
        if (mu_agent_send(c->first, &question, NULL) != MU_OK) {
            exit(1);
        }
        await(c, &c->answers, i + 1);
        took_ns[i] = mu_clock_ns() - began_ns;
    }
    qsort(took_ns, (size_t)count, sizeof took_ns[0], compare);
    printf("%.3f\n", (double)took_ns[count / 2] * 1e-3);
}

static void cached(struct crowd *c, uint64_t count)
{
    enum { NAMES = 1024 };
    static char names[NAMES][MU_NAME_MAX + 1];
    for (uint64_t i = 0; i < NAMES; i++) {
        agent_name(names[i], i * NAMES_EACH % c->agents);
        while (!mu_process_lookup(c->process, names[i])) { /* its line may still be on its way */
            if (mu_process_spin(c->process, 10000000) != MU_OK) {
                exit(1);
            }
        }
    }
    uint64_t found = 0, began_ns = mu_clock_ns();
    for (uint64_t i = 0; i < count; i++) {
        found += mu_process_lookup(c->process, names[i % NAMES]) != NULL;
    }
    double each_ns = (double)(mu_clock_ns() - began_ns) / (double)count;
    printf("%.2f\n", found == count ? each_ns : -1.0);
}

int main(int argc, char **argv)
{
    static struct crowd c;
    c.agents = argc > 3 ? (uint32_t)strtoul(argv[3], NULL, 10) : 0;
    uint64_t count = argc > 4 ? strtoull(argv[4], NULL, 10) : 1;
    if (argc < 4 || argc > 5 || c.agents < 2 || c.agents > MU_LOCAL_AGENTS_MAX || count < 1 ||
        count > COUNT_MAX) {
        return 2;
    }
    struct mu_process_options options = {
        .domain = (int)strtol(argv[2], NULL, 10), .agents = c.agents, .outbox = OUTBOX};
    if (mu_process_open(&c.process, &options) != MU_OK) {
        return 4;
    }
    double each_s = crowd_join(&c);
    if (strcmp(argv[1], "lookup") == 0) {
        lookup(&c, count);
    } else if (strcmp(argv[1], "cached") == 0) {
        cached(&c, count);
    } else {
        printf("%.1f\n", each_s);
        fflush(stdout);
    }
    bool stays = strcmp(argv[1], "stay") == 0;
    mu_result ran = stays ? mu_process_run(c.process) : MU_OK;
    mu_process_close(c.process);
    return ran == MU_OK ? 0 : 1;
}
