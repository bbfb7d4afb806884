/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/draw.h"

#include <math.h>

/* splitmix64 (Steele, Lea, Flood, 2014), one number further from x. */
static uint64_t draw_mix(uint64_t x)
{
    x += 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

uint64_t draw_key(uint64_t seed, uint64_t robot, enum draw_use use, uint64_t tick)
{
    uint64_t key = draw_mix(draw_mix(seed) ^ robot);
    return draw_mix(draw_mix(key ^ (uint64_t)use) ^ tick);
}

uint64_t draw_bits(uint64_t key, uint64_t index)
{
    return draw_mix(draw_mix(key) ^ index);
}

double draw_unit(uint64_t bits)
{
    return ((double)(bits >> 12) + 0.5) * 0x1p-52;
}

double draw_normal(uint64_t bits)
{
    return sqrt(-2 * log(draw_unit(bits))) * cos(2 * M_PI * draw_unit(draw_mix(bits)));
}
