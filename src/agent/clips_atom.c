/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Atoms: symbols and numbers, of which the engine has each once.  An atom that nothing uses is
 * ephemeral: it stands in the list of the garbage frame that it was made in, and goes with it if
 * nothing has used it by then.
 */
#include "agent/clips_engine.h"

/* Powers of two.  With fewer, -0.0 and 0.0, which are equal, would be in one list, and one atom. */
enum { FLOAT_PLACES_LEAST = 256, FLOAT_PLACES_MOST = 8192 };

/* Every hash table begins its entries like that. */
typedef struct genericHashNode atom;

unsigned long HashSymbol(const char *word, unsigned long range)
{
    unsigned long tally = 0;
    for (const signed char *c = (const signed char *)word; *c; c++) {
        tally = tally * 127 + (unsigned long)*c;
    }
    return range == 0 ? tally : tally % range;
}

/* The bytes of a number as the engine adds them up, all at once. */
static inline unsigned long atom_tally(double number)
{
    static const unsigned long weights[sizeof number] = {
        532875860165503ul, 4195872914689ul, 33038369407ul, 260144641, 2048383, 16129, 127, 1};
    signed char bytes[sizeof number];
    memcpy(bytes, &number, sizeof number);
    unsigned long tally = 0;
    for (size_t i = 0; i < sizeof number; i++) {
        tally += weights[i] * (unsigned long)bytes[i];
    }
    return tally;
}

unsigned long HashFloat(double number, unsigned long range)
{
    unsigned long tally = atom_tally(number);
    return range == 0 ? tally : tally % range;
}

static inline struct ephemeron *atom_mark(void *env, atom *a, struct ephemeron *list)
{
    struct ephemeron *mark = clips_engine_take(env, sizeof *mark);
    a->markedEphemeral = TRUE;
    mark->associatedValue = a;
    mark->next = list;
    return mark;
}

/* What every new atom begins with. */
static inline void atom_begin(atom *a, unsigned long bucket)
{
    a->next = NULL;
    a->count = 0;
    a->permanent = FALSE;
    a->bucket = (unsigned int)bucket & 0x1FFFFFFF;
}

/*
 * The engine has 8191 lists of floats, so that each of the hundred new ones of a step reads memory
 * that nothing else does.  A mind begins with few lists, and has more when it has more floats.
 */
static inline uint32_t atom_places(const struct mind *m)
{
    return m ? m->float_places : FLOAT_PLACES_MOST;
}

static inline struct floatHashNode **atom_float_list(void *env, unsigned long bucket,
                                                     uint32_t places)
{
    return &SymbolData(env)->FloatTable[bucket & (places - 1)];
}

static void atom_spread_floats(void *env, struct mind *m, uint32_t places)
{
    struct floatHashNode **table = SymbolData(env)->FloatTable, *all = NULL, *next;
    for (size_t i = 0; i < FLOAT_HASH_SIZE; i++) {
        for (struct floatHashNode *f = table[i]; f; f = next) {
            next = f->next;
            f->next = all;
            all = f;
        }
        table[i] = NULL;
    }
    m->floats = 0;
    m->float_places = places;
    for (struct floatHashNode *f = all; f; f = next) {
        struct floatHashNode **list = atom_float_list(env, f->bucket, places);
        next = f->next;
        f->next = *list;
        *list = f;
        m->floats++;
    }
}

void clips_atom_install(struct mind *m)
{
    atom_spread_floats(m->env, m, FLOAT_PLACES_LEAST);
}

/* Once for every float more. */
static inline void atom_count_float(void *env, struct mind *m)
{
    if (m && ++m->floats > m->float_places && m->float_places < FLOAT_PLACES_MOST) {
        atom_spread_floats(env, m, 2 * m->float_places);
    }
}

void *EnvAddDouble(void *env, double number)
{
    struct mind *m = clips_engine_mind(env);
    unsigned long bucket = atom_tally(number) % FLOAT_HASH_SIZE;
    struct floatHashNode **end = atom_float_list(env, bucket, atom_places(m));
    for (; *end; end = &(*end)->next) {
        if ((*end)->contents == number) {
            return *end;
        }
    }
    struct garbageFrame *frame = UtilityData(env)->CurrentGarbageFrame;
    struct floatHashNode *made = clips_engine_take(env, sizeof *made);
    *end = made;
    atom_begin((atom *)made, bucket);
    made->contents = number;
    frame->ephemeralFloatList = atom_mark(env, (atom *)made, frame->ephemeralFloatList);
    frame->dirty = TRUE;
    atom_count_float(env, m);
    return made;
}

