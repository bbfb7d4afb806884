/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"
#include "suite.h"

#include <CUnit/Basic.h>

static const uint64_t MS = 1000000;

/* Asks every millisecond from one time to the other.  @return how many Beacons went out */
static uint32_t beats(struct heartbeat *p, uint64_t from_ms, uint64_t to_ms, uint64_t silence_ms)
{
    uint32_t count = 0;
    for (uint64_t now = from_ms; now < to_ms; now++) {
        uint64_t spoke_ms = silence_ms < now ? now - silence_ms : 0;
        count += heartbeat_looks(p, now * MS) && heartbeat_beats(p, spoke_ms * MS, now * MS);
    }
    return count;
}

static void test_the_first_is_due_at_once(void)
{
    struct heartbeat p = {0};
    CU_ASSERT_TRUE(heartbeat_looks(&p, 5000 * MS));
    CU_ASSERT_TRUE(heartbeat_beats(&p, 4999 * MS, 5000 * MS)); /* whoever has spoken */
    CU_ASSERT_FALSE(heartbeat_looks(&p, 5000 * MS));
}

static void test_beats_where_nobody_speaks(void)
{
    struct heartbeat p = {0};
    CU_ASSERT_EQUAL(beats(&p, 5000, 8000, UINT64_MAX), 10);
}

static void test_is_spared_where_all_speak(void)
{
    struct heartbeat p = {0};
    CU_ASSERT_EQUAL(beats(&p, 5000, 17000, 10), 10); /* the first look after a second: 1,200 ms */
}

static void test_who_falls_silent_hears_of_us_again(void)
{
    struct heartbeat p = {0};
    CU_ASSERT_EQUAL(beats(&p, 5000, 5700, 10), 1);
    CU_ASSERT_EQUAL(beats(&p, 5700, 8700, 301), 10);
}

static void test_what_was_said_before_the_last_look_does_not_count(void)
{
    struct heartbeat p = {0};
    CU_ASSERT_TRUE(heartbeat_beats(&p, 0, 5000 * MS));
    CU_ASSERT_FALSE(heartbeat_beats(&p, 5001 * MS, 5300 * MS));
    CU_ASSERT_TRUE(heartbeat_beats(&p, 5299 * MS, 5600 * MS));
}

static void test_what_is_asked_for_is_due(void)
{
    struct heartbeat p = {0};
    CU_ASSERT_EQUAL(beats(&p, 5000, 5010, 1), 1);
    p.told_ns = 0;
    CU_ASSERT_EQUAL(beats(&p, 5010, 5020, 1), 1);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the first is due at once", test_the_first_is_due_at_once},
        {"beats where nobody speaks", test_beats_where_nobody_speaks},
        {"is spared where all speak", test_is_spared_where_all_speak},
        {"who falls silent hears of us again", test_who_falls_silent_hears_of_us_again},
        {"what was said before the last look does not count",
         test_what_was_said_before_the_last_look_does_not_count},
        {"what is asked for is due", test_what_is_asked_for_is_due},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/pulse", tests);
}
