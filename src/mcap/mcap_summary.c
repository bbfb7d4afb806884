/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The summary at the end of a recording.  Where chunks, attachments and tables stand is read back
 * from the file, from the heads of its records: however many there are, no memory is needed.
 */
#include "mcap/mcap_writer.h"

#include <errno.h>
#include <unistd.h>
#include <zlib.h>

enum { HEAD_MAX = 2048, GROUPS = 6 };

/* A record of the data section, and as much of it as says what it is. */
struct record {
    enum mcap_op op;
    uint64_t at, length; /* with its head */
    struct mcap_in in;   /* what follows the head */
    uint8_t head[HEAD_MAX];
};

struct summary {
    struct mcap_writer *w;
    uint64_t data_end; /* where the data section ends */
    uint64_t begins;
    uLong crc;
    struct {
        enum mcap_op op;
        uint64_t at, length;
    } groups[GROUPS];
    size_t group_count;
};

/* Reads the head of the record at a place of the file.  @return whether there is one */
static bool record_read(const struct summary *s, uint64_t at, struct record *r)
{
    if (at >= s->data_end) {
        return false;
    }
    ssize_t got = pread(s->w->fd, r->head, HEAD_MAX, (off_t)at);
    struct mcap_in in = {.at = r->head, .left = got > 0 ? (size_t)got : 0};
    r->op = (enum mcap_op)mcap_in_number(&in, 1);
    r->length = MCAP_HEAD_BYTES + mcap_in_number(&in, 8);
    r->at = at;
    r->in = in;
    if (in.cut && s->w->error == 0) {
        s->w->error = got < 0 ? errno : EIO;
    }
    return !in.cut;
}

/* Hands what lies in the chunk's buffer to the file, and goes on with an empty one. */
static void summary_put(struct summary *s)
{
    struct mcap_out *o = &s->w->chunk;
    s->crc = crc32_z(s->crc, o->at, o->len);
    mcap_writer_put(s->w, o->at, o->len);
    o->len = 0;
}

static void group_begin(struct summary *s, enum mcap_op op)
{
    s->groups[s->group_count].op = op;
    s->groups[s->group_count].at = s->w->offset;
}

static void group_end(struct summary *s)
{
    summary_put(s);
    uint64_t length = s->w->offset - s->groups[s->group_count].at;
    s->groups[s->group_count].length = length;
    s->group_count += length > 0;
}

/* The indices of one chunk's messages follow it.  @return how many bytes they have */
static uint64_t offsets_put(struct summary *s, uint64_t at)
{
    struct mcap_out *o = &s->w->chunk;
    struct record r;
    uint64_t begins = at;
    size_t map = mcap_out_begin(o, 4);
    while (record_read(s, at, &r) && r.op == MCAP_MESSAGE_INDEX) {
        mcap_out_number(o, mcap_in_number(&r.in, 2), 2);
        mcap_out_number(o, at, 8);
        at += r.length;
    }
    mcap_out_end(o, map, 4);
    return at - begins;
}

static void chunk_index(struct summary *s, struct record *r)
{
    struct mcap_out *o = &s->w->chunk;
    size_t record = mcap_out_record(o, MCAP_CHUNK_INDEX);
    mcap_out_number(o, mcap_in_number(&r->in, 8), 8); /* first and last time */
    mcap_out_number(o, mcap_in_number(&r->in, 8), 8);
    uint64_t size = mcap_in_number(&r->in, 8);
    mcap_out_number(o, r->at, 8);
    mcap_out_number(o, r->length, 8);
    mcap_out_number(o, offsets_put(s, r->at + r->length), 8);
    mcap_out_text(o, "");
    mcap_out_number(o, size, 8);
    mcap_out_number(o, size, 8);
    mcap_out_record_end(o, record);
}

/* Copies a text with its length. */
static void text_copy(struct mcap_out *o, struct mcap_in *in)
{
    struct mcap_in text = mcap_in_part(in, 4);
    mcap_out_number(o, text.left, 4);
    mcap_out_bytes(o, text.at, text.left);
}

static void attachment_index(struct summary *s, struct record *r)
{
    struct mcap_out *o = &s->w->chunk;
    size_t record = mcap_out_record(o, MCAP_ATTACHMENT_INDEX);
    mcap_out_number(o, r->at, 8);
    mcap_out_number(o, r->length, 8);
    mcap_out_bytes(o, mcap_in_bytes(&r->in, 16), 16); /* its two times */
    struct mcap_in names = r->in;
    (void)mcap_in_part(&names, 4);
    (void)mcap_in_part(&names, 4);
    mcap_out_number(o, mcap_in_number(&names, 8), 8);
    text_copy(o, &r->in);
    text_copy(o, &r->in);
    mcap_out_record_end(o, record);
}

