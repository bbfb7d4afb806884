/* SPDX-License-Identifier: Apache-2.0 */
#include "core/name.h"
#include "muster/limits.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static void test_names_that_are_names(void)
{
    static const char *const names[] = {"a",   "Z",    "_",       "red", "red.1",  "r2-d2",
                                        "__",  "a..b", "A_b-C.9", "all", "broker", "broker.x",
                                        "nil", "true", "x-",      "x.",  "_-._-.", "operator"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        CU_ASSERT_TRUE(mu_name_valid(names[i]));
    }
}

static void test_names_from_hell(void)
{
    static const char *const names[] = {
        "",
        " ",
        "9",
        "-",
        ".",
        "-rf",
        "..",
        "../x",
        "a/b",
        "a b",
        " a",
        "a ",
        "a\n",
        "\na",
        "a\tb",
        "a,b",
        "a:b",
        "group:g",
        "*",
        "a*",
        "?x",
        "$?x",
        "?*x*",
        "a;b",
        "a'b",
        "a\"b",
        "a\\b",
        "(a)",
        "a&b",
        "a|b",
        "~a",
        "a=b",
        "a%sb",
        "%n",
        "a\x01"
        "b",
        "a\x7f",
        "\x1b[31m",
        "r\xc3\xb6t",
        "\xc3\xa9",
        "\xff\xfe",
        "a\x80",
        "a\xc2\xa0",
        "\xd0\xb0",
        "e\xcc\x81",
        "\xe2\x80\xae"
        "a",
        "\xf0\x9f\xa4\x96",
        "@",
        "[",
        "`",
        "{",
        "a^",
    };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        CU_ASSERT_FALSE(mu_name_valid(names[i]));
    }
}

/* The grammar again, a character at a time, against every single byte in each place. */
static void test_every_byte_in_every_place(void)
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_";
    static const char later[] = "0123456789.-";
    for (int byte = 1; byte < 256; byte++) {
        const char first[] = {(char)byte, '\0'};
        const char second[] = {'a', (char)byte, '\0'};
        bool starts = strchr(letters, byte) != NULL;
        CU_ASSERT_EQUAL(mu_name_valid(first), starts);
        CU_ASSERT_EQUAL(mu_name_valid(second), starts || strchr(later, byte) != NULL);
    }
}

static void test_limit_length(void)
{
    char name[4 * MU_NAME_MAX];
    memset(name, 'n', sizeof name);
    name[MU_NAME_MAX + 1] = '\0';
    CU_ASSERT_FALSE(mu_name_valid(name));
    name[MU_NAME_MAX] = '\0';
    CU_ASSERT_TRUE(mu_name_valid(name));
    name[MU_NAME_MAX - 1] = ' ';
    CU_ASSERT_FALSE(mu_name_valid(name));
    /* Too long even without an end in reach. */
    memset(name, 'n', sizeof name);
    CU_ASSERT_FALSE(mu_name_valid(name));
}

static void test_reserved_names(void)
{
    static const char *const reserved[] = {"all",      "robots",    "special",
                                           "observer", "operator",  "broker",
                                           "broker.",  "broker.b1", "broker.broker"};
    static const char *const allowed[] = {
        "All",     "ALL",   "al",        "all_",      "all.x",      "robot",    "",
        "brokers", "broke", "broker-b1", "operators", "observer.1", "specials", "red",
    };
    for (size_t i = 0; i < sizeof reserved / sizeof reserved[0]; i++) {
        CU_ASSERT_TRUE(mu_name_reserved(reserved[i]));
    }
    for (size_t i = 0; i < sizeof allowed / sizeof allowed[0]; i++) {
        CU_ASSERT_FALSE(mu_name_reserved(allowed[i]));
    }
}

static void test_names_of_groups(void)
{
    static const char *const refused[] = {"all", "robots", "special", "broker", "a b", ""};
    static const char *const allowed[] = {"scouts", "observer", "broker.x", "All"};
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        CU_ASSERT_FALSE(mu_name_of_group(refused[i]));
    }
    for (size_t i = 0; i < sizeof allowed / sizeof allowed[0]; i++) {
        CU_ASSERT_TRUE(mu_name_of_group(allowed[i]));
    }
}

static void test_parts_of_the_broker_that_were_renamed(void)
{
    CU_ASSERT_STRING_EQUAL(mu_name_now("broker.courier"), "broker.delivery");
    CU_ASSERT_STRING_EQUAL(mu_name_was("broker.delivery"), "broker.courier");
    CU_ASSERT_STRING_EQUAL(mu_name_now("broker.delivery"), "broker.delivery");
    CU_ASSERT_STRING_EQUAL(mu_name_now("courier"), "courier");
    CU_ASSERT_PTR_NULL(mu_name_was("broker.trust"));
    CU_ASSERT_PTR_NULL(mu_name_was("broker.courier"));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"names that are names", test_names_that_are_names},
        {"names from hell", test_names_from_hell},
        {"every byte in every place", test_every_byte_in_every_place},
        {"limit: the length of a name", test_limit_length},
        {"reserved names", test_reserved_names},
        {"names of groups", test_names_of_groups},
        {"parts of the broker that were renamed", test_parts_of_the_broker_that_were_renamed},
        CU_TEST_INFO_NULL,
    };
    return suite_run("core/name", tests);
}
