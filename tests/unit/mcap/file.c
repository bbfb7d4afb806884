/* SPDX-License-Identifier: Apache-2.0 */
/* Recordings: what is written is read again, whatever becomes of the file in between. */
#include "capture.h"
#include "mcap/mcap.h"
#include "muster/limits.h"
#include "suite.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static struct mcap_writer *w;
static struct mcap_reader *r;
static struct mu_fault fault;
static char folder[] = "/tmp/muster-mcap-XXXXXX";
static char path[64], other[64];

static int begin(void)
{
    w = mcap_writer_create();
    r = mcap_reader_create();
    if (!mkdtemp(folder)) {
        return 1;
    }
    snprintf(path, sizeof path, "%s/run.mcap", folder);
    snprintf(other, sizeof other, "%s/other.mcap", folder);
    return 0;
}

static int end(void)
{
    mcap_reader_close(r);
    unlink(path);
    unlink(other);
    return rmdir(folder);
}

static void write_begin(void)
{
    CU_ASSERT_EQUAL_FATAL(mcap_writer_open(w, path, "test"), MU_OK);
}

static void write_end(void)
{
    CU_ASSERT_EQUAL_FATAL(mcap_writer_close(w), MU_OK);
}

static void read_begin(const char *file)
{
    mu_result opened = mcap_reader_open(r, file, &fault);
    if (opened != MU_OK) {
        mu_fault_print(&fault);
    }
    CU_ASSERT_EQUAL_FATAL(opened, MU_OK);
}

static uint32_t channel_add(const char *topic, const char *schema)
{
    static const struct mcap_pair pairs[] = {{"qos", "reliable"}, {"empty", ""}};
    struct mcap_channel c = {.topic = topic,
                             .encoding = "cdr",
                             .schema_name = schema,
                             .schema_encoding = "ros2msg",
                             .schema = "uint8 x\n",
                             .schema_size = 8,
                             .pairs = pairs,
                             .pairs_count = 2};
    uint32_t index = UINT32_MAX;
    CU_ASSERT_EQUAL(mcap_writer_channel(w, &c, &index), MU_OK);
    return index;
}

static void message_add(uint32_t channel, uint64_t log_ns, const void *data, size_t size)
{
    struct mcap_message m = {.channel = channel,
                             .sequence = (uint32_t)log_ns,
                             .log_ns = log_ns,
                             .publish_ns = log_ns + 7,
                             .data = data,
                             .size = size};
    CU_ASSERT_EQUAL(mcap_writer_message(w, &m), MU_OK);
}

/* A thousand messages on two channels, about three chunks; and a file and two tables. */
static void sample_write(void)
{
    static uint8_t bytes[4096];
    static const struct mcap_pair pairs[] = {{"seed", "7"}, {"hash", "abc"}};
    write_begin();
    CU_ASSERT_EQUAL(mcap_writer_metadata(w, "run", pairs, 2), MU_OK);
    CU_ASSERT_EQUAL(mcap_writer_attach(w, "arena.world", "text/plain", "define", 6), MU_OK);
    uint32_t a = channel_add("Frame", "muster/msg/Frame");
    uint32_t b = channel_add("Scene", "muster/msg/Scene");
    CU_ASSERT_EQUAL(a, 0);
    CU_ASSERT_EQUAL(b, 1);
    for (uint64_t i = 0; i < 1000; i++) {
        memset(bytes, (int)i, sizeof bytes);
        message_add(i % 10 == 0 ? b : a, 100 * i, bytes, i % 10 == 0 ? i : sizeof bytes - i);
    }
    CU_ASSERT_EQUAL(mcap_writer_metadata(w, "end", pairs, 1), MU_OK);
    write_end();
}

