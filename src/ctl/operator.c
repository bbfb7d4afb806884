/* SPDX-License-Identifier: Apache-2.0 */
#include "ctl/operator.h"

#include "core/clock.h"
#include "core/exits.h"
#include "core/text.h"
#include "ctl/runs.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const uint64_t BROKER_PATIENCE_NS = 2500000000;
static const uint64_t RECEIPT_PATIENCE_NS = 5000000000;
static const int64_t ROUND_NS = 20000000;

mu_result operator_parse(struct mu_options *o, int argc, char **argv,
                         struct operator_options *options)
{
    options->network.domain = -1;
    return mu_options_parse(o, argc, argv);
}

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    struct operator* o = self;
    o->registered = accepted;
    o->refused = !accepted;
    if (!accepted) {
        fprintf(stderr, "muster: the broker refuses the name %s: %s\n", mu_agent_name(a), reason);
    }
}

static void on_receipt(void *self, mu_agent *a, uint64_t first_seq, uint64_t last_seq,
                       enum mu_outcome outcome)
{
    (void)a;
    struct operator* o = self;
    if (first_seq <= o->seq && o->seq <= last_seq) {
        o->outcome = outcome;
        o->answered_for = true;
    }
}

/* Prints the content of an answer; one that is a single CLIPS string without its quotes. */
static void answer_print(const char *content)
{
    size_t len = strlen(content);
    bool quoted = len >= 2 && content[0] == '"' && content[len - 1] == '"';
    for (size_t i = quoted; i < len - quoted; i++) {
        if (quoted && content[i] == '\\' && i + 1 < len - quoted) {
            i++;
        }
        putchar(content[i]);
    }
    size_t last = len - quoted;
    if (last <= (size_t)quoted || content[last - 1] != '\n') {
        putchar('\n');
    }
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)a;
    struct operator* o = self;
    if (!o->reply_with[0] || strcmp(mail->in_reply_to, o->reply_with) != 0) {
        return;
    }
    bool understood = strcmp(mail->performative, "not-understood") != 0;
    if (!understood && o->asks_group) {
        return; /* who is in a group need not know CLIPS */
    }
    o->answers++;
    o->failures += !understood || strcmp(mail->performative, "failure") == 0;
    if (o->on_answer) {
        o->on_answer(o->on_answer_self, mail);
        return;
    }
    printf("%s: %s", mail->src, understood ? "" : "not understood: ");
    answer_print(mail->content);
}

int operator_join(struct operator* o, const struct operator_options *options, const char *verb)
{
    int domain = (int)options->network.domain;
    *o = (struct operator){0};
    if (domain < 0 && runs_find(&domain) != MU_OK) {
        return MU_EXIT_USAGE;
    }
    struct mu_process_options process = {.domain = domain,
                                         .interface = options->network.interface,
                                         .peer = mu_network_peers(&options->network),
                                         .name = "operator",
                                         .broker = options->network.broker};
    if (mu_process_open(&o->process, &process) != MU_OK) {
        return MU_EXIT_DDS;
    }
    const char *name = options->as ? options->as : "operator";
    enum mu_kind kind = options->as ? MU_KIND_AGENT : MU_KIND_SPECIAL;
    struct mu_handlers handlers = {
        .self = o, .on_registered = on_registered, .on_mail = on_mail, .on_receipt = on_receipt};
    if (mu_agent_join(o->process, &o->agent, name, kind, 0, &handlers) != MU_OK) {
        fprintf(stderr, "muster %s: '%s' is not a name that an agent can have\n", verb, name);
        return MU_EXIT_USAGE;
    }
    mu_agent_decline_broadcasts(o->agent);
    mu_result met = mu_process_await_broker(o->process, BROKER_PATIENCE_NS);
    if (met != MU_OK) {
        fprintf(stderr,
                "muster %s: no broker answers in domain %d; start one with: muster broker %s "
                "--domain %d, or a whole run with: muster run FILE\n",
                verb, domain, options->network.broker ? options->network.broker : "NAME", domain);
        return MU_EXIT_DDS;
    }
    return o->refused ? MU_EXIT_REFUSED : MU_EXIT_DONE;
}

