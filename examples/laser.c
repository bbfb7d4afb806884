/* SPDX-License-Identifier: Apache-2.0 */
/* Drives to where its laser sees most room: laser [NAME [DOMAIN]] */
#include <math.h>
#include <muster/muster.h>
#include <stdlib.h>

static void on_act(void *self, mu_agent *a, const struct mu_percept *p)
{
    size_t best = 0, middle = p->laser_count / 2;
    for (size_t i = 0; i < p->laser_count; i++) { /* from right to left */
        best = p->laser_m[i] > p->laser_m[best] ? i : best;
    }
    double ahead_m = p->laser_count > 0 ? (double)p->laser_m[middle] : 0.0;
    double turn_rad_s = best > middle ? 0.6 : -0.6;
    double forward_m_s = fmin(0.4, fmax(0.0, ahead_m - 0.6));
    if (mu_agent_drive(a, forward_m_s, best == middle ? 0.0 : turn_rad_s) != MU_OK) {
        mu_process_stop(self);
    }
}

int main(int argc, char **argv)
{
    const char *domain = argc > 2 ? argv[2] : getenv("MUSTER_DOMAIN");
    struct mu_process_options options = {.domain = domain ? (int)strtol(domain, NULL, 10) : 0,
                                         .with_body = true};
    mu_process *process;
    mu_agent *robot;
    if (mu_process_open(&process, &options) != MU_OK ||
        mu_agent_join(process, &robot, argc > 1 ? argv[1] : "red", MU_KIND_ROBOT, 0,
                      &(struct mu_handlers){.self = process, .on_act = on_act}) != MU_OK) {
        return EXIT_FAILURE;
    }
    mu_agent_senses(robot, MU_SENSE_LASER); /* sonar is not read any more */
    mu_result ran = mu_process_run(process);
    mu_process_close(process);
    return ran == MU_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