/* Reads messages of the sample: those from one number on.  @return how many there were */
static uint64_t sample_read(uint64_t from)
{
    struct mcap_message m;
    uint64_t count = 0;
    for (uint64_t i = from; mcap_reader_next(r, &m) == MU_OK; i++, count++) {
        const uint8_t *bytes = m.data;
        bool good = m.log_ns == 100 * i && m.publish_ns == 100 * i + 7 &&
                    m.sequence == (uint32_t)(100 * i) && m.channel == (i % 10 == 0) &&
                    m.size == (i % 10 == 0 ? i : 4096 - i) &&
                    (m.size == 0 || (bytes[0] == (uint8_t)i && bytes[m.size - 1] == (uint8_t)i));
        if (!good) {
            CU_FAIL("a message is not what was written");
            return count;
        }
    }
    return count;
}

static void test_round_trip(void)
{
    uint64_t first, last;
    sample_write();
    read_begin(path);
    CU_ASSERT(mcap_reader_whole(r));
    CU_ASSERT_EQUAL(mcap_reader_channels(r), 2);
    CU_ASSERT(mcap_reader_span(r, &first, &last));
    CU_ASSERT_EQUAL(first, 0);
    CU_ASSERT_EQUAL(last, 99900);
    CU_ASSERT_EQUAL(sample_read(0), 1000);
    CU_ASSERT_EQUAL(mcap_reader_broken(r), 0);
    const struct mcap_channel *c = mcap_reader_channel(r, mcap_reader_find(r, "Scene"));
    READS(c->topic, "Scene");
    READS(c->encoding, "cdr");
    READS(c->schema_name, "muster/msg/Scene");
    READS(c->schema_encoding, "ros2msg");
    CU_ASSERT_EQUAL_FATAL(c->schema_size, 8);
    CU_ASSERT_EQUAL(memcmp(c->schema, "uint8 x\n", 8), 0);
    CU_ASSERT_EQUAL(c->messages, 100);
    CU_ASSERT_EQUAL_FATAL(c->pairs_count, 2);
    READS(c->pairs[0].key, "qos");
    READS(c->pairs[0].value, "reliable");
    READS(c->pairs[1].value, "");
    CU_ASSERT_EQUAL(mcap_reader_find(r, "scene"), MU_NONE);
}

static void test_files_and_tables(void)
{
    char text[8] = "";
    sample_write();
    read_begin(path);
    const struct mcap_attachment *a = mcap_reader_attachment(r, 0);
    CU_ASSERT_PTR_NOT_NULL_FATAL(a);
    CU_ASSERT_PTR_NULL(mcap_reader_attachment(r, 1));
    READS(a->name, "arena.world");
    READS(a->media_type, "text/plain");
    CU_ASSERT_EQUAL(a->size, 6);
    CU_ASSERT_EQUAL(mcap_reader_attachment_find(r, "arena.world"), 0);
    CU_ASSERT_EQUAL(mcap_reader_attachment_find(r, "arena"), MU_NONE);
    CU_ASSERT_EQUAL(mcap_reader_attachment_read(r, 0, text, 5), MU_FULL);
    CU_ASSERT_EQUAL(mcap_reader_attachment_read(r, 0, text, 6), MU_OK);
    READS(text, "define");
    READS(mcap_reader_value(r, "run", "hash"), "abc");
    READS(mcap_reader_value(r, "end", "seed"), "7");
    CU_ASSERT_PTR_NULL(mcap_reader_value(r, "end", "hash"));
    CU_ASSERT_PTR_NULL(mcap_reader_value(r, "no", "hash"));
    CU_ASSERT_EQUAL(mcap_reader_table(r, 1)->count, 1);
    CU_ASSERT_PTR_NULL(mcap_reader_table(r, 2));
}

static void test_an_empty_recording(void)
{
    uint64_t first, last;
    struct mcap_message m;
    write_begin();
    write_end();
    read_begin(path);
    CU_ASSERT(mcap_reader_whole(r));
    CU_ASSERT_EQUAL(mcap_reader_channels(r), 0);
    CU_ASSERT_FALSE(mcap_reader_span(r, &first, &last));
    CU_ASSERT_EQUAL(mcap_reader_next(r, &m), MU_DONE);
}

