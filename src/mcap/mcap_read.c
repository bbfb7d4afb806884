/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Opens a recording: by its summary or, where that is missing or wrong, by reading all of it.
 */
#include "mcap/mcap.h"

#include "core/sort.h"
#include "core/text.h"
#include "mcap/mcap_reader.h"
#include "muster/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

/* As much of an attachment as names it. */
enum { NAMES_MAX = 4096 };

struct mcap_reader *mcap_reader_create(void)
{
    struct mcap_reader *r = mu_startup_alloc(sizeof *r);
    r->fd = -1;
    r->text =
        (struct mcap_out){.at = mu_startup_alloc(READER_TEXT_BYTES), .size = READER_TEXT_BYTES};
    r->channel_ids = mu_startup_array(READER_IDS, sizeof *r->channel_ids);
    r->schema_ids = mu_startup_array(READER_IDS, sizeof *r->schema_ids);
    r->pairs = mu_startup_array(READER_PAIRS_MAX, sizeof *r->pairs);
    r->chunks = mu_startup_array(MU_RECORD_CHUNKS_MAX, sizeof *r->chunks);
    for (size_t i = 0; i < READER_SLOTS; i++) {
        r->slots[i].bytes = mu_startup_alloc(READER_CHUNK_MAX);
        r->slots[i].entries = mu_startup_array(READER_ENTRIES, sizeof *r->slots[i].entries);
    }
    return r;
}

/* A record in the file: its head, and where its content is. */
struct record {
    enum mcap_op op;
    uint64_t at, length; /* of its content */
};

/* Reads the head at a place.  @return MU_OK; MU_MALFORMED: there is no whole head */
static mu_result record_head(const struct mcap_reader *r, uint64_t at, struct record *record)
{
    uint8_t bytes[MCAP_HEAD_BYTES];
    struct mcap_in in = {.at = bytes, .left = sizeof bytes};
    mu_result got = mcap_reader_bytes(r, at, bytes, sizeof bytes);
    if (got != MU_OK) {
        return got;
    }
    record->op = (enum mcap_op)mcap_in_number(&in, 1);
    record->length = mcap_in_number(&in, 8);
    record->at = at + sizeof bytes;
    return MU_OK;
}

static bool record_ends(const struct mcap_reader *r, const struct record *record)
{
    return record->length <= r->size - record->at;
}

/* Reads as much of a record's content as there is, up to max bytes, into the first slot. */
static mu_result record_content(struct mcap_reader *r, const struct record *record, size_t max,
                                struct mcap_in *in)
{
    size_t count = record->length < max ? (size_t)record->length : max;
    *in = (struct mcap_in){.at = r->slots[0].bytes, .left = count};
    return mcap_reader_bytes(r, record->at, r->slots[0].bytes, count);
}

/* A schema, channel or table: what has to be read as a whole. */
static mu_result small_take(struct mcap_reader *r, const struct record *record)
{
    struct mcap_in in;
    if (record->length > READER_CHUNK_MAX) {
        r->full = true;
        return MU_OK;
    }
    mu_result got = record_content(r, record, READER_CHUNK_MAX, &in);
    if (got != MU_OK) {
        return got;
    }
    bool good = record->op == MCAP_SCHEMA     ? mcap_catalog_schema(r, in)
                : record->op == MCAP_CHANNEL  ? mcap_catalog_channel(r, in)
                : record->op == MCAP_METADATA ? mcap_catalog_table(r, in)
                                              : mcap_catalog_statistics(r, in);
    return good ? MU_OK : MU_MALFORMED;
}

static mu_result attachment_take(struct mcap_reader *r, const struct record *record)
{
    struct mcap_in in;
    mu_result got = record_content(r, record, NAMES_MAX, &in);
    if (got != MU_OK) {
        return got;
    }
    return mcap_catalog_file(r, in, record->at, record->length) ? MU_OK : MU_MALFORMED;
}

/* --- by the summary --------------------------------------------------------------------------- */

/* An index names a record elsewhere.  @return MU_OK; MU_MALFORMED: it is not there */
static mu_result indexed_take(struct mcap_reader *r, struct mcap_in in, enum mcap_op op)
{
    struct record record;
    uint64_t at = mcap_in_number(&in, 8);
    mu_result got = in.cut ? MU_MALFORMED : record_head(r, at, &record);
    if (got != MU_OK) {
        return got;
    }
    if (record.op != op || !record_ends(r, &record)) {
        return MU_MALFORMED;
    }
    return op == MCAP_ATTACHMENT ? attachment_take(r, &record) : small_take(r, &record);
}

