/* SPDX-License-Identifier: Apache-2.0 */
/* Chunks in memory, and their messages in order of time. */
#include "mcap/mcap_reader.h"

#include "core/sort.h"

#include <zlib.h>

/* Its channel's messages are counted, or it is passed over: its channel is unknown. */
static void message_take(struct mcap_reader *r, struct reader_slot *slot, struct mcap_in in,
                         bool learns)
{
    const uint8_t *content = in.at;
    size_t size = in.left;
    uint32_t id = (uint32_t)mcap_in_number(&in, 2);
    (void)mcap_in_number(&in, 4);
    uint64_t log_ns = mcap_in_number(&in, 8);
    (void)mcap_in_number(&in, 8);
    if (in.cut || r->channel_ids[id] == MU_NONE) {
        return;
    }
    r->channels[r->channel_ids[id]].messages += learns;
    slot->entries[slot->count++] = (struct reader_entry){
        .log_ns = log_ns, .at = (uint32_t)(content - slot->bytes), .size = (uint32_t)size};
}

/* Takes one record out of a chunk.  @return false: there is no whole one */
static bool inner_take(struct mcap_reader *r, struct reader_slot *slot, struct mcap_in *records,
                       bool learns)
{
    enum mcap_op op = (enum mcap_op)mcap_in_number(records, 1);
    struct mcap_in in = mcap_in_part(records, 8);
    if (in.cut || records->cut) {
        return false;
    }
    switch ((int)op) {
    case MCAP_SCHEMA: return !learns || mcap_catalog_schema(r, in);
    case MCAP_CHANNEL: return !learns || mcap_catalog_channel(r, in);
    case MCAP_MESSAGE: message_take(r, slot, in, learns); return true;
    default: return true;
    }
}

static int entry_compare(const void *one, const void *other, const void *context)
{
    const struct reader_entry *a = one;
    const struct reader_entry *b = other;
    (void)context;
    if (a->log_ns != b->log_ns) {
        return a->log_ns < b->log_ns ? -1 : 1;
    }
    return (a->at > b->at) - (a->at < b->at);
}

/* A chunk that is read again is counted once. */
static void chunk_break(struct mcap_reader *r, struct reader_chunk *chunk)
{
    r->broken += !chunk->broken;
    chunk->broken = true;
}

/* Finds the records of a chunk in the slot.  @return false: they are not there, or damaged */
static bool records_find(struct mcap_reader *r, const struct reader_slot *slot,
                         struct reader_chunk *chunk, struct mcap_in *records)
{
    struct mcap_in in = {.at = slot->bytes, .left = (size_t)chunk->length};
    bool is_chunk = mcap_in_number(&in, 1) == MCAP_CHUNK;
    (void)mcap_in_bytes(&in, 8 + 8 + 8);
    uint64_t size = mcap_in_number(&in, 8);
    uint32_t crc = (uint32_t)mcap_in_number(&in, 4);
    struct mcap_in compression = mcap_in_part(&in, 4);
    uint64_t stored = mcap_in_number(&in, 8);
    if (!is_chunk || in.cut) {
        return false;
    }
    if (compression.left > 0) {
        r->compressed = true;
        return false;
    }
    *records = in;
    if (chunk->cut) {
        return true;
    }
    records->left = stored == size && stored <= in.left ? (size_t)stored : 0;
    bool right = crc == 0 || crc == (uint32_t)crc32_z(0, records->at, records->left);
    if (!right) {
        chunk_break(r, chunk);
    }
    return stored == records->left && (right || r->believes);
}

/* @return MU_OK: the chunk's bytes are in the slot */
static mu_result chunk_bytes(struct mcap_reader *r, struct reader_slot *slot,
                             const struct reader_chunk *chunk)
{
    return chunk->length > READER_CHUNK_MAX
               ? MU_MALFORMED
               : mcap_reader_bytes(r, chunk->at, slot->bytes, (size_t)chunk->length);
}

