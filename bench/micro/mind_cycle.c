/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A controller cycle alone: five percept facts in the place of the last ones, two rules, four calls
 * of the robot's functions (bench/minds/cycle.clp).
 *   mind_cycle RULES_FOLDER FILE COUNT
 * prints microseconds of processor time a cycle, and KiB of memory of a mind without any rules
 */
#include "usage.h"

#include "core/text_file.h"
#include "mind/mind.h"
#include "muster/limits.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { SONARS = 16, WARM_UP = 100, FIRINGS = 2, BARE = 8 };

/* A robot that goes round a circle: every number is another one in each step.  @return whether both
 * rules fired and one drove */
static bool cycle(struct mind *m, uint64_t step)
{
    double turn_rad = remainder(0.02 * (double)step, 2 * M_PI);
    float sonar_m[SONARS];
    for (size_t i = 0; i < SONARS; i++) {
        sonar_m[i] = 0.8F + 0.0021F * (float)((7 * step + 31 * i) % 1999);
    }
    struct mu_blob blob = {0xFF0000, 0.3 * turn_rad, 0.1, 2 + cos(turn_rad)};
    struct mu_fiducial marks[] = {{1, 0.4 + 0.1 * turn_rad, 1.5 + 0.1 * turn_rad, 0.2},
                                  {2, -0.4 + 0.1 * turn_rad, 1.7 - 0.1 * turn_rad, 0.3}};
    struct mu_percept percept = {.time_ns = step * MU_STEP_NS,
                                 .x_m = 2 * cos(turn_rad),
                                 .y_m = 2 * sin(turn_rad),
                                 .heading_rad = turn_rad,
                                 .forward_m_s = 0.2,
                                 .sonar_count = SONARS,
                                 .sonar_m = sonar_m,
                                 .blob_count = 1,
                                 .blobs = &blob,
                                 .fiducial_count = 2,
                                 .fiducials = marks};
    struct mind_act act;
    mind_percept(m, &percept);
    mind_fire(m, &act);
    return act.drives && act.firings == FIRINGS && act.errors == 0;
}

static struct mind *mind_make(const char *folder, const char *file)
{
    struct mind_options options = {
        .read = mu_text_file_read, .name = "red", .seed = 1, .rules_folder = folder};
    struct mu_fault fault;
    struct mind *m;
    if (mind_open(&m, &options, &fault) != MU_OK || (file && mind_load(m, file, &fault) != MU_OK)) {
        mu_fault_print(&fault);
        exit(3);
    }
    return m;
}

/* The first one also takes what the process needs for any. */
static double bare_kib(void)
{
    mind_make(NULL, NULL);
    double before_kib = resident_kib();
    for (int i = 0; i < BARE; i++) {
        mind_make(NULL, NULL);
    }
    return (resident_kib() - before_kib) / BARE;
}

int main(int argc, char **argv)
{
    uint64_t count = argc == 4 ? strtoull(argv[3], NULL, 10) : 0;
    if (count < 1) {
        return 2;
    }
    struct mind *m = mind_make(argv[1], argv[2]);
    uint64_t began_ns = 0;
    for (uint64_t i = 0; i < WARM_UP + count; i++) {
        began_ns = i == WARM_UP ? processor_ns() : began_ns;
        if (!cycle(m, i)) {
            fprintf(stderr, "bench: not two rules in step %llu\n", (unsigned long long)i);
            return 1;
        }
    }
    double used_ns = (double)(processor_ns() - began_ns);
    printf("%.3f %.0f\n", used_ns * 1e-3 / (double)count, bare_kib());
    mind_close(m);
    return 0;
}
