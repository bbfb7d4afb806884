/* SPDX-License-Identifier: Apache-2.0 */
/* Samples as bytes, on loopback: what a feed writes, a tap hears; what is no sample is refused. */
#include "bus/raw/raw.h"
#include "core/clock.h"
#include "core/random.h"
#include "samples.h"
#include "suite.h"
#include "wire.h"

#include <dds/dds.h>

#include <stdlib.h>
#include <unistd.h>

enum { HEARD_MAX = 512, BYTES_MAX = 4096, ROUNDS = 3000 };

static const uint64_t PATIENCE_NS = 5000000000u;

static struct bus bus; /* static: DDS keeps pointers into it */
static struct tap tap;
static struct feed feed;
static struct bus_bytes bytes;

static struct heard {
    uint8_t bytes[BYTES_MAX];
    size_t size;
    uint64_t source_ns;
    char partition[64];
    enum gone_what gone;
} heard[HEARD_MAX];
static size_t heard_count;

static int begin(void)
{
    unsetenv("CYCLONEDDS_URI");
    alarm(60);
    struct bus_options options = {
        .domain = 100 + (int)(getpid() % 100), .place = BUS_OBSERVER, .name = "test"};
    return bus_open(&bus, &options) != MU_OK || tap_open(&tap, &bus, BUS_PART_STATUS) != MU_OK ||
           feed_open(&feed, &bus, BUS_PART_STATUS, "here", NULL) != MU_OK;
}

static int end(void)
{
    bus_bytes_free(&bytes);
    bus_close(&bus);
    return 0;
}

static void hear(void *self, struct tap *of, const struct tap_sample *s)
{
    (void)self;
    struct heard *h = &heard[heard_count++ % HEARD_MAX];
    h->size = s->size < BYTES_MAX ? s->size : BYTES_MAX;
    h->source_ns = s->source_ns;
    memcpy(h->bytes, s->data, h->size);
    struct tap_offer offer;
    (void)tap_offer(of, s->writer, &offer);
    (void)mu_text_copy(h->partition, sizeof h->partition, offer.partitions);
    h->gone = s->gone;
}

static void hear_until(size_t count)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (heard_count < count && mu_clock_ns() < until_ns) {
        (void)tap_take(&tap, hear, NULL);
    }
    CU_ASSERT_EQUAL_FATAL(heard_count, count);
}

static const struct bus_bytes *sample(const char *part, uint64_t value)
{
    static muster_Counter counter;
    counter = (muster_Counter){.name = words("mails"), .value = value};
    muster_PartStatus s = {.broker = words("main"), .part = words(part)};
    s.counters._buffer = &counter;
    s.counters._length = s.counters._maximum = 1;
    CU_ASSERT_EQUAL_FATAL(bus_encode(BUS_PART_STATUS, &s, &bytes), MU_OK);
    return &bytes;
}

/* DDS hands a reader the samples of an instance together; a tap has them as they were written. */
static void test_what_is_fed_is_heard(void)
{
    enum { COUNT = 200 };
    static const char *const parts[] = {"delivery", "groups", "journal"};
    heard_count = 0;
    for (uint64_t i = 0; i < COUNT; i++) {
        const struct bus_bytes *b = sample(parts[i % 3], i);
        CU_ASSERT_EQUAL(feed_write(&feed, b->data, b->size), MU_OK);
    }
    hear_until(COUNT);
    size_t wrong = 0;
    for (uint64_t i = 0; i < COUNT; i++) {
        const struct bus_bytes *b = sample(parts[i % 3], i);
        wrong += heard[i].size != b->size || memcmp(heard[i].bytes, b->data, b->size) != 0;
        wrong += i > 0 && heard[i].source_ns < heard[i - 1].source_ns;
        wrong += strcmp(heard[i].partition, "here") != 0;
    }
    CU_ASSERT_EQUAL(wrong, 0);
}