static void metadata_index(struct summary *s, struct record *r)
{
    struct mcap_out *o = &s->w->chunk;
    size_t record = mcap_out_record(o, MCAP_METADATA_INDEX);
    mcap_out_number(o, r->at, 8);
    mcap_out_number(o, r->length, 8);
    text_copy(o, &r->in);
    mcap_out_record_end(o, record);
}

/* One group of indices: of each record of this sort in the data. */
static void indices_put(struct summary *s, enum mcap_op of, enum mcap_op index,
                        void (*put)(struct summary *, struct record *))
{
    struct record r;
    group_begin(s, index);
    for (uint64_t at = MCAP_MAGIC_BYTES; record_read(s, at, &r); at += r.length) {
        if (r.op == of) {
            put(s, &r);
        }
        if (s->w->chunk.len >= WRITER_CHUNK_BYTES) {
            summary_put(s);
        }
    }
    group_end(s);
}

static void records_put(struct summary *s, enum mcap_op op, const struct mcap_out *records)
{
    group_begin(s, op);
    mcap_out_bytes(&s->w->chunk, records->at, records->len);
    group_end(s);
}

static void statistics_put(struct summary *s)
{
    const struct mcap_writer *w = s->w;
    struct mcap_out *o = &s->w->chunk;
    group_begin(s, MCAP_STATISTICS);
    size_t record = mcap_out_record(o, MCAP_STATISTICS);
    mcap_out_number(o, w->messages, 8);
    mcap_out_number(o, w->schema_count, 2);
    mcap_out_number(o, w->channel_count, 4);
    mcap_out_number(o, w->attachments, 4);
    mcap_out_number(o, w->tables, 4);
    mcap_out_number(o, w->chunks, 4);
    mcap_out_number(o, w->span.first_ns, 8);
    mcap_out_number(o, w->span.last_ns, 8);
    size_t map = mcap_out_begin(o, 4);
    for (uint32_t i = 0; i < w->channel_count; i++) {
        mcap_out_number(o, i, 2);
        mcap_out_number(o, w->channels[i].messages, 8);
    }
    mcap_out_end(o, map, 4);
    mcap_out_record_end(o, record);
    group_end(s);
}

static void offsets_of_groups(struct summary *s)
{
    struct mcap_out *o = &s->w->chunk;
    for (size_t i = 0; i < s->group_count; i++) {
        size_t record = mcap_out_record(o, MCAP_SUMMARY_OFFSET);
        mcap_out_number(o, s->groups[i].op, 1);
        mcap_out_number(o, s->groups[i].at, 8);
        mcap_out_number(o, s->groups[i].length, 8);
        mcap_out_record_end(o, record);
    }
    summary_put(s);
}

static void footer_put(struct summary *s, uint64_t offsets_begin)
{
    struct mcap_out *o = &s->w->chunk;
    mcap_out_number(o, MCAP_FOOTER, 1);
    mcap_out_number(o, MCAP_FOOTER_BYTES, 8);
    mcap_out_number(o, s->begins, 8);
    mcap_out_number(o, offsets_begin, 8);
    mcap_out_number(o, crc32_z(s->crc, o->at, o->len), 4);
    mcap_out_bytes(o, MCAP_MAGIC, MCAP_MAGIC_BYTES);
    mcap_writer_put(s->w, o->at, o->len);
    o->len = 0;
}

void mcap_summary_write(struct mcap_writer *w)
{
    struct summary s = {.w = w, .data_end = w->offset};
    w->chunk.len = 0;
    size_t record = mcap_out_record(&w->chunk, MCAP_DATA_END);
    mcap_out_number(&w->chunk, 0, 4); /* the chunks have checksums of their own */
    mcap_out_record_end(&w->chunk, record);
    summary_put(&s);
    s.begins = w->offset;
    s.crc = 0;
    records_put(&s, MCAP_SCHEMA, &w->schema_records);
    records_put(&s, MCAP_CHANNEL, &w->channel_records);
    statistics_put(&s);
    indices_put(&s, MCAP_CHUNK, MCAP_CHUNK_INDEX, chunk_index);
    indices_put(&s, MCAP_ATTACHMENT, MCAP_ATTACHMENT_INDEX, attachment_index);
    indices_put(&s, MCAP_METADATA, MCAP_METADATA_INDEX, metadata_index);
    uint64_t offsets_begin = w->offset;
    offsets_of_groups(&s);
    footer_put(&s, offsets_begin);
}
