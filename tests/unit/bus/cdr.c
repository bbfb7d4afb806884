/* SPDX-License-Identifier: Apache-2.0 */
/* Samples of the topics with sockets, any that their tables allow: our bytes are those of DDS, and
 * bytes that DDS refuses are refused. */
#include "bus/cdr.h"

#include "bus/bus.h"
#include "bus/topics.h"
#include "core/random.h"
#include "suite.h"
#include "wire.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define asm __asm__ /* a word of Cyclone's headers that is none of standard C */
#include <dds/ddsi/ddsi_cdrstream.h>
#include <dds/ddsi/ddsi_serdata.h>

enum { ROUNDS = 400, TEXT_MAX = 40, ELEMENTS = 5, XCDR1 = 1 };

static struct mu_random random_numbers;
static struct cdr_room room;
static dds_ostream_t of_dds = {.m_xcdr_version = XCDR1};

static uint32_t below(uint32_t count)
{
    return (uint32_t)(mu_random_next(&random_numbers) % count);
}

/* --- any sample of a type --------------------------------------------------------------------- */

static void some_struct(char *to, const uint32_t *ops);

static char *some_text(void)
{
    size_t len = below(2) * below(TEXT_MAX);
    char *text = dds_alloc(len + 1);
    memset(text, 'a', len);
    text[len] = '\0';
    return text;
}

static uint64_t some_bits(void)
{
    return mu_random_next(&random_numbers) >> below(64);
}

/* @return the words of the member in its table */
static int some_sequence(dds_sequence_t *to, const uint32_t *ops)
{
    bool is_struct = DDS_OP_SUBTYPE(*ops) == DDS_OP_VAL_STU;
    size_t each = is_struct ? ops[2] : DDS_OP_SUBTYPE(*ops) == DDS_OP_VAL_4BY ? 4 : 8;
    *to = (dds_sequence_t){._length = below(2) * below(ELEMENTS)};
    to->_maximum = to->_length;
    to->_release = to->_length > 0;
    to->_buffer = to->_length > 0 ? dds_alloc(each * to->_length) : NULL;
    for (uint32_t i = 0; i < to->_length; i++) {
        char *element = (char *)to->_buffer + i * each;
        uint64_t bits = some_bits();
        if (is_struct) {
            memset(element, 0, each);
            some_struct(element, ops + DDS_OP_ADR_JSR(ops[3]));
        } else {
            memcpy(element, &bits, each);
        }
    }
    return is_struct ? 4 : 2;
}

/* @return the words of the member in its table */
static int some_member(char *to, const uint32_t *ops)
{
    uint64_t bits = some_bits();
    uint32_t word = (uint32_t)bits;
    switch ((int)DDS_OP_TYPE(*ops)) {
    case DDS_OP_VAL_STR: *(char **)(void *)to = some_text(); return 2;
    case DDS_OP_VAL_8BY: memcpy(to, &bits, 8); return 2;
    case DDS_OP_VAL_4BY: memcpy(to, &word, 4); return 2;
    case DDS_OP_VAL_BLN: *(bool *)to = below(2) == 1; return 2;
    case DDS_OP_VAL_ENU:
        word = below(ops[2] + 1);
        memcpy(to, &word, 4);
        return 3;
    case DDS_OP_VAL_EXT: some_struct(to, ops + DDS_OP_ADR_JSR(ops[2])); return 3;
    case DDS_OP_VAL_SEQ: return some_sequence((dds_sequence_t *)(void *)to, ops);
    default: CU_FAIL_FATAL("a topic with sockets has a type that src/bus/cdr.c does not know");
    }
    return 0;
}

static void some_struct(char *to, const uint32_t *ops)
{
    while (*ops != DDS_OP_RTS) {
        ops += some_member(to + ops[1], ops);
    }
}

static void *some_sample(const dds_topic_descriptor_t *d)
{
    void *sample = dds_alloc(d->m_size);
    memset(sample, 0, d->m_size);
    some_struct(sample, d->m_ops);
    return sample;
}

