/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Sends mails of some size as fast as the broker answers for them.
 *   mail_flooder DOMAIN NAME RECEIVER COUNT BYTES
 * When each has an answer it prints how many of which: "stored N", "box-full N", ..., one a line.
 * With COUNT 0 it goes on until it is ended.
 */
#include <muster/muster.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OUTCOMES = MU_MAIL_NO_STORE + 1 };

static const uint64_t PATIENCE_NS = 10000000000;

struct flood {
    uint64_t outcomes[OUTCOMES];
    uint64_t answered; /* up to this mail */
};

static void on_receipt(void *self, mu_agent *a, uint64_t first, uint64_t last,
                       enum mu_outcome outcome)
{
    (void)a;
    struct flood *f = self;
    f->outcomes[outcome] += last - first + 1;
    f->answered = last > f->answered ? last : f->answered;
}

int main(int argc, char **argv)
{
    static char content[MU_CONTENT_MAX + 1];
    static struct flood flood;
    size_t bytes = argc == 6 ? (size_t)strtoull(argv[5], NULL, 10) : 0;
    if (bytes < 1 || bytes > MU_CONTENT_MAX) {
        return 2;
    }
    memset(content, 'x', bytes);
    uint64_t count = strtoull(argv[4], NULL, 10);
    mu_process *p;
    mu_agent *a;
    struct mu_process_options options = {.domain = (int)strtol(argv[1], NULL, 10)};
    struct mu_handlers handlers = {.self = &flood, .on_receipt = on_receipt};
    if (mu_process_open(&p, &options) != MU_OK ||
        mu_agent_join(p, &a, argv[2], MU_KIND_AGENT, 0, &handlers) != MU_OK ||
        mu_process_await_broker(p, PATIENCE_NS) != MU_OK) {
        return 4;
    }
    struct mu_mail mail = {.dst = argv[3], .content = content};
    uint64_t sent = 0;
    while (count == 0 || flood.answered < count) {
        while ((count == 0 || sent < count) && mu_agent_send(a, &mail, NULL) == MU_OK) {
            sent++;
        }
        if (mu_process_spin(p, 10000000) != MU_OK) {
            break;
        }
    }
    for (int i = 0; i < OUTCOMES; i++) {
        printf("%s %llu\n", mu_outcome_text((enum mu_outcome)i),
               (unsigned long long)flood.outcomes[i]);
    }
    mu_process_close(p);
    return count > 0 && flood.answered < count;
}
