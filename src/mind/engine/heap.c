/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The memory of a mind's engine.  What is small is cut from chunks and never goes back alone: the
 * engine has pools of it, by size.  What is not is a piece of its own.  So all of it can be given
 * back at once without a look at what stands in it, and a mind that broke in the middle of
 * something leaves nothing behind.
 */
#include "mind/engine/clips_engine.h"

#include <malloc.h>
#include <stdlib.h>
#include <sys/mman.h>

enum {
    HEAP_CHUNK = 64 << 10,
    HEAP_CHUNKS = 64,
    HEAP_REGION = HEAP_CHUNK * HEAP_CHUNKS,
    HEAP_ALIGNMENT = 8,
    HEAP_MUCH = 8 << 20 /* more than most minds have */
};

/* The heap of a checker sees what runs over. */
#ifdef __SANITIZE_ADDRESS__
enum { HEAP_PIECES_FROM = 1 };
#else
enum { HEAP_PIECES_FROM = MEM_TABLE_SIZE };
#endif

/* Chunks that the system gave together, at a multiple of their size: so a block tells its region.
 * The record is where the first chunk begins. */
struct clips_region {
    struct clips_region *next;
    uint32_t used[HEAP_CHUNKS]; /* bytes that were cut from each; 0: it is free */
    uint32_t idle[HEAP_CHUNKS]; /* of them, those in pools: while memory is given back */
};

/* Stands before each piece. */
struct clips_piece {
    struct clips_piece *next, **link; /* link: what points to it */
};

/* Whose environment is being made: it is not tied to its mind yet. */
static struct mind *heap_maker;

static struct mind *heap_mind(void *env)
{
    struct mind *m = clips_engine_mind(env);
    return m ? m : heap_maker;
}

/* --- chunks ----------------------------------------------------------------------------------- */

