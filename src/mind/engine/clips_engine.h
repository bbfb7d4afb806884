/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file clips_engine.h
 * Functions of the engine that are ours.
 *
 * They stand in the files that include this one, under the names that CLIPS has for them;
 * ENGINE_OWN in the Makefile lists them, and the linker takes ours in all of the engine.  Each does
 * what the engine's does, as tests/rules/engine compares, and counts besides what it costs:
 * clips_guard.c.
 * Those of clips_heap.c are ours so that a mind can give back all of its memory in any state.
 */
#ifndef MUSTER_AGENT_CLIPS_ENGINE_H
#define MUSTER_AGENT_CLIPS_ENGINE_H

#include "mind/clips_mind.h"

/* Whose environment it is; NULL: it is being made. */
static inline struct mind *clips_engine_mind(void *env)
{
    return ((struct environmentData *)env)->context;
}

/* Takes a structure of the engine's from the pool of that size. */
static inline void *clips_engine_take(void *env, size_t bytes)
{
    struct memoryPtr **pool = &MemoryData(env)->MemoryTable[bytes];
    struct memoryPtr *first = *pool;
    if (!first) {
        return genalloc(env, bytes);
    }
    *pool = first->next;
    return first;
}

/* Gives it back. */
static inline void clips_engine_give(void *env, void *structure, size_t bytes)
{
    struct memoryPtr **pool = &MemoryData(env)->MemoryTable[bytes];
    struct memoryPtr *first = structure;
    first->next = *pool;
    *pool = first;
}

/* What the engine calls a system error: it is not to be trusted any more. */
static inline void clips_engine_assert(void *env, bool holds, const char *module, int number)
{
    if (__builtin_expect(!holds, 0)) {
        SystemError(env, module, number);
        EnvExitRouter(env, EXIT_FAILURE);
    }
}

#endif