/* --- beside DDS ------------------------------------------------------------------------------- */

static void dds_put(const void *sample, const uint32_t *ops)
{
    of_dds.m_index = 0;
    CU_ASSERT_PTR_NOT_NULL_FATAL(dds_stream_write(&of_dds, sample, ops));
}

static void bytes_are_equal(const void *sample, const uint32_t *ops)
{
    dds_put(sample, ops);
    CU_ASSERT_EQUAL_FATAL(cdr_put(&room, 0, sample, ops), of_dds.m_index);
    CU_ASSERT_EQUAL(memcmp(room.at, of_dds.m_buffer, of_dds.m_index), 0);
}

/* One sample is read over the other, as readers do it. */
static void topic_goes_both_ways(const dds_topic_descriptor_t *d)
{
    void *taken = dds_alloc(d->m_size);
    memset(taken, 0, d->m_size);
    for (int i = 0; i < ROUNDS; i++) {
        void *sample = some_sample(d);
        bytes_are_equal(sample, d->m_ops);
        CU_ASSERT_TRUE_FATAL(cdr_take(taken, (char *)of_dds.m_buffer, of_dds.m_index, d->m_ops));
        bytes_are_equal(taken, d->m_ops);
        dds_sample_free(sample, d, DDS_FREE_ALL);
    }
    dds_sample_free(taken, d, DDS_FREE_ALL);
}

/* In memory of their own size, so that a byte behind them is noticed under the sanitizer.
 * @return whether they were taken */
static bool is_judged_as_by_dds(void *taken, const char *bytes, size_t size, const uint32_t *ops)
{
    char *mine = malloc(size > 0 ? size : 1), *theirs = malloc(size > 0 ? size : 1);
    uint32_t read = 0;
    memcpy(mine, bytes, size);
    memcpy(theirs, bytes, size);
    bool whole = cdr_take(taken, mine, size, ops);
    CU_ASSERT_EQUAL(
        whole, dds_stream_normalize_data(theirs, &read, (uint32_t)size, false, XCDR1, ops) != NULL);
    if (whole) {
        bytes_are_equal(taken, ops);
    }
    free(mine);
    free(theirs);
    return whole;
}

static void topic_is_cut_and_broken(const dds_topic_descriptor_t *d)
{
    void *taken = dds_alloc(d->m_size);
    memset(taken, 0, d->m_size);
    for (int i = 0; i < ROUNDS; i++) {
        void *sample = some_sample(d);
        size_t size = cdr_put(&room, 0, sample, d->m_ops);
        char *bytes = malloc(size);
        memcpy(bytes, room.at, size);
        CU_ASSERT_FALSE(is_judged_as_by_dds(taken, bytes, below((uint32_t)size), d->m_ops));
        for (uint32_t k = 0; k <= below(4); k++) {
            bytes[below((uint32_t)size)] = (char)(below(2) * below(256));
            (void)is_judged_as_by_dds(taken, bytes, size, d->m_ops);
        }
        free(bytes);
        dds_sample_free(sample, d, DDS_FREE_ALL);
    }
    dds_sample_free(taken, d, DDS_FREE_ALL);
}

/* @return how many topics have sockets */
static int topics_each(void (*test)(const dds_topic_descriptor_t *d))
{
    int count = 0;
    for (int topic = 0; topic < BUS_TOPICS; topic++) {
        if (topic_table[topic].local) {
            test(topic_table[topic].descriptor);
            count++;
        }
    }
    return count;
}

static void test_bytes_are_those_of_dds(void)
{
    CU_ASSERT_EQUAL(topics_each(topic_goes_both_ways), 3);
}

static void test_what_dds_refuses_is_refused(void)
{
    CU_ASSERT_EQUAL(topics_each(topic_is_cut_and_broken), 3);
}