static mu_result chunk_index_take(struct mcap_reader *r, struct mcap_in in)
{
    struct reader_chunk chunk = {.first_ns = mcap_in_number(&in, 8),
                                 .last_ns = mcap_in_number(&in, 8)};
    chunk.at = mcap_in_number(&in, 8);
    chunk.length = mcap_in_number(&in, 8);
    (void)mcap_in_part(&in, 4);
    (void)mcap_in_number(&in, 8);
    struct mcap_in compression = mcap_in_part(&in, 4);
    uint64_t size = mcap_in_number(&in, 8);
    r->compressed = r->compressed || compression.left > 0;
    bool there = !in.cut && chunk.at <= r->size && chunk.length <= r->size - chunk.at &&
                 chunk.length >= MCAP_HEAD_BYTES && size < chunk.length;
    return there && mcap_catalog_chunk(r, &chunk) ? MU_OK : MU_MALFORMED;
}

static mu_result summary_record_take(struct mcap_reader *r, const struct record *record)
{
    struct mcap_in in;
    mu_result got;
    switch ((int)record->op) {
    case MCAP_SCHEMA:
    case MCAP_CHANNEL:
    case MCAP_STATISTICS: return small_take(r, record);
    case MCAP_CHUNK_INDEX:
    case MCAP_ATTACHMENT_INDEX:
    case MCAP_METADATA_INDEX: break;
    default: return MU_OK;
    }
    got = record_content(r, record, READER_CHUNK_MAX, &in);
    if (got != MU_OK) {
        return got;
    }
    if (record->op == MCAP_CHUNK_INDEX) {
        return chunk_index_take(r, in);
    }
    return indexed_take(r, in, record->op == MCAP_METADATA_INDEX ? MCAP_METADATA : MCAP_ATTACHMENT);
}

/* The checksum goes from the beginning of the summary into the footer. */
static mu_result summary_sum(struct mcap_reader *r, uint64_t begins, uint64_t ends, uint32_t wanted)
{
    uLong crc = 0;
    while (begins < ends && wanted != 0) {
        size_t count =
            ends - begins < READER_CHUNK_MAX ? (size_t)(ends - begins) : (size_t)READER_CHUNK_MAX;
        mu_result got = mcap_reader_bytes(r, begins, r->slots[0].bytes, count);
        if (got != MU_OK) {
            return got;
        }
        crc = crc32_z(crc, r->slots[0].bytes, count);
        begins += count;
    }
    return wanted == 0 || crc == wanted ? MU_OK : MU_MALFORMED;
}

/* @return MU_OK: begins and ends of the summary; MU_MALFORMED: there is none */
static mu_result footer_read(struct mcap_reader *r, uint64_t *begins, uint64_t *ends)
{
    uint8_t tail[MCAP_TAIL_BYTES];
    if (r->size < MCAP_MAGIC_BYTES + sizeof tail) {
        return MU_MALFORMED;
    }
    *ends = r->size - sizeof tail;
    mu_result got = mcap_reader_bytes(r, *ends, tail, sizeof tail);
    struct mcap_in in = {.at = tail, .left = sizeof tail};
    bool is_footer =
        mcap_in_number(&in, 1) == MCAP_FOOTER && mcap_in_number(&in, 8) == MCAP_FOOTER_BYTES &&
        memcmp(tail + sizeof tail - MCAP_MAGIC_BYTES, MCAP_MAGIC, MCAP_MAGIC_BYTES) == 0;
    *begins = mcap_in_number(&in, 8);
    (void)mcap_in_number(&in, 8);
    uint32_t crc = (uint32_t)mcap_in_number(&in, 4);
    if (got != MU_OK || !is_footer || *begins < MCAP_MAGIC_BYTES || *begins > *ends) {
        return got < 0 ? got : MU_MALFORMED;
    }
    return summary_sum(r, *begins, *ends + MCAP_FOOTER_CRC_AT, crc);
}

/* Some writers leave out the indices of chunks, or the channels: then the file is searched.
 */
