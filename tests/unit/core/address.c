/* SPDX-License-Identifier: Apache-2.0 */
#include "core/address.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static void test_addresses(void)
{
    static const char *const good[] = {"red",        "red,blue",  "all",       "robots",
                                       "special",    "allied",    "group:a.b", "near:2,3",
                                       "role:scout", "red,red,a", "grouped",   "groups:9",
                                       "x:y:z",      "all:2",     "a:\xc3\xa9"};
    static const char *const bad[] = {"",          "red,",      ",red",   "a,,b",    "a b",
                                      "red,all",   "special,a", "group:", "group:1", ":a",
                                      "1:a",       "a:",        "a,b:c",  "a:b c",   "*",
                                      "group:a b", "a:\n",      "\xe9",   ":",       "a:\x7f"};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        CU_ASSERT_TRUE(mu_address_valid(good[i]));
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        CU_ASSERT_FALSE(mu_address_valid(bad[i]));
    }
}

static void test_kinds(void)
{
    static const struct {
        const char *dst;
        enum mu_address_kind kind;
    } all[] = {
        {"red", MU_ADDRESS_NAMES},       {"red,all", MU_ADDRESS_NAMES},
        {"all", MU_ADDRESS_ALL},         {"robots", MU_ADDRESS_ROBOTS},
        {"special", MU_ADDRESS_SPECIAL}, {"group:a", MU_ADDRESS_GROUP},
        {"groups:a", MU_ADDRESS_SCHEME}, {"near:1:2", MU_ADDRESS_SCHEME},
    };
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        CU_ASSERT_EQUAL(mu_address_kind(all[i].dst), all[i].kind);
    }
    CU_ASSERT_STRING_EQUAL(mu_address_rest("near:1:2"), "1:2");
}

static void test_names_of_a_list(void)
{
    char name[MU_NAME_MAX + 1];
    const char *list = "red,r2-d2";
    CU_ASSERT_TRUE(mu_address_next(&list, name));
    CU_ASSERT_STRING_EQUAL(name, "red");
    CU_ASSERT_TRUE(mu_address_next(&list, name));
    CU_ASSERT_STRING_EQUAL(name, "r2-d2");
    CU_ASSERT_FALSE(mu_address_next(&list, name));
}

static void test_limit_name(void)
{
    char dst[2 * MU_NAME_MAX + 8];
    memset(dst, 'a', sizeof dst);
    dst[MU_NAME_MAX + 1] = '\0';
    CU_ASSERT_FALSE(mu_address_valid(dst));
    dst[MU_NAME_MAX] = '\0';
    CU_ASSERT_TRUE(mu_address_valid(dst));
    memcpy(dst + MU_NAME_MAX, ",b", 3);
    CU_ASSERT_TRUE(mu_address_valid(dst));
    memcpy(dst + MU_NAME_MAX, ":b", 3);
    CU_ASSERT_TRUE(mu_address_valid(dst));
    memcpy(dst + MU_NAME_MAX, "a:b", 4);
    CU_ASSERT_FALSE(mu_address_valid(dst));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"addresses", test_addresses},
        {"kinds", test_kinds},
        {"names of a list", test_names_of_a_list},
        {"limit: name", test_limit_name},
        CU_TEST_INFO_NULL,
    };
    return suite_run("core/address", tests);
}
