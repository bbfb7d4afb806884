/* SPDX-License-Identifier: Apache-2.0 */
/* The only file of muster that calls an allocator, but for clips_heap.c; tools/tidy.py sees to
 * that. */
#include "muster/memory.h"

#include "muster/result.h"

#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

static bool memory_sealed;

/* There in programs built with a leak checker: this memory is meant to be kept. */
void __lsan_ignore_object(const void *p) __attribute__((weak));

/* A block larger than a page comes from the system: a heap would clear it, and pages that are
 * not used would take memory.  The heap of a checker finds accesses beyond a block. */
#ifdef __SANITIZE_ADDRESS__
enum { PAGES_FROM = INT_MAX };
#else
enum { PAGES_FROM = 4096 };
#endif

static void *memory_take(size_t bytes)
{
    if (bytes < PAGES_FROM) {
        return calloc(1, bytes ? bytes : 1);
    }
    void *p = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return p == MAP_FAILED ? NULL : p;
}

void *mu_startup_array(size_t count, size_t bytes)
{
    MU_ASSERT(!memory_sealed);
    MU_ASSERT(bytes == 0 || count <= SIZE_MAX / bytes);
    void *p = memory_take(count * bytes);
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
