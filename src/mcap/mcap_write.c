/* SPDX-License-Identifier: Apache-2.0 */
#include "core/clock.h"
#include "core/text_file.h"
#include "mcap/mcap_writer.h"
#include "muster/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/uio.h>
#include <unistd.h>
#include <zlib.h>

static const uint64_t CHUNK_NS = 1000000000;

/* Where a chunk's records begin in the buffer of the chunk. */
enum { RECORDS_AT = MCAP_HEAD_BYTES + MCAP_CHUNK_BYTES };

static void room_take(struct mcap_out *o, size_t size)
{
    *o = (struct mcap_out){.at = mu_startup_alloc(size), .size = size};
}

struct mcap_writer *mcap_writer_create(void)
{
    struct mcap_writer *w = mu_startup_alloc(sizeof *w);
    w->fd = -1;
    room_take(&w->chunk,
              RECORDS_AT + WRITER_CHUNK_BYTES + MU_RECORD_TYPES_BYTES + MU_RECORD_MESSAGE_MAX);
    room_take(&w->index, WRITER_CHUNK_MESSAGES * MCAP_INDEX_ENTRY_BYTES +
                             MU_RECORD_CHANNELS_MAX * (MCAP_HEAD_BYTES + 2 + 4));
    room_take(&w->schema_records, MU_RECORD_TYPES_BYTES / 2);
    room_take(&w->channel_records, MU_RECORD_TYPES_BYTES / 2);
    w->entries = mu_startup_array(WRITER_CHUNK_MESSAGES, sizeof *w->entries);
    return w;
}

/* --- chunks ----------------------------------------------------------------------------------- */

static void span_add(struct writer_span *s, uint64_t time_ns)
{
    s->first_ns = !s->any || time_ns < s->first_ns ? time_ns : s->first_ns;
    s->last_ns = !s->any || time_ns > s->last_ns ? time_ns : s->last_ns;
    s->any = true;
}

static void chunk_begin(struct mcap_writer *w)
{
    w->chunk.len = RECORDS_AT;
    w->chunk.full = false;
    w->index.len = 0;
    w->entry_count = 0;
    w->chunk_span = (struct writer_span){0};
}

/* What stands before the records is known when they are all there. */
static void chunk_head(struct mcap_writer *w)
{
    size_t size = w->chunk.len - RECORDS_AT;
    uLong crc = crc32_z(0, w->chunk.at + RECORDS_AT, size);
    struct mcap_out head = {.at = w->chunk.at, .size = RECORDS_AT};
    mcap_out_number(&head, MCAP_CHUNK, 1);
    mcap_out_number(&head, MCAP_CHUNK_BYTES + size, 8);
    mcap_out_number(&head, w->chunk_span.first_ns, 8);
    mcap_out_number(&head, w->chunk_span.last_ns, 8);
    mcap_out_number(&head, size, 8);
    mcap_out_number(&head, crc, 4);
    mcap_out_text(&head, ""); /* not compressed */
    mcap_out_number(&head, size, 8);
}

static void channel_index(struct mcap_writer *w, uint32_t channel)
{
    struct writer_channel *c = &w->channels[channel];
    size_t record = mcap_out_record(&w->index, MCAP_MESSAGE_INDEX);
    mcap_out_number(&w->index, channel, 2);
    size_t list = mcap_out_begin(&w->index, 4);
    for (int32_t i = c->first; c->entries > 0 && i != WRITER_NONE; i = w->entries[i].next) {
        mcap_out_number(&w->index, w->entries[i].log_ns, 8);
        mcap_out_number(&w->index, w->entries[i].at, 8);
    }
    mcap_out_end(&w->index, list, 4);
    mcap_out_record_end(&w->index, record);
    c->entries = 0;
}

