/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Damaged recordings: whatever the wounds, opening and reading ends, within the bytes of the file,
 * and says the same twice.
 *
 * A recording is wounded at random, from another seed where MUSTER_SEED names one, and so many
 * times as MUSTER_ROUNDS says.  Half of the wounds have their checksums mended, so that they get
 * behind them.
 */
#include "mcap/mcap.h"
#include "suite.h"
#include "wound.h"

#include <stdlib.h>
#include <unistd.h>
#include <zlib.h>

enum { SAMPLE_MAX = 16384, ROUNDS = 3000 };

static struct mcap_writer *w;
static struct mcap_reader *r;
static char path[] = "/tmp/muster-mcap-XXXXXX";
static uint8_t sample[SAMPLE_MAX], wounded[SAMPLE_MAX + WOUND_ROOM];
static size_t sample_len;

static bool sample_fill(void)
{
    static const struct mcap_pair pairs[] = {{"seed", "7"}, {"hash", "abc"}};
    struct mcap_channel c = {.topic = "Frame",
                             .encoding = "cdr",
                             .schema_name = "muster/msg/Frame",
                             .schema_encoding = "ros2msg",
                             .schema = "uint8 x\n",
                             .schema_size = 8,
                             .pairs = pairs,
                             .pairs_count = 2};
    uint32_t channel = 0;
    bool good = mcap_writer_metadata(w, "run", pairs, 2) == MU_OK;
    good = mcap_writer_attach(w, "arena.world", "text/plain", "define", 6) == MU_OK && good;
    for (int i = 0; i < 60; i++) {
        if (i % 20 == 0) {
            c.topic = i == 0 ? "Frame" : i == 20 ? "Scene" : "RunStatus";
            good = mcap_writer_channel(w, &c, &channel) == MU_OK && good;
            mcap_writer_look(w, UINT64_MAX / 2); /* a chunk of its own */
        }
        struct mcap_message m = {.channel = channel, .log_ns = 100u * (unsigned)(i ^ 5)};
        m.data = "some bytes of a message";
        m.size = (size_t)i % 23;
        good = mcap_writer_message(w, &m) == MU_OK && good;
    }
    return good;
}

static int begin(void)
{
    w = mcap_writer_create();
    r = mcap_reader_create();
    int fd = mkstemp(path);
    if (fd < 0 || close(fd) != 0 || mcap_writer_open(w, path, "test") != MU_OK) {
        return 1;
    }
    if (!sample_fill() || mcap_writer_close(w) != MU_OK) {
        return 1;
    }
    FILE *file = fopen(path, "r");
    sample_len = fread(sample, 1, sizeof sample, file);
    fclose(file);
    return sample_len == 0 || sample_len == sizeof sample;
}

static int end(void)
{
    mcap_reader_close(r);
    return unlink(path);
}

static uint64_t texts_read(void)
{
    uint64_t sum = 0;
    char room[64];
    for (uint32_t i = 0; i < mcap_reader_channels(r); i++) {
        const struct mcap_channel *c = mcap_reader_channel(r, i);
        sum += strlen(c->topic) + strlen(c->encoding) + strlen(c->schema_name) + c->schema_size +
               strlen(c->schema_encoding);
        sum = crc32_z(sum & 0xffffffff, c->schema, c->schema_size);
        for (size_t p = 0; p < c->pairs_count; p++) {
            sum += strlen(c->pairs[p].key) + strlen(c->pairs[p].value);
        }
    }
    for (uint32_t i = 0; mcap_reader_attachment(r, i); i++) {
        sum += strlen(mcap_reader_attachment(r, i)->name) + mcap_reader_attachment(r, i)->size;
        sum += (uint64_t)mcap_reader_attachment_read(r, i, room, sizeof room);
    }
    for (uint32_t i = 0; mcap_reader_table(r, i); i++) {
        sum += strlen(mcap_reader_table(r, i)->name) + mcap_reader_table(r, i)->count;
    }
    const char *seed = mcap_reader_value(r, "run", "seed");
    return sum + (seed ? strlen(seed) : 0);
}

/* Reads all that there is.  @return a sum of it; 0: it was refused */
static uint64_t all_read(uint64_t *messages)
{
    struct mu_fault fault = {.text = ""};
    *messages = 0;
    if (mcap_reader_open(r, path, &fault) != MU_OK) {
        CU_ASSERT_NOT_EQUAL(fault.text[0], '\0');
        return 0;
    }
    uint64_t sum = 1 + texts_read();
    struct mcap_message m;
    while (mcap_reader_next(r, &m) == MU_OK) {
        CU_ASSERT_FATAL(m.channel < mcap_reader_channels(r));
        sum = crc32_z((sum + m.log_ns) & 0xffffffff, m.data, m.size) + 1;
        (*messages)++;
    }
    return sum + texts_read();
}

static void test_wounded_recordings(void)
{
    struct mu_random random;
    uint64_t seed = suite_setting("MUSTER_SEED", 41);
    uint64_t rounds = suite_setting("MUSTER_ROUNDS", ROUNDS);
    uint64_t some = 0, refused = 0, whole = 0;
    mu_random_seed(&random, seed, "wounded recordings");
    printf("seed %llu ", (unsigned long long)seed);
    for (uint64_t round = 0; round < rounds; round++) {
        uint64_t messages, again;
        size_t len = wound_file(&random, wounded, sample, sample_len);
        FILE *file = fopen(path, "w");
        CU_ASSERT_PTR_NOT_NULL_FATAL(file);
        fwrite(wounded, 1, len, file);
        fclose(file);
        uint64_t sum = all_read(&messages);
        CU_ASSERT_EQUAL(all_read(&again), sum);
        CU_ASSERT_EQUAL(again, messages);
        refused += sum == 0;
        whole += sum > 0 && mcap_reader_whole(r);
        some += messages > 0 && messages < 60;
    }
    /* The wounds are of all sorts. */
    CU_ASSERT(refused > 0);
    CU_ASSERT(whole > rounds / 20);
    CU_ASSERT(some > rounds / 20);
}

static void test_the_sample_itself(void)
{
    uint64_t messages;
    CU_ASSERT_NOT_EQUAL(all_read(&messages), 0);
    CU_ASSERT_EQUAL(messages, 60);
    CU_ASSERT(mcap_reader_whole(r));
    memcpy(wounded, sample, sample_len);
    wound_mend(wounded, sample_len);
    CU_ASSERT_EQUAL(memcmp(wounded, sample, sample_len), 0); /* it computes them as the writer */
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the sample itself", test_the_sample_itself},
        {"wounded recordings", test_wounded_recordings},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"mcap/garbage", begin, end, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
