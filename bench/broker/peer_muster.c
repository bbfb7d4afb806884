/* SPDX-License-Identifier: Apache-2.0 */
#include "peer.h"

#include "core/clock.h"
#include "load.h"
#include "muster/muster.h"

#include <stdlib.h>
#include <string.h>

static const uint64_t PATIENCE_NS = 20000000000;

static struct {
    mu_process *process;
    mu_agent *agent;
    void (*on_mail)(const char *text);
    bool registered;
    uint64_t answered_seq; /* outcomes come in the order of the mails: all go to one receiver */
} peer;

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    (void)self;
    (void)a;
    if (!accepted) {
        load_die("registration refused: %s", reason);
    }
    peer.registered = true;
}

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    (void)a;
    if (peer.on_mail) {
        peer.on_mail(mail->content);
    }
}

static void on_receipt(void *self, mu_agent *a, uint64_t first_seq, uint64_t last_seq,
                       enum mu_outcome outcome)
{
    (void)self;
    (void)a;
    if (outcome != MU_MAIL_DELIVERED && outcome != MU_MAIL_STORED && outcome != MU_MAIL_BOX_FULL) {
        load_die("mail %llu: %s", (unsigned long long)first_seq, mu_outcome_text(outcome));
    }
    peer.answered_seq = last_seq > peer.answered_seq ? last_seq : peer.answered_seq;
}

void peer_open(const struct peer_options *options)
{
    struct mu_process_options process = {.domain = (int)strtol(options->where, NULL, 10)};
    struct mu_handlers handlers = {
        .on_registered = on_registered, .on_mail = on_mail, .on_receipt = on_receipt};
    peer.on_mail = options->on_mail;
    if (mu_process_open(&peer.process, &process) != MU_OK ||
        mu_agent_join(peer.process, &peer.agent, options->name, MU_KIND_AGENT, 0, &handlers) !=
            MU_OK) {
        load_die("cannot join as %s", options->name);
    }
    if (strncmp(options->name, "sender", 6) == 0) {
        mu_agent_decline_broadcasts(peer.agent);
    }
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (!peer.registered) {
        peer_spin(100000000);
        if (mu_clock_ns() > until_ns) {
            load_die("no broker in domain %s", options->where);
        }
    }
}

bool peer_send(const char *to, const char *text, enum mu_level level)
{
    struct mu_mail mail = {.dst = to, .layer = MU_LAYER_SPEECH, .content = text, .level = level};
    mu_result sent = mu_agent_send(peer.agent, &mail, NULL);
    if (sent != MU_OK && sent != MU_FULL) {
        load_die("a mail to %s was refused", to);
    }
    return sent == MU_OK;
}

void peer_answer(const char *to, const char *text)
{
    if (!peer_send(to, text, MU_LEVEL_RAM)) {
        load_die("no room for an answer to %s", to);
    }
}

void peer_spin(int64_t timeout_ns)
{
    if (mu_process_spin(peer.process, timeout_ns) != MU_OK) {
        load_die("the process has ended");
    }
}

void peer_serve(void)
{
    if (mu_process_run(peer.process) != MU_OK) {
        load_die("the process has ended");
    }
}

uint64_t peer_answered(void)
{
    return peer.answered_seq;
}

void peer_close(void)
{
    mu_process_close(peer.process);
}
