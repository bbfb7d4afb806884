/* SPDX-License-Identifier: Apache-2.0 */
/* Three agents of a production line, without a simulator; each call is a process:
 *   line gauge [N]     asks the press N times, every 10 ms, and prints how long answers took
 *   line press         answers each question: "go" below the limit, else "stop"
 *   line journal       counts what the group `line` is told; it may be away, its mail waits
 *   line units [N]     N agents in one process: what names cost
 * The domain comes from MUSTER_DOMAIN. */
#include <muster/muster.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PERIOD_NS = 10000000, ANSWERS_MAX = 10000, UNITS_MAX = MU_LOCAL_AGENTS_MAX, LIMIT = 90 };

struct gauge {
    mu_agent *agent;
    long wanted, sent, answered;
    uint64_t sent_ns, took_ns[ANSWERS_MAX];
};

static uint64_t clock_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000U + (uint64_t)now.tv_nsec;
}

static void gauge_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    struct gauge *g = self;
    (void)a;
    if (strcmp(mail->in_reply_to, "level") == 0 && g->answered < g->sent) {
        g->took_ns[g->answered++] = clock_ns() - g->sent_ns;
    }
}

static void gauge_ask(struct gauge *g)
{
    char level[32];
    snprintf(level, sizeof level, "level %ld", g->sent % (LIMIT + 10));
    struct mu_mail question = {
        .dst = "press", .performative = "ask-one", .reply_with = "level", .content = level};
    g->sent_ns = clock_ns();
    if (mu_agent_send(g->agent, &question, NULL) == MU_OK) {
        g->sent++;
    }
}

static int by_time(const void *a, const void *b)
{
    uint64_t one = *(const uint64_t *)a, other = *(const uint64_t *)b;
    return (one > other) - (one < other);
}

static void gauge_tell(struct gauge *g)
{
    size_t n = (size_t)g->answered;
    if (n == 0) {
        puts("no answer");
        return;
    }
    qsort(g->took_ns, n, sizeof g->took_ns[0], by_time);
    printf("%zu answers: median %.0f us, 99th percentile %.0f us\n", n,
           (double)g->took_ns[n / 2] / 1e3, (double)g->took_ns[n * 99 / 100] / 1e3);
}

/* A loop of one's own: other work of the program has its place in it. */
static mu_result gauge_run(mu_process *process, struct gauge *g)
{
    uint64_t next_ns = clock_ns();
    mu_result result = MU_OK;
    while (g->answered < g->wanted && result >= MU_OK) {
        uint64_t now_ns = clock_ns();
        if (now_ns >= next_ns && g->sent == g->answered) {
            gauge_ask(g);
            next_ns = now_ns + PERIOD_NS;
        }
        result = mu_process_spin(process, PERIOD_NS / 10);
    }
    gauge_tell(g);
    return result < MU_OK ? result : MU_OK;
}

static void press_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    long level = 0;
    bool asked = sscanf(mail->content, "level %ld", &level) == 1;
    const char *answer = level < LIMIT ? "go" : "stop";
    if (asked && mu_agent_reply(a, mail, "tell", answer) < MU_OK) {
        fputs("an answer is lost\n", stderr);
    }
    if (asked && level >= LIMIT && mu_agent_group_send(a, "line", "stopped") != MU_OK) {
        fputs("the journal has no room\n", stderr);
    }
}

static void journal_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    (void)self;
    if (!accepted || mu_agent_group_join(a, "line") != MU_OK) {
        fprintf(stderr, "no journal: %s\n", reason);
    }
}

static void journal_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    printf("%ld %s: %s\n", ++*(long *)self, mail->src, mail->content);
    fflush(stdout);
}

static mu_result units_join(mu_process *process, long count)
{
    static struct mu_handlers none;
    mu_result joined = MU_OK;
    for (long i = 0; i < count && i < UNITS_MAX && joined == MU_OK; i++) {
        char name[32];
        mu_agent *a;
        snprintf(name, sizeof name, "unit_%ld", i);
        joined = mu_agent_join(process, &a, name, MU_KIND_AGENT, 0, &none);
    }
    return joined;
}

static mu_result role_run(mu_process *process, const char *role, long count)
{
    static struct gauge gauge;
    static long told;
    mu_agent *a;
    if (strcmp(role, "gauge") == 0) {
        struct mu_handlers handlers = {.self = &gauge, .on_mail = gauge_mail};
        gauge.wanted = count < ANSWERS_MAX ? count : ANSWERS_MAX;
        mu_result joined = mu_agent_join(process, &gauge.agent, role, MU_KIND_AGENT, 0, &handlers);
        return joined == MU_OK ? gauge_run(process, &gauge) : joined;
    }
    struct mu_handlers press = {.on_mail = press_mail};
    struct mu_handlers journal = {
        .self = &told, .on_registered = journal_registered, .on_mail = journal_mail};
    bool is_press = strcmp(role, "press") == 0;
    mu_result joined = strcmp(role, "units") == 0 ? units_join(process, count)
                                                  : mu_agent_join(process, &a, role, MU_KIND_AGENT,
                                                                  0, is_press ? &press : &journal);
    return joined == MU_OK ? mu_process_run(process) : joined;
}

int main(int argc, char **argv)
{
    const char *domain = getenv("MUSTER_DOMAIN");
    const char *role = argc > 1 ? argv[1] : "";
    if (!strstr("gauge press journal units", role) || strlen(role) < 5) {
        fputs("usage: line gauge|press|journal|units [N]\n", stderr);
        return 2;
    }
    struct mu_process_options options = {.domain = domain ? (int)strtol(domain, NULL, 10) : 0};
    long count = argc > 2 ? strtol(argv[2], NULL, 10) : 200;
    if (strcmp(role, "units") == 0 && count > 0 && count <= UNITS_MAX) {
        options.agents = (uint32_t)count; /* its memory is taken now */
        options.outbox = 4;
    }
    mu_process *process = NULL;
    mu_result result = mu_process_open(&process, &options);
    if (result == MU_OK) {
        result = role_run(process, role, count);
    }
    mu_process_close(process);
    return result != MU_OK;
}
