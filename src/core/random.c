/* SPDX-License-Identifier: Apache-2.0 */
#include "core/random.h"

#include "core/hash.h"

void mu_random_seed(struct mu_random *r, uint64_t seed, const char *name)
{
    r->state = seed ^ mu_hash_string(name);
    r->state = mu_random_next(r); /* neighbouring seeds part at once */
}

uint64_t mu_random_next(struct mu_random *r)
{
    return mu_hash_number(r->state += 0x9e3779b97f4a7c15ull);
}

double mu_random_unit(struct mu_random *r)
{
    return (double)(mu_random_next(r) >> 11) * 0x1p-53;
}

int64_t mu_random_between(struct mu_random *r, int64_t lo, int64_t hi)
{
    if (hi <= lo) {
        return lo;
    }
    uint64_t span = (uint64_t)hi - (uint64_t)lo + 1;
    uint64_t pick = mu_random_next(r);
    return (int64_t)((uint64_t)lo + (span ? pick % span : pick));
}
