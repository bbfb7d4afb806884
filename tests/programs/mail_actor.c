/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Does with mail what it is told on its standard input, line by line, and notes what comes of it.
 *   mail_actor DOMAIN RECORD [BROKER]
 *     join NAME LAST_NUMBER [POLICY MAILS]  POLICY: 0 refuse, 1 drop the oldest, 2 the lowest
 *     leave NAME
 *     state NAME standby|running|suspended
 *     enter NAME GROUP, exit NAME GROUP
 *     send NAME TO COUNT EVERY_US LEVELS PRIORITIES TTL_MS  LEVELS: of r l s; PRIORITIES: of 0 1 2,
 *                                                           taken in turn
 *     tell NAME TO PERFORMATIVE             a directive
 * Lines of the record, each written with one write:
 *   J AGENT ACCEPTED                        the broker has said yes or no
 *   S AGENT NUMBER TO LEVEL PRIORITY TTL    sent
 *   M AGENT PLACE_IN_BOX SENDER NUMBER PRIORITY
 *   R AGENT FIRST LAST OUTCOME
 *   E AGENT                                 all of a `send` is out
 *   L AGENT                                 it leaves
 */
#include "record.h"

#include <muster/muster.h>

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { AGENTS = 32, STREAMS = 64 };

struct stream {
    mu_agent *from;
    char to[512], levels[8], priorities[8];
    uint64_t count, sent, every_us, began_us, ttl_ns;
};

static int record;
static mu_process *process;
static struct stream streams[STREAMS];
static struct {
    mu_agent *agent;
    bool accepted;
} agents[AGENTS];
static uint32_t agents_count;

static uint64_t now_us(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000u + (uint64_t)t.tv_nsec / 1000u;
}

/* --- what comes of it ------------------------------------------------------------------------- */

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    bool *yes = self;
    *yes = accepted;
    record_line(record, "J %s %d %s", mu_agent_name(a), accepted, reason);
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *m)
{
    (void)self;
    record_line(record, "M %s %llu %s %llu %d", mu_agent_name(a), (unsigned long long)m->number,
                m->src, (unsigned long long)m->seq, m->priority);
}

static void on_directive(void *self, mu_agent *a, const struct mu_mail *m)
{
    (void)self;
    record_line(record, "M %s %llu %s %llu 9", mu_agent_name(a), (unsigned long long)m->number,
                m->src, (unsigned long long)m->seq);
}

static void on_receipt(void *self, mu_agent *a, uint64_t first, uint64_t last,
                       enum mu_outcome outcome)
{
    (void)self;
    record_line(record, "R %s %llu %llu %s", mu_agent_name(a), (unsigned long long)first,
                (unsigned long long)last, mu_outcome_text(outcome));
}

/* --- what it is told -------------------------------------------------------------------------- */

static uint32_t index_of(const char *name)
{
    uint32_t i = agents_count;
    while (i > 0 && strcmp(mu_agent_name(agents[i - 1].agent), name) != 0) {
        i--;
    }
    return i - 1;
}

static mu_agent *agent_of(const char *name)
{
    uint32_t i = index_of(name);
    return i < agents_count ? agents[i].agent : NULL;
}

static void join(char *word[])
{
    uint32_t i = agents_count;
    bool *yes = &agents[i].accepted;
    struct mu_handlers handlers = {.self = yes,
                                   .on_registered = on_registered,
                                   .on_mail = on_mail,
                                   .on_directive = on_directive,
                                   .on_receipt = on_receipt};
    *yes = false;
    uint64_t last = strtoull(word[2], NULL, 10);
    if (i == AGENTS || mu_agent_join(process, &agents[i].agent, word[1], MU_KIND_AGENT, last,
                                     &handlers) != MU_OK) {
        record_line(record, "X cannot join %s", word[1]);
        return;
    }
    agents_count++;
    if (word[3]) {
        mu_agent_limit_box(agents[i].agent, (enum mu_box_policy)strtol(word[3], NULL, 10),
                           (uint32_t)strtoul(word[4], NULL, 10), 0);
    }
}

static void state_set(mu_agent *a, const char *word)
{
    static const enum mu_state states[] = {MU_STANDBY, MU_RUNNING, MU_SUSPENDED};
    for (size_t i = 0; i < sizeof states / sizeof states[0]; i++) {
        if (strcmp(word, mu_state_text(states[i])) == 0) {
            mu_agent_set_state(a, states[i]);
        }
    }
}

static void stream_begin(mu_agent *a, char *word[])
{
    struct stream *s = streams;
    while (s < streams + STREAMS && s->sent < s->count) {
        s++;
    }
    if (s == streams + STREAMS || !word[7]) {
        record_line(record, "X no stream");
        return;
    }
    *s = (struct stream){.from = a,
                         .count = strtoull(word[3], NULL, 10),
                         .every_us = strtoull(word[4], NULL, 10),
                         .began_us = now_us(),
                         .ttl_ns = strtoull(word[7], NULL, 10) * 1000000u};
    snprintf(s->to, sizeof s->to, "%s", word[2]);
    snprintf(s->levels, sizeof s->levels, "%s", word[5]);
    snprintf(s->priorities, sizeof s->priorities, "%s", word[6]);
}