static void test_seek(void)
{
    static const uint64_t from[] = {0, 1, 99, 500, 257, 998, 999, 3};
    struct mcap_message m;
    sample_write();
    read_begin(path);
    for (size_t i = 0; i < sizeof from / sizeof from[0]; i++) {
        mcap_reader_seek(r, 100 * from[i] - (from[i] > 0 ? 50 : 0), UINT64_MAX);
        CU_ASSERT_EQUAL(sample_read(from[i]), 1000 - from[i]);
    }
    mcap_reader_seek(r, 30000, 30500);
    CU_ASSERT_EQUAL(sample_read(300), 6);
    mcap_reader_seek(r, 30001, 30099);
    CU_ASSERT_EQUAL(mcap_reader_next(r, &m), MU_DONE);
    mcap_reader_seek(r, 99901, UINT64_MAX);
    CU_ASSERT_EQUAL(mcap_reader_next(r, &m), MU_DONE);
    mcap_reader_pick(r, 0, false);
    mcap_reader_seek(r, 0, UINT64_MAX);
    uint64_t count = 0;
    for (; mcap_reader_next(r, &m) == MU_OK; count++) {
        CU_ASSERT_EQUAL(m.channel, 1);
    }
    CU_ASSERT_EQUAL(count, 100);
}

/* Messages that come in any order are read in order of time, those of one time as they came. */
static void test_order(void)
{
    struct mcap_message m;
    write_begin();
    uint32_t a = channel_add("A", "");
    for (uint64_t i = 0; i < 40000; i++) { /* more than two chunks take */
        message_add(a, 10 * (i ^ 3), &i, sizeof i);
        if (i % 5000 == 0) {
            message_add(a, 10 * (i ^ 3), "x", 1);
        }
    }
    write_end();
    read_begin(path);
    CU_ASSERT_EQUAL(mcap_reader_channel(r, 0)->schema_size, 0);
    uint64_t count = 0, before = 0, wrong = 0, twice = 0;
    while (mcap_reader_next(r, &m) == MU_OK) {
        twice += m.size == 1;
        wrong += m.log_ns < before || (m.size == 1 && m.log_ns != before);
        before = m.log_ns;
        count++;
    }
    CU_ASSERT_EQUAL(count, 40008);
    CU_ASSERT_EQUAL(twice, 8);
    CU_ASSERT_EQUAL(wrong, 0);
}