/* Writes the chunk at hand, and begins a new one. */
static void mcap_writer_flush(struct mcap_writer *w)
{
    if (w->chunk.len == RECORDS_AT) {
        return;
    }
    chunk_head(w);
    for (uint32_t i = 0; i < w->channel_count; i++) {
        if (w->channels[i].entries > 0) {
            channel_index(w, i);
        }
    }
    struct iovec pieces[] = {{.iov_base = w->chunk.at, .iov_len = w->chunk.len},
                             {.iov_base = w->index.at, .iov_len = w->index.len}};
    mcap_writer_put_pieces(w, pieces, w->index.len > 0 ? 2 : 1);
    w->chunks++;
    chunk_begin(w);
}

void mcap_writer_look(struct mcap_writer *w, uint64_t now_ns)
{
    if (w->chunk.len > RECORDS_AT && now_ns - w->chunk_began_ns >= CHUNK_NS) {
        mcap_writer_flush(w);
    }
}

/* --- channels --------------------------------------------------------------------------------- */

static void pairs_put(struct mcap_out *o, const struct mcap_pair *pairs, size_t count)
{
    size_t map = mcap_out_begin(o, 4);
    for (size_t i = 0; i < count; i++) {
        mcap_out_text(o, pairs[i].key);
        mcap_out_text(o, pairs[i].value);
    }
    mcap_out_end(o, map, 4);
}

/* The number of a schema that is there already, word for word; 0: it is not. */
static uint32_t schema_find(const struct mcap_writer *w, size_t begins)
{
    enum { BODY_AT = MCAP_HEAD_BYTES + 2 };
    const struct mcap_out *all = &w->schema_records;
    size_t len = all->len - begins;
    uint32_t id = 1;
    for (size_t at = 0; at < begins; id++) {
        struct mcap_in in = {.at = all->at + at + 1, .left = 8};
        size_t other = MCAP_HEAD_BYTES + (size_t)mcap_in_number(&in, 8);
        if (other == len &&
            memcmp(all->at + at + BODY_AT, all->at + begins + BODY_AT, len - BODY_AT) == 0) {
            return id;
        }
        at += other;
    }
    return 0;
}

/* @return the number of the channel's schema; 0: it has none */
static uint32_t schema_put(struct mcap_writer *w, const struct mcap_channel *c)
{
    struct mcap_out *o = &w->schema_records;
    size_t begins = o->len;
    if (c->schema_name[0] == '\0') {
        return 0;
    }
    size_t record = mcap_out_record(o, MCAP_SCHEMA);
    mcap_out_number(o, w->schema_count + 1, 2);
    mcap_out_text(o, c->schema_name);
    mcap_out_text(o, c->schema_encoding);
    mcap_out_number(o, c->schema_size, 4);
    mcap_out_bytes(o, c->schema, c->schema_size);
    mcap_out_record_end(o, record);
    uint32_t there = o->full ? 0 : schema_find(w, begins);
    if (there > 0) {
        o->len = begins;
        return there;
    }
    mcap_out_bytes(&w->chunk, o->at + begins, o->len - begins);
    return ++w->schema_count;
}

static void channel_put(struct mcap_writer *w, const struct mcap_channel *c, uint32_t schema)
{
    struct mcap_out *o = &w->channel_records;
    size_t begins = o->len;
    size_t record = mcap_out_record(o, MCAP_CHANNEL);
    mcap_out_number(o, w->channel_count, 2);
    mcap_out_number(o, schema, 2);
    mcap_out_text(o, c->topic);
    mcap_out_text(o, c->encoding);
    pairs_put(o, c->pairs, c->pairs_count);
    mcap_out_record_end(o, record);
    mcap_out_bytes(&w->chunk, o->at + begins, o->len - begins);
}

