/* SPDX-License-Identifier: Apache-2.0 */
/* A vehicle of Braitenberg's: each sonar slows the wheel of the other side, so that it turns away
 * from what is near (V. Braitenberg, Vehicles, 1984, vehicle 3b).  An experiment starts it as a
 * controller, and names it: braitenberg [SPEED_M_S] */
#include <math.h>
#include <muster/muster.h>
#include <stdio.h>
#include <stdlib.h>

enum { NEAR_MM = 1500 };

/* Nearness of what the sonars of one side see, 0 to 1; sonars from first to last. */
static double nearness(const struct mu_percept *p, size_t first, size_t last)
{
    double nearest_m = NEAR_MM / 1000.0;
    for (size_t i = first; i < last; i++) {
        nearest_m = fmin(nearest_m, (double)p->sonar_m[i]);
    }
    return 1.0 - nearest_m * 1000.0 / NEAR_MM;
}

static void on_act(void *self, mu_agent *a, const struct mu_percept *p)
{
    const double *speed_m_s = self;
    double left = nearness(p, 0, p->sonar_count / 4);
    double right = nearness(p, p->sonar_count / 4, p->sonar_count / 2);
    double forward_m_s = *speed_m_s * (1.0 - fmax(left, right));
    double turn_rad_s = p->stalled ? 1.0 : 1.5 * (right - left) + (left > 0.7 ? 0.3 : 0.0);
    if (mu_agent_drive(a, p->stalled ? -0.1 : forward_m_s, turn_rad_s) != MU_OK) {
        abort(); /* neither is infinite */
    }
    char place[128]; /* as rules tell it: millimetres */
    snprintf(place, sizeof place, "mate-pos %s %.1f %.1f", mu_agent_name(a), p->x_m * 1000,
             p->y_m * 1000);
    if (mu_agent_broadcast(a, place) != MU_OK) {
        fputs("no room for a mail\n", stderr);
    }
}

int main(int argc, char **argv)
{
    double speed_m_s = argc > 1 ? strtod(argv[1], NULL) : 0.3;
    struct mu_process_options options = {.with_body = true}; /* domain and broker: by environment */
    struct mu_handlers handlers = {.self = &speed_m_s, .on_act = on_act};
    mu_process *process;
    mu_agent *robot; /* named by MUSTER_AGENT */
    if (mu_process_open(&process, &options) != MU_OK ||
        mu_agent_join(process, &robot, NULL, MU_KIND_ROBOT, 0, &handlers) != MU_OK) {
        return EXIT_FAILURE;
    }
    mu_result ran = mu_process_run(process);
    mu_process_close(process);
    return ran == MU_OK || ran == MU_DONE ? EXIT_SUCCESS : EXIT_FAILURE;
}
