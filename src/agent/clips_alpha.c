/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Alpha memories: the facts that fit a pattern, apart by what the next join compares.  The engine
 * finds each through a table of 63559 places.  Most patterns have one memory or none: here that one
 * hangs at its pattern and is in no table, so that a percept needs not read places of it.
 */
#include "agent/clips_engine.h"

#include <drive.h>
#include <reteutil.h>

static unsigned long alpha_bucket(const struct patternNodeHeader *pattern, unsigned long hash)
{
    return ((unsigned)(uintptr_t)pattern + hash) % ALPHA_MEMORY_HASH_SIZE;
}

/* A memory that is in no table is its own neighbour. */
static bool alpha_is_tabled(const struct alphaMemoryHash *memory)
{
    return memory->prev != memory;
}

static void alpha_table(void *env, struct alphaMemoryHash *memory)
{
    struct alphaMemoryHash **place = &DefruleData(env)->AlphaMemoryTable[memory->bucket];
    memory->next = *place;
    memory->prev = NULL;
    if (*place) {
        (*place)->prev = memory;
    }
    *place = memory;
}

static void alpha_untable(void *env, struct alphaMemoryHash *memory)
{
    if (!alpha_is_tabled(memory)) {
        return;
    }
    if (memory->prev) {
        memory->prev->next = memory->next;
    } else {
        DefruleData(env)->AlphaMemoryTable[memory->bucket] = memory->next;
    }
    if (memory->next) {
        memory->next->prev = memory->prev;
    }
}

static struct alphaMemoryHash *alpha_find(void *env, const struct patternNodeHeader *pattern,
                                          unsigned long bucket)
{
    struct alphaMemoryHash *m = pattern->firstHash;
    if (!m || m->bucket == bucket) {
        return m;
    }
    if (m == pattern->lastHash) {
        return NULL;
    }
    m = DefruleData(env)->AlphaMemoryTable[bucket];
    while (m && m->owner != pattern) {
        m = m->next;
    }
    return m;
}

/* An empty memory, behind those that the pattern has. */
static struct alphaMemoryHash *alpha_make(void *env, struct patternNodeHeader *pattern,
                                          unsigned long bucket)
{
    struct alphaMemoryHash *made = clips_engine_take(env, sizeof *made);
    *made = (struct alphaMemoryHash){
        .bucket = bucket, .owner = pattern, .prevHash = pattern->lastHash, .prev = made};
    if (!pattern->firstHash) {
        pattern->firstHash = made;
    } else {
        if (!alpha_is_tabled(pattern->firstHash)) {
            alpha_table(env, pattern->firstHash);
        }
        alpha_table(env, made);
        pattern->lastHash->nextHash = made;
    }
    pattern->lastHash = made;
    return made;
}

static void alpha_end(void *env, struct patternNodeHeader *pattern, struct alphaMemoryHash *memory)
{
    alpha_untable(env, memory);
    if (memory->prevHash) {
        memory->prevHash->nextHash = memory->nextHash;
    } else {
        pattern->firstHash = memory->nextHash;
    }
    if (memory->nextHash) {
        memory->nextHash->prevHash = memory->prevHash;
    } else {
        pattern->lastHash = memory->prevHash;
    }
    clips_engine_give(env, memory, sizeof *memory);
}

struct partialMatch *CreateAlphaMatch(void *env, void *entity, struct multifieldMarker *markers,
                                      struct patternNodeHeader *pattern, unsigned long hash)
{
    struct partialMatch *match = clips_engine_take(env, sizeof *match);
    struct alphaMatch *alpha = clips_engine_take(env, sizeof *alpha);
    unsigned long bucket = alpha_bucket(pattern, hash);
    *alpha = (struct alphaMatch){.matchingItem = entity, .bucket = bucket};
    *match = (struct partialMatch){.bcount = 1, .hashValue = hash};
    match->binds[0].gm.theMatch = alpha;
    alpha->markers = markers ? CopyMultifieldMarkers(env, markers) : NULL;
    struct alphaMemoryHash *memory = alpha_find(env, pattern, bucket);
    if (!memory) {
        memory = alpha_make(env, pattern, bucket);
    }
    match->prevInMemory = memory->endOfQueue;
    if (memory->endOfQueue) {
        memory->endOfQueue->nextInMemory = match;
    } else {
        memory->alphaMemory = match;
    }
    memory->endOfQueue = match;
    return match;
}

struct partialMatch *GetAlphaMemory(void *env, struct patternNodeHeader *pattern,
                                    unsigned long hash)
{
    struct alphaMemoryHash *memory = alpha_find(env, pattern, alpha_bucket(pattern, hash));
    return memory ? memory->alphaMemory : NULL;
}

void RemoveAlphaMemoryMatches(void *env, struct patternNodeHeader *pattern,
                              struct partialMatch *match, struct alphaMatch *alpha)
{
    bool outer = !match->prevInMemory || !match->nextInMemory;
    struct alphaMemoryHash *memory = outer ? alpha_find(env, pattern, alpha->bucket) : NULL;
    if (match->prevInMemory) {
        match->prevInMemory->nextInMemory = match->nextInMemory;
    } else {
        memory->alphaMemory = match->nextInMemory;
    }
    if (match->nextInMemory) {
        match->nextInMemory->prevInMemory = match->prevInMemory;
    } else {
        memory->endOfQueue = match->prevInMemory;
    }
    match->nextInMemory = EngineData(env)->GarbagePartialMatches;
    EngineData(env)->GarbagePartialMatches = match;
    if (memory && !memory->alphaMemory) {
        alpha_end(env, pattern, memory);
    }
}

/* The pattern goes, or forgets what fits it.  destroy: nobody else looks at its matches. */
static void alpha_end_all(void *env, struct patternNodeHeader *pattern, bool destroy, bool untable)
{
    struct alphaMemoryHash *next;
    for (struct alphaMemoryHash *memory = pattern->firstHash; memory; memory = next) {
        next = memory->nextHash;
        if (destroy) {
            DestroyAlphaBetaMemory(env, memory->alphaMemory);
        } else {
            FlushAlphaBetaMemory(env, memory->alphaMemory);
        }
        if (untable) {
            alpha_untable(env, memory);
        }
        clips_engine_give(env, memory, sizeof *memory);
    }
    pattern->firstHash = NULL;
    pattern->lastHash = NULL;
}

void DestroyAlphaMemory(void *env, struct patternNodeHeader *pattern, int unlink)
{
    alpha_end_all(env, pattern, true, unlink);
}

void FlushAlphaMemory(void *env, struct patternNodeHeader *pattern)
{
    alpha_end_all(env, pattern, false, true);
}

/* A join that has nothing to compare with costs no more than a look. */
void NetworkAssert(void *env, struct partialMatch *match, struct joinNode *join)
{
    if (EngineData(env)->IncrementalResetInProgress && !join->initialize) {
        return;
    }
    if (join->firstJoin || join->leftMemory->count > 0) {
        NetworkAssertRight(env, match, join, NETWORK_ASSERT);
    }
}