mu_result mcap_chunk_load(struct mcap_reader *r, struct reader_slot *slot,
                          struct reader_chunk *chunk, bool learns)
{
    struct mcap_in records;
    slot->count = slot->next = 0;
    slot->at = chunk->at;
    mu_result got = chunk_bytes(r, slot, chunk);
    if (got == MU_OK && !records_find(r, slot, chunk, &records)) {
        got = MU_MALFORMED;
    }
    if (got != MU_OK) {
        if (got == MU_MALFORMED) {
            chunk_break(r, chunk);
        }
        return got;
    }
    bool good = true;
    while (records.left > 0 && good) {
        good = inner_take(r, slot, &records, learns);
    }
    if (!good && !chunk->cut) { /* what stands before the damage is read */
        chunk_break(r, chunk);
    }
    mu_sort(slot->entries, slot->count, sizeof *slot->entries, entry_compare, NULL);
    return MU_OK;
}

void mcap_reader_pick(struct mcap_reader *r, uint32_t channel, bool picked)
{
    MU_ASSERT(channel < r->channel_count);
    r->picked[channel] = picked;
}

void mcap_reader_seek(struct mcap_reader *r, uint64_t from_ns, uint64_t until_ns)
{
    r->from_ns = from_ns;
    r->until_ns = until_ns;
    r->next_chunk = 0;
    for (size_t i = 0; i < READER_SLOTS; i++) {
        r->slots[i].count = r->slots[i].next = 0;
    }
}

/* The slot with the next message; NULL: all are empty. */
static struct reader_slot *slot_first(struct mcap_reader *r)
{
    struct reader_slot *first = NULL;
    for (size_t i = 0; i < READER_SLOTS; i++) {
        struct reader_slot *s = &r->slots[i];
        if (s->next == s->count) {
            continue;
        }
        uint64_t time_ns = s->entries[s->next].log_ns;
        uint64_t best_ns = first ? first->entries[first->next].log_ns : 0;
        if (!first || time_ns < best_ns || (time_ns == best_ns && s->at < first->at)) {
            first = s;
        }
    }
    return first;
}

static struct reader_slot *slot_free(struct mcap_reader *r)
{
    for (size_t i = 0; i < READER_SLOTS; i++) {
        if (r->slots[i].next == r->slots[i].count) {
            return &r->slots[i];
        }
    }
    return NULL;
}

/* Loads the chunks that may have a message before the first one in memory.  With all slots taken by
 * chunks that overlap, order is kept among these.  @return MU_OK or MU_FAULT_OS */
static mu_result chunks_load(struct mcap_reader *r)
{
    for (; r->next_chunk < r->chunk_count; r->next_chunk++) {
        struct reader_chunk *chunk = &r->chunks[r->next_chunk];
        const struct reader_slot *first = slot_first(r);
        struct reader_slot *room = slot_free(r);
        bool later = first && first->entries[first->next].log_ns < chunk->first_ns;
        if (later || !room || chunk->first_ns > r->until_ns) {
            break;
        }
        if (chunk->last_ns >= r->from_ns) {
            MU_TRY(mcap_chunk_load(r, room, chunk, false));
        }
    }
    return MU_OK;
}

static void message_fill(const struct mcap_reader *r, const struct reader_slot *slot,
                         const struct reader_entry *e, struct mcap_message *m)
{
    struct mcap_in in = {.at = slot->bytes + e->at, .left = e->size};
    m->channel = r->channel_ids[mcap_in_number(&in, 2)];
    m->sequence = (uint32_t)mcap_in_number(&in, 4);
    m->log_ns = mcap_in_number(&in, 8);
    m->publish_ns = mcap_in_number(&in, 8);
    m->data = in.at;
    m->size = in.left;
}

mu_result mcap_reader_next(struct mcap_reader *r, struct mcap_message *message)
{
    for (;;) {
        MU_TRY(chunks_load(r));
        struct reader_slot *slot = slot_first(r);
        if (!slot) {
            return MU_DONE;
        }
        const struct reader_entry *e = &slot->entries[slot->next];
        if (e->log_ns > r->until_ns) {
            return MU_DONE;
        }
        slot->next++;
        message_fill(r, slot, e, message);
        if (e->log_ns >= r->from_ns && r->picked[message->channel]) {
            return MU_OK;
        }
    }
}
