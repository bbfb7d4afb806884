/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Types that we were not compiled with, for this test some of ours under other names: a type as
 * bytes is a topic again, damaged bytes are none, and readers find what they ask for.
 */
#include "bus/raw/raw.h"
#include "bus/topics.h"
#include "core/clock.h"
#include "core/random.h"
#include "samples.h"
#include "suite.h"
#include "wire.h"

#include <stdlib.h>
#include <unistd.h>

enum { TYPE_BYTES = 1 << 20, ROUNDS = 500, BYTES_MAX = 4096, HEARD_MAX = 64 };

static const uint64_t PATIENCE_NS = 5000000000u;

static struct bus bus; /* static: DDS keeps pointers into it */
static uint8_t type[TYPE_BYTES], wounded[TYPE_BYTES];
static size_t type_len;

static int begin(void)
{
    unsetenv("CYCLONEDDS_URI");
    alarm(500);
    struct bus_options options = {
        .domain = 100 + (int)(getpid() % 100), .place = BUS_OBSERVER, .name = "test"};
    return bus_open(&bus, &options) != MU_OK;
}

static int end(void)
{
    bus_close(&bus);
    return 0;
}

static void type_of(enum bus_topic topic)
{
    char hash[TYPE_HASH_MAX];
    type_len = type_bytes_write(topic_table[topic].descriptor, type, sizeof type, hash);
    CU_ASSERT_FATAL(type_len > 0);
    CU_ASSERT_EQUAL(strlen(hash), TYPE_HASH_MAX - 1);
}

static mu_result topic_of(const void *bytes, size_t size, const char *name, const char *type_name)
{
    dds_entity_t topic = 0;
    mu_result made = type_bytes_topic(bus.participant, bytes, size, name, type_name, &topic);
    CU_ASSERT_EQUAL(topic > 0, made == MU_OK);
    return made;
}

static void test_every_type_can_be_kept(void)
{
    char name[64];
    for (int t = 0; t < BUS_TOPICS; t++) {
        type_of((enum bus_topic)t);
        snprintf(name, sizeof name, "strange%d", t);
        CU_ASSERT_EQUAL(topic_of(type, type_len, name, topic_table[t].descriptor->m_typename),
                        MU_OK);
        CU_ASSERT_EQUAL(topic_of(type, type_len, name, "zoo::Other"), MU_MALFORMED);
    }
}

static void test_types_without_room(void)
{
    char hash[TYPE_HASH_MAX];
    const dds_topic_descriptor_t *d = topic_table[BUS_FRAME].descriptor;
    type_of(BUS_FRAME);
    CU_ASSERT_EQUAL(type_bytes_write(d, type, type_len - 1, hash), 0);
    CU_ASSERT_EQUAL(type_bytes_write(d, type, type_len, hash), type_len);
    const dds_topic_descriptor_t silent = {.m_typename = d->m_typename};
    CU_ASSERT_EQUAL(type_bytes_write(&silent, type, sizeof type, hash), 0);
}

static void test_types_that_are_cut(void)
{
    type_of(BUS_PART_STATUS);
    for (size_t len = 0; len < type_len; len++) {
        uint8_t *copy = malloc(len + 1); /* of this size, for who watches its end */
        memcpy(copy, type, len);
        CU_ASSERT_EQUAL(topic_of(copy, len, "cut", "muster::PartStatus"), MU_MALFORMED);
        free(copy);
    }
}

/* A type whose bytes are others has another hash: it is refused, or it is the same. */
static void test_wounded_types(void)
{
    struct mu_random random;
    uint64_t rounds = suite_setting("MUSTER_ROUNDS", ROUNDS), refused = 0;
    mu_random_seed(&random, suite_setting("MUSTER_SEED", 41), "wounded types");
    for (uint64_t i = 0; i < rounds; i++) {
        type_of(i % 2 ? BUS_FRAME : BUS_PART_STATUS);
        memcpy(wounded, type, type_len);
        for (int64_t wounds = mu_random_between(&random, 1, 3); wounds > 0; wounds--) {
            size_t at = (size_t)mu_random_between(&random, 0, (int64_t)type_len - 1);
            wounded[at] ^= (uint8_t)mu_random_between(&random, 1, 255);
        }
        mu_result made =
            topic_of(wounded, type_len, "wounded", i % 2 ? "muster::Frame" : "muster::PartStatus");
        CU_ASSERT(made == MU_OK || made == MU_MALFORMED);
        refused += made == MU_MALFORMED;
    }
    CU_ASSERT(refused > rounds * 8 / 10);
}

/* --- what is offered -------------------------------------------------------------------------- */

static void words_read(const char *words, const char *wanted)
{
    char buffer[TAP_OFFER_MAX + 1];
    struct mu_text text;
    dds_qos_t *qos = dds_create_qos();
    mu_text_init(&text, buffer, sizeof buffer);
    offer_read(words, qos);
    offer_write(qos, &text);
    READS(text.at, wanted);
    dds_delete_qos(qos);
}

static const char OFFER[] =
    "reliability=1 durability=1 history=1,0 deadline=20000000000 latency=7 "
    "lifespan=9223372036854775807 liveliness=2,30000000000 ownership=1,-3 order=1 "
    "presentation=2,0,1 representation=2";

static void test_offers_in_words(void)
{
    words_read(OFFER, OFFER);
    words_read("", "");
    words_read("order=1  durability=0", "durability=0 order=1");
    /* What is no policy, or has another number of numbers. */
    words_read("order order= order=x order=1,2 order=1x liveliness=1 liveliness=1, =1 orders=1 , ",
               "");
}

/* --- from a feed to a tap ----------------------------------------------------------------------
 */

