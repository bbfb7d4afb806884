/* SPDX-License-Identifier: Apache-2.0 */
/* Recordings whose summary leaves something out, or does not say what their chunks say. */
#include "mcap/mcap.h"
#include "mcap/mcap_bytes.h"
#include "suite.h"
#include "wound.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

enum { FILE_MAX = 65536, UNKNOWN_OP = 0x7f, MESSAGES = 40 };

static struct mcap_writer *w;
static struct mcap_reader *r;
static struct mu_fault fault;
static char path[] = "/tmp/muster-strange-XXXXXX";
static uint8_t bytes[FILE_MAX];
static size_t len;

static int begin(void)
{
    w = mcap_writer_create();
    r = mcap_reader_create();
    int fd = mkstemp(path);
    return fd < 0 || close(fd) != 0;
}

static int end(void)
{
    mcap_reader_close(r);
    return unlink(path);
}

/* Two channels, in one chunk; their messages take turns. */
static void sample_write(void)
{
    static const char *const topics[] = {"A", "B"};
    CU_ASSERT_EQUAL_FATAL(mcap_writer_open(w, path, "test"), MU_OK);
    for (uint32_t i = 0; i < 2; i++) {
        struct mcap_channel c = {.topic = topics[i], .encoding = "cdr", .schema_name = ""};
        uint32_t index;
        CU_ASSERT_EQUAL_FATAL(mcap_writer_channel(w, &c, &index), MU_OK);
    }
    for (uint32_t i = 0; i < MESSAGES; i++) {
        struct mcap_message m = {.channel = i % 2, .log_ns = 10 + i, .data = "word", .size = 4};
        CU_ASSERT_EQUAL(mcap_writer_message(w, &m), MU_OK);
    }
    CU_ASSERT_EQUAL_FATAL(mcap_writer_close(w), MU_OK);
    FILE *file = fopen(path, "r");
    len = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    CU_ASSERT_FATAL(len > 100 && len < sizeof bytes);
}

static void sample_open(void)
{
    FILE *file = fopen(path, "w");
    fwrite(bytes, 1, len, file);
    fclose(file);
    CU_ASSERT_EQUAL_FATAL(mcap_reader_open(r, path, &fault), MU_OK);
}

/* Finds the n-th record of a sort in the data, or in the summary.  @return where its head begins */
static size_t record_find(enum mcap_op op, size_t n, bool in_summary)
{
    size_t footer = len - MCAP_TAIL_BYTES;
    size_t summary = (size_t)wound_number(bytes + footer + MCAP_HEAD_BYTES, 8);
    size_t at = in_summary ? summary : MCAP_MAGIC_BYTES;
    while (at < len && !(bytes[at] == op && n-- == 0)) {
        at += MCAP_HEAD_BYTES + (size_t)wound_number(bytes + at + 1, 8);
    }
    CU_ASSERT_FATAL(at < len);
    wound_set(bytes + footer + MCAP_FOOTER_CRC_AT, 0, 4); /* nobody has computed it */
    return at;
}

/* Reads all.  @return how many messages; the other channel's are counted apart */
static uint32_t all_read(uint32_t *of_b)
{
    struct mcap_message m;
    uint32_t count = 0;
    *of_b = 0;
    mcap_reader_seek(r, 0, UINT64_MAX);
    while (mcap_reader_next(r, &m) == MU_OK) {
        CU_ASSERT_FATAL(m.channel < mcap_reader_channels(r));
        *of_b += strcmp(mcap_reader_channel(r, m.channel)->topic, "B") == 0;
        count++;
    }
    return count;
}

/* The format lets a summary leave out what the chunks say. */
static void test_a_summary_without_channels(void)
{
    uint32_t of_b;
    sample_write();
    bytes[record_find(MCAP_CHANNEL, 0, true)] = UNKNOWN_OP;
    bytes[record_find(MCAP_CHANNEL, 0, true)] = UNKNOWN_OP;
    sample_open();
    CU_ASSERT(mcap_reader_whole(r));
    CU_ASSERT_EQUAL(mcap_reader_channels(r), 2);
    CU_ASSERT_EQUAL(all_read(&of_b), MESSAGES);
    CU_ASSERT_EQUAL(of_b, MESSAGES / 2);
    bytes[record_find(MCAP_STATISTICS, 0, true)] = UNKNOWN_OP;
    sample_open();
    CU_ASSERT_EQUAL(mcap_reader_channels(r), 2);
    CU_ASSERT_EQUAL(all_read(&of_b), MESSAGES);
}

