/* SPDX-License-Identifier: Apache-2.0 */
/* The only file of muster that calls an allocator; tools/tidy.py sees to that. */
#include "muster/memory.h"

#include "muster/result.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static bool memory_sealed;

/* There in programs built with a leak checker: this memory is meant to be kept. */
void __lsan_ignore_object(const void *p) __attribute__((weak));

void *mu_startup_array(size_t count, size_t bytes)
{
    MU_ASSERT(!memory_sealed);
    MU_ASSERT(bytes == 0 || count <= SIZE_MAX / bytes);
    void *p = calloc(count ? count : 1, bytes ? bytes : 1);
    MU_ASSERT(p);
    if (__lsan_ignore_object) {
        __lsan_ignore_object(p);
    }
    return p;
}

void *mu_startup_alloc(size_t bytes)
{
    return mu_startup_array(1, bytes);
}

char *mu_startup_string(const char *text)
{
    size_t bytes = strlen(text) + 1;
    char *copy = mu_startup_alloc(bytes);
    memcpy(copy, text, bytes);
    return copy;
}

void mu_memory_seal(void)
{
    memory_sealed = true;
}

bool mu_memory_sealed(void)
{
    return memory_sealed;
}