static bool heap_grow(struct clips_heap *h)
{
    char *got = mmap(NULL, 2 * (size_t)HEAP_REGION, PROT_READ | PROT_WRITE,
                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (got == MAP_FAILED) {
        return false;
    }
    size_t before = -(uintptr_t)got % HEAP_REGION;
    char *start = got + before;
    if (before > 0) {
        (void)munmap(got, before);
    }
    (void)munmap(start + HEAP_REGION, HEAP_REGION - before);
    (void)madvise(start, HEAP_REGION, MADV_NOHUGEPAGE); /* most minds need a part of it only */
    struct clips_region *made = (struct clips_region *)start;
    made->next = h->regions;
    h->regions = made;
    return true;
}

/* Opens the first chunk that is free.  @return false: none is */
static bool heap_open(struct clips_heap *h)
{
    for (struct clips_region *r = h->regions; r; r = r->next) {
        for (size_t i = 0; i < HEAP_CHUNKS; i++) {
            if (r->used[i] == 0) {
                h->at = (char *)r + i * HEAP_CHUNK + (i == 0 ? sizeof *r : 0);
                h->end = (char *)r + (i + 1) * HEAP_CHUNK;
                h->held += HEAP_CHUNK;
                return true;
            }
        }
    }
    return false;
}

/* The region of a block, or NULL: it is a piece. */
static struct clips_region *heap_region(const struct clips_heap *h, const void *block)
{
    uintptr_t start = (uintptr_t)block - (uintptr_t)block % HEAP_REGION;
    struct clips_region *r = h->regions;
    while (r && (uintptr_t)r != start) {
        r = r->next;
    }
    return r;
}

static size_t heap_chunk(const void *block)
{
    return (uintptr_t)block % HEAP_REGION / HEAP_CHUNK;
}

static size_t heap_rounded(size_t bytes)
{
    return (bytes + HEAP_ALIGNMENT - 1) / HEAP_ALIGNMENT * HEAP_ALIGNMENT;
}

static bool heap_has_room(const struct clips_heap *h, size_t bytes, size_t most)
{
    return bytes <= most && h->held <= most - bytes;
}

static void *heap_cut(struct clips_heap *h, size_t bytes, size_t most)
{
    bytes = heap_rounded(bytes);
    if ((size_t)(h->end - h->at) < bytes) {
        bool opened =
            heap_has_room(h, HEAP_CHUNK, most) && (heap_open(h) || (heap_grow(h) && heap_open(h)));
        if (!opened) {
            return NULL;
        }
    }
    char *cut = h->at;
    h->at += bytes;
    uintptr_t start = (uintptr_t)cut - (uintptr_t)cut % HEAP_REGION;
    ((struct clips_region *)start)->used[heap_chunk(cut)] += (uint32_t)bytes;
    return cut;
}

/* --- pieces ----------------------------------------------------------------------------------- */

static void *heap_piece(struct clips_heap *h, size_t bytes, size_t most)
{
    if (!heap_has_room(h, bytes, most)) {
        return NULL;
    }
    struct clips_piece *made = malloc(sizeof *made + bytes);
    if (!made) {
        return NULL;
    }
    *made = (struct clips_piece){.next = h->pieces, .link = &h->pieces};
    if (made->next) {
        made->next->link = &made->next;
    }
    h->pieces = made;
    h->held += bytes;
    return made + 1;
}

static void heap_end_piece(struct clips_heap *h, void *memory, size_t bytes)
{
    struct clips_piece *piece = (struct clips_piece *)memory - 1;
    *piece->link = piece->next;
    if (piece->next) {
        piece->next->link = piece->link;
    }
    h->held -= bytes;
    free(piece);
}

/* --- what the engine calls -------------------------------------------------------------------- */

void *genalloc(void *env, size_t bytes)
{
    struct mind *m = heap_mind(env);
    struct memoryData *data = MemoryData(env);
    size_t most = m->sheltered ? CLIPS_MEMORY_BURST : SIZE_MAX;
    size_t whole = bytes < sizeof(void *) ? sizeof(void *) : bytes;
    if (whole < MEM_TABLE_SIZE && data->MemoryTable[whole]) {
        return clips_engine_take(env, whole);
    }
    void *given = whole < HEAP_PIECES_FROM ? heap_cut(&m->heap, whole, most)
                                           : heap_piece(&m->heap, whole, most);
    if (!given) {
        clips_guard_burst(m);
    }
    data->MemoryAmount += (long)whole;
    data->MemoryCalls++;
    m->units += whole >= MEM_TABLE_SIZE ? whole / 64 : 0; /* it is filled */
    clips_guard_allocated(m);
    return given;
}

int genfree(void *env, void *memory, size_t bytes)
{
    struct clips_heap *h = &heap_mind(env)->heap;
    if (bytes < MEM_TABLE_SIZE) {
        clips_engine_give(env, memory, bytes < sizeof(void *) ? sizeof(void *) : bytes);
        return 0;
    }
    MemoryData(env)->MemoryAmount -= (long)bytes;
    MemoryData(env)->MemoryCalls--;
    if (!heap_region(h, memory)) {
        heap_end_piece(h, memory, bytes);
    }
    return 0;
}

/* Says of each chunk how much of it is in pools; a piece that is there goes at once. */
static void heap_count_idle(void *env, struct clips_heap *h)
{
    struct memoryData *data = MemoryData(env);
    for (size_t bytes = sizeof(void *); bytes < MEM_TABLE_SIZE; bytes++) {
        struct memoryPtr **at = &data->MemoryTable[bytes];
        while (*at) {
            struct memoryPtr *block = *at;
            struct clips_region *r = heap_region(h, block);
            if (r) {
                r->idle[heap_chunk(block)] += (uint32_t)heap_rounded(bytes);
                at = &block->next;
            } else {
                *at = block->next;
                data->MemoryAmount -= (long)bytes;
                data->MemoryCalls--;
                heap_end_piece(h, block, bytes);
            }
        }
    }
}

/* A region's record stays, and with it the first chunk; so does the one that is open. */
static bool heap_is_idle(const struct clips_heap *h, const struct clips_region *r, size_t chunk)
{
    return chunk > 0 && r->used[chunk] > 0 && r->idle[chunk] == r->used[chunk] &&
           h->end != (const char *)r + (chunk + 1) * HEAP_CHUNK;
}

/* Takes out of the pools what is in chunks that go. */
static void heap_leave_pools(void *env, struct clips_heap *h)
{
    struct memoryData *data = MemoryData(env);
    for (size_t bytes = sizeof(void *); bytes < MEM_TABLE_SIZE; bytes++) {
        struct memoryPtr **at = &data->MemoryTable[bytes];
        while (*at) {
            if (heap_is_idle(h, heap_region(h, *at), heap_chunk(*at))) {
                *at = (*at)->next;
                data->MemoryAmount -= (long)bytes;
                data->MemoryCalls--;
            } else {
                at = &(*at)->next;
            }
        }
    }
}

static void heap_shrink(struct clips_heap *h)
{
    for (struct clips_region *r = h->regions; r; r = r->next) {
        for (size_t i = 0; i < HEAP_CHUNKS; i++) {
            if (heap_is_idle(h, r, i)) {
                (void)madvise((char *)r + i * HEAP_CHUNK, HEAP_CHUNK, MADV_DONTNEED);
                h->held -= HEAP_CHUNK;
                r->used[i] = 0;
            }
            r->idle[i] = 0;
        }
    }
}

/* Gives back all that can be, whatever is asked for: chunks of which everything is in pools. */
long EnvReleaseMem(void *env, long wanted)
{
    struct clips_heap *h = &heap_mind(env)->heap;
    long before = MemoryData(env)->MemoryAmount;
    (void)wanted;
    heap_count_idle(env, h);
    heap_leave_pools(env, h);
    heap_shrink(h);
    return before - MemoryData(env)->MemoryAmount;
}

/* --- the whole -------------------------------------------------------------------------------- */

void clips_heap_make(struct mind *m)
{
    heap_maker = m;
    m->env = CreateEnvironment();
    MU_ASSERT(m->env);
    SetEnvironmentContext(m->env, m);
    heap_maker = NULL;
}

/* What the engine has of malloc itself: the tables that it finds everything else by. */
static void heap_end_environment(struct environmentData *env)
{
    struct environmentCleanupFunction *next;
    for (struct environmentCleanupFunction *f = env->listOfCleanupEnvironmentFunctions; f;
         f = next) {
        next = f->next;
        free(f);
    }
    free(MemoryData(env)->MemoryTable);
    for (size_t i = 0; i < MAXIMUM_ENVIRONMENT_POSITIONS; i++) {
        free(env->theData[i]);
    }
    free(env->cleanupFunctions);
    free(env->theData);
    free(env);
}

void clips_heap_drop(struct mind *m)
{
    struct clips_heap *h = &m->heap;
    bool much = h->held > HEAP_MUCH;
    heap_end_environment(m->env);
    m->env = NULL;
    while (h->pieces) {
        struct clips_piece *next = h->pieces->next;
        free(h->pieces);
        h->pieces = next;
    }
    while (h->regions) {
        struct clips_region *next = h->regions->next;
        (void)munmap(h->regions, HEAP_REGION);
        h->regions = next;
    }
    *h = (struct clips_heap){.held = 0};
    if (much) {
        (void)malloc_trim(0); /* else it keeps some of it */
    }
}
