/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/dedup.h"
#include "suite.h"

#include "core/hash.h"

#include <CUnit/Basic.h>

static muster_Mail mail_of(const char *src, uint64_t seq, uint32_t layer, int32_t priority)
{
    return (muster_Mail){
        .src = (char *)(uintptr_t)src, .seq = seq, .layer = layer, .priority = priority};
}

static void take(struct dedup *t, const char *src, uint64_t seq)
{
    muster_Mail m = mail_of(src, seq, 3, 0);
    dedup_add(t, &m);
}

static bool is_taken(const struct dedup *t, const char *src, uint64_t seq)
{
    muster_Mail m = mail_of(src, seq, 3, 0);
    return dedup_has(t, &m);
}

static void test_the_last_ones_are_known(void)
{
    static struct dedup t;
    CU_ASSERT_FALSE(is_taken(&t, "red", 1));
    CU_ASSERT_FALSE(is_taken(&t, "", 0)); /* nothing was taken, not even number 0 */
    for (uint64_t seq = 1; seq <= DEDUP_MAX; seq++) {
        take(&t, "red", seq);
    }
    CU_ASSERT_TRUE(is_taken(&t, "red", 1));
    CU_ASSERT_TRUE(is_taken(&t, "red", DEDUP_MAX));
    CU_ASSERT_FALSE(is_taken(&t, "blue", 1));
    CU_ASSERT_FALSE(is_taken(&t, "red", DEDUP_MAX + 1));
    take(&t, "blue", 1);
    CU_ASSERT_FALSE(is_taken(&t, "red", 1)); /* the oldest made room */
    CU_ASSERT_TRUE(is_taken(&t, "red", 2));
    CU_ASSERT_TRUE(is_taken(&t, "blue", 1));
}

/* What overtakes in the box does not drive out what it has overtaken. */
static void test_each_priority_has_its_own(void)
{
    static struct dedup t;
    muster_Mail kept[] = {mail_of("red", 1, 0, 0), mail_of("red", 2, 3, -1),
                          mail_of("red", 3, 3, 0)};
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; i++) {
        dedup_add(&t, &kept[i]);
    }
    for (uint64_t seq = 4; seq < 4 + 2 * DEDUP_MAX; seq++) {
        muster_Mail high = mail_of("red", seq, 3, 1);
        dedup_add(&t, &high);
    }
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; i++) {
        CU_ASSERT_TRUE(dedup_has(&t, &kept[i]));
    }
    dedup_clear(&t);
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; i++) {
        CU_ASSERT_FALSE(dedup_has(&t, &kept[i]));
    }
}

/* Its broker had no store and died with it, so it counts from 1 once more. */
static void test_another_life_of_a_sender_is_another_sender(void)
{
    static struct dedup t;
    muster_Mail first = mail_of("red", 1, 3, 0), second = first, restored = first;
    first.since_wall_ns = 1700000000000000000u;
    second.since_wall_ns = first.since_wall_ns + 1;
    dedup_add(&t, &first);
    CU_ASSERT_TRUE(dedup_has(&t, &first));
    CU_ASSERT_FALSE(dedup_has(&t, &second));
    CU_ASSERT_TRUE(dedup_has(&t, &restored)); /* a store does not say, and gives no number twice */
    dedup_clear(&t);
    dedup_add(&t, &restored);
    CU_ASSERT_TRUE(dedup_has(&t, &first));
}

static void test_limit_brokers(void)
{
    static struct dedup t;
    for (uint64_t i = 1; i <= DEDUP_BROKERS; i++) {
        dedup_leave(&t, i, 10 * i);
    }
    CU_ASSERT_EQUAL(dedup_last_number(&t, 1), 10);
    dedup_leave(&t, 2, 21); /* it was there again */
    CU_ASSERT_EQUAL(dedup_last_number(&t, 2), 21);
    CU_ASSERT_EQUAL(dedup_last_number(&t, 1), 10);
    dedup_leave(&t, 5, 50);
    CU_ASSERT_EQUAL(dedup_last_number(&t, 1), 0); /* the one that it left first made room */
    for (uint64_t i = 3; i <= 5; i++) {
        CU_ASSERT_EQUAL(dedup_last_number(&t, i), 10 * i);
    }
    dedup_clear(&t);
    CU_ASSERT_EQUAL(dedup_last_number(&t, 5), 0);
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
