/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Answers mail as it is told to: the first word is the answer's performative, the rest its content.
 *   mail_answerer DOMAIN NAME
 */
#include <muster/muster.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void on_mail(void *self, mu_agent *a, const struct mu_mail *mail)
{
    (void)self;
    char performative[MU_FIELD_MAX + 1];
    size_t len = strcspn(mail->content, " ");
    snprintf(performative, sizeof performative, "%.*s", (int)len, mail->content);
    const char *content = mail->content + len + (mail->content[len] == ' ');
    if (mu_agent_reply(a, mail, performative, content) != MU_OK) {
        fprintf(stderr, "no answer to %s\n", mail->src);
    }
}

int main(int argc, char **argv)
{
    mu_process *p;
    mu_agent *a;
    struct mu_process_options options = {.domain = argc > 2 ? (int)strtol(argv[1], NULL, 10) : 0};
    struct mu_handlers handlers = {.on_mail = on_mail};
    if (argc < 3 || mu_process_open(&p, &options) != MU_OK ||
        mu_agent_join(p, &a, argv[2], MU_KIND_AGENT, 0, &handlers) != MU_OK) {
        return 4;
    }
    mu_result ran = mu_process_run(p);
    mu_process_close(p);
    return ran == MU_OK ? 0 : 4;
}