static bool summary_says_all(const struct mcap_reader *r)
{
    bool all_described = r->counted ? r->channel_count >= r->said_channels : r->channel_count > 0;
    bool all_indexed = r->chunk_count > 0 || (r->counted && r->said_messages == 0);
    return all_indexed && all_described;
}

/* @return MU_OK; MU_MALFORMED: no summary, or not a good one; MU_FAULT_OS */
static mu_result summary_read(struct mcap_reader *r)
{
    uint64_t at = 0;
    uint64_t ends = 0;
    mu_result got = footer_read(r, &at, &ends);
    while (got == MU_OK && at < ends) {
        struct record record;
        got = record_head(r, at, &record);
        if (got == MU_OK && (record.at > ends || record.length > ends - record.at)) {
            got = MU_MALFORMED;
        }
        if (got == MU_OK) {
            got = summary_record_take(r, &record);
            at = record.at + record.length;
        }
    }
    return got;
}

/* --- by reading all of it --------------------------------------------------------------------- */

static mu_result chunk_take(struct mcap_reader *r, const struct record *record)
{
    struct reader_slot *slot = &r->slots[1];
    uint64_t there = r->size - record->at;
    struct reader_chunk chunk = {.at = record->at - MCAP_HEAD_BYTES, .cut = record->length > there};
    chunk.length = MCAP_HEAD_BYTES + (chunk.cut ? there : record->length);
    mu_result loaded = mcap_chunk_load(r, slot, &chunk, true);
    if (loaded != MU_OK || slot->count == 0) {
        return loaded < 0 ? loaded : MU_OK;
    }
    chunk.first_ns = slot->entries[0].log_ns;
    chunk.last_ns = slot->entries[slot->count - 1].log_ns;
    slot->count = 0;
    return mcap_catalog_chunk(r, &chunk) ? MU_OK : MU_MALFORMED;
}

static mu_result data_record_take(struct mcap_reader *r, const struct record *record)
{
    bool ends = record_ends(r, record);
    if (record->op == MCAP_CHUNK) {
        return chunk_take(r, record); /* of one that is cut, what there is */
    }
    if (!ends) {
        return MU_MALFORMED;
    }
    switch ((int)record->op) {
    case MCAP_SCHEMA:
    case MCAP_CHANNEL:
    case MCAP_METADATA: return small_take(r, record);
    case MCAP_ATTACHMENT: return attachment_take(r, record);
    case MCAP_MESSAGE: r->loose = true; return MU_OK;
    default: return MU_OK;
    }
}

/* Goes through the data as far as they are good.  @return MU_OK or MU_FAULT_OS */
static mu_result data_read(struct mcap_reader *r)
{
    mu_result got = MU_OK;
    bool more = true;
    for (uint64_t at = MCAP_MAGIC_BYTES; more && got == MU_OK;) {
        struct record record;
        got = record_head(r, at, &record);
        if (got == MU_OK && record.op != MCAP_DATA_END) {
            got = data_record_take(r, &record);
            more = record_ends(r, &record);
            at = record.at + record.length;
        } else {
            more = false;
        }
    }
    return got < 0 ? got : MU_OK;
}

/* --- the whole -------------------------------------------------------------------------------- */

static int chunk_compare(const void *one, const void *other, const void *context)
{
    const struct reader_chunk *a = one;
    const struct reader_chunk *b = other;
    (void)context;
    if (a->first_ns != b->first_ns) {
        return a->first_ns < b->first_ns ? -1 : 1;
    }
    return (a->at > b->at) - (a->at < b->at);
}

static bool has_magic(const struct mcap_reader *r)
{
    uint8_t bytes[MCAP_MAGIC_BYTES];
    return mcap_reader_bytes(r, 0, bytes, sizeof bytes) == MU_OK &&
           memcmp(bytes, MCAP_MAGIC, sizeof bytes) == 0;
}

static mu_result open_fault(struct mcap_reader *r, struct mu_fault *fault, const char *why)
{
    mu_result refused = mu_fault_at(fault, r->path, 0, 0, "%s", why);
    mcap_reader_close(r);
    return refused;
}

