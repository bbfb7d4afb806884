/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text.h"
#include "core/random.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static void test_text_grows_and_is_cleared(void)
{
    char buffer[32];
    struct mu_text t;
    mu_text_init(&t, buffer, sizeof buffer);
    CU_ASSERT_STRING_EQUAL(t.at, "");
    mu_text_add(&t, "red");
    mu_text_format(&t, " %d/%s", 7, "x");
    mu_text_add_bytes(&t, "green", 2);
    CU_ASSERT_STRING_EQUAL(buffer, "red 7/xgr");
    CU_ASSERT_EQUAL(t.len, 9);
    CU_ASSERT_FALSE(t.cut);
    mu_text_clear(&t);
    CU_ASSERT_EQUAL(t.len, 0);
    CU_ASSERT_EQUAL(t.size, sizeof buffer);
    CU_ASSERT_STRING_EQUAL(buffer, "");
}

static void test_numbers_are_those_of_printf(void)
{
    const long long numbers[] = {0, 7, 10, -1, -90, 1234567890123, INT64_MAX, INT64_MIN};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        char one[32], other[32];
        struct mu_text t = mu_text_in(one, sizeof one), u = mu_text_in(other, sizeof other);
        mu_text_add_number(&t, numbers[i]);
        mu_text_format(&u, "%lld", numbers[i]);
        CU_ASSERT_STRING_EQUAL(one, other);
        CU_ASSERT_EQUAL(t.len, u.len);
    }
    char few[4];
    struct mu_text t = mu_text_in(few, sizeof few);
    mu_text_add_number(&t, 12345);
    CU_ASSERT_TRUE(t.cut);
}

static void test_limit_text_is_cut(void)
{
    char buffer[8];
    struct mu_text t;
    mu_text_init(&t, buffer, sizeof buffer);
    mu_text_add(&t, "1234567");
    CU_ASSERT_FALSE(t.cut);
    mu_text_add(&t, "");
    mu_text_format(&t, "%s", "");
    CU_ASSERT_FALSE(t.cut);
    mu_text_add(&t, "8");
    CU_ASSERT_TRUE(t.cut);
    CU_ASSERT_STRING_EQUAL(buffer, "1234567");
    CU_ASSERT_EQUAL(t.len, 7);

    mu_text_clear(&t);
    CU_ASSERT_FALSE(t.cut);
    mu_text_format(&t, "%d", 1234567);
    CU_ASSERT_FALSE(t.cut);
    mu_text_clear(&t);
    mu_text_format(&t, "%d", 12345678);
    CU_ASSERT_TRUE(t.cut);
    CU_ASSERT_STRING_EQUAL(buffer, "1234567");
    CU_ASSERT_EQUAL(t.len, 7);
    mu_text_format(&t, "%s", "more");
    mu_text_add_bytes(&t, "more", 4);
    CU_ASSERT_STRING_EQUAL(buffer, "1234567");
}

static void test_text_of_one_byte_holds_nothing(void)
{
    char buffer[2] = "xy";
    struct mu_text t;
    mu_text_init(&t, buffer, 1);
    mu_text_add(&t, "a");
    CU_ASSERT_TRUE(t.cut);
    CU_ASSERT_STRING_EQUAL(buffer, "");
    CU_ASSERT_EQUAL(buffer[1], 'y');
}

static void test_copy_says_whether_it_fitted(void)
{
    char to[4];
    CU_ASSERT_TRUE(mu_text_copy(to, sizeof to, "abc"));
    CU_ASSERT_STRING_EQUAL(to, "abc");
    CU_ASSERT_FALSE(mu_text_copy(to, sizeof to, "abcd"));
    CU_ASSERT_STRING_EQUAL(to, "abc");
    CU_ASSERT_TRUE(mu_text_copy(to, sizeof to, ""));
    CU_ASSERT_STRING_EQUAL(to, "");
}

/* Encodes by the bit patterns of Unicode 15, table 3-6.  @return bytes */
static size_t encode(uint32_t code, char to[5])
{
    size_t len = code < 0x80 ? 1 : code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
    static const unsigned char leads[] = {0, 0x00, 0xc0, 0xe0, 0xf0};
    for (size_t i = len; i-- > 1;) {
        to[i] = (char)(0x80 | (code & 0x3f));
        code >>= 6;
    }
    to[0] = (char)(leads[len] | code);
    to[len] = '\0';
    return len;
}

