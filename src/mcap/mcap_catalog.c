/* SPDX-License-Identifier: Apache-2.0 */
/* What a recording says of itself, kept in memory of fixed size. */
#include "mcap/mcap_reader.h"

#include <string.h>

void mcap_catalog_reset(struct mcap_reader *r)
{
    memset(r->channel_ids, 0xff, READER_IDS * sizeof *r->channel_ids);
    memset(r->schema_ids, 0xff, READER_IDS * sizeof *r->schema_ids);
    r->text.len = 0;
    r->text.full = false;
    r->schema_count = r->channel_count = r->pair_count = 0;
    r->file_count = r->table_count = r->chunk_count = 0;
    r->full = r->compressed = r->loose = r->counted = false;
    r->broken = 0;
}

/* Keeps a text, with a zero after it. */
static const char *text_keep(struct mcap_reader *r, struct mcap_in *in)
{
    struct mcap_in text = mcap_in_part(in, 4);
    size_t begins = r->text.len;
    if (text.cut) {
        return "";
    }
    mcap_out_bytes(&r->text, text.at, text.left);
    mcap_out_number(&r->text, 0, 1);
    r->full = r->full || r->text.full;
    return r->text.full ? "" : (const char *)r->text.at + begins;
}

/* Keeps a map of texts.  @return where its pairs begin, or NULL: it is malformed, or too large */
static const struct mcap_pair *pairs_keep(struct mcap_reader *r, struct mcap_in *in, size_t *count)
{
    struct mcap_in map = mcap_in_part(in, 4);
    uint32_t begins = r->pair_count;
    while (map.left > 0 && !map.cut && r->pair_count < READER_PAIRS_MAX) {
        struct mcap_pair *p = &r->pairs[r->pair_count++];
        p->key = text_keep(r, &map);
        p->value = text_keep(r, &map);
    }
    r->full = r->full || (map.left > 0 && !map.cut);
    *count = r->pair_count - begins;
    in->cut = in->cut || map.cut;
    return in->cut ? NULL : &r->pairs[begins];
}

bool mcap_catalog_schema(struct mcap_reader *r, struct mcap_in in)
{
    uint32_t id = (uint32_t)mcap_in_number(&in, 2);
    if (in.cut || r->schema_ids[id] != MU_NONE) {
        return !in.cut;
    }
    if (r->schema_count == MU_RECORD_CHANNELS_MAX) {
        r->full = true;
        return true;
    }
    struct reader_schema *s = &r->schemas[r->schema_count];
    s->name = text_keep(r, &in);
    s->encoding = text_keep(r, &in);
    struct mcap_in bytes = mcap_in_part(&in, 4);
    s->bytes = r->text.at + r->text.len;
    s->size = bytes.left;
    mcap_out_bytes(&r->text, bytes.at, bytes.left);
    r->full = r->full || r->text.full;
    if (bytes.cut || r->text.full) {
        return !bytes.cut;
    }
    r->schema_ids[id] = r->schema_count++;
    return true;
}

bool mcap_catalog_channel(struct mcap_reader *r, struct mcap_in in)
{
    uint32_t id = (uint32_t)mcap_in_number(&in, 2);
    uint32_t schema = (uint32_t)mcap_in_number(&in, 2);
    if (in.cut || r->channel_ids[id] != MU_NONE) {
        return !in.cut;
    }
    if (r->channel_count == MU_RECORD_CHANNELS_MAX) {
        r->full = true;
        return true;
    }
    struct mcap_channel c = {.schema_name = "", .schema_encoding = "", .schema = ""};
    if (r->schema_ids[schema] != MU_NONE) {
        const struct reader_schema *s = &r->schemas[r->schema_ids[schema]];
        c.schema_name = s->name;
        c.schema_encoding = s->encoding;
        c.schema = s->bytes;
        c.schema_size = s->size;
    }
    c.topic = text_keep(r, &in);
    c.encoding = text_keep(r, &in);
    c.pairs = pairs_keep(r, &in, &c.pairs_count);
    if (in.cut) {
        return false;
    }
    r->picked[r->channel_count] = true;
    r->channels[r->channel_count] = c;
    r->channel_ids[id] = r->channel_count++;
    return true;
}