/* What a count promises is not believed before its bytes have come. */
static void test_a_count_takes_no_memory(void)
{
    muster_Up taken = {0};
    muster_Up up = {.process = (char[]){"p"}};
    size_t size = cdr_put(&room, 0, &up, muster_Up_desc.m_ops);
    const size_t acts = 24; /* behind process, broker_incarnation and step */
    memset(room.at + acts, 0xff, 3);
    CU_ASSERT_FALSE(cdr_take(&taken, room.at, size, muster_Up_desc.m_ops));
    CU_ASSERT_EQUAL(taken.acts._maximum, 0);
    dds_sample_free(&taken, &muster_Up_desc, DDS_FREE_CONTENTS);
}

/* --- written by DDS --------------------------------------------------------------------------- */

/* @return the payload of the only sample that is there; the caller frees it */
static char *payload_take(int32_t reader, uint32_t *size)
{
    struct ddsi_serdata *data;
    dds_sample_info_t info;
    CU_ASSERT_EQUAL_FATAL(dds_takecdr(reader, &data, 1, &info, DDS_ANY_STATE), 1);
    *size = ddsi_serdata_size(data);
    char *payload = malloc(*size);
    ddsi_serdata_to_ser(data, 0, *size, payload);
    ddsi_serdata_unref(data);
    return payload;
}

static void samples_are_written_alike(const struct bus_reader *r, const struct bus_writer *w)
{
    const dds_topic_descriptor_t *d = topic_table[r->topic].descriptor;
    for (int i = 0; i < ROUNDS; i++) {
        void *sample = some_sample(d);
        uint32_t mine_size, theirs_size;
        CU_ASSERT_EQUAL_FATAL(dds_write(w->writer, sample), DDS_RETCODE_OK);
        char *theirs = payload_take(r->reader, &theirs_size);
        size_t at = cdr_frame(&room, sample, d->m_ops);
        CU_ASSERT_EQUAL_FATAL(cdr_frame_write(w->writer, room.at, at, dds_time()), DDS_RETCODE_OK);
        char *mine = payload_take(r->reader, &mine_size);
        CU_ASSERT_EQUAL_FATAL(mine_size, theirs_size);
        CU_ASSERT_EQUAL(memcmp(mine, theirs, mine_size), 0);
        free(mine);
        free(theirs);
        dds_sample_free(sample, d, DDS_FREE_ALL);
    }
}

static void test_dds_writes_a_frame_as_it_writes_the_sample(void)
{
    static struct bus bus;
    static struct bus_reader reader;
    const struct bus_options options = {
        .domain = 100 + (int)(getpid() % 100), .place = BUS_AGENT, .name = "cdr"};
    CU_ASSERT_EQUAL_FATAL(bus_open(&bus, &options), MU_OK);
    for (int topic = 0; topic < BUS_TOPICS; topic++) {
        struct bus_writer writer;
        if (topic_table[topic].local) {
            CU_ASSERT_EQUAL_FATAL(bus_reader_open(&bus, (enum bus_topic)topic, "a", &reader),
                                  MU_OK);
            CU_ASSERT_EQUAL_FATAL(bus_writer_open(&bus, (enum bus_topic)topic, "a", NULL, &writer),
                                  MU_OK);
            samples_are_written_alike(&reader, &writer);
            bus_writer_close(&writer);
            bus_reader_close(&reader);
        }
    }
    bus_close(&bus);
}

static int end(void)
{
    dds_free(room.at);
    dds_free(of_dds.m_buffer);
    return 0;
}

int main(void)
{
    CU_TestInfo all[] = {
        {"bytes are those of DDS, both ways", test_bytes_are_those_of_dds},
        {"what DDS refuses is refused", test_what_dds_refuses_is_refused},
        {"DDS writes a frame as it writes the sample",
         test_dds_writes_a_frame_as_it_writes_the_sample},
        {"a count takes no memory", test_a_count_takes_no_memory},
        CU_TEST_INFO_NULL,
    };

    mu_random_seed(&random_numbers, 1, "cdr");
    int result = suite_run("bus/cdr", all);
    (void)end();
    return result;
}
