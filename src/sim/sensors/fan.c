/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/sensors/fan.h"

#include "muster/memory.h"
#include "muster/result.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const struct fan_kernel fan_portable, fan_sse2, fan_avx2, fan_avx512;

static const struct fan_kernel *chosen;

/* Lists the kernels that this processor can run, the widest first. */
static size_t fan_list(const struct fan_kernel *list[FAN_KERNELS_MAX])
{
    size_t count = 0;
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
        list[count++] = &fan_avx512;
    }
    if (__builtin_cpu_supports("avx2")) {
        list[count++] = &fan_avx2;
    }
    list[count++] = &fan_sse2;
#endif
    list[count++] = &fan_portable;
    return count;
}

bool fan_choose(const char *name)
{
    const struct fan_kernel *list[FAN_KERNELS_MAX];
    size_t count = fan_list(list);
    for (size_t k = 0; k < count; k++) {
        if (strcmp(list[k]->name, name) == 0) {
            chosen = list[k];
            return true;
        }
    }
    return false;
}

const char *fan_name(size_t number)
{
    const struct fan_kernel *list[FAN_KERNELS_MAX];
    return number < fan_list(list) ? list[number]->name : NULL;
}

const struct fan_kernel *fan_kernel(void)
{
    if (!chosen) {
        const struct fan_kernel *list[FAN_KERNELS_MAX];
        (void)fan_list(list);
        chosen = list[0];
        const char *name = getenv("MUSTER_FAN");
        if (name && !fan_choose(name)) {
            fprintf(stderr, "MUSTER_FAN=%s: not on this processor; %s is used\n", name,
                    chosen->name);
        }
    }
    return chosen;
}

static size_t fan_room(size_t count)
{
    return (count + FAN_PAD - 1u) & ~(size_t)(FAN_PAD - 1);
}

void fan_rays_init(struct fan_rays *rays, size_t count)
{
    double **numbers[] = {&rays->from_x, &rays->from_y, &rays->along_x, &rays->along_y,
                          &rays->range_m};
    *rays = (struct fan_rays){0};
    for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
        *numbers[k] = mu_startup_array(fan_room(count), sizeof **numbers[k]);
    }
}

void fan_table_init(struct fan_table *table, double first_rad, double step_rad, uint32_t count)
{
    MU_ASSERT(count > 0 && step_rad > 0);
    size_t room = fan_room(count);
    *table = (struct fan_table){.first_rad = first_rad, .step_rad = step_rad, .count = count};
    table->along_x = mu_startup_array(room, sizeof *table->along_x);
    table->along_y = mu_startup_array(room, sizeof *table->along_y);
    for (uint32_t k = 0; k < room; k++) {
        double turn = first_rad + step_rad * (k < count ? k : count - 1);
        table->along_x[k] = cos(turn);
        table->along_y[k] = sin(turn);
    }
}
