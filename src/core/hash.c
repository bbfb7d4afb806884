/* SPDX-License-Identifier: Apache-2.0 */
#include "core/hash.h"

uint64_t mu_hash_string(const char *s)
{
    uint64_t hash = 14695981039346656037ull;
    for (const char *c = s; *c; c++) {
        hash = (hash ^ (unsigned char)*c) * 1099511628211ull;
    }
    return hash;
}

uint64_t mu_hash_number(uint64_t x)
{
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}
