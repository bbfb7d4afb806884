/* SPDX-License-Identifier: Apache-2.0 */
#include "core/fields.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static char buffer[128];
static struct mu_text text;

static const char *added(void (*add)(struct mu_text *, const char *), const char *s)
{
    mu_text_init(&text, buffer, sizeof buffer);
    add(&text, s);
    return text.at;
}

static void test_symbols_stay_others_become_strings(void)
{
    CU_ASSERT_STRING_EQUAL(added(mu_fields_add, "red-1"), " red-1");
    CU_ASSERT_STRING_EQUAL(added(mu_fields_add, ""), " \"\"");
    CU_ASSERT_STRING_EQUAL(added(mu_fields_add, "12"), " \"12\"");
    CU_ASSERT_STRING_EQUAL(added(mu_fields_add, "?x"), " \"?x\"");
    CU_ASSERT_STRING_EQUAL(added(mu_fields_add, "a b"), " \"a b\"");
    CU_ASSERT_STRING_EQUAL(added(mu_fields_add, "a(b"), " \"a(b\"");
    CU_ASSERT_STRING_EQUAL(added(mu_fields_add_string, "red"), " \"red\"");
    CU_ASSERT_STRING_EQUAL(added(mu_fields_quote, "a\"b\\c"), "\"a\\\"b\\\\c\"");
}

static void test_what_is_added_is_read(void)
{
    static const char *const all[] = {"red", "", "a\"b\\", "\\\"", "x y", "(do)", "12", "<="};
    char line[256], got[64];
    struct mu_text out;
    mu_text_init(&text, line, sizeof line);
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        mu_fields_add(&text, all[i]);
    }
    const char *at = line;
    mu_text_init(&out, got, sizeof got);
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        CU_ASSERT_FALSE(mu_fields_end(at));
        CU_ASSERT_TRUE(mu_fields_next(&at, &out));
        CU_ASSERT_STRING_EQUAL(got, all[i]);
    }
    CU_ASSERT_TRUE(mu_fields_end(at));
    CU_ASSERT_FALSE(mu_fields_next(&at, &out));
}

static void test_what_is_no_field(void)
{
    static const char *const all[] = {"", " \t", "\"a", "\"a\\\"", "(a", ")"};
    char got[64];
    struct mu_text out;
    mu_text_init(&out, got, sizeof got);
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        const char *at = all[i];
        CU_ASSERT_FALSE(mu_fields_next(&at, &out));
    }
}

static void test_limit_field(void)
{
    char got[4];
    struct mu_text out;
    const char *fits = "abc", *longer = "abcd";
    mu_text_init(&out, got, sizeof got);
    CU_ASSERT_TRUE(mu_fields_next(&fits, &out));
    CU_ASSERT_FALSE(mu_fields_next(&longer, &out));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"symbols stay, others become strings", test_symbols_stay_others_become_strings},
        {"what is added is read", test_what_is_added_is_read},
        {"what is no field", test_what_is_no_field},
        {"limit: field", test_limit_field},
        CU_TEST_INFO_NULL,
    };
    return suite_run("core/fields", tests);
}
