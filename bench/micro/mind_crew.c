/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Many minds in one process, in turns as in a control step: what each takes of time and memory.
 *   mind_crew RULES_FOLDER FILE MINDS STEPS
 * prints milliseconds of processor time to make a mind, its memory in KiB, microseconds a cycle
 */
#include "usage.h"

#include "core/text_file.h"
#include "mind/mind.h"
#include "muster/limits.h"
#include "muster/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SONARS = 16, WARM_UP = 10 };

static mu_result post(void *self, const struct mind_letter *letter)
{
    (void)self;
    (void)letter;
    return MU_OK;
}

/* Each robot goes round a circle of its own and sees something at one side.  @return whether a rule
 * drove */
static bool cycle(struct mind *m, uint64_t robot, uint64_t step)
{
    float sonar_m[SONARS];
    for (size_t i = 0; i < SONARS; i++) {
        sonar_m[i] = 0.8F + 0.21F * (float)((step / 8 + robot + 3 * i) % 20);
    }
    double turn_rad = remainder(0.02 * (double)(step + robot), 2 * M_PI);
    struct mu_percept percept = {.time_ns = step * MU_STEP_NS,
                                 .x_m = (double)robot + cos(turn_rad),
                                 .y_m = sin(turn_rad),
                                 .heading_rad = turn_rad,
                                 .forward_m_s = 0.2,
                                 .sonar_count = SONARS,
                                 .sonar_m = sonar_m};
    struct mind_act act;
    mind_percept(m, &percept);
    mind_fire(m, &act);
    return act.drives && act.firings > 0 && act.errors == 0;
}

static bool minds_make(struct mind **minds, uint64_t count, char **argv)
{
    struct mu_fault fault;
    for (uint64_t i = 0; i < count; i++) {
        char name[MU_NAME_MAX + 1];
        snprintf(name, sizeof name, "w_%llu", (unsigned long long)i);
        struct mind_options options = {.read = mu_text_file_read,
                                       .name = name,
                                       .seed = 1,
                                       .rules_folder = argv[1],
                                       .ports = {.send = post}};
        if (mind_open(&minds[i], &options, &fault) != MU_OK ||
            mind_load(minds[i], argv[2], &fault) != MU_OK) {
            mu_fault_print(&fault);
            return false;
        }
    }
    return true;
}

int main(int argc, char **argv)
{
    uint64_t count = argc == 5 ? strtoull(argv[3], NULL, 10) : 0;
    uint64_t steps = argc == 5 ? strtoull(argv[4], NULL, 10) : 0;
    if (count < 1 || steps < 1) {
        return 2;
    }
    struct mind **minds = mu_startup_array(count, sizeof(struct mind *));
    double before_kib = resident_kib();
    uint64_t began_ns = processor_ns();
    if (!minds_make(minds, count, argv)) {
        return 3;
    }
    double made_ms = (double)(processor_ns() - began_ns) * 1e-6 / (double)count;
    for (uint64_t s = 0; s < WARM_UP + steps; s++) {
        began_ns = s == WARM_UP ? processor_ns() : began_ns;
        for (uint64_t i = 0; i < count; i++) {
            if (!cycle(minds[i], i, s)) {
                fprintf(stderr, "bench: no rule drove in step %llu\n", (unsigned long long)s);
                return 1;
            }
        }
    }
    double cycles = (double)count * (double)steps;
    printf("%.2f %.0f %.2f\n", made_ms, (resident_kib() - before_kib) / (double)count,
           (double)(processor_ns() - began_ns) * 1e-3 / cycles);
    return 0;
}