/* Copies the first bytes of the recording, and some of them changed.  @return bytes of the whole */
static size_t copy_bytes(size_t count, size_t changed_at)
{
    static uint8_t bytes[6 << 20];
    FILE *file = fopen(path, "r");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    if (changed_at < size) {
        bytes[changed_at] ^= 0x55;
    }
    file = fopen(other, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    fwrite(bytes, 1, count < size ? count : size, file);
    fclose(file);
    return size;
}

static void test_cut_anywhere(void)
{
    sample_write();
    size_t size = copy_bytes(SIZE_MAX, SIZE_MAX);
    uint64_t before = 0;
    for (size_t cut = 8; cut < size; cut += 1 + cut % 30011) {
        copy_bytes(cut, SIZE_MAX);
        read_begin(other);
        CU_ASSERT_FALSE(mcap_reader_whole(r));
        uint64_t count = sample_read(0);
        CU_ASSERT(count >= before);
        /* But for what describes the channels, no more than one message's bytes are missing. */
        CU_ASSERT((count + 1) * (4096 + 31) + 4096 >= cut || count == 1000 || cut < 8192);
        before = count;
    }
    copy_bytes(size - 1, SIZE_MAX);
    read_begin(other);
    CU_ASSERT_FALSE(mcap_reader_whole(r));
    CU_ASSERT_EQUAL(sample_read(0), 1000);
}

static void test_what_died_is_read(void)
{
    static const uint8_t bytes[2048];
    write_begin();
    uint32_t a = channel_add("A", "muster/msg/A");
    for (uint64_t i = 0; i < 5000; i++) {
        message_add(a, i, bytes, sizeof bytes);
    }
    mcap_writer_look(w, UINT64_MAX / 2); /* a second later */
    read_begin(path);                    /* and nobody has closed it */
    CU_ASSERT_FALSE(mcap_reader_whole(r));
    CU_ASSERT_EQUAL(mcap_reader_channel(r, 0)->messages, 5000);
    READS(mcap_reader_channel(r, 0)->schema_name, "muster/msg/A");
    struct mcap_message m;
    uint64_t count = 0;
    while (mcap_reader_next(r, &m) == MU_OK) {
        CU_ASSERT_EQUAL(m.log_ns, count);
        count++;
    }
    CU_ASSERT_EQUAL(count, 5000);
    write_end();
}

static void test_a_damaged_chunk_is_left_out(void)
{
    sample_write();
    copy_bytes(SIZE_MAX, 2000000); /* in the second chunk */
    read_begin(other);
    CU_ASSERT(mcap_reader_whole(r));
    struct mcap_message m;
    uint64_t count = 0;
    while (mcap_reader_next(r, &m) == MU_OK) {
        count++;
    }
    CU_ASSERT_EQUAL(mcap_reader_broken(r), 1);
    CU_ASSERT(count > 500 && count < 800);
}

static void test_a_damaged_summary_is_not_believed(void)
{
    sample_write();
    size_t size = copy_bytes(SIZE_MAX, SIZE_MAX);
    copy_bytes(SIZE_MAX, size - 200); /* in the indices */
    read_begin(other);
    CU_ASSERT_FALSE(mcap_reader_whole(r));
    CU_ASSERT_EQUAL(sample_read(0), 1000);
    READS(mcap_reader_value(r, "end", "seed"), "7");
    CU_ASSERT_EQUAL(mcap_reader_attachment_find(r, "arena.world"), 0);
}

static void test_a_damaged_file_is_noticed(void)
{
    char text[6];
    sample_write();
    read_begin(path);
    size_t at = 0;
    char bytes[512];
    int fd = open(path, O_RDONLY);
    CU_ASSERT_EQUAL(pread(fd, bytes, sizeof bytes, 0), (ssize_t)sizeof bytes);
    close(fd);
    while (at < sizeof bytes - 6 && memcmp(bytes + at, "define", 6) != 0) {
        at++;
    }
    copy_bytes(SIZE_MAX, at);
    read_begin(other);
    CU_ASSERT_EQUAL(mcap_reader_attachment_read(r, 0, text, sizeof text), MU_MALFORMED);
}

static void test_no_recording(void)
{
    CU_ASSERT_EQUAL(mcap_reader_open(r, "/nowhere/run.mcap", &fault), MU_FAULT_FILE);
    READS(fault.text, "No such file or directory");
    CU_ASSERT_EQUAL(mcap_reader_open(r, folder, &fault), MU_FAULT_FILE);
    READS(fault.text, "is a folder: expected a recording, such as run.mcap in the folder of a run");
    FILE *file = fopen(other, "w");
    fputs("time_s,robot\n", file);
    fclose(file);
    CU_ASSERT_EQUAL(mcap_reader_open(r, other, &fault), MU_FAULT_FILE);
    READS(fault.text, "this is no recording: expected an MCAP file");
}

/* --- limits ----------------------------------------------------------------------------------- */

static void test_limit_messages(void)
{
    static uint8_t large[MU_RECORD_MESSAGE_MAX + 1];
    struct mcap_message m = {.data = large, .size = sizeof large};
    large[MU_RECORD_MESSAGE_MAX - 1] = 99;
    write_begin();
    m.channel = channel_add("A", "");
    message_add(m.channel, 1, "a", 1);
    CU_ASSERT_EQUAL(mcap_writer_message(w, &m), MU_FULL);
    CU_ASSERT_EQUAL(mcap_writer_refused(w), 1);
    message_add(m.channel, 2, large, MU_RECORD_MESSAGE_MAX);
    CU_ASSERT_EQUAL(mcap_writer_attach(w, "a", "", large, sizeof large), MU_FULL);
    CU_ASSERT_EQUAL(mcap_writer_attach(w, "a", "", large, MU_RECORD_MESSAGE_MAX), MU_OK);
    write_end();
    read_begin(path);
    struct mcap_message got;
    CU_ASSERT_EQUAL(mcap_reader_next(r, &got), MU_OK);
    CU_ASSERT_EQUAL(mcap_reader_next(r, &got), MU_OK);
    CU_ASSERT_EQUAL_FATAL(got.size, MU_RECORD_MESSAGE_MAX);
    CU_ASSERT_EQUAL(((const uint8_t *)got.data)[got.size - 1], 99);
    CU_ASSERT_EQUAL(mcap_reader_next(r, &got), MU_DONE);
    CU_ASSERT_EQUAL(mcap_reader_attachment_read(r, 0, large, sizeof large), MU_OK);
}

static void test_limit_channels(void)
{
    char topic[32];
    struct mcap_channel c = {.topic = topic, .encoding = "cdr", .schema_name = ""};
    uint32_t index;
    write_begin();
    for (int i = 0; i < MU_RECORD_CHANNELS_MAX; i++) {
        snprintf(topic, sizeof topic, "topic%d", i);
        CU_ASSERT_EQUAL(mcap_writer_channel(w, &c, &index), MU_OK);
    }
    CU_ASSERT_EQUAL(mcap_writer_channel(w, &c, &index), MU_FULL);
    message_add(MU_RECORD_CHANNELS_MAX - 1, 5, "z", 1);
    write_end();
    read_begin(path);
    CU_ASSERT_EQUAL(mcap_reader_channels(r), MU_RECORD_CHANNELS_MAX);
    struct mcap_message got;
    CU_ASSERT_EQUAL(mcap_reader_next(r, &got), MU_OK);
    READS(mcap_reader_channel(r, got.channel)->topic, topic);
}

static void test_limit_files(void)
{
    for (uint32_t more = 0; more < 2; more++) {
        write_begin();
        for (uint32_t i = 0; i < MU_RECORD_FILES_MAX + more; i++) {
            CU_ASSERT_EQUAL(mcap_writer_attach(w, "a", "", "b", 1), MU_OK);
        }
        write_end();
        CU_ASSERT_EQUAL(mcap_reader_open(r, path, &fault), more ? MU_FAULT_FILE : MU_OK);
    }
    READS(fault.text, "it has more channels, files or chunks than are read");
}

/* What does not fit leaves no trace: the next one that does is taken. */
static void test_limit_types(void)
{
    static char text[MU_RECORD_TYPES_BYTES];
    struct mcap_channel c = {.topic = "A",
                             .encoding = "cdr",
                             .schema_name = "a/msg/A",
                             .schema_encoding = "ros2msg",
                             .schema = text,
                             .schema_size = sizeof text};
    uint32_t index;
    write_begin();
    CU_ASSERT_EQUAL(mcap_writer_channel(w, &c, &index), MU_FULL);
    c.schema_size = 10;
    CU_ASSERT_EQUAL(mcap_writer_channel(w, &c, &index), MU_OK);
    CU_ASSERT_EQUAL(index, 0);
    write_end();
    read_begin(path);
    CU_ASSERT_EQUAL_FATAL(mcap_reader_channels(r), 1);
    CU_ASSERT_EQUAL(mcap_reader_channel(r, 0)->schema_size, 10);
}

static void test_a_schema_stands_once(void)
{
    struct stat one, two;
    write_begin();
    channel_add("A", "a/msg/A");
    write_end();
    stat(path, &one);
    write_begin();
    channel_add("A", "a/msg/A");
    channel_add("B", "a/msg/A");
    write_end();
    stat(path, &two);
    read_begin(path);
    READS(mcap_reader_channel(r, 1)->schema_name, "a/msg/A");
    CU_ASSERT_EQUAL(mcap_reader_channel(r, 0)->schema, mcap_reader_channel(r, 1)->schema);
    CU_ASSERT(two.st_size > one.st_size);
}

/* --- disks ------------------------------------------------------------------------------------ */

static void test_a_full_disk_shows_at_the_close(void)
{
    static const uint8_t bytes[1 << 19];
    CU_ASSERT_EQUAL_FATAL(mcap_writer_open(w, "/dev/full", "test"), MU_OK);
    uint32_t a = channel_add("A", "");
    struct mcap_message m = {.channel = a, .data = bytes, .size = sizeof bytes};
    mu_result result = MU_OK;
    for (int i = 0; i < 8; i++) {
        result = mcap_writer_message(w, &m);
    }
    CU_ASSERT_EQUAL(result, MU_FAULT_OS);
    CU_ASSERT(mcap_writer_failed(w));
    capture_begin();
    mu_result closed = mcap_writer_close(w);
    capture_end();
    CU_ASSERT_EQUAL(closed, MU_FAULT_OS);
    CU_ASSERT(said("cannot write /dev/full: No space left on device"));
}

static void test_a_folder_that_is_not_there(void)
{
    capture_begin();
    mu_result opened = mcap_writer_open(w, "/tmp/muster-nowhere/run.mcap", "test");
    capture_end();
    CU_ASSERT_EQUAL(opened, MU_FAULT_OS);
    CU_ASSERT(said("cannot create /tmp/muster-nowhere/run.mcap: No such file or directory"));
}

static void test_attached_from_the_disk(void)
{
    static char text[1 << 16];
    write_begin();
    CU_ASSERT_EQUAL(mcap_writer_attach_file(w, "x", "text/plain", "/nowhere"), MU_ABSENT);
    CU_ASSERT_EQUAL(mcap_writer_attach_file(w, "me", "text/x-c", "tests/unit/mcap/file.c"), MU_OK);
    write_end();
    read_begin(path);
    uint32_t index = mcap_reader_attachment_find(r, "me");
    CU_ASSERT_NOT_EQUAL_FATAL(index, MU_NONE);
    CU_ASSERT_EQUAL(mcap_reader_attachment_read(r, index, text, sizeof text), MU_OK);
    CU_ASSERT_PTR_NOT_NULL(strstr(text, "test_attached_from_the_disk"));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"round trip", test_round_trip},
        {"files and tables", test_files_and_tables},
        {"an empty recording", test_an_empty_recording},
        {"seek", test_seek},
        {"order", test_order},
        {"cut anywhere", test_cut_anywhere},
        {"what died is read", test_what_died_is_read},
        {"a damaged chunk is left out", test_a_damaged_chunk_is_left_out},
        {"a damaged summary is not believed", test_a_damaged_summary_is_not_believed},
        {"a damaged file is noticed", test_a_damaged_file_is_noticed},
        {"no recording", test_no_recording},
        {"limit: messages", test_limit_messages},
        {"limit: channels", test_limit_channels},
        {"limit: files", test_limit_files},
        {"limit: types", test_limit_types},
        {"a schema stands once", test_a_schema_stands_once},
        {"a full disk shows at the close", test_a_full_disk_shows_at_the_close},
        {"a folder that is not there", test_a_folder_that_is_not_there},
        {"attached from the disk", test_attached_from_the_disk},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"mcap/file", begin, end, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
