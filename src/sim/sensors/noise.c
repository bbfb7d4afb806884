/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/sensors/models.h"

double noise_range(const struct world_noise *noise, const struct noise_limits *limits,
                   double range_m, uint64_t bits)
{
    double deviation = noise->constant_m + noise->per_m * range_m;
    if (range_m < limits->max_m && deviation > 0) {
        range_m += deviation * draw_normal(bits);
    }
    return noise_clip(limits, range_m);
}

/* The half-angle form turns by 2 atan(error / 2), without a sine. */
void noise_turn(const struct world_noise *noise, double along[2], uint64_t bits)
{
    double half = noise->angle_rad * draw_normal(bits) / 2;
    double per = 1 / (1 + half * half);
    double c = (1 - half * half) * per;
    double s = 2 * half * per;
    double x = along[0];
    along[0] = c * x - s * along[1];
    along[1] = s * x + c * along[1];
}
