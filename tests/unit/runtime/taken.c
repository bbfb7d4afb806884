/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/taken.h"
#include "suite.h"

#include "core/hash.h"

#include <CUnit/Basic.h>

static muster_Mail mail_of(const char *src, uint64_t seq, uint32_t layer, int32_t priority)
{
    return (muster_Mail){
        .src = (char *)(uintptr_t)src, .seq = seq, .layer = layer, .priority = priority};
}

static void take(struct taken *t, const char *src, uint64_t seq)
{
    muster_Mail m = mail_of(src, seq, 3, 0);
    taken_add(t, &m);
}

static bool is_taken(const struct taken *t, const char *src, uint64_t seq)
{
    muster_Mail m = mail_of(src, seq, 3, 0);
    return taken_has(t, &m);
}

static void test_the_last_ones_are_known(void)
{
    static struct taken t;
    CU_ASSERT_FALSE(is_taken(&t, "red", 1));
    CU_ASSERT_FALSE(is_taken(&t, "", 0)); /* nothing was taken, not even number 0 */
    for (uint64_t seq = 1; seq <= TAKEN_MAX; seq++) {
        take(&t, "red", seq);
    }
    CU_ASSERT_TRUE(is_taken(&t, "red", 1));
    CU_ASSERT_TRUE(is_taken(&t, "red", TAKEN_MAX));
    CU_ASSERT_FALSE(is_taken(&t, "blue", 1));
    CU_ASSERT_FALSE(is_taken(&t, "red", TAKEN_MAX + 1));
    take(&t, "blue", 1);
    CU_ASSERT_FALSE(is_taken(&t, "red", 1)); /* the oldest made room */
    CU_ASSERT_TRUE(is_taken(&t, "red", 2));
    CU_ASSERT_TRUE(is_taken(&t, "blue", 1));
}

/* What overtakes in the box does not drive out what it has overtaken. */
static void test_each_priority_has_its_own(void)
{
    static struct taken t;
    muster_Mail kept[] = {mail_of("red", 1, 0, 0), mail_of("red", 2, 3, -1),
                          mail_of("red", 3, 3, 0)};
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; i++) {
        taken_add(&t, &kept[i]);
    }
    for (uint64_t seq = 4; seq < 4 + 2 * TAKEN_MAX; seq++) {
        muster_Mail high = mail_of("red", seq, 3, 1);
        taken_add(&t, &high);
    }
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; i++) {
        CU_ASSERT_TRUE(taken_has(&t, &kept[i]));
    }
    taken_clear(&t);
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; i++) {
        CU_ASSERT_FALSE(taken_has(&t, &kept[i]));
    }
}

/* Its broker had no store and died with it, so it counts from 1 once more. */
static void test_another_life_of_a_sender_is_another_sender(void)
{
    static struct taken t;
    muster_Mail first = mail_of("red", 1, 3, 0), second = first, restored = first;
    first.since_wall_ns = 1700000000000000000u;
    second.since_wall_ns = first.since_wall_ns + 1;
    taken_add(&t, &first);
    CU_ASSERT_TRUE(taken_has(&t, &first));
    CU_ASSERT_FALSE(taken_has(&t, &second));
    CU_ASSERT_TRUE(taken_has(&t, &restored)); /* a store does not say, and gives no number twice */
    taken_clear(&t);
    taken_add(&t, &restored);
    CU_ASSERT_TRUE(taken_has(&t, &first));
}

static void test_limit_brokers(void)
{
    static struct taken t;
    for (uint64_t i = 1; i <= TAKEN_BROKERS; i++) {
        taken_leave(&t, i, 10 * i);
    }
    CU_ASSERT_EQUAL(taken_last_number(&t, 1), 10);
    taken_leave(&t, 2, 21); /* it was there again */
    CU_ASSERT_EQUAL(taken_last_number(&t, 2), 21);
    CU_ASSERT_EQUAL(taken_last_number(&t, 1), 10);
    taken_leave(&t, 5, 50);
    CU_ASSERT_EQUAL(taken_last_number(&t, 1), 0); /* the one that it left first made room */
    for (uint64_t i = 3; i <= 5; i++) {
        CU_ASSERT_EQUAL(taken_last_number(&t, i), 10 * i);
    }
    taken_clear(&t);
    CU_ASSERT_EQUAL(taken_last_number(&t, 5), 0);
}

static void test_hashes_are_the_published_ones(void)
{
    CU_ASSERT_EQUAL(mu_hash_string(""), 0xcbf29ce484222325ull);
    CU_ASSERT_EQUAL(mu_hash_string("a"), 0xaf63dc4c8601ec8cull);
    CU_ASSERT_EQUAL(mu_hash_string("foobar"), 0x85944171f73967e8ull);
    CU_ASSERT_EQUAL(mu_hash_number(0), 0);
    CU_ASSERT_EQUAL(mu_hash_number(0x9e3779b97f4a7c15ull), 0xe220a8397b1dcdafull);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the last ones are known", test_the_last_ones_are_known},
        {"each priority has its own", test_each_priority_has_its_own},
        {"another life of a sender is another sender",
         test_another_life_of_a_sender_is_another_sender},
        {"limit: brokers", test_limit_brokers},
        {"hashes are the published ones", test_hashes_are_the_published_ones},
        CU_TEST_INFO_NULL,
    };
    return suite_run("taken", tests);
}
