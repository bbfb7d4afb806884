/* SPDX-License-Identifier: Apache-2.0 */
/* Parcels of a Delivery that are put together without DDS are the bytes that DDS would write. */
#include "bus/local_frame.h"
#include "bus/local_parcels.h"
#include "core/random.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 2000, PARCELS = 12, TEXTS = 24, BEGIN = LOCAL_HEAD };

static struct mu_random random_numbers;
static struct local_room taken;
static struct bus bus;
static dds_ostream_t room = {.m_xcdr_version = LOCAL_CDR};
static char *written;
static muster_Parcel parcels[PARCELS];
static muster_Receipt receipts[3];

static uint32_t below(uint32_t count)
{
    return (uint32_t)(mu_random_next(&random_numbers) % count);
}

static char *some_text(void)
{
    static char texts[TEXTS + 1][TEXTS + 1];
    uint32_t len = below(TEXTS + 1);
    memset(texts[len], 'a', len);
    return texts[len];
}

static muster_Mail some_mail(void)
{
    return (muster_Mail){.src = some_text(),
                         .since_wall_ns = mu_random_next(&random_numbers),
                         .seq = mu_random_next(&random_numbers),
                         .dst = some_text(),
                         .layer = below(5),
                         .performative = some_text(),
                         .language = some_text(),
                         .ontology = some_text(),
                         .reply_with = some_text(),
                         .in_reply_to = some_text(),
                         .conversation = some_text(),
                         .reply_by_ns = mu_random_next(&random_numbers),
                         .priority = (int32_t)below(3) - 1,
                         .level = (muster_Level)below(3),
                         .again = below(2) == 1,
                         .hops = below(9),
                         .due_ns = -(int64_t)below(9),
                         .ttl_ns = mu_random_next(&random_numbers),
                         .content = some_text()};
}

static muster_Delivery some_delivery(uint32_t count)
{
    muster_Delivery d = {.process = some_text(),
                         .broker_incarnation = mu_random_next(&random_numbers),
                         .step = below(1000),
                         .broker = some_text(),
                         .roll_call = below(2) == 1,
                         .serial = below(1000)};
    for (uint32_t i = 0; i < count; i++) {
        parcels[i] = (muster_Parcel){some_text(), below(1000), some_mail()};
    }
    d.parcels._buffer = parcels;
    d.parcels._length = d.parcels._maximum = count;
    d.receipts._buffer = receipts;
    d.receipts._length = d.receipts._maximum = below(4);
    for (uint32_t i = 0; i < d.receipts._length; i++) {
        receipts[i] = (muster_Receipt){some_text(), 1, below(9), muster_OUTCOME_STORED};
    }
    return d;
}

static void dds_put(dds_ostream_t *out, const muster_Delivery *d)
{
    out->m_index = BEGIN;
    CU_ASSERT_PTR_NOT_NULL_FATAL(
        dds_stream_write(out, (const char *)d, muster_Delivery_desc.m_ops));
}

/* @return whether the bytes behind the head were a Delivery */
static bool ours_take(muster_Delivery *d, char *body, size_t bytes)
{
    uint32_t size = (uint32_t)bytes, others = 0, at = 0;
    char *lone = local_parcels_take(&taken, d, body, &size, &others);
    const uint32_t *ops = muster_Delivery_desc.m_ops;
    bool whole = lone && dds_stream_normalize_data(lone, &at, size, false, LOCAL_CDR, ops);
    if (whole) {
        dds_istream_t in;
        dds_istream_init(&in, size, lone, LOCAL_CDR);
        (void)dds_stream_read(&in, (char *)d, ops);
    }
    if (whole && others > 0) {
        local_parcels_join(d, others);
    }
    return whole;
}

static void test_bytes_are_those_of_dds(void)
{
    dds_ostream_t out = {.m_xcdr_version = LOCAL_CDR}, again = {.m_xcdr_version = LOCAL_CDR};
    muster_Delivery *d = dds_alloc(sizeof *d);
    memset(d, 0, sizeof *d);
    for (int i = 0; i < ROUNDS; i++) {
        uint32_t count = below(PARCELS + 1);
        muster_Delivery from = some_delivery(count);
        dds_put(&out, &from);
        size_t size = out.m_index;
        if (count > 1) {
            CU_ASSERT_EQUAL_FATAL(local_parcels_write(&bus, &from, &written), size);
            CU_ASSERT_EQUAL(memcmp(written + BEGIN, out.m_buffer + BEGIN, size - BEGIN), 0);
        }
        CU_ASSERT_TRUE_FATAL(ours_take(d, (char *)out.m_buffer + BEGIN, size - BEGIN));
        dds_put(&again, d);
        CU_ASSERT_EQUAL_FATAL(again.m_index, size);
        CU_ASSERT_EQUAL(memcmp(again.m_buffer + BEGIN, out.m_buffer + BEGIN, size - BEGIN), 0);
    }
    dds_sample_free(d, &muster_Delivery_desc, DDS_FREE_ALL);
    dds_free(out.m_buffer);
    dds_free(again.m_buffer);
}

/* Each in memory of its own size, so that a byte behind it is noticed under the sanitizer. */
static void test_what_is_cut_or_broken_is_refused(void)
{
    muster_Delivery *d = dds_alloc(sizeof *d), from = some_delivery(5);
    memset(d, 0, sizeof *d);
    size_t size = local_parcels_write(&bus, &from, &written) - BEGIN;
    for (size_t bytes = 0; bytes < size; bytes++) {
        char *body = malloc(bytes > 0 ? bytes : 1);
        memcpy(body, written + BEGIN, bytes);
        CU_ASSERT_FALSE(ours_take(d, body, bytes));
        free(body);
    }
    for (int i = 0; i < ROUNDS; i++) {
        char *body = malloc(size);
        memcpy(body, written + BEGIN, size);
        for (uint32_t k = below(4); k < 4; k++) {
            body[below((uint32_t)size)] = (char)below(256);
        }
        (void)ours_take(d, body, size);
        free(body);
    }
    dds_sample_free(d, &muster_Delivery_desc, DDS_FREE_ALL);
}

int main(void)
{
    CU_TestInfo all[] = {
        {"bytes are those of DDS, both ways", test_bytes_are_those_of_dds},
        {"what is cut or broken is refused", test_what_is_cut_or_broken_is_refused},
        CU_TEST_INFO_NULL,
    };

    bus.room = &room;
    mu_random_seed(&random_numbers, 1, "parcels");
    return suite_run("bus/parcels", all);
}
