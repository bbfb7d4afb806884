/* SPDX-License-Identifier: Apache-2.0 */
/* muster without a word: what lives here, and what to try. */
#include "cli/help/doctor.h"
#include "cli/help/help.h"
#include "core/exits.h"
#include "operator/operator.h"

#include <stdio.h>
#include <stdlib.h>

static const double PATIENCE_S = 0.5;

/* What lives in a domain, by kind. */
static void domain_print(int domain, const char *name)
{
    struct operator_options join = {.only_reads = true};
    struct operator op;
    const struct mu_member *m;
    unsigned count[3] = {0}; /* robots, hosts, others */
    join.network.domain = domain;
    join.network.wait_broker_s = PATIENCE_S;
    printf("  --domain %d  %s", domain, name);
    fflush(stdout);
    if (operator_join(&op, &join, "ps") != MU_EXIT_DONE) {
        puts("");
        return;
    }
    for (size_t i = 0; (m = mu_process_member(op.process, i)); i++) {
        if (!reader_is(m) && m->state != MU_GONE) {
            count[m->kind == MU_KIND_ROBOT ? 0 : m->kind == MU_KIND_HOST ? 1 : 2]++;
        }
    }
    printf(": %u brokers, %u robots, %u hosts, %u other agents\n", doctor_brokers(domain), count[0],
           count[1], count[2]);
    operator_leave(&op);
}

int live_print(void)
{
    char name[RUNS_NAME_MAX + 1];
    const char *said = getenv("MUSTER_DOMAIN");
    int by_hand = said ? (int)strtol(said, NULL, 10) : 0;
    unsigned found = 0;
    for (int domain = 0; runs_next(&domain, name); domain++) {
        puts(found++ == 0 ? "Runs of yours that live:" : "");
        domain_print(domain, name);
        by_hand = domain == by_hand ? -1 : by_hand;
    }
    if (by_hand >= 0 && doctor_brokers(by_hand) > 0) {
        found++;
        puts("No run of yours, but a broker lives:");
        domain_print(by_hand, "by hand");
    }
    fputs(found == 0 ? "No run of yours lives.  Try:\n"
                       "  muster run follow --watch   a run, in a browser\n"
                       "  muster run follow           the same as fast as it goes, and its report\n"
                       "  muster new mine             an experiment and rules to change\n"
                       "  muster doctor               what may keep muster from running here\n"
                     : "Try:\n"
                       "  muster ps                   the agents\n"
                       "  muster top                  what they do\n"
                       "  muster web --open           the same in a browser\n"
                       "  muster console NAME         what an agent thinks\n",
          stdout);
    fputs("  muster help                 all verbs\n", stdout);
    return MU_EXIT_DONE;
}
