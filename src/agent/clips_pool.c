/* SPDX-License-Identifier: Apache-2.0 */
/* Memory of the engine's pools, and multifields, which it takes and gives back most. */
#include "agent/clips_engine.h"

void *gm2(void *env, size_t bytes)
{
    bytes = bytes < sizeof(void *) ? sizeof(void *) : bytes;
    return bytes < MEM_TABLE_SIZE ? clips_engine_take(env, bytes) : genalloc(env, bytes);
}

int rm(void *env, void *memory, size_t bytes)
{
    clips_engine_assert(env, bytes > 0, "MEMORY", 1);
    bytes = bytes < sizeof(void *) ? sizeof(void *) : bytes;
    if (bytes >= MEM_TABLE_SIZE) {
        return genfree(env, memory, bytes);
    }
    clips_engine_give(env, memory, bytes);
    return 1;
}

static size_t pool_multifield_bytes(long length)
{
    size_t fields = length > 1 ? (size_t)length : 1;
    return sizeof(struct multifield) + (fields - 1) * sizeof(struct field);
}

void *CreateMultifield2(void *env, long length)
{
    struct multifield *made = gm2(env, pool_multifield_bytes(length));
    made->multifieldLength = length;
    made->busyCount = 0;
    made->next = NULL;
    return made;
}

void ReturnMultifield(void *env, struct multifield *fields)
{
    if (fields) {
        rm(env, fields, pool_multifield_bytes(fields->multifieldLength));
    }
}

void AddToMultifieldList(void *env, struct multifield *fields)
{
    struct garbageFrame *frame = UtilityData(env)->CurrentGarbageFrame;
    fields->next = frame->ListOfMultifields;
    frame->ListOfMultifields = fields;
    frame->dirty = TRUE;
    if (!frame->LastMultifield) {
        frame->LastMultifield = fields;
    }
}

void *EnvCreateMultifield(void *env, long length)
{
    struct multifield *made = CreateMultifield2(env, length);
    AddToMultifieldList(env, made);
    return made;
}

/* Those of the frame that nothing uses go. */
void FlushMultifields(void *env)
{
    struct garbageFrame *frame = UtilityData(env)->CurrentGarbageFrame;
    struct multifield **at = &frame->ListOfMultifields, *last = NULL;
    while (*at) {
        struct multifield *fields = *at;
        if (fields->busyCount == 0) {
            *at = fields->next;
            ReturnMultifield(env, fields);
        } else {
            last = fields;
            at = &fields->next;
        }
    }
    frame->LastMultifield = last;
}