/* Whoever has opened a file has seen all of its channels: none comes while it is read. */
static void test_a_channel_that_the_summary_denies(void)
{
    uint32_t of_b;
    sample_write();
    bytes[record_find(MCAP_CHANNEL, 1, true)] = UNKNOWN_OP;
    wound_set(bytes + record_find(MCAP_STATISTICS, 0, true) + MCAP_HEAD_BYTES + 8 + 2, 1, 4);
    sample_open();
    CU_ASSERT_EQUAL(mcap_reader_channels(r), 1);
    CU_ASSERT_EQUAL(all_read(&of_b), MESSAGES / 2);
    CU_ASSERT_EQUAL(of_b, 0);
    CU_ASSERT_EQUAL(mcap_reader_channels(r), 1);
}

/* The checksum is right, and a length in the chunk is not: what stands before it is read. */
static void test_a_length_that_lies(void)
{
    uint32_t of_b;
    sample_write();
    size_t chunk = record_find(MCAP_CHUNK, 0, false);
    size_t records = chunk + MCAP_HEAD_BYTES + MCAP_CHUNK_BYTES;
    size_t size = (size_t)wound_number(bytes + chunk + 1, 8) - MCAP_CHUNK_BYTES;
    size_t message = MCAP_HEAD_BYTES + MCAP_MESSAGE_BYTES + 4;
    wound_set(bytes + records + size - 5 * message + 1, UINT64_MAX - 8,
              8); /* the fifth from the end */
    wound_set(bytes + chunk + MCAP_HEAD_BYTES + MCAP_CHUNK_CRC_AT,
              crc32_z(0, bytes + records, size), 4);
    sample_open();
    for (int round = 0; round < 3; round++) { /* and is counted once */
        CU_ASSERT_EQUAL(all_read(&of_b), MESSAGES - 5);
        CU_ASSERT_EQUAL(mcap_reader_broken(r), 1);
    }
}

static void test_a_checksum_that_is_wrong(void)
{
    uint32_t of_b;
    sample_write();
    bytes[record_find(MCAP_CHUNK, 0, false) + MCAP_HEAD_BYTES + MCAP_CHUNK_CRC_AT] ^= 1;
    sample_open();
    for (int round = 0; round < 3; round++) {
        CU_ASSERT_EQUAL(all_read(&of_b), 0);
        CU_ASSERT_EQUAL(mcap_reader_broken(r), 1);
    }
}

static void test_a_pipe(void)
{
    char pipe[] = "/tmp/muster-pipe-XXXXXX";
    CU_ASSERT_PTR_NOT_NULL_FATAL(mkdtemp(pipe));
    char name[64];
    snprintf(name, sizeof name, "%s/p", pipe);
    CU_ASSERT_EQUAL(mkfifo(name, 0600), 0);
    CU_ASSERT_EQUAL(mcap_reader_open(r, name, &fault), MU_FAULT_FILE); /* and waits for nobody */
    READS(fault.text, "this is no recording: expected an MCAP file");
    unlink(name);
    rmdir(pipe);
}

static void test_a_path_that_is_too_long(void)
{
    static char name[8192];
    memset(name, 'a', sizeof name - 1);
    CU_ASSERT_EQUAL(mcap_reader_open(r, name, &fault), MU_FAULT_FILE);
    READS(fault.text, "File name too long");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a summary without channels", test_a_summary_without_channels},
        {"a channel that the summary denies", test_a_channel_that_the_summary_denies},
        {"a length that lies", test_a_length_that_lies},
        {"a checksum that is wrong", test_a_checksum_that_is_wrong},
        {"a pipe", test_a_pipe},
        {"a path that is too long", test_a_path_that_is_too_long},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"mcap/strange", begin, end, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
