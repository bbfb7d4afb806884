/* SPDX-License-Identifier: Apache-2.0 */
#include "core/random.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdbool.h>

/* The generator's reference output for the state 1234567, as published with xoshiro. */
static void test_reference_values(void)
{
    static const uint64_t want[] = {6457827717110365317u, 3203168211198807973u,
                                    9817491932198370423u, 4593380528125082431u,
                                    16408922859458223821u};
    struct mu_random r = {.state = 1234567};
    for (size_t i = 0; i < sizeof want / sizeof want[0]; i++) {
        CU_ASSERT_EQUAL(mu_random_next(&r), want[i]);
    }
}

/* Recordings of old runs depend on these: computed by another program from the definition. */
static void test_streams_stay_what_they_were(void)
{
    static const struct {
        uint64_t seed;
        const char *name;
        uint64_t want[3];
    } streams[] = {
        {0, "", {0x21fa69a58f3d62f5, 0xbc78bed6e022d134, 0xb42a8fa96d1c00b4}},
        {1, "red", {0x46911b21519660e7, 0x79426a8055fc08d2, 0x94732e33f784eed9}},
        {UINT64_MAX, "blue", {0xd25e5838cec7dc27, 0x7ce32e5a87c454f9, 0x5d62bae764f45842}},
    };
    for (size_t i = 0; i < sizeof streams / sizeof streams[0]; i++) {
        struct mu_random r;
        mu_random_seed(&r, streams[i].seed, streams[i].name);
        for (size_t k = 0; k < 3; k++) {
            CU_ASSERT_EQUAL(mu_random_next(&r), streams[i].want[k]);
        }
    }
}

static void test_seed_and_name_part_the_streams(void)
{
    enum { SEEDS = 20 };
    static const char *const names[] = {"", "a", "b", "ab", "ba", "red", "der", "blue"};
    enum { NAMES = sizeof names / sizeof names[0] };
    uint64_t first[SEEDS * NAMES];
    for (size_t i = 0; i < SEEDS * NAMES; i++) {
        struct mu_random r;
        struct mu_random again;
        mu_random_seed(&r, i / NAMES, names[i % NAMES]);
        mu_random_seed(&again, i / NAMES, names[i % NAMES]);
        first[i] = mu_random_next(&r);
        CU_ASSERT_EQUAL(mu_random_next(&again), first[i]);
    }
    unsigned same = 0;
    for (size_t i = 0; i < SEEDS * NAMES; i++) {
        for (size_t k = 0; k < i; k++) {
            same += first[i] == first[k];
        }
    }
    CU_ASSERT_EQUAL(same, 0);
}

static void test_unit_is_in_its_interval(void)
{
    enum { ROUNDS = 20000, PARTS = 10 };
    struct mu_random r;
    unsigned parts[PARTS] = {0};
    bool inside = true;
    mu_random_seed(&r, 3, "unit");
    for (int i = 0; i < ROUNDS; i++) {
        double u = mu_random_unit(&r);
        inside = inside && u >= 0.0 && u < 1.0;
        parts[inside ? (int)(u * PARTS) : 0]++;
    }
    CU_ASSERT_TRUE(inside);
    for (int i = 0; i < PARTS; i++) { /* six standard deviations */
        CU_ASSERT(parts[i] > 1745 && parts[i] < 2255);
    }
}

static void test_between_reaches_both_ends(void)
{
    static const int64_t edges[][2] = {
        {0, 1}, {-1, 1}, {-3, -2}, {INT64_MAX - 1, INT64_MAX}, {INT64_MIN, INT64_MIN + 2}};
    struct mu_random r;
    mu_random_seed(&r, 4, "between");
    for (size_t i = 0; i < sizeof edges / sizeof edges[0]; i++) {
        int64_t lo = edges[i][0];
        int64_t hi = edges[i][1];
        bool at_lo = false;
        bool at_hi = false;
        for (int k = 0; k < 200; k++) {
            int64_t got = mu_random_between(&r, lo, hi);
            CU_ASSERT_FATAL(got >= lo && got <= hi);
            at_lo = at_lo || got == lo;
            at_hi = at_hi || got == hi;
        }
        CU_ASSERT(at_lo && at_hi);
    }
}

static void test_between_everything_and_nothing(void)
{
    struct mu_random r;
    struct mu_random raw;
    bool below = false;
    bool above = false;
    mu_random_seed(&r, 5, "wide");
    raw = r;
    for (int i = 0; i < 100; i++) {
        int64_t got = mu_random_between(&r, INT64_MIN, INT64_MAX);
        CU_ASSERT_EQUAL(got, (int64_t)((uint64_t)INT64_MIN + mu_random_next(&raw)));
        below = below || got < INT64_MIN / 2;
        above = above || got > INT64_MAX / 2;
        CU_ASSERT(mu_random_between(&r, -1, INT64_MAX) >= -1);
        CU_ASSERT(mu_random_between(&r, INT64_MIN, 0) <= 0);
        raw = r;
    }
    CU_ASSERT(below && above);
    CU_ASSERT_EQUAL(mu_random_between(&r, 7, 7), 7);
    CU_ASSERT_EQUAL(mu_random_between(&r, 7, 6), 7);
    CU_ASSERT_EQUAL(mu_random_between(&r, INT64_MAX, INT64_MIN), INT64_MAX);
    CU_ASSERT_EQUAL(r.state, raw.state);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"reference values", test_reference_values},
        {"streams stay what they were", test_streams_stay_what_they_were},
        {"seed and name part the streams", test_seed_and_name_part_the_streams},
        {"unit", test_unit_is_in_its_interval},
        {"between reaches both ends", test_between_reaches_both_ends},
        {"between everything, and nothing", test_between_everything_and_nothing},
        CU_TEST_INFO_NULL,
    };
    return suite_run("core/random", tests);
}
