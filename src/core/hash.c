/* SPDX-License-Identifier: Apache-2.0 */
#include "core/hash.h"

#include <string.h>

uint64_t mu_hash_bytes(uint64_t hash, const void *bytes, size_t count)
{
    const unsigned char *b = bytes;
    for (size_t i = 0; i < count; i++) {
        hash = (hash ^ b[i]) * 1099511628211ull;
    }
    return hash;
}

uint64_t mu_hash_string(const char *s)
{
    return mu_hash_bytes(MU_HASH_EMPTY, s, strlen(s));
}

uint64_t mu_hash_number(uint64_t x)
{
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}
