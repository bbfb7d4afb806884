/* SPDX-License-Identifier: Apache-2.0 */
#include "../support/suite.h"
#include "core/pieces.h"

#include <CUnit/Basic.h>
#include <string.h>

static const char *rest;
static char piece[16];

static bool next(void)
{
    return mu_pieces_next(&rest, piece, sizeof piece);
}

static void test_short_texts_are_one_piece(void)
{
    rest = "";
    CU_ASSERT_FALSE(next());
    CU_ASSERT_EQUAL(mu_pieces_count("", sizeof piece), 1);
    rest = "123456789012345"; /* fits with its zero */
    CU_ASSERT_TRUE(next());
    READS(piece, "123456789012345");
    CU_ASSERT_FALSE(next());
    CU_ASSERT_EQUAL(mu_pieces_count("123456789012345", sizeof piece), 1);
}

static void test_they_end_with_a_line(void)
{
    static const char text[] = "one\ntwo\nthree\nfour\na line that is long";
    rest = text;
    static const char *const wanted[] = {"one\ntwo\nthree\n", "four\n", "a line that is ", "long"};
    CU_ASSERT_EQUAL(mu_pieces_count(text, sizeof piece), 4);
    for (size_t i = 0; i < 4; i++) {
        CU_ASSERT_TRUE(next());
        READS(piece, wanted[i]);
    }
    CU_ASSERT_FALSE(next());
}

static void test_characters_stay_whole(void)
{
    rest = "1234567890123\xf0\x9f\xa4\x96z"; /* its robot would end behind the piece */
    CU_ASSERT_TRUE(next());
    READS(piece, "1234567890123");
    CU_ASSERT_TRUE(next());
    READS(piece, "\xf0\x9f\xa4\x96z");
    rest = "\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80\x80"; /* no text */
    CU_ASSERT_TRUE(next());
    CU_ASSERT_EQUAL(strlen(piece), 15);
}

int main(void)
{
    CU_TestInfo tests[] = {{"short texts are one piece", test_short_texts_are_one_piece},
                           {"they end with a line", test_they_end_with_a_line},
                           {"characters stay whole", test_characters_stay_whole},
                           CU_TEST_INFO_NULL};
    return suite_run("core/pieces", tests);
}