void *EnvAddLong(void *env, long long number)
{
    unsigned size = number < 0 ? 0u - (unsigned)number : (unsigned)number;
    unsigned long bucket = size % INTEGER_HASH_SIZE;
    struct integerHashNode **end = &SymbolData(env)->IntegerTable[bucket];
    for (; *end; end = &(*end)->next) {
        if ((*end)->contents == number) {
            return *end;
        }
    }
    struct garbageFrame *frame = UtilityData(env)->CurrentGarbageFrame;
    struct integerHashNode *made = clips_engine_take(env, sizeof *made);
    *end = made;
    atom_begin((atom *)made, bucket);
    made->contents = number;
    frame->ephemeralIntegerList = atom_mark(env, (atom *)made, frame->ephemeralIntegerList);
    frame->dirty = TRUE;
    return made;
}

/* One user less; the last one leaves it to the frame that it is in. */
static inline void atom_release(void *env, atom *a, size_t list)
{
    clips_engine_assert(env, a->count > 0, "SYMBOL", 5);
    if (--a->count > 0 || a->markedEphemeral) {
        return;
    }
    struct garbageFrame *frame = UtilityData(env)->CurrentGarbageFrame;
    struct ephemeron **first = (struct ephemeron **)((char *)frame + list);
    *first = atom_mark(env, a, *first);
    frame->dirty = TRUE;
}

void DecrementSymbolCount(void *env, struct symbolHashNode *symbol)
{
    atom_release(env, (atom *)symbol, offsetof(struct garbageFrame, ephemeralSymbolList));
}

void DecrementFloatCount(void *env, struct floatHashNode *number)
{
    atom_release(env, (atom *)number, offsetof(struct garbageFrame, ephemeralFloatList));
}

void DecrementIntegerCount(void *env, struct integerHashNode *number)
{
    atom_release(env, (atom *)number, offsetof(struct garbageFrame, ephemeralIntegerList));
}

/* Takes it out of its list. */
static inline void atom_unlink(void *env, const atom *a, atom **at)
{
    while (*at != a) {
        clips_engine_assert(env, *at != NULL, "SYMBOL", 11);
        at = &(*at)->next;
    }
    *at = a->next;
}

/*
 * Ends the list of a frame: what is used is ephemeral no more, and what is not goes.  The mask says
 * which bits of an atom's bucket tell its list.
 *
 * @return how many have gone
 */
static inline uint32_t atom_sweep(void *env, struct ephemeron **list, atom **table, uint32_t mask,
                                  size_t bytes, void (*end)(void *env, atom *a))
{
    struct ephemeron *next;
    uint32_t gone = 0;
    for (struct ephemeron *mark = *list; mark; mark = next) {
        atom *a = mark->associatedValue;
        next = mark->next;
        if (a->count > 0) {
            a->markedEphemeral = FALSE;
        } else {
            atom_unlink(env, a, &table[a->bucket & mask]);
            if (end) {
                end(env, a);
            }
            clips_engine_give(env, a, bytes);
            gone++;
        }
        clips_engine_give(env, mark, sizeof *mark);
    }
    *list = NULL;
    return gone;
}

static void atom_end_symbol(void *env, atom *a)
{
    const char *contents = ((struct symbolHashNode *)a)->contents;
    rm(env, (char *)(uintptr_t)contents, strlen(contents) + 1);
}

static void atom_end_bits(void *env, atom *a)
{
    const struct bitMapHashNode *bits = (struct bitMapHashNode *)a;
    rm(env, (char *)(uintptr_t)bits->contents, bits->size);
}

static void atom_end_address(void *env, atom *a)
{
    const struct externalAddressHashNode *address = (struct externalAddressHashNode *)a;
    const struct externalAddressType *type =
        EvaluationData(env)->ExternalAddressTypes[address->type];
    if (type && type->discardFunction) {
        type->discardFunction(env, address->externalAddress);
    }
}