static struct heard {
    uint8_t bytes[BYTES_MAX];
    size_t size;
    enum gone_what gone;
} heard[HEARD_MAX];
static size_t heard_count;
static struct tap_offer offer;

static void hear(void *self, struct tap *of, const struct tap_sample *s)
{
    struct heard *h = &heard[heard_count++ % HEARD_MAX];
    (void)self;
    h->gone = s->gone;
    h->size = s->size < BYTES_MAX ? s->size : BYTES_MAX;
    memcpy(h->bytes, s->data, h->size);
    (void)tap_offer(of, s->writer, &offer);
}

static void heard_await(struct tap *tap, size_t wanted)
{
    uint64_t until_ns = mu_clock_ns() + PATIENCE_NS;
    while (heard_count < wanted && mu_clock_ns() < until_ns) {
        (void)tap_take(tap, hear, NULL);
    }
    CU_ASSERT_EQUAL_FATAL(heard_count, wanted);
}

/* A tap of a reader that knows the type since it was compiled, and asks for what is offered. */
static void tap_make(struct tap *tap, const char *partition)
{
    dds_qos_t *group = dds_create_qos(), *qos = dds_create_qos();
    dds_qset_partition1(group, partition);
    offer_read(OFFER, group);
    offer_read(OFFER, qos);
    *tap = (struct tap){.name = "Strange", .type = "muster::PartStatus"};
    tap->topic = dds_create_topic(bus.participant, &muster_PartStatus_desc, "Strange", NULL, NULL);
    tap->reader = dds_create_reader(dds_create_subscriber(bus.participant, group, NULL), tap->topic,
                                    qos, NULL);
    CU_ASSERT_FATAL(tap->topic > 0 && tap->reader > 0);
    dds_delete_qos(group);
    dds_delete_qos(qos);
}

static void part_feed(struct feed *feed, uint64_t value, struct bus_bytes *bytes)
{
    muster_PartStatus s = {.broker = words("main"), .part = words("delivery")};
    muster_Counter counter = {.name = words("mails"), .value = value};
    s.counters = (dds_sequence_muster_Counter){1, 1, &counter, false};
    CU_ASSERT_EQUAL_FATAL(bus_encode(BUS_PART_STATUS, &s, bytes), MU_OK);
    CU_ASSERT_EQUAL(feed_write(feed, bytes->data, bytes->size), MU_OK);
}

/* What a tap hears of a feed is what the feed was given: bytes, type, partitions, offer. */
static void test_a_foreign_topic_there_and_back(void)
{
    static struct bus_bytes bytes;
    static const char *const partitions[] = {"a", "", "b,c"};
    struct feed_foreign of = {.topic = "Strange",
                              .type = "muster::PartStatus",
                              .type_bytes = type,
                              .words = OFFER,
                              .partitions = partitions,
                              .partition_count = 3};
    struct feed feed;
    struct tap tap;
    type_of(BUS_PART_STATUS);
    of.type_size = type_len;
    CU_ASSERT_EQUAL_FATAL(feed_open_foreign(&feed, &bus, &of), MU_OK);
    tap_make(&tap, "b,c");
    for (size_t i = 0; i < 10; i++) {
        part_feed(&feed, i, &bytes);
        heard_await(&tap, i + 1);
        CU_ASSERT(heard[i].size == bytes.size &&
                  memcmp(heard[i].bytes, bytes.data, bytes.size) == 0);
    }
    READS(offer.partitions, "a\n\nb,c");
    READS(offer.words, OFFER);
    bus_bytes_free(&bytes);
}

static void test_a_tap_keeps_the_type(void)
{
    struct tap tap;
    struct mu_text name;
    char name_bytes[128], hash[TYPE_HASH_MAX];
    mu_text_init(&name, name_bytes, sizeof name_bytes);
    type_of(BUS_PART_STATUS);
    (void)type_bytes_write(&muster_PartStatus_desc, type, sizeof type, hash);
    tap_make(&tap, "a");
    CU_ASSERT_EQUAL(tap_type(&tap, wounded, sizeof wounded, &name), type_len);
    CU_ASSERT_EQUAL(memcmp(wounded, type, type_len), 0);
    CU_ASSERT_EQUAL_FATAL(strncmp(name.at, "muster::PartStatus-", 19), 0);
    READS(name.at + 19, hash);
}

static void test_a_writer_that_cannot_be(void)
{
    static const char *const none[] = {""};
    struct feed_foreign of = {.topic = "no topic \n",
                              .type = "muster::PartStatus",
                              .type_bytes = type,
                              .words = "",
                              .partitions = none,
                              .partition_count = 1};
    struct feed feed;
    type_of(BUS_PART_STATUS);
    of.type_size = type_len;
    CU_ASSERT_EQUAL(feed_open_foreign(&feed, &bus, &of), MU_REFUSED);
    of.topic = "Strange";
    of.words = "durability=99 history=7,7 deadline=-5"; /* DDS refuses what is no value */
    CU_ASSERT_EQUAL(feed_open_foreign(&feed, &bus, &of), MU_REFUSED);
    of.words = "";
    of.type_size = type_len - 4;
    CU_ASSERT_EQUAL(feed_open_foreign(&feed, &bus, &of), MU_MALFORMED);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"every type can be kept", test_every_type_can_be_kept},
        {"types without room", test_types_without_room},
        {"types that are cut", test_types_that_are_cut},
        {"wounded types", test_wounded_types},
        {"offers in words", test_offers_in_words},
        {"a foreign topic there and back", test_a_foreign_topic_there_and_back},
        {"a tap keeps the type", test_a_tap_keeps_the_type},
        {"a writer that cannot be", test_a_writer_that_cannot_be},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"bus/foreign", begin, end, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
