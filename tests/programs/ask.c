/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Asks another agent in any layer, from a poll loop of its own, and prints the answer.
 *   ask DOMAIN TO LAYER PERFORMATIVE [CONTENT]
 * Ends with 0 when an answer has come, 1 when none came within five seconds, 4 without a broker.
 */
#include <muster/muster.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static bool answered;

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    (void)a;
    if (strcmp(mail->in_reply_to, "q1") == 0) {
        printf("%u %s %s %s: %s\n", mail->layer, mail->src, mail->conversation, mail->performative,
               mail->content);
        answered = true;
    }
}

int main(int argc, char **argv)
{
    if (argc < 5) {
        return 2;
    }
    struct mu_process_options options = {.domain = (int)strtol(argv[1], NULL, 10)};
    struct mu_handlers handlers = {.on_mail = on_mail};
    mu_process *p;
    mu_agent *a;
    if (mu_process_open(&p, &options) != MU_OK ||
        mu_agent_join(p, &a, "asker", MU_KIND_AGENT, 0, &handlers) != MU_OK ||
        mu_process_await_broker(p, 5000000000u) != MU_OK) {
        return 4;
    }
    struct mu_mail mail = {.dst = argv[2],
                           .layer = (uint32_t)strtoul(argv[3], NULL, 10),
                           .performative = argv[4],
                           .content = argc > 5 ? argv[5] : NULL,
                           .conversation = "talk",
                           .reply_with = "q1"};
    mu_result going = mu_agent_send(a, &mail, NULL);
    struct pollfd wake = {.fd = mu_process_wake_fd(p), .events = POLLIN};
    for (time_t until = time(NULL) + 5; going == MU_OK && !answered && time(NULL) < until;) {
        going = mu_process_spin(p, 0);
        if (!answered && poll(&wake, 1, 100) < 0) {
            break;
        }
    }
    mu_process_close(p);
    return answered ? 0 : 1;
}