mu_result mcap_writer_channel(struct mcap_writer *w, const struct mcap_channel *channel,
                              uint32_t *index)
{
    struct mcap_out before[] = {w->chunk, w->schema_records, w->channel_records};
    uint32_t schemas = w->schema_count;
    if (w->channel_count == MU_RECORD_CHANNELS_MAX) {
        return MU_FULL;
    }
    channel_put(w, channel, schema_put(w, channel));
    if (w->chunk.full || w->schema_records.full || w->channel_records.full) {
        w->chunk = before[0];
        w->schema_records = before[1];
        w->channel_records = before[2];
        w->schema_count = schemas;
        return MU_FULL;
    }
    if (before[0].len == RECORDS_AT) {
        w->chunk_began_ns = mu_clock_ns();
    }
    w->channels[w->channel_count] =
        (struct writer_channel){.first = WRITER_NONE, .last = WRITER_NONE};
    *index = w->channel_count++;
    return MU_OK;
}

/* --- messages --------------------------------------------------------------------------------- */

static void entry_add(struct mcap_writer *w, const struct mcap_message *m)
{
    struct writer_channel *c = &w->channels[m->channel];
    int32_t index = (int32_t)w->entry_count++;
    w->entries[index] = (struct writer_entry){m->log_ns, w->chunk.len - RECORDS_AT, WRITER_NONE};
    if (c->entries == 0) {
        c->first = index;
    } else {
        w->entries[c->last].next = index;
    }
    c->last = index;
    c->entries++;
    c->messages++;
}

mu_result mcap_writer_message(struct mcap_writer *w, const struct mcap_message *m)
{
    MU_ASSERT(m->channel < w->channel_count);
    if (m->size > MU_RECORD_MESSAGE_MAX) {
        w->refused++;
        return MU_FULL;
    }
    uint64_t now_ns = mu_clock_ns();
    w->chunk_began_ns = w->chunk.len == RECORDS_AT ? now_ns : w->chunk_began_ns;
    entry_add(w, m);
    span_add(&w->chunk_span, m->log_ns);
    span_add(&w->span, m->log_ns);
    w->messages++;
    mcap_out_number(&w->chunk, MCAP_MESSAGE, 1);
    mcap_out_number(&w->chunk, MCAP_MESSAGE_BYTES + m->size, 8);
    mcap_out_number(&w->chunk, m->channel, 2);
    mcap_out_number(&w->chunk, m->sequence, 4);
    mcap_out_number(&w->chunk, m->log_ns, 8);
    mcap_out_number(&w->chunk, m->publish_ns, 8);
    mcap_out_bytes(&w->chunk, m->data, m->size);
    MU_ASSERT(!w->chunk.full);
    bool large = w->chunk.len >= WRITER_CHUNK_BYTES || w->entry_count == WRITER_CHUNK_MESSAGES;
    if (large) {
        mcap_writer_flush(w);
    } else {
        mcap_writer_look(w, now_ns);
    }
    return w->error ? MU_FAULT_OS : MU_OK;
}

/* --- files and tables ------------------------------------------------------------------------- */

mu_result mcap_writer_attach(struct mcap_writer *w, const char *name, const char *media_type,
                             const void *bytes, size_t size)
{
    uint8_t buffer[2048];
    struct mcap_out head = {.at = buffer, .size = sizeof buffer};
    size_t record = mcap_out_record(&head, MCAP_ATTACHMENT);
    mcap_out_number(&head, 0, 8);
    mcap_out_number(&head, mu_clock_wall_ns(), 8);
    mcap_out_text(&head, name);
    mcap_out_text(&head, media_type);
    mcap_out_number(&head, size, 8);
    if (head.full || size > MU_RECORD_MESSAGE_MAX) {
        w->refused++;
        return MU_FULL;
    }
    struct mcap_out length = {.at = buffer + 1, .size = 8};
    mcap_out_number(&length, head.len - record + size + 4, 8);
    uLong crc = crc32_z(0, buffer + record, head.len - record);
    crc = size > 0 ? crc32_z(crc, bytes, size) : crc;
    uint8_t sum[4];
    struct mcap_out tail = {.at = sum, .size = sizeof sum};
    mcap_out_number(&tail, crc, 4);
    struct iovec pieces[] = {{.iov_base = buffer, .iov_len = head.len},
                             {.iov_base = (void *)(uintptr_t)bytes, .iov_len = size},
                             {.iov_base = sum, .iov_len = sizeof sum}};
    mcap_writer_put_pieces(w, pieces, 3);
    w->attachments++;
    return w->error ? MU_FAULT_OS : MU_OK;
}

