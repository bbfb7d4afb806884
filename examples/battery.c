/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A resolver of one's own: battery:low is whoever offers something with battery < 0.3, and
 * battery:0.5 whoever has less than a half: battery [DOMAIN]
 *
 * An agent says how much it has left by mu_agent_advertise(a, "drive", "battery=0.2", 0), and
 * `muster send battery:low go home` reaches it.
 */
#include <math.h>
#include <muster/muster.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double LOW = 0.3;

static bool battery_resolve(void *self, mu_agent *a, const char *rest, const char *sender,
                            mu_resolution *r)
{
    (void)a;
    (void)sender;
    const mu_process *process = self;
    char query[64], *end = NULL;
    double below = strcmp(rest, "low") == 0 ? LOW : strtod(rest, &end);
    if (end && (end == rest || *end != '\0' || !isfinite(below))) {
        return false; /* the sender is told unknown-name */
    }
    snprintf(query, sizeof query, "* battery<%.17g", below);
    const struct mu_service *s;
    for (size_t i = 0; (s = mu_process_find_service(process, query, i)) != NULL; i++) {
        mu_resolution_add(r, s->agent);
    }
    return true;
}

int main(int argc, char **argv)
{
    const char *domain = argc > 1 ? argv[1] : getenv("MUSTER_DOMAIN");
    /* It watches, so that runs in lock step wait for it and are the same every time. */
    struct mu_process_options options = {.domain = domain ? (int)strtol(domain, NULL, 10) : 0,
                                         .watches = true};
    mu_process *process;
    mu_agent *a;
    if (mu_process_open(&process, &options) != MU_OK ||
        mu_agent_join(process, &a, "resolver.battery", MU_KIND_AGENT, 0,
                      &(struct mu_handlers){.self = NULL}) != MU_OK ||
        mu_agent_resolve(a, "battery", battery_resolve, process) != MU_OK) {
        return EXIT_FAILURE;
    }
    mu_agent_decline_broadcasts(a);
    mu_result ran = mu_process_run(process);
    mu_process_close(process);
    return ran == MU_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
