/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/record/record.h"

#include "core/rounded.h"

#include <math.h>

void tally_take(struct tally *t, uint64_t time_ns, uint64_t step_ns,
                const struct engine_sample *sample)
{
    double time_s = mu_rounded((double)time_ns * 1e-9);
    double x_m = mu_rounded(sample->pose.x_m);
    double y_m = mu_rounded(sample->pose.y_m);
    double spent_s = (double)step_ns * 1e-9;
    if (t->seen) {
        spent_s = time_s - t->time_s;
        t->distance_m += sample->placed ? 0 : hypot(x_m - t->x_m, y_m - t->y_m);
    }
    if (sample->percept.stalled) {
        t->stalls += !t->stalled;
        t->stalled_s += spent_s;
    }
    t->seen = true;
    t->stalled = sample->percept.stalled;
    t->time_s = time_s;
    t->x_m = x_m;
    t->y_m = y_m;
}