bool mcap_catalog_table(struct mcap_reader *r, struct mcap_in in)
{
    if (r->table_count == MU_RECORD_FILES_MAX) {
        r->full = true;
        return true;
    }
    struct mcap_table *t = &r->tables[r->table_count];
    t->name = text_keep(r, &in);
    t->pairs = pairs_keep(r, &in, &t->count);
    r->table_count += !in.cut;
    return !in.cut;
}

bool mcap_catalog_statistics(struct mcap_reader *r, struct mcap_in in)
{
    r->said_messages = mcap_in_number(&in, 8);
    (void)mcap_in_number(&in, 2); /* schemas */
    r->said_channels = mcap_in_number(&in, 4);
    (void)mcap_in_bytes(&in, 4 + 4 + 4 + 8 + 8);
    r->counted = !in.cut;
    struct mcap_in map = mcap_in_part(&in, 4);
    while (map.left > 0 && !map.cut) {
        uint32_t id = (uint32_t)mcap_in_number(&map, 2);
        uint64_t messages = mcap_in_number(&map, 8);
        if (r->channel_ids[id] != MU_NONE) {
            r->channels[r->channel_ids[id]].messages = messages;
            r->loose = r->loose || (messages > 0 && r->chunk_count == 0);
        }
    }
    return !in.cut && !map.cut;
}

bool mcap_catalog_file(struct mcap_reader *r, struct mcap_in in, uint64_t at, uint64_t length)
{
    if (r->file_count == MU_RECORD_FILES_MAX) {
        r->full = true;
        return true;
    }
    struct reader_file *f = &r->files[r->file_count];
    size_t before = in.left;
    (void)mcap_in_bytes(&in, 16); /* two times */
    f->shown.name = text_keep(r, &in);
    f->shown.media_type = text_keep(r, &in);
    f->shown.size = mcap_in_number(&in, 8);
    f->at = at;
    f->length = length;
    uint64_t named = before - in.left;
    bool fits = !in.cut && named + 4 <= length && f->shown.size == length - named - 4;
    r->file_count += fits;
    return fits;
}

bool mcap_catalog_chunk(struct mcap_reader *r, const struct reader_chunk *chunk)
{
    if (r->chunk_count == MU_RECORD_CHUNKS_MAX) {
        r->full = true;
        return true;
    }
    r->chunks[r->chunk_count++] = *chunk;
    return true;
}

uint32_t mcap_reader_channels(const struct mcap_reader *r)
{
    return r->channel_count;
}

const struct mcap_channel *mcap_reader_channel(const struct mcap_reader *r, uint32_t index)
{
    MU_ASSERT(index < r->channel_count);
    return &r->channels[index];
}

uint32_t mcap_reader_find(const struct mcap_reader *r, const char *topic)
{
    for (uint32_t i = 0; i < r->channel_count; i++) {
        if (strcmp(r->channels[i].topic, topic) == 0) {
            return i;
        }
    }
    return MU_NONE;
}

const struct mcap_attachment *mcap_reader_attachment(const struct mcap_reader *r, uint32_t index)
{
    return index < r->file_count ? &r->files[index].shown : NULL;
}

uint32_t mcap_reader_attachment_find(const struct mcap_reader *r, const char *name)
{
    for (uint32_t i = 0; i < r->file_count; i++) {
        if (strcmp(r->files[i].shown.name, name) == 0) {
            return i;
        }
    }
    return MU_NONE;
}

const struct mcap_table *mcap_reader_table(const struct mcap_reader *r, uint32_t index)
{
    return index < r->table_count ? &r->tables[index] : NULL;
}

const char *mcap_reader_value(const struct mcap_reader *r, const char *table, const char *key)
{
    for (uint32_t i = 0; i < r->table_count; i++) {
        const struct mcap_table *t = &r->tables[i];
        for (size_t p = 0; p < t->count && strcmp(t->name, table) == 0; p++) {
            if (strcmp(t->pairs[p].key, key) == 0) {
                return t->pairs[p].value;
            }
        }
    }
    return NULL;
}
