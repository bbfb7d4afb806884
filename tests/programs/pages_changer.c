/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Joins and leaves groups, offers and withdraws services, at random, each once the broker has
 * answered the last one; before each it asks whether another line is as it was left.
 *   pages_changer DOMAIN NAME RECORD CHANGES SEED
 * Writes "lost LINE ..." where it is not.  After all changes it asks for every line again and
 * again, and writes "round" after each time, until it is ended.
 */
#include "core/random.h"
#include "record.h"

#include <muster/muster.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { LINES = 16, PATIENCE_S = 2 }; /* the even ones are groups, the others services */

struct changer {
    mu_process *process;
    mu_agent *agent;
    int record;
    uint64_t version[LINES]; /* as which it was offered; 0: it is not there */
    uint64_t asked;          /* number of the question that is open */
    bool answered;
    char performative[MU_FIELD_MAX + 1];
    char answer[MU_CONTENT_MAX + 1];
};

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    struct changer *c = self;
    if (strtoull(mail->in_reply_to, NULL, 10) != c->asked) {
        return;
    }
    snprintf(c->performative, sizeof c->performative, "%s", mail->performative);
    snprintf(c->answer, sizeof c->answer, "%s", mail->content);
    c->answered = true;
}

/* Asks until there is an answer: a question, or an answer to it, dies with the broker. */
static bool ask(struct changer *c, const char *performative, const char *content)
{
    c->answered = false;
    while (!c->answered) {
        char number[32];
        snprintf(number, sizeof number, "%llu", (unsigned long long)++c->asked);
        struct mu_mail mail = {.dst = "broker",
                               .layer = MU_LAYER_QUERY,
                               .performative = performative,
                               .reply_with = number,
                               .content = content};
        if (mu_agent_send(c->agent, &mail, NULL) != MU_OK) {
            c->asked--;
        }
        for (time_t until = time(NULL) + PATIENCE_S; !c->answered && time(NULL) < until;) {
            if (mu_process_spin(c->process, 10000000) != MU_OK) {
                return false;
            }
        }
    }
    return true;
}

static bool line_check(struct changer *c, int line)
{
    const char *name = mu_agent_name(c->agent);
    char content[32], mine[128];
    bool group = line % 2 == 0;
    snprintf(content, sizeof content, "%c%d", group ? 'g' : 's', line);
    if (!ask(c, group ? "members" : "find-service", content)) {
        return false;
    }
    bool there;
    if (group) {
        char padded[MU_CONTENT_MAX + 3];
        snprintf(padded, sizeof padded, "%s ", c->answer);
        snprintf(mine, sizeof mine, " %s ", name);
        there = strcmp(c->performative, "inform") == 0 && strstr(padded, mine);
    } else {
        int len = snprintf(mine, sizeof mine, " %s \"v=", name);
        const char *offer = strstr(c->answer, mine);
        there = offer && strtoull(offer + len, NULL, 10) == c->version[line];
        there = there || (offer && c->version[line] == 0);
    }
    if (there != (c->version[line] > 0)) {
        record_line(c->record, "lost %s version %llu: %s %.200s", content,
                    (unsigned long long)c->version[line], c->performative, c->answer);
    }
    return true;
}

static bool line_change(struct changer *c, int line, uint64_t version)
{
    static const char *const performatives[2][2] = {{"group-leave", "group-join"},
                                                    {"withdraw", "advertise"}};
    char content[64];
    int service = line % 2;
    if (service && version > 0) {
        snprintf(content, sizeof content, "s%d \"v=%llu\"", line, (unsigned long long)version);
    } else {
        snprintf(content, sizeof content, "%c%d", service ? 's' : 'g', line);
    }
    if (!ask(c, performatives[service][version > 0], content)) {
        return false;
    }
    /* To leave or withdraw a second time, when the first answer was lost, fails, and is done. */
    bool done = strcmp(c->performative, "inform") == 0 ||
                (version == 0 && (strncmp(c->answer, "not-", 4) == 0 ||
                                  strncmp(c->answer, "unknown-group", 13) == 0));
    if (!done) {
        record_line(c->record, "refused %s: %s %.200s", content, c->performative, c->answer);
    }
    c->version[line] = version;
    return true;
}

int main(int argc, char **argv)
{
    if (argc != 6) {
        return 2;
    }
    static struct changer c;
    uint64_t changes = strtoull(argv[4], NULL, 10);
    struct mu_random dice;
    mu_random_seed(&dice, strtoull(argv[5], NULL, 10), argv[2]);
    c.record = record_open(argv[3]);
    struct mu_process_options options = {.domain = (int)strtol(argv[1], NULL, 10)};
    struct mu_handlers handlers = {.self = &c, .on_mail = on_mail};
    if (c.record < 0 || mu_process_open(&c.process, &options) != MU_OK ||
        mu_agent_join(c.process, &c.agent, argv[2], MU_KIND_AGENT, 0, &handlers) != MU_OK ||
        mu_process_await_broker(c.process, 5000000000u) != MU_OK) {
        return 4;
    }
    bool going = true;
    for (uint64_t i = 1; i <= changes && going; i++) {
        int line = (int)mu_random_between(&dice, 0, LINES - 1);
        bool there = mu_random_between(&dice, 0, 2) > 0;
        going = line_check(&c, (int)mu_random_between(&dice, 0, LINES - 1)) &&
                line_change(&c, line, there ? i : 0);
        record_line(c.record, "changed");
    }
    while (going) {
        for (int line = 0; line < LINES && going; line++) {
            going = line_check(&c, line);
        }
        record_line(c.record, "round");
    }
    mu_process_close(c.process);
    return 0;
}
