/* SPDX-License-Identifier: Apache-2.0 */
/* Codes of refusals: each has a word and a text of its own, and is found by the word. */
#include "muster/refusal.h"
#include "suite.h"

#include <string.h>

static void test_each_has_its_word(void)
{
    for (int i = MU_REFUSAL_NONE + 1; i <= MU_REFUSAL_GROUP_EXISTS; i++) {
        enum mu_refusal code = (enum mu_refusal)i;
        char content[128];
        snprintf(content, sizeof content, "suspend %s standby", mu_refusal_word(code));
        CU_ASSERT_TRUE(mu_refusal_word(code)[0] && mu_refusal_text(code)[0]);
        CU_ASSERT_EQUAL(mu_refusal_named(mu_refusal_word(code)), code);
        CU_ASSERT_EQUAL(mu_refusal_of(content), code);
    }
}

static void test_text_is_no_code(void)
{
    static const char *const texts[] = {
        "", " ", "held", "red not-held", "the host is busy", "red wrong-statement", "red  busy"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        CU_ASSERT_EQUAL(mu_refusal_of(texts[i]), MU_REFUSAL_NONE);
    }
    CU_ASSERT_EQUAL(mu_refusal_named("held by another"), MU_REFUSAL_NONE);
    CU_ASSERT_EQUAL(mu_refusal_named(""), MU_REFUSAL_NONE);
    CU_ASSERT_STRING_EQUAL(mu_refusal_word((enum mu_refusal)1000), "");
    CU_ASSERT_STRING_EQUAL(mu_refusal_text((enum mu_refusal) - 1), "");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"each has its word", test_each_has_its_word},
        {"text is no code", test_text_is_no_code},
        CU_TEST_INFO_NULL,
    };
    return suite_run("refusal", tests);
}
