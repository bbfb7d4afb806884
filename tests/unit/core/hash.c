/* SPDX-License-Identifier: Apache-2.0 */
#include "core/hash.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

/* Numbers that are published with FNV-1a. */
static void test_published_values(void)
{
    CU_ASSERT_EQUAL(mu_hash_string(""), 0xcbf29ce484222325ull);
    CU_ASSERT_EQUAL(mu_hash_string("a"), 0xaf63dc4c8601ec8cull);
    CU_ASSERT_EQUAL(mu_hash_string("foobar"), 0x85944171f73967e8ull);
}

static void test_bytes_in_parts_are_the_whole(void)
{
    static const char text[] = "a\0b\xff and more";
    uint64_t whole = mu_hash_bytes(MU_HASH_EMPTY, text, sizeof text);
    for (size_t at = 0; at <= sizeof text; at++) {
        uint64_t first = mu_hash_bytes(MU_HASH_EMPTY, text, at);
        CU_ASSERT_EQUAL(mu_hash_bytes(first, text + at, sizeof text - at), whole);
    }
    CU_ASSERT_NOT_EQUAL(mu_hash_bytes(MU_HASH_EMPTY, text, 2), mu_hash_string(text));
}

int main(void)
{
    CU_TestInfo tests[] = {{"published values", test_published_values},
                           {"bytes in parts are the whole", test_bytes_in_parts_are_the_whole},
                           CU_TEST_INFO_NULL};
    return suite_run("core/hash", tests);
}