static void test_every_character_is_read_back(void)
{
    unsigned wrong = 0;
    for (uint32_t code = 1; code <= 0x110fff; code++) {
        char bytes[5];
        size_t len = encode(code, bytes);
        bool valid = code <= 0x10ffff && (code < 0xd800 || code > 0xdfff);
        uint32_t got;
        size_t used = mu_utf8_next(bytes, &got);
        wrong += valid ? used != len || got != code : used != 1 || got != MU_UTF8_BROKEN;
    }
    CU_ASSERT_EQUAL(wrong, 0);
}

static void test_broken_characters(void)
{
    static const char *const broken[] = {
        "\x80",
        "\xbf",
        "\xfe",
        "\xff",
        "\xc0\x80",
        "\xc1\xbf",
        "\xe0\x80\x80",
        "\xe0\x9f\xbf",
        "\xc3",
        "\xe2\x82",
        "\xf0\x9f\x98",
        "\xc3(",
        "\xe2(\xa1",
        "\xf8\x88\x80\x80\x80",
        "\xf0\x80\x80\x80",
        "\xf4\x90\x80\x80",
        "\xed\xa0\x80",
    };
    for (size_t i = 0; i < sizeof broken / sizeof broken[0]; i++) {
        uint32_t code = 0;
        CU_ASSERT_EQUAL(mu_utf8_next(broken[i], &code), 1);
        CU_ASSERT_EQUAL(code, MU_UTF8_BROKEN);
    }
    uint32_t code = 1;
    CU_ASSERT_EQUAL(mu_utf8_next("", &code), 0);
    CU_ASSERT_EQUAL(code, 0);
}

/* Whatever the bytes are, the reader stays inside and gets to the end. */
static void test_random_bytes_are_walked_through(void)
{
    enum { SEED = 5, ROUNDS = 20000, LEN_MAX = 24 };
    struct mu_random r;
    mu_random_seed(&r, SEED, "utf8");
    for (int round = 0; round < ROUNDS; round++) {
        char bytes[LEN_MAX + 1];
        size_t len = (size_t)mu_random_between(&r, 0, LEN_MAX);
        for (size_t i = 0; i < len; i++) {
            /* Lead and continuation bytes more often than chance would have them. */
            bytes[i] = (char)(mu_random_between(&r, 0, 1) ? mu_random_between(&r, 1, 255)
                                                          : mu_random_between(&r, 0x80, 0xf7));
        }
        bytes[len] = '\0';
        size_t at = 0;
        uint32_t code;
        for (size_t used; (used = mu_utf8_next(bytes + at, &code)) > 0; at += used) {
            CU_ASSERT_FATAL(used <= len - at);
        }
        CU_ASSERT_EQUAL_FATAL(at, len);
    }
    printf("seed %d ", SEED);
}

/* What somebody's file says must not move a cursor, or worse. */
static void test_control_characters_are_not_shown(void)
{
    static const char evil[] = "a\033[2Jb\nc\177d\302\233e\303\244\302\251\302";
    char buffer[64];
    struct mu_text t;
    mu_text_init(&t, buffer, sizeof buffer);
    mu_text_add_plain(&t, evil, sizeof evil - 1);
    READS(t.at, "a?[2Jb?c?d?e\303\244\302\251\302");
    mu_text_init(&t, buffer, 4);
    mu_text_add_plain(&t, "\001\002\003\004", 4);
    READS(t.at, "???");
    CU_ASSERT(t.cut);
    mu_text_init(&t, buffer, sizeof buffer);
    mu_text_add_plain(&t, "", 0);
    READS(t.at, "");
}

int main(void)
{
    CU_TestInfo texts[] = {
        {"grows and is cleared", test_text_grows_and_is_cleared},
        {"numbers are those of printf", test_numbers_are_those_of_printf},
        {"limit: what does not fit is cut", test_limit_text_is_cut},
        {"limit: a buffer of one byte", test_text_of_one_byte_holds_nothing},
        {"control characters are not shown", test_control_characters_are_not_shown},
        {"copy", test_copy_says_whether_it_fitted},
        CU_TEST_INFO_NULL,
    };
    CU_TestInfo utf8[] = {
        {"every character is read back", test_every_character_is_read_back},
        {"broken characters", test_broken_characters},
        {"random bytes", test_random_bytes_are_walked_through},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"core/text", NULL, NULL, NULL, NULL, texts},
                             {"core/text utf8", NULL, NULL, NULL, NULL, utf8},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
