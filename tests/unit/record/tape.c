/* SPDX-License-Identifier: Apache-2.0 */
/* What a tape makes of what taps hear: channels by topic, partitions and quality of service, what
 * has gone beside them; and what is too long leaves no channel. */
#include "record/tape.h"
#include "bus/raw/raw.h"
#include "bus/topics.h"
#include "core/clock.h"
#include "mcap/mcap.h"
#include "samples.h"
#include "suite.h"

#include <stdlib.h>
#include <unistd.h>

static const uint64_t PATIENCE_NS = 5000000000u;

static struct bus bus; /* static: DDS keeps pointers into it */
static struct tape *tape;
static struct mcap_reader *reader;
static char path[] = "/tmp/muster-tape-XXXXXX";

static int begin(void)
{
    unsetenv("CYCLONEDDS_URI");
    alarm(60);
    int fd = mkstemp(path);
    struct bus_options options = {
        .domain = 100 + (int)(getpid() % 100), .place = BUS_OBSERVER, .name = "test"};
    tape = tape_create();
    reader = mcap_reader_create();
    return fd < 0 || close(fd) != 0 || bus_open(&bus, &options) != MU_OK;
}

static int end(void)
{
    mcap_reader_close(reader);
    bus_close(&bus);
    return unlink(path);
}

static void tape_begin(void)
{
    memset(tape->channels, 0, sizeof tape->channels);
    memset(tape->writers, 0, sizeof tape->writers);
    tape->channel_count = 0;
    tape->messages = tape->lost = 0;
    CU_ASSERT_EQUAL_FATAL(tape_open(tape, path, 7), MU_OK);
}

static void tape_end(void)
{
    struct mu_fault fault;
    CU_ASSERT_EQUAL_FATAL(tape_close(tape), MU_OK);
    CU_ASSERT_EQUAL_FATAL(mcap_reader_open(reader, path, &fault), MU_OK);
}

static void part_feed(struct feed *feed, const char *part)
{
    struct bus_bytes bytes = {0};
    muster_PartStatus s = {.broker = words("main"), .part = words(part)};
    CU_ASSERT_EQUAL_FATAL(bus_encode(BUS_PART_STATUS, &s, &bytes), MU_OK);
    CU_ASSERT_EQUAL(feed_write(feed, bytes.data, bytes.size), MU_OK);
    bus_bytes_free(&bytes);
}

static void tape_until(struct tap *tap, uint64_t messages)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (tape->messages < messages && mu_clock_ns() < until_ns) {
        (void)tap_take(tap, tape_take, tape);
    }
    CU_ASSERT_EQUAL_FATAL(tape->messages, messages);
}

static const char *pair_of(const char *topic, const char *key)
{
    uint32_t index = mcap_reader_find(reader, topic);
    CU_ASSERT_NOT_EQUAL_FATAL(index, MU_NONE);
    const struct mcap_channel *c = mcap_reader_channel(reader, index);
    for (size_t i = 0; i < c->pairs_count; i++) {
        if (strcmp(c->pairs[i].key, key) == 0) {
            return c->pairs[i].value;
        }
    }
    return "-";
}

static void test_samples_and_what_has_gone(void)
{
    struct feed feed;
    struct tap tap;
    tape_begin();
    CU_ASSERT_EQUAL_FATAL(feed_open(&feed, &bus, BUS_PART_STATUS, "a", "b"), MU_OK);
    CU_ASSERT_EQUAL_FATAL(tap_open(&tap, &bus, BUS_PART_STATUS), MU_OK);
    part_feed(&feed, "delivery");
    part_feed(&feed, "groups");
    tape_until(&tap, 2);
    bus_writer_close(&feed.out); /* its instances have no writer any more */
    tape_until(&tap, 4);
    CU_ASSERT_EQUAL(tape_topics(tape), 1);
    tape_end();
    CU_ASSERT_EQUAL(mcap_reader_channels(reader), 2);
    READS(pair_of("PartStatus", "partition"), "a");
    READS(pair_of("PartStatus", "partition.2"), "b");
    READS(pair_of("PartStatus", "gone_of"), "-");
    READS(pair_of("PartStatus/gone", "gone_of"), "PartStatus");
    READS(pair_of("PartStatus/gone", "partition.2"), "b");
    READS(pair_of("PartStatus/gone", "dds_type"), "muster::PartStatus");
    const struct mcap_channel *gone =
        mcap_reader_channel(reader, mcap_reader_find(reader, "PartStatus/gone"));
    READS(gone->schema_name, GONE_SCHEMA_NAME);
    CU_ASSERT_EQUAL(gone->messages, 2);
}