static void atom_sweep_floats(void *env, struct ephemeron **list)
{
    struct mind *m = clips_engine_mind(env);
    uint32_t gone = atom_sweep(env, list, (atom **)SymbolData(env)->FloatTable, atom_places(m) - 1,
                               sizeof(struct floatHashNode), NULL);
    if (m) {
        m->floats -= gone;
    }
}

void RemoveEphemeralAtoms(void *env)
{
    struct garbageFrame *frame = UtilityData(env)->CurrentGarbageFrame;
    const struct symbolData *tables = SymbolData(env);
    if (!frame->dirty) {
        return;
    }
    atom_sweep_floats(env, &frame->ephemeralFloatList);
    atom_sweep(env, &frame->ephemeralSymbolList, (atom **)tables->SymbolTable, UINT32_MAX,
               sizeof(struct symbolHashNode), atom_end_symbol);
    atom_sweep(env, &frame->ephemeralIntegerList, (atom **)tables->IntegerTable, UINT32_MAX,
               sizeof(struct integerHashNode), NULL);
    atom_sweep(env, &frame->ephemeralBitMapList, (atom **)tables->BitMapTable, UINT32_MAX,
               sizeof(struct bitMapHashNode), atom_end_bits);
    atom_sweep(env, &frame->ephemeralExternalAddressList, (atom **)tables->ExternalAddressTable,
               UINT32_MAX, sizeof(struct externalAddressHashNode), atom_end_address);
}

void MultifieldInstall(void *env, struct multifield *fields)
{
    if (!fields) {
        return;
    }
    fields->busyCount++;
    for (long i = 0; i < fields->multifieldLength; i++) {
        AtomInstall(env, fields->theFields[i].type, fields->theFields[i].value);
    }
}

void MultifieldDeinstall(void *env, struct multifield *fields)
{
    if (!fields) {
        return;
    }
    fields->busyCount--;
    for (long i = 0; i < fields->multifieldLength; i++) {
        AtomDeinstall(env, fields->theFields[i].type, fields->theFields[i].value);
    }
}

/* What the engine knows of a type of its own, or NULL. */
static const struct entityRecord *atom_entity(void *env, int type)
{
    return type < MAXIMUM_PRIMITIVES ? EvaluationData(env)->PrimitivesArray[type] : NULL;
}

static void atom_install_other(void *env, int type, void *value)
{
    const struct entityRecord *entity = atom_entity(env, type);
    if (!entity) {
        return;
    }
    if (entity->bitMap) {
        ((struct bitMapHashNode *)value)->count++;
    } else if (entity->incrementBusyCount) {
        entity->incrementBusyCount(env, value);
    }
}

static void atom_deinstall_other(void *env, int type, void *value)
{
    const struct entityRecord *entity = atom_entity(env, type);
    if (!entity) {
        return;
    }
    if (entity->bitMap) {
        DecrementBitMapCount(env, value);
    } else if (entity->decrementBusyCount) {
        entity->decrementBusyCount(env, value);
    }
}

void AtomInstall(void *env, int type, void *value)
{
    switch (type) {
    case SYMBOL:
    case STRING:
    case INSTANCE_NAME:
    case GBL_VARIABLE:
    case FLOAT:
    case INTEGER:
    case EXTERNAL_ADDRESS: ((atom *)value)->count++; break;
    case MULTIFIELD: MultifieldInstall(env, value); break;
    default: atom_install_other(env, type, value); break;
    }
}

void AtomDeinstall(void *env, int type, void *value)
{
    switch (type) {
    case SYMBOL:
    case STRING:
    case INSTANCE_NAME:
    case GBL_VARIABLE: DecrementSymbolCount(env, value); break;
    case FLOAT: DecrementFloatCount(env, value); break;
    case INTEGER: DecrementIntegerCount(env, value); break;
    case EXTERNAL_ADDRESS: DecrementExternalAddressCount(env, value); break;
    case MULTIFIELD: MultifieldDeinstall(env, value); break;
    default: atom_deinstall_other(env, type, value); break;
    }
}
