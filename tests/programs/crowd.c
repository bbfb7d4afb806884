/* SPDX-License-Identifier: Apache-2.0 */
/*
 * crowd DOMAIN COUNT [PREFIX [BROKER [dispose]]]: a process of agents c0, c1 ...; says when the
 * broker has confirmed all, and disposes of them then, if it is to.
 */
#include "muster/limits.h"
#include "muster/muster.h"

#include <stdio.h>
#include <stdlib.h>

static mu_agent *agents[MU_LOCAL_AGENTS_MAX];
static uint32_t confirmed;

static void on_registered(void *self, mu_agent *a, bool accepted, const char *reason)
{
    (void)self;
    if (!accepted) {
        fprintf(stderr, "%s: %s\n", mu_agent_name(a), reason);
    }
    confirmed += accepted;
}

int main(int argc, char **argv)
{
    static const struct mu_handlers handlers = {.on_registered = on_registered};
    uint32_t count = argc >= 3 ? (uint32_t)strtoul(argv[2], NULL, 10) : 0;
    struct mu_process_options options = {.domain = argc >= 3 ? (int)strtol(argv[1], NULL, 10) : 0,
                                         .agents = count,
                                         .outbox = 4,
                                         .broker = argc > 4 ? argv[4] : NULL};
    mu_process *p = NULL;
    if (count == 0 || count > MU_LOCAL_AGENTS_MAX || mu_process_open(&p, &options) != MU_OK) {
        return 2;
    }
    for (uint32_t i = 0; i < count; i++) {
        char name[MU_NAME_MAX + 1];
        snprintf(name, sizeof name, "%s%u", argc > 3 ? argv[3] : "c", i);
        if (mu_agent_join(p, &agents[i], name, MU_KIND_AGENT, 0, &handlers) != MU_OK) {
            return 1;
        }
    }
    while (confirmed < count) {
        if (mu_process_spin(p, 10000000) != MU_OK) {
            return 1;
        }
    }
    puts("all confirmed");
    fflush(stdout);
    for (uint32_t i = 0; i < count && argc > 5; i++) {
        mu_agent_set_state(agents[i], MU_GONE);
    }
    mu_result ran = argc > 5 ? MU_OK : mu_process_run(p);
    mu_process_close(p);
    return ran == MU_OK ? 0 : 1;
}
