/* SPDX-License-Identifier: Apache-2.0 */
#include "core/pieces.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
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

static void test_numbered_pieces_make_the_text_again(void)
{
    static char text[2 * MU_CONTENT_MAX], again[sizeof text], content[MU_CONTENT_MAX + 1];
    for (size_t k = 0; k + 3 < sizeof text; k += 2) {
        memcpy(text + k, "\xc3\xa9", 2); /* an e with an acute */
    }
    memmove(text + 1, text, sizeof text - 2);
    text[0] = 'e'; /* a character now lies across the end of the first piece */
    size_t len = strlen(text), at = 0;
    unsigned pieces = 0;
    for (; at < len; pieces++) {
        unsigned number;
        size_t total, bytes = mu_pieces_numbered(content, pieces, text, len, at);
        int head = 0;
        CU_ASSERT_EQUAL_FATAL(sscanf(content, "%u %zu%n", &number, &total, &head), 2);
        CU_ASSERT(number == pieces && total == len && content[head] == '\n');
        CU_ASSERT_EQUAL_FATAL(strlen(content + head + 1), bytes);
        CU_ASSERT_NOT_EQUAL((unsigned char)content[head + 1] & 0xc0, 0x80);
        memcpy(again + at, content + head + 1, bytes);
        at += bytes;
    }
    CU_ASSERT_EQUAL(pieces, 3);
    READS(again, text);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"short texts are one piece", test_short_texts_are_one_piece},
        {"they end with a line", test_they_end_with_a_line},
        {"characters stay whole", test_characters_stay_whole},
        {"numbered pieces make the text again", test_numbered_pieces_make_the_text_again},
        CU_TEST_INFO_NULL};
    return suite_run("core/pieces", tests);
}