static void obey(char *line)
{
    char *word[9] = {0}, *rest = line;
    for (int i = 0; i < 8 && (word[i] = strtok_r(i ? NULL : line, " ", &rest)); i++) {
    }
    if (!word[0] || !word[1]) {
        return;
    }
    mu_result done = MU_OK;
    mu_agent *a = agent_of(word[1]);
    if (strcmp(word[0], "join") == 0) {
        join(word);
    } else if (!a) {
        done = MU_MALFORMED;
    } else if (strcmp(word[0], "leave") == 0) {
        uint32_t i = index_of(word[1]);
        for (struct stream *s = streams; s < streams + STREAMS; s++) {
            s->count = s->from == a ? 0 : s->count;
        }
        agents[i].accepted = false;
        record_line(record, "L %s", word[1]);
        mu_agent_set_state(a, MU_GONE);
    } else if (strcmp(word[0], "state") == 0) {
        state_set(a, word[2]);
    } else if (strcmp(word[0], "enter") == 0) {
        done = mu_agent_group_join(a, word[2]);
    } else if (strcmp(word[0], "exit") == 0) {
        done = mu_agent_group_leave(a, word[2]);
    } else if (strcmp(word[0], "send") == 0) {
        stream_begin(a, word);
    } else if (strcmp(word[0], "tell") == 0) {
        struct mu_mail mail = {.dst = word[2], .directive = true, .performative = word[3]};
        uint64_t seq;
        done = mu_agent_send(a, &mail, &seq);
        if (done == MU_OK) {
            record_line(record, "S %s %llu %s r 9 0", word[1], (unsigned long long)seq, word[2]);
        }
    }
    if (done != MU_OK) {
        record_line(record, "X %s %s %d", word[0], word[1], done);
    }
}

/* Reads what has come.  @return false: nobody tells any more */
static bool lines_take(void)
{
    static char line[4096];
    static size_t len;
    struct pollfd in = {.fd = 0, .events = POLLIN};
    while (poll(&in, 1, 0) > 0) {
        ssize_t got = read(0, line + len, 1);
        if (got <= 0) {
            return false;
        }
        if (line[len] == '\n') {
            line[len] = '\0';
            obey(line);
            len = 0;
        } else if (len < sizeof line - 1) {
            len++;
        }
    }
    return true;
}

/* --- what it sends ---------------------------------------------------------------------------- */

static bool mail_send(struct stream *s)
{
    char level = s->levels[s->sent % strlen(s->levels)];
    int priority = s->priorities[s->sent % strlen(s->priorities)] - '1';
    struct mu_mail mail = {.dst = s->to,
                           .priority = (enum mu_priority)priority,
                           .level = level == 's'   ? MU_LEVEL_SYNCED
                                    : level == 'l' ? MU_LEVEL_LOGGED
                                                   : MU_LEVEL_RAM,
                           .ttl_ns = s->ttl_ns,
                           .content = "n"};
    uint64_t seq;
    if (mu_agent_send(s->from, &mail, &seq) != MU_OK) {
        return false;
    }
    s->sent++;
    record_line(record, "S %s %llu %s %c %d %llu", mu_agent_name(s->from), (unsigned long long)seq,
                s->to, level, priority, (unsigned long long)s->ttl_ns);
    return true;
}

static void streams_send(void)
{
    for (struct stream *s = streams; s < streams + STREAMS; s++) {
        uint32_t i = s->sent < s->count ? index_of(mu_agent_name(s->from)) : AGENTS;
        if (i >= agents_count || !agents[i].accepted) {
            continue;
        }
        uint64_t due = s->every_us ? 1 + (now_us() - s->began_us) / s->every_us : s->count;
        due = due < s->count ? due : s->count;
        while (s->sent < due && mail_send(s)) {
        }
        if (s->sent == s->count) {
            record_line(record, "E %s", mu_agent_name(s->from));
        }
    }
}

int main(int argc, char **argv)
{
    if (argc < 3) {
        return 2;
    }
    record = record_open(argv[2]);
    struct mu_process_options options = {.domain = (int)strtol(argv[1], NULL, 10),
                                         .agents = AGENTS,
                                         .broker = argc > 3 ? argv[3] : NULL};
    if (record < 0 || mu_process_open(&process, &options) != MU_OK) {
        return 4;
    }
    mu_result ran = MU_OK;
    while (ran == MU_OK && lines_take()) {
        streams_send();
        ran = mu_process_spin(process, 1000000);
    }
    mu_process_close(process);
    return ran == MU_OK ? 0 : 1;
}