/* A channel that has no message would stand in the file, and have no time. */
static void test_limit_what_is_too_long(void)
{
    static const uint8_t large[MU_RECORD_MESSAGE_MAX + 1] = {0, 1};
    struct tap tap;
    struct mcap_message m;
    tape_begin();
    CU_ASSERT_EQUAL_FATAL(tap_open(&tap, &bus, BUS_BROKER_EVENT), MU_OK);
    struct tap_sample s = {.data = large, .size = MU_RECORD_MESSAGE_MAX + 1, .source_ns = 5};
    tape_take(tape, &tap, &s);
    s = (struct tap_sample){
        .gone = GONE_DISPOSED, .data = large, .size = MU_RECORD_KEY_MAX + 1, .source_ns = 6};
    tape_take(tape, &tap, &s);
    CU_ASSERT_EQUAL(tape->lost, 2);
    CU_ASSERT_EQUAL(tape->channel_count, 0);
    s.size = MU_RECORD_KEY_MAX;
    tape_take(tape, &tap, &s);
    CU_ASSERT_EQUAL(tape->messages, 1);
    tape_end();
    CU_ASSERT_EQUAL(mcap_reader_channels(reader), 1);
    CU_ASSERT_EQUAL_FATAL(mcap_reader_next(reader, &m), MU_OK);
    CU_ASSERT_EQUAL(m.size, MU_RECORD_KEY_MAX + GONE_HEAD_BYTES);
}

/* Of a writer with more partitions than have a place the first ones are said. */
static void test_limit_partitions(void)
{
    static char names[MU_RECORD_PARTITIONS_MAX + 1][8];
    static const char *list[MU_RECORD_PARTITIONS_MAX + 1];
    struct tap tap;
    tape_begin();
    for (size_t i = 0; i < MU_RECORD_PARTITIONS_MAX + 1; i++) {
        snprintf(names[i], sizeof names[i], "p%zu", i + 1);
        list[i] = names[i];
    }
    dds_qos_t *group = dds_create_qos(), *qos = topics_qos(&topic_table[BUS_PART_STATUS]);
    dds_qset_partition(group, MU_RECORD_PARTITIONS_MAX + 1, list);
    dds_entity_t publisher = dds_create_publisher(bus.participant, group, NULL);
    CU_ASSERT_EQUAL_FATAL(tap_open(&tap, &bus, BUS_PART_STATUS), MU_OK);
    dds_entity_t writer = dds_create_writer(publisher, tap.topic, qos, NULL);
    dds_delete_qos(group);
    dds_delete_qos(qos);
    muster_PartStatus s = {.broker = words("main"), .part = words("delivery")};
    CU_ASSERT_EQUAL(dds_write(writer, &s), DDS_RETCODE_OK);
    tape_until(&tap, 1);
    tape_end();
    char last[16], beyond[16];
    snprintf(last, sizeof last, "partition.%d", MU_RECORD_PARTITIONS_MAX);
    snprintf(beyond, sizeof beyond, "partition.%d", MU_RECORD_PARTITIONS_MAX + 1);
    READS(pair_of("PartStatus", last), names[MU_RECORD_PARTITIONS_MAX - 1]);
    READS(pair_of("PartStatus", beyond), "-");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"samples and what has gone", test_samples_and_what_has_gone},
        {"limit: what is too long", test_limit_what_is_too_long},
        {"limit: partitions", test_limit_partitions},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"record/tape", begin, end, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
