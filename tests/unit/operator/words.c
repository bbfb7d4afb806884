/* SPDX-License-Identifier: Apache-2.0 */
/* What people type: words, receivers, envelopes. */
#include "operator/operator.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static void test_join(void)
{
    static const char *const words[] = {"ab", "", "c"};
    char text[6];
    CU_ASSERT_TRUE(words_join(text, sizeof text, words, 3));
    CU_ASSERT_STRING_EQUAL(text, "ab  c");
    CU_ASSERT_FALSE(words_join(text, sizeof text - 1, words, 3));
    CU_ASSERT_TRUE(words_join(text, sizeof text, words, 0));
    CU_ASSERT_STRING_EQUAL(text, "");
}

static void test_utf8(void)
{
    static const char *const good[] = {"", "a", "\xc3\xa9", "\xef\xbf\xbd", "\xf0\x9f\xa4\x96"};
    static const char *const bad[] = {"\xe9", "a\xc3", "\x80", "\xc0\x80", "\xed\xa0\x80"};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        CU_ASSERT_TRUE(words_are_utf8(good[i]));
        CU_ASSERT_FALSE(words_are_utf8(bad[i]));
    }
}

static void test_show(void)
{
    char shown[MU_TEXT_SHOWN], longest[64];
    CU_ASSERT_STRING_EQUAL(mu_text_show(shown, "a b"), "a b");
    CU_ASSERT_STRING_EQUAL(mu_text_show(shown, "a\n\x1b[1m\xe9"), "a\\x0a\\x1b[1m\\xe9");
    memset(longest, '\n', sizeof longest - 1);
    longest[sizeof longest - 1] = '\0';
    mu_text_show(shown, longest);
    CU_ASSERT_EQUAL(strlen(shown), 24 * 4 + 3);
    CU_ASSERT_STRING_EQUAL(shown + 24 * 4, "...");
}

static void test_names_are_counted_once(void)
{
    CU_ASSERT_EQUAL(receivers_count(NULL, "red", "operator", true), 1);
    CU_ASSERT_EQUAL(receivers_count(NULL, "red,re,red,blue,re", "operator", false), 3);
    CU_ASSERT_EQUAL(receivers_count(NULL, "role:scout", "operator", false), 1);
    CU_ASSERT_FALSE(receivers_are_many("red,blue"));
    CU_ASSERT_TRUE(receivers_are_many("all") && receivers_are_many("group:g"));
}

static void test_envelope(void)
{
    struct mu_mail mail = {.dst = "red"};
    struct envelope e = {.performative = "ask",
                         .level = "synced",
                         .priority = "low",
                         .conversation = "c",
                         .ttl_s = 1.5,
                         .reply_by_s = 2};
    CU_ASSERT_TRUE(envelope_fill(&e, &mail, "send"));
    CU_ASSERT_STRING_EQUAL(mail.performative, "ask");
    CU_ASSERT_STRING_EQUAL(mail.conversation, "c");
    CU_ASSERT_EQUAL(mail.level, MU_LEVEL_SYNCED);
    CU_ASSERT_EQUAL(mail.priority, MU_PRIORITY_LOW);
    CU_ASSERT_EQUAL(mail.ttl_ns, 1500000000);
    CU_ASSERT_EQUAL(mail.reply_by_ns, 2000000000);
    CU_ASSERT_TRUE(envelope_fill(&(struct envelope){0}, &mail, "send"));
    CU_ASSERT_PTR_NULL(mail.ontology);
    CU_ASSERT_EQUAL(mail.level, MU_LEVEL_RAM);
    CU_ASSERT_EQUAL(mail.priority, MU_PRIORITY_NORMAL);
}

static void test_limit_envelope(void)
{
    char field[MU_FIELD_MAX + 2];
    struct mu_mail mail = {.dst = "red"};
    memset(field, 'x', sizeof field - 1);
    field[MU_FIELD_MAX + 1] = '\0';
    CU_ASSERT_FALSE(envelope_fill(&(struct envelope){.ontology = field}, &mail, "send"));
    field[MU_FIELD_MAX] = '\0';
    CU_ASSERT_TRUE(envelope_fill(&(struct envelope){.ontology = field}, &mail, "send"));
    CU_ASSERT_FALSE(envelope_fill(&(struct envelope){.language = "\xe9"}, &mail, "send"));
    CU_ASSERT_FALSE(envelope_fill(&(struct envelope){.level = "RAM"}, &mail, "send"));
    CU_ASSERT_FALSE(envelope_fill(&(struct envelope){.level = ""}, &mail, "send"));
    CU_ASSERT_FALSE(envelope_fill(&(struct envelope){.priority = "high "}, &mail, "send"));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"join", test_join},         {"UTF-8", test_utf8},
        {"show", test_show},         {"names are counted once", test_names_are_counted_once},
        {"envelope", test_envelope}, {"limit: fields of an envelope", test_limit_envelope},
        CU_TEST_INFO_NULL,
    };
    return suite_run("operator/words", tests);
}