static mu_result file_open(struct mcap_reader *r, const char *path)
{
    struct stat is;
    r->fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe is no recording */
    if (r->fd < 0 || fstat(r->fd, &is) != 0) {
        return MU_FAULT_OS;
    }
    if (S_ISDIR(is.st_mode)) {
        errno = EISDIR;
        return MU_FAULT_OS;
    }
    r->size = S_ISREG(is.st_mode) && is.st_size > 0 ? (uint64_t)is.st_size : 0;
    return MU_OK;
}

/* @return MU_OK or MU_FAULT_OS */
static mu_result catalog_read(struct mcap_reader *r)
{
    mu_result got = summary_read(r);
    r->whole = got == MU_OK;
    if (got == MU_MALFORMED || (got == MU_OK && !summary_says_all(r))) {
        mcap_catalog_reset(r);
        got = data_read(r);
    }
    return got;
}

mu_result mcap_reader_open(struct mcap_reader *r, const char *path, struct mu_fault *fault)
{
    mcap_reader_close(r);
    mcap_catalog_reset(r);
    if (!mu_text_copy(r->path, sizeof r->path, path)) {
        return open_fault(r, fault, strerror(ENAMETOOLONG));
    }
    if (file_open(r, path) != MU_OK) {
        return open_fault(r, fault,
                          errno == EISDIR ? "is a folder: expected a recording, such as "
                                            "run.mcap in the folder of a run"
                                          : strerror(errno));
    }
    if (!has_magic(r)) {
        return open_fault(r, fault, "this is no recording: expected an MCAP file");
    }
    if (catalog_read(r) != MU_OK) {
        return open_fault(r, fault, strerror(errno));
    }
    if (r->compressed) {
        return open_fault(r, fault, "its chunks are compressed, which is not read here");
    }
    if (r->loose && r->chunk_count == 0) {
        return open_fault(r, fault, "its messages are in no chunks, which is not read here");
    }
    if (r->full) {
        return open_fault(r, fault, "it has more channels, files or chunks than are read");
    }
    mu_sort(r->chunks, r->chunk_count, sizeof *r->chunks, chunk_compare, NULL);
    mcap_reader_seek(r, 0, UINT64_MAX);
    return MU_OK;
}

void mcap_reader_close(struct mcap_reader *r)
{
    if (r->fd >= 0) {
        close(r->fd);
    }
    r->fd = -1;
    r->size = 0;
    r->whole = false;
    for (size_t i = 0; i < READER_SLOTS; i++) {
        r->slots[i].count = r->slots[i].next = 0;
    }
}

bool mcap_reader_whole(const struct mcap_reader *r)
{
    return r->whole;
}

void mcap_reader_believe(struct mcap_reader *r)
{
    r->believes = true;
}

uint64_t mcap_reader_broken(const struct mcap_reader *r)
{
    return r->broken;
}

bool mcap_reader_span(const struct mcap_reader *r, uint64_t *first_ns, uint64_t *last_ns)
{
    *first_ns = r->chunk_count > 0 ? r->chunks[0].first_ns : 0;
    *last_ns = 0;
    for (uint32_t i = 0; i < r->chunk_count; i++) {
        *last_ns = r->chunks[i].last_ns > *last_ns ? r->chunks[i].last_ns : *last_ns;
    }
    return r->chunk_count > 0;
}

mu_result mcap_reader_attachment_read(struct mcap_reader *r, uint32_t index, void *to, size_t size)
{
    MU_ASSERT(index < r->file_count);
    const struct reader_file *f = &r->files[index];
    uint64_t named = f->length - f->shown.size - 4;
    uint8_t head[NAMES_MAX];
    uint8_t sum[4];
    if (f->shown.size > size) {
        return MU_FULL;
    }
    mu_result got = mcap_reader_bytes(r, f->at, head, (size_t)named);
    got = got == MU_OK ? mcap_reader_bytes(r, f->at + named, to, (size_t)f->shown.size) : got;
    got = got == MU_OK ? mcap_reader_bytes(r, f->at + f->length - 4, sum, sizeof sum) : got;
    if (got != MU_OK) {
        return got;
    }
    struct mcap_in in = {.at = sum, .left = sizeof sum};
    uint32_t wanted = (uint32_t)mcap_in_number(&in, 4);
    uLong crc = crc32_z(0, head, (size_t)named);
    crc = f->shown.size > 0 ? crc32_z(crc, to, (size_t)f->shown.size) : crc;
    return wanted == 0 || crc == wanted ? MU_OK : MU_MALFORMED;
}
