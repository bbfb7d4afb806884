/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A process of agents aINDEX-0, aINDEX-1, ... that send numbered mails to any agent of any process.
 *   churner DOMAIN INDEX PROCESSES AGENTS RECORD
 * Writes "sent NAME NUMBER RECEIVER", "told NAME - FIRST LAST OUTCOME", "took NAME SENDER NUMBER".
 * After SIGUSR1 it sends no more, and writes "done - - -" when all that it sent has an outcome.
 */
#include "core/clock.h"
#include "core/random.h"
#include "record.h"

#include <muster/muster.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { AGENTS_MAX = 64, MAILS_MAX = 100000 };

static struct sender {
    mu_agent *agent;
    uint64_t sent, answered;
    uint64_t first_seq; /* of this life */
    bool registered;
    bool told[MAILS_MAX];
} senders[AGENTS_MAX];

static const uint64_t BETWEEN_NS = 5000000;

static volatile sig_atomic_t quiet;
static int record;

static void on_signal(int number)
{
    (void)number;
    quiet = 1;
}

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    (void)a;
    (void)reason;
    struct sender *s = self;
    s->registered = accepted;
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    record_line(record, "took %s %s %s", mu_agent_name(a), mail->src, mail->content);
}

static void on_receipt(void *self, mu_agent *a, uint64_t first, uint64_t last,
                       enum mu_outcome outcome)
{
    struct sender *s = self;
    record_line(record, "told %s - %llu %llu %s", mu_agent_name(a),
                (unsigned long long)(first - s->first_seq),
                (unsigned long long)(last - s->first_seq), mu_outcome_text(outcome));
    for (uint64_t i = first - s->first_seq; i <= last - s->first_seq && i < MAILS_MAX; i++) {
        s->answered += !s->told[i];
        s->told[i] = true;
    }
}

static void mail_send(struct sender *s, struct mu_random *dice, int64_t processes, int64_t agents)
{
    char to[MU_NAME_MAX + 1], content[32];
    snprintf(to, sizeof to, "a%d-%d", (int)mu_random_between(dice, 0, processes - 1),
             (int)mu_random_between(dice, 0, agents - 1));
    snprintf(content, sizeof content, "%llu", (unsigned long long)s->sent);
    struct mu_mail mail = {.dst = to, .content = content};
    if (s->registered && s->sent < MAILS_MAX &&
        mu_agent_send(s->agent, &mail, s->sent == 0 ? &s->first_seq : NULL) == MU_OK) {
        record_line(record, "sent %s %llu %s", mu_agent_name(s->agent),
                    (unsigned long long)s->sent++, to);
    }
}

static bool all_answered(int64_t agents)
{
    bool all = true;
    for (int64_t i = 0; i < agents; i++) {
        all = all && senders[i].answered == senders[i].sent;
    }
    return all;
}

int main(int argc, char **argv)
{
    int64_t agents = argc == 6 ? strtoll(argv[4], NULL, 10) : 0;
    if (agents < 1 || agents > AGENTS_MAX) {
        return 2;
    }
    struct mu_random dice;
    mu_random_seed(&dice, (uint64_t)getpid(), argv[2]);
    signal(SIGUSR1, on_signal); /* whoever finds the record may send one */
    record = record_open(argv[5]);
    mu_process *p;
    struct mu_process_options options = {.domain = (int)strtol(argv[1], NULL, 10),
                                         .agents = (uint32_t)agents};
    if (record < 0 || mu_process_open(&p, &options) != MU_OK) {
        return 4;
    }
    for (int64_t i = 0; i < agents; i++) {
        struct mu_handlers handlers = {.self = &senders[i],
                                       .on_registered = on_registered,
                                       .on_mail = on_mail,
                                       .on_receipt = on_receipt};
        char name[MU_NAME_MAX + 1];
        snprintf(name, sizeof name, "a%s-%d", argv[2], (int)i);
        if (mu_agent_join(p, &senders[i].agent, name, MU_KIND_AGENT, 0, &handlers) != MU_OK) {
            return 1;
        }
    }
    bool done = false;
    uint64_t next_ns = 0;
    while (mu_process_spin(p, 20000000) == MU_OK) {
        if (!quiet && mu_clock_ns() >= next_ns) {
            next_ns = mu_clock_ns() + BETWEEN_NS;
            mail_send(&senders[mu_random_between(&dice, 0, agents - 1)], &dice,
                      strtoll(argv[3], NULL, 10), agents);
        } else if (quiet && !done && all_answered(agents)) {
            record_line(record, "done - - -");
            done = true;
        }
    }
    mu_process_close(p);
    return 0;
}
