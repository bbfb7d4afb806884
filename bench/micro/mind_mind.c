/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A robot's mind alone: percepts and a mail in, the library's following rules, a speed out.
 *   mind_mind RULES_FOLDER FILE COUNT    prints microseconds a cycle
 */
#include "mind/mind.h"
#include "core/clock.h"
#include "core/text_file.h"
#include "muster/limits.h"

#include <stdio.h>
#include <stdlib.h>

enum { SONARS = 16, WARM_UP = 100 };

static mu_result post(void *self, const struct mind_letter *letter)
{
    (void)self;
    (void)letter;
    return MU_OK;
}

/* One control step of a robot that follows another along a line.  @return whether a rule drove */
static bool cycle(struct mind *m, uint64_t step)
{
    float sonar_m[SONARS];
    for (size_t i = 0; i < SONARS; i++) {
        sonar_m[i] = 4.0F + 0.01F * (float)((step + i) % 16);
    }
    double x_m = 0.02 * (double)(step % 1000);
    struct mu_percept percept = {.time_ns = step * MU_STEP_NS,
                                 .x_m = x_m,
                                 .forward_m_s = 0.2,
                                 .sonar_count = SONARS,
                                 .sonar_m = sonar_m};
    char content[64];
    snprintf(content, sizeof content, "mate-pos red %.3f 100.0", 1000.0 * x_m + 1500.0);
    struct mind_mail mail = {step + 1, "red", "", "", "", "", "", "", content, 0, 0};
    struct mind_act act;
    mind_percept(m, &percept);
    bool taken = mind_take_mail(m, &mail) == MU_OK;
    mind_fire(m, &act);
    return taken && act.drives && act.firings > 0 && act.errors == 0;
}

int main(int argc, char **argv)
{
    uint64_t count = argc == 4 ? strtoull(argv[3], NULL, 10) : 0;
    if (count < 1) {
        return 2;
    }
    struct mind_options options = {.read = mu_text_file_read,
                                   .name = "blue",
                                   .seed = 1,
                                   .rules_folder = argv[1],
                                   .forward_max_m_s = 0.5,
                                   .turn_max_rad_s = 1.6,
                                   .ports = {.send = post}};
    struct mu_fault fault;
    struct mind *m;
    static char answer[256];
    struct mu_text out;
    mu_text_init(&out, answer, sizeof answer);
    if (mind_open(&m, &options, &fault) != MU_OK || mind_load(m, argv[2], &fault) != MU_OK) {
        mu_fault_print(&fault);
        return 3;
    }
    if (mind_line(m, "(follow red)", &out) != MU_OK) {
        fprintf(stderr, "bench: %s\n", answer);
        return 1;
    }
    uint64_t began_ns = 0;
    for (uint64_t i = 0; i < WARM_UP + count; i++) {
        if (i == WARM_UP) {
            began_ns = mu_clock_ns();
        }
        if (!cycle(m, i)) {
            fprintf(stderr, "bench: no rule drove in step %llu\n", (unsigned long long)i);
            return 1;
        }
    }
    printf("%.3f\n", (double)(mu_clock_ns() - began_ns) * 1e-3 / (double)count);
    mind_close(m);
    return 0;
}
