/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The facts that there are, by content: so that none is there twice.  The engine's own table has
 * 16231 places, so that every new fact reads memory that nothing else does; this one has as many as
 * a robot needs.  Which place a fact has is seen by nobody.
 */
#include "agent/clips_engine.h"

enum { FACTSET_LEAST = 128 }; /* places: a power of two */

static struct factHashEntry **factset_make(void *env, unsigned long places)
{
    struct factHashEntry **made = gm3(env, places * sizeof *made);
    memset(made, 0, places * sizeof *made);
    return made;
}

void InitializeFactHashTable(void *env)
{
    FactData(env)->FactHashTable = factset_make(env, FACTSET_LEAST);
    FactData(env)->FactHashTableSize = FACTSET_LEAST;
}

static inline struct factHashEntry **factset_place(void *env, unsigned long hash)
{
    const struct factsData *facts = FactData(env);
    return &facts->FactHashTable[hash & (facts->FactHashTableSize - 1)];
}

/* Moves what is there to a table of another size. */
static void factset_resize(void *env, unsigned long places)
{
    struct factsData *facts = FactData(env);
    struct factHashEntry **before = facts->FactHashTable, *next;
    unsigned long places_before = facts->FactHashTableSize;
    facts->FactHashTable = factset_make(env, places);
    facts->FactHashTableSize = places;
    for (unsigned long i = 0; i < places_before; i++) {
        for (struct factHashEntry *e = before[i]; e; e = next) {
            struct factHashEntry **place = factset_place(env, e->theFact->hashValue);
            next = e->next;
            e->next = *place;
            *place = e;
        }
    }
    rm3(env, before, places_before * sizeof(struct factHashEntry *));
}

static inline uint64_t factset_mix(uint64_t hash, uint64_t with)
{
    hash = (hash ^ with) * 0x9E3779B97F4A7C15u; /* 2^64 / golden ratio */
    return hash ^ hash >> 32;
}

/* Atoms are there once, so that what is equal has the same pointers. */
static uint64_t factset_hash_fields(uint64_t hash, const struct multifield *fields)
{
    for (long i = 0; i < fields->multifieldLength; i++) {
        const struct field *f = &fields->theFields[i];
        hash = f->type == MULTIFIELD ? factset_hash_fields(hash, f->value)
                                     : factset_mix(hash, (uint64_t)(uintptr_t)f->value);
    }
    return hash;
}

unsigned long HashFact(struct fact *fact)
{
    uint64_t start = (uint64_t)(uintptr_t)fact->whichDeftemplate;
    fact->hashValue = factset_hash_fields(start, &fact->theProposition);
    return fact->hashValue;
}

/* The fact that is equal to one, or NULL. */
static struct fact *factset_find(void *env, const struct fact *fact)
{
    for (struct factHashEntry *e = *factset_place(env, fact->hashValue); e; e = e->next) {
        struct fact *other = e->theFact;
        if (other->hashValue == fact->hashValue &&
            other->whichDeftemplate == fact->whichDeftemplate &&
            MultifieldsEqual((struct multifield *)(uintptr_t)&fact->theProposition,
                             &other->theProposition)) {
            return other;
        }
    }
    return NULL;
}

void AddHashedFact(void *env, struct fact *fact, unsigned long hash)
{
    const struct factsData *facts = FactData(env);
    if (facts->NumberOfFacts > facts->FactHashTableSize) {
        factset_resize(env, 2 * facts->FactHashTableSize);
    }
    struct factHashEntry *entry = clips_engine_take(env, sizeof *entry);
    struct factHashEntry **place = factset_place(env, hash);
    entry->theFact = fact;
    entry->next = *place;
    *place = entry;
}

/* Called before the fact is counted out. */
intBool RemoveHashedFact(void *env, struct fact *fact)
{
    struct factHashEntry **at = factset_place(env, fact->hashValue);
    while (*at && (*at)->theFact != fact) {
        at = &(*at)->next;
    }
    struct factHashEntry *entry = *at;
    if (!entry) {
        return FALSE;
    }
    *at = entry->next;
    clips_engine_give(env, entry, sizeof *entry);
    if (FactData(env)->NumberOfFacts == 1 && FactData(env)->FactHashTableSize > FACTSET_LEAST) {
        factset_resize(env, FACTSET_LEAST);
    }
    return TRUE;
}

intBool FactWillBeAsserted(void *env, void *fact)
{
    HashFact(fact);
    return FactData(env)->FactDuplication || !factset_find(env, fact);
}

unsigned long HandleFactDuplication(void *env, void *fact, intBool *duplicate)
{
    unsigned long hash = HashFact(fact);
    struct fact *same = FactData(env)->FactDuplication ? NULL : factset_find(env, fact);
    *duplicate = same != NULL;
    if (!same) {
        return hash;
    }
    ReturnFact(env, fact);
    AddLogicalDependencies(env, (struct patternEntity *)same, TRUE);
    return 0;
}