void operator_leave(struct operator* o)
{
    mu_process_close(o->process);
}

static int outcome_exit(enum mu_outcome outcome)
{
    switch (outcome) {
    case MU_MAIL_DELIVERED:
    case MU_MAIL_STORED:
    case MU_MAIL_DUPLICATE: return MU_EXIT_DONE;
    case MU_MAIL_UNKNOWN_NAME: return MU_EXIT_NO_AGENT;
    case MU_MAIL_REFUSED: return MU_EXIT_REFUSED;
    case MU_MAIL_NO_STORE: return MU_EXIT_WRITE;
    case MU_MAIL_EXPIRED:
    case MU_MAIL_DROPPED:
    case MU_MAIL_BOX_FULL: return MU_EXIT_UNDELIVERED;
    }
    return MU_EXIT_UNDELIVERED;
}

static bool spin_until(struct operator* o, const bool *flag, const unsigned *count, unsigned wanted,
                       uint64_t patience_ns)
{
    uint64_t until_ns = mu_clock_ns() + patience_ns;
    while (!(flag && *flag) && !(count && *count >= wanted)) {
        if (mu_clock_ns() > until_ns || mu_process_spin(o->process, ROUND_NS) != MU_OK) {
            return false;
        }
    }
    return true;
}

static bool is_group(const char *to)
{
    return strcmp(to, "all") == 0 || strcmp(to, "robots") == 0 || strcmp(to, "special") == 0;
}

int operator_send(struct operator* o, struct mu_mail *mail, unsigned answers_wanted, double wait_s)
{
    if (answers_wanted > 0) {
        snprintf(o->reply_with, sizeof o->reply_with, "q%ld", (long)getpid());
        mail->reply_with = o->reply_with;
        o->asks_group = is_group(mail->dst);
    }
    mu_result sent = mu_agent_send(o->agent, mail, &o->seq);
    if (sent != MU_OK) {
        fprintf(stderr,
                "muster: the mail cannot be sent: %s (content up to %d bytes, receivers up "
                "to %d)\n",
                mu_result_text(sent), MU_CONTENT_MAX, MU_DST_MAX);
        return MU_EXIT_USAGE;
    }
    if (!spin_until(o, &o->answered_for, NULL, 0, RECEIPT_PATIENCE_NS)) {
        fprintf(stderr, "muster: the broker has not answered for the mail\n");
        return MU_EXIT_DDS;
    }
    int code = outcome_exit(o->outcome);
    if (code != MU_EXIT_DONE) {
        fprintf(stderr, "muster: to %s: %s%s\n", mail->dst, mu_outcome_text(o->outcome),
                o->outcome == MU_MAIL_UNKNOWN_NAME ? "; muster ps lists who is there" : "");
        return code;
    }
    if (answers_wanted == 0) {
        printf("%s\n", mu_outcome_text(o->outcome));
        return MU_EXIT_DONE;
    }
    if (!spin_until(o, NULL, &o->answers, answers_wanted, (uint64_t)(wait_s * 1e9))) {
        fprintf(stderr, "muster: %u of %u answers within %g s\n", o->answers, answers_wanted,
                wait_s);
        return MU_EXIT_TIME;
    }
    return o->failures > 0 ? MU_EXIT_UNDELIVERED : MU_EXIT_DONE;
}

bool operator_words(char *text, size_t size, const char *const *words, size_t count)
{
    struct mu_text t;
    mu_text_init(&t, text, size);
    for (size_t i = 0; i < count; i++) {
        mu_text_format(&t, "%s%s", i ? " " : "", words[i]);
    }
    return !t.cut;
}
