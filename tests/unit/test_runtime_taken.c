/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/taken.h"

#include "core/hash.h"

#include <CUnit/Basic.h>
#include <stdlib.h>

static void test_the_last_ones_are_known(void)
{
    static struct taken t;
    CU_ASSERT_FALSE(taken_has(&t, "red", 1));
    CU_ASSERT_FALSE(taken_has(&t, "", 0)); /* nothing was taken, not even number 0 */
    for (uint64_t seq = 1; seq <= TAKEN_MAX; seq++) {
        taken_add(&t, "red", seq);
    }
    CU_ASSERT_TRUE(taken_has(&t, "red", 1));
    CU_ASSERT_TRUE(taken_has(&t, "red", TAKEN_MAX));
    CU_ASSERT_FALSE(taken_has(&t, "blue", 1));
    CU_ASSERT_FALSE(taken_has(&t, "red", TAKEN_MAX + 1));
    taken_add(&t, "blue", 1);
    CU_ASSERT_FALSE(taken_has(&t, "red", 1)); /* the oldest made room */
    CU_ASSERT_TRUE(taken_has(&t, "red", 2));
    CU_ASSERT_TRUE(taken_has(&t, "blue", 1));
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
        {"hashes are the published ones", test_hashes_are_the_published_ones},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"taken", NULL, NULL, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    CU_initialize_registry();
    CU_register_suites(suites);
    CU_basic_set_mode(CU_BRM_NORMAL);
    CU_basic_run_tests();
    unsigned failures = CU_get_number_of_failures();
    CU_cleanup_registry();
    return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