static void test_what_is_no_sample_is_refused(void)
{
    static const uint8_t cases[][16] = {
        {0},
        {0, 1, 0, 0},
        {0, 1, 0, 0, 255, 255, 255, 255},
        {0, 1, 0, 0, 1, 0, 0, 0, 'x', 0, 0, 0},
        {0, 99, 0, 0, 1, 0, 0, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        for (size_t size = 0; size <= sizeof cases[0]; size++) {
            CU_ASSERT_EQUAL(feed_write(&feed, cases[i], size), MU_MALFORMED);
        }
    }
}

/* Whatever the wounds, bytes are a sample or they are refused. */
static void test_wounded_bytes(void)
{
    struct mu_random random;
    uint8_t wounded[BYTES_MAX];
    size_t refused = 0;
    heard_count = 0;
    mu_random_seed(&random, suite_setting("MUSTER_SEED", 41), "wounded bytes");
    uint64_t rounds = suite_setting("MUSTER_ROUNDS", ROUNDS);
    for (uint64_t i = 0; i < rounds; i++) {
        const struct bus_bytes *b = sample("delivery", i);
        size_t size = b->size;
        memcpy(wounded, b->data, size);
        for (int64_t wounds = mu_random_between(&random, 1, 4); wounds > 0; wounds--) {
            wounded[mu_random_between(&random, 0, (int64_t)size - 1)] =
                (uint8_t)mu_random_between(&random, 0, 255);
        }
        if (i % 4 == 0) {
            size = (size_t)mu_random_between(&random, 0, (int64_t)size);
        }
        mu_result written = feed_write(&feed, wounded, size);
        CU_ASSERT(written == MU_OK || written == MU_MALFORMED);
        refused += written == MU_MALFORMED;
        (void)tap_take(&tap, hear, NULL);
    }
    CU_ASSERT(refused > rounds / 4 && refused < rounds);
}

/* --- what has gone ---------------------------------------------------------------------------- */

static uint8_t key_of_delivery[64];
static size_t key_size;

static void part_write(const char *part, uint64_t value)
{
    const struct bus_bytes *b = sample(part, value);
    CU_ASSERT_EQUAL(feed_write(&feed, b->data, b->size), MU_OK);
}

/* Asserts that what was heard is this: d a sample, x disposed, u unregistered; all of one part. */
static void heard_reads(const char *wanted)
{
    char got[HEARD_MAX + 1];
    size_t count = heard_count < HEARD_MAX ? heard_count : HEARD_MAX;
    for (size_t i = 0; i < count; i++) {
        got[i] = "dxu"[heard[i].gone];
        CU_ASSERT(i == 0 || heard[i].source_ns >= heard[i - 1].source_ns);
        CU_ASSERT(
            heard[i].gone == GONE_NOT ||
            (heard[i].size == key_size && memcmp(heard[i].bytes, key_of_delivery, key_size) == 0));
    }
    got[count] = '\0';
    READS(got, wanted);
}

static void delivery_goes(enum gone_what what)
{
    CU_ASSERT_EQUAL(feed_gone(&feed, what, key_of_delivery, key_size), MU_OK);
}

static void test_an_instance_that_goes_is_heard(void)
{
    heard_count = key_size = 0;
    part_write("delivery", 1);
    hear_until(1);
    /* The key of it, as DDS has it: found out by a first word that it has gone. */
    muster_PartStatus s = {.broker = words("main"), .part = words("delivery")};
    CU_ASSERT_EQUAL(dds_dispose(feed.out.writer, &s), DDS_RETCODE_OK);
    hear_until(2);
    CU_ASSERT_EQUAL_FATAL(heard[1].gone, GONE_DISPOSED);
    key_size = heard[1].size;
    memcpy(key_of_delivery, heard[1].bytes, key_size);
    part_write("delivery", 2);
    hear_until(3);
    delivery_goes(GONE_UNREGISTERED);
    hear_until(4);
    heard_reads("dxdu");
}

/* Nobody listens in between: each going is told all the same, between what was before and after. */
static void test_what_goes_and_comes_again_unheard(void)
{
    heard_count = 0;
    for (uint64_t i = 0; i < 3; i++) {
        part_write("delivery", i);
        part_write("delivery", i);
        delivery_goes(i == 1 ? GONE_UNREGISTERED : GONE_DISPOSED);
    }
    hear_until(9);
    heard_reads("ddxdduddx");
    part_write("delivery", 9);
    hear_until(10);
    delivery_goes(GONE_DISPOSED);
    part_write("delivery", 10);
    hear_until(12);
    heard_reads("ddxdduddxdxd");
}

/* More of one instance than a batch has, and then it goes. */
static void test_what_goes_behind_a_full_batch(void)
{
    for (size_t count = TAP_BATCH - 1; count <= TAP_BATCH + 1; count++) {
        heard_count = 0;
        for (size_t i = 0; i < count; i++) {
            part_write("delivery", i);
        }
        delivery_goes(GONE_DISPOSED);
        hear_until(count + 1);
        CU_ASSERT_EQUAL(heard[count].gone, GONE_DISPOSED);
        for (size_t i = 0; i < count; i++) {
            CU_ASSERT_EQUAL(heard[i].gone, GONE_NOT);
        }
    }
}

static void test_wounded_keys(void)
{
    struct mu_random random;
    uint8_t wounded[64];
    uint64_t rounds = suite_setting("MUSTER_ROUNDS", ROUNDS), refused = 0;
    mu_random_seed(&random, suite_setting("MUSTER_SEED", 41), "wounded keys");
    heard_count = 0;
    for (uint64_t i = 0; i < rounds; i++) {
        memcpy(wounded, key_of_delivery, key_size);
        for (int64_t wounds = mu_random_between(&random, 1, 3); wounds > 0; wounds--) {
            wounded[mu_random_between(&random, 0, (int64_t)key_size - 1)] =
                (uint8_t)mu_random_between(&random, 0, 255);
        }
        enum gone_what what = i % 2 ? GONE_DISPOSED : GONE_UNREGISTERED;
        size_t size = (size_t)mu_random_between(&random, (int64_t)key_size / 2, (int64_t)key_size);
        mu_result told = feed_gone(&feed, what, wounded, size);
        CU_ASSERT(told == MU_OK || told == MU_MALFORMED);
        refused += told == MU_MALFORMED;
        (void)tap_take(&tap, hear, NULL);
    }
    CU_ASSERT(refused > rounds / 4 && refused < rounds);
}

static void test_keys_that_are_none(void)
{
    uint8_t wounded[64];
    memcpy(wounded, key_of_delivery, key_size);
    for (size_t size = 0; size < key_size; size++) {
        mu_result gone = feed_gone(&feed, GONE_DISPOSED, wounded, size);
        CU_ASSERT_EQUAL(gone, MU_MALFORMED);
    }
    wounded[4] = 0xff;
    CU_ASSERT_EQUAL(feed_gone(&feed, GONE_DISPOSED, wounded, key_size), MU_MALFORMED);
}

static void test_gone_as_a_message(void)
{
    uint8_t bytes_of[GONE_HEAD_BYTES + 5];
    const void *key;
    size_t size;
    CU_ASSERT_EQUAL(gone_write(bytes_of, GONE_UNREGISTERED, "abcde", 5), sizeof bytes_of);
    CU_ASSERT_EQUAL(gone_read(bytes_of, sizeof bytes_of, &key, &size), GONE_UNREGISTERED);
    CU_ASSERT(size == 5 && memcmp(key, "abcde", 5) == 0);
    for (size_t cut = 0; cut < sizeof bytes_of; cut++) {
        CU_ASSERT_EQUAL(gone_read(bytes_of, cut, &key, &size), GONE_NOT);
    }
    bytes_of[4] = 3;
    CU_ASSERT_EQUAL(gone_read(bytes_of, sizeof bytes_of, &key, &size), GONE_NOT);
    bytes_of[4] = 0;
    CU_ASSERT_EQUAL(gone_read(bytes_of, sizeof bytes_of, &key, &size), GONE_NOT);
}

static void test_topics_by_name(void)
{
    enum bus_topic topic;
    CU_ASSERT(feed_topic("Frame", NULL, &topic));
    CU_ASSERT_EQUAL(topic, BUS_FRAME);
    CU_ASSERT(feed_topic("Frame", "muster::Frame", &topic));
    CU_ASSERT_FALSE(feed_topic("Frame", "zoo::Frame", &topic));
    CU_ASSERT_FALSE(feed_topic("frame", NULL, &topic));
}

static void test_every_topic_can_be_fed(void)
{
    static struct feed feeds[BUS_TOPICS];
    for (int t = 0; t < BUS_TOPICS; t++) {
        CU_ASSERT_EQUAL(feed_open(&feeds[t], &bus, (enum bus_topic)t, NULL, NULL), MU_OK);
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"what is fed is heard", test_what_is_fed_is_heard},
        {"what is no sample is refused", test_what_is_no_sample_is_refused},
        {"wounded bytes", test_wounded_bytes},
        {"an instance that goes is heard", test_an_instance_that_goes_is_heard},
        {"what goes and comes again unheard", test_what_goes_and_comes_again_unheard},
        {"what goes behind a full batch", test_what_goes_behind_a_full_batch},
        {"wounded keys", test_wounded_keys},
        {"keys that are none", test_keys_that_are_none},
        {"gone as a message", test_gone_as_a_message},
        {"topics by name", test_topics_by_name},
        {"every topic can be fed", test_every_topic_can_be_fed},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"bus/tap", begin, end, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