mu_result mcap_writer_attach_file(struct mcap_writer *w, const char *name, const char *media_type,
                                  const char *path)
{
    struct mu_fault fault;
    mcap_writer_flush(w); /* its room is large enough for a file */
    struct mu_text text = mu_text_in((char *)w->chunk.at + RECORDS_AT, MU_RECORD_MESSAGE_MAX + 2);
    mu_result read = mu_text_file_read(path, &text, &fault);
    return read == MU_OK ? mcap_writer_attach(w, name, media_type, text.at, text.len) : MU_ABSENT;
}

mu_result mcap_writer_metadata(struct mcap_writer *w, const char *name,
                               const struct mcap_pair *pairs, size_t count)
{
    mcap_writer_flush(w);
    size_t before = w->chunk.len;
    size_t record = mcap_out_record(&w->chunk, MCAP_METADATA);
    mcap_out_text(&w->chunk, name);
    pairs_put(&w->chunk, pairs, count);
    mcap_out_record_end(&w->chunk, record);
    bool fits = !w->chunk.full;
    if (fits) {
        mcap_writer_put(w, w->chunk.at + before, w->chunk.len - before);
    }
    w->tables += fits;
    w->refused += !fits;
    chunk_begin(w);
    return !fits ? MU_FULL : w->error ? MU_FAULT_OS : MU_OK;
}

/* --- begin and end ---------------------------------------------------------------------------- */

static mu_result writer_fault(const struct mcap_writer *w, const char *what, int error)
{
    fprintf(stderr, "cannot %s %s: %s\n", what, w->path, strerror(error));
    return MU_FAULT_OS;
}

/* Everything but the memory is as in a new writer. */
static void writer_reset(struct mcap_writer *w)
{
    w->error = 0;
    w->offset = w->refused = w->messages = 0;
    w->channel_count = w->schema_count = 0;
    w->attachments = w->tables = w->chunks = 0;
    w->schema_records.len = w->channel_records.len = 0;
    w->schema_records.full = w->channel_records.full = false;
    w->span = (struct writer_span){0};
    chunk_begin(w);
}

mu_result mcap_writer_open(struct mcap_writer *w, const char *path, const char *library)
{
    writer_reset(w);
    if (!mu_text_copy(w->path, sizeof w->path, path)) {
        return writer_fault(w, "create", ENAMETOOLONG);
    }
    w->fd = open(path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (w->fd < 0) {
        return writer_fault(w, "create", errno);
    }
    uint8_t buffer[512];
    struct mcap_out head = {.at = buffer, .size = sizeof buffer};
    mcap_out_bytes(&head, MCAP_MAGIC, MCAP_MAGIC_BYTES);
    size_t record = mcap_out_record(&head, MCAP_HEADER);
    mcap_out_text(&head, ""); /* no profile */
    mcap_out_text(&head, library);
    mcap_out_record_end(&head, record);
    MU_ASSERT(!head.full);
    mcap_writer_put(w, buffer, head.len);
    return MU_OK;
}

uint64_t mcap_writer_refused(const struct mcap_writer *w)
{
    return w->refused;
}

bool mcap_writer_failed(const struct mcap_writer *w)
{
    return w->error != 0;
}

mu_result mcap_writer_close(struct mcap_writer *w)
{
    mcap_writer_flush(w);
    if (w->error == 0) {
        mcap_summary_write(w);
    }
    if (close(w->fd) != 0 && w->error == 0) {
        w->error = errno;
    }
    w->fd = -1;
    return w->error ? writer_fault(w, "write", w->error) : MU_OK;
}
