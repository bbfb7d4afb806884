/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/ack_delay.h"
#include "suite.h"

#include <CUnit/Basic.h>

static const uint64_t T_NS = 7000000000;

static void test_nothing_owed_is_never_due(void)
{
    struct ack_delay o = {0};
    CU_ASSERT_FALSE(ack_delay_due(&o, 0));
    CU_ASSERT_FALSE(ack_delay_due(&o, T_NS));
    CU_ASSERT_EQUAL(ack_delay_wait_ns(&o, T_NS), INT64_MAX);
}

static void test_the_first_parcel_starts_the_clock(void)
{
    struct ack_delay o = {0};
    ack_delay_add(&o, T_NS);
    ack_delay_add(&o, T_NS + ACK_DELAY_NS - 1);
    CU_ASSERT_FALSE(ack_delay_due(&o, T_NS + ACK_DELAY_NS - 1));
    CU_ASSERT_EQUAL(ack_delay_wait_ns(&o, T_NS + ACK_DELAY_NS - 1), 1);
    CU_ASSERT_TRUE(ack_delay_due(&o, T_NS + ACK_DELAY_NS));
}

static void test_many_parcels_wait_for_nothing(void)
{
    struct ack_delay o = {0};
    for (int i = 1; i < ACK_DELAY_ITEMS; i++) {
        ack_delay_add(&o, T_NS);
    }
    CU_ASSERT_FALSE(ack_delay_due(&o, T_NS));
    ack_delay_add(&o, T_NS);
    CU_ASSERT_TRUE(ack_delay_due(&o, T_NS));
}

static void test_what_is_due_and_cannot_go_is_no_busy_loop(void)
{
    struct ack_delay o = {0};
    ack_delay_add(&o, T_NS);
    CU_ASSERT_EQUAL(ack_delay_wait_ns(&o, T_NS + 10 * (uint64_t)ACK_DELAY_NS), ACK_DELAY_NS);
}

static void test_what_is_out_is_not_owed(void)
{
    struct ack_delay o = {0};
    ack_delay_add(&o, T_NS);
    ack_delay_clear(&o, T_NS);
    CU_ASSERT_FALSE(ack_delay_due(&o, T_NS + ACK_PAUSE_NS));
    ack_delay_add(&o, T_NS + ACK_PAUSE_NS);
    CU_ASSERT_FALSE(ack_delay_due(&o, T_NS + ACK_PAUSE_NS));
    CU_ASSERT_TRUE(ack_delay_due(&o, T_NS + ACK_PAUSE_NS + ACK_DELAY_NS));
}

/* @return how long who has spoken at that time, and takes one item after the other, is silent */
static uint64_t pause_after(uint64_t said_ns)
{
    struct ack_delay o = {0};
    ack_delay_add(&o, said_ns);
    ack_delay_clear(&o, said_ns);
    ack_delay_add(&o, said_ns + 1);
    uint64_t pause_ns = 1 + (uint64_t)ack_delay_wait_ns(&o, said_ns + 1);
    CU_ASSERT_FALSE(ack_delay_due(&o, said_ns + pause_ns - 1));
    CU_ASSERT_TRUE(ack_delay_due(&o, said_ns + pause_ns));
    return pause_ns;
}

static void test_a_steady_taker_speaks_at_intervals(void)
{
    struct ack_delay o = {0};
    ack_delay_add(&o, T_NS);
    ack_delay_clear(&o, T_NS);
    ack_delay_clear(&o, T_NS + 2 * (uint64_t)ACK_PAUSE_NS); /* nothing was said */
    ack_delay_add(&o, T_NS + 2 * (uint64_t)ACK_PAUSE_NS);
    CU_ASSERT_TRUE(ack_delay_due(&o, T_NS + 2 * (uint64_t)ACK_PAUSE_NS + ACK_DELAY_NS));
    for (int i = 1; i < ACK_DELAY_ITEMS; i++) {
        ack_delay_add(&o, T_NS + ACK_PAUSE_NS);
    }
    CU_ASSERT_TRUE(ack_delay_due(&o, T_NS + 2 * (uint64_t)ACK_PAUSE_NS)); /* the window fills up */
}

/* A hundred that have answered a broadcast within a millisecond do not do so together again. */
static void test_a_crowd_speaks_at_different_times(void)
{
    enum { CROWD = 100, TENTHS = 10 };
    unsigned in_tenth[TENTHS] = {0};
    for (uint64_t i = 0; i < CROWD; i++) {
        uint64_t said_ns = T_NS + 9973 * i;
        uint64_t pause_ns = pause_after(said_ns);
        CU_ASSERT_FATAL(pause_ns >= ACK_PAUSE_NS / 2 && pause_ns < ACK_PAUSE_NS * 3 / 2);
        in_tenth[(pause_ns - ACK_PAUSE_NS / 2) * TENTHS / ACK_PAUSE_NS]++;
    }
    for (int i = 0; i < TENTHS; i++) {
        CU_ASSERT(in_tenth[i] < CROWD / 4);
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"nothing owed is never due", test_nothing_owed_is_never_due},
        {"the first item starts the clock", test_the_first_parcel_starts_the_clock},
        {"many parcels wait for nothing", test_many_parcels_wait_for_nothing},
        {"what is due and cannot go is no busy loop",
         test_what_is_due_and_cannot_go_is_no_busy_loop},
        {"what is out is not owed", test_what_is_out_is_not_owed},
        {"a steady taker speaks at intervals", test_a_steady_taker_speaks_at_intervals},
        {"a crowd speaks at different times", test_a_crowd_speaks_at_different_times},
        CU_TEST_INFO_NULL,
    };
    return suite_run("runtime/ack_delay", tests);
}
