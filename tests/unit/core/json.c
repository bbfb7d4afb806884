/* SPDX-License-Identifier: Apache-2.0 */
#include "core/json.h"
#include "core/text.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static char buffer[1024];
static struct mu_text text;
static struct mu_json json;

static void begin(enum mu_json_form form)
{
    mu_text_init(&text, buffer, sizeof buffer);
    mu_json_to_text(&json, &text, form);
}

static void test_one_line(void)
{
    begin(MU_JSON_LINE);
    mu_json_object(&json, NULL);
    mu_json_string(&json, "name", "red");
    mu_json_bool(&json, "here", true);
    mu_json_int(&json, "least", INT64_MIN);
    mu_json_uint(&json, "most", UINT64_MAX);
    mu_json_string(&json, "host", NULL);
    mu_json_list(&json, "list");
    mu_json_real(&json, NULL, 0.1);
    mu_json_object(&json, NULL);
    mu_json_end(&json);
    mu_json_end(&json);
    mu_json_end(&json);
    CU_ASSERT_STRING_EQUAL(buffer, "{\"name\": \"red\", \"here\": true, "
                                   "\"least\": -9223372036854775808, "
                                   "\"most\": 18446744073709551615, \"host\": null, "
                                   "\"list\": [0.1, {}]}\n");
}

static void test_indented(void)
{
    begin(MU_JSON_INDENTED);
    mu_json_object(&json, NULL);
    mu_json_list(&json, "a");
    mu_json_uint(&json, NULL, 1);
    mu_json_uint(&json, NULL, 2);
    mu_json_end(&json);
    mu_json_list(&json, "none");
    mu_json_end(&json);
    mu_json_end(&json);
    CU_ASSERT_STRING_EQUAL(buffer, "{\n  \"a\": [\n    1,\n    2\n  ],\n  \"none\": []\n}\n");
}

static void test_strings_are_escaped(void)
{
    static const struct {
        const char *value, *want;
    } cases[] = {
        {"a\"b\\c/", "\"a\\\"b\\\\c/\""},
        {"\b\f\n\r\t", "\"\\b\\f\\n\\r\\t\""},
        {"\x01\x1f\x7f", "\"\\u0001\\u001f\\u007f\""},
        {"\xc3\xa9 \xe2\x82\xac \xf0\x9f\x90\xa7", "\"\xc3\xa9 \xe2\x82\xac \xf0\x9f\x90\xa7\""},
        {"\xff", "\"\xef\xbf\xbd\""},
        {"a\xc3", "\"a\xef\xbf\xbd\""},
        {"\xc0\xaf", "\"\xef\xbf\xbd\xef\xbf\xbd\""},
        {"\xed\xa0\x80", "\"\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\""},
        {"", "\"\""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        begin(MU_JSON_LINE);
        mu_json_string(&json, NULL, cases[i].value);
        CU_ASSERT_STRING_EQUAL(buffer, cases[i].want);
    }
}

static void test_keys_are_escaped(void)
{
    begin(MU_JSON_LINE);
    mu_json_object(&json, NULL);
    mu_json_bool(&json, "a\"", false);
    mu_json_end(&json);
    CU_ASSERT_STRING_EQUAL(buffer, "{\"a\\\"\": false}\n");
}

static void test_numbers_read_back_the_same(void)
{
    static const double values[] = {
        0.0,  1.0,     -1.5,         0.1,   1.0 / 3.0,          100.0 * 1.1,
        1e22, DBL_MAX, DBL_TRUE_MIN, -1e-7, 123456789.123456789};
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        char number[MU_JSON_NUMBER_MAX];
        mu_json_number(number, values[i]);
        double back = strtod(number, NULL);
        CU_ASSERT(memcmp(&back, &values[i], sizeof back) == 0);
    }
    char number[MU_JSON_NUMBER_MAX];
    mu_json_number(number, 0.1);
    CU_ASSERT_STRING_EQUAL(number, "0.1");
}

static void test_what_is_not_finite_is_null(void)
{
    begin(MU_JSON_LINE);
    mu_json_list(&json, NULL);
    mu_json_real(&json, NULL, (double)NAN);
    mu_json_real(&json, NULL, (double)INFINITY);
    mu_json_end(&json);
    CU_ASSERT_STRING_EQUAL(buffer, "[null, null]\n");
}

static void test_limit_depth(void)
{
    begin(MU_JSON_LINE);
    for (unsigned i = 0; i < MU_JSON_DEPTH_MAX; i++) {
        mu_json_list(&json, NULL);
    }
    for (unsigned i = 0; i < MU_JSON_DEPTH_MAX; i++) {
        mu_json_end(&json);
    }
    CU_ASSERT_EQUAL(text.len, 2 * MU_JSON_DEPTH_MAX + 1);
}

static void test_limit_a_full_text_is_cut(void)
{
    char small[8];
    mu_text_init(&text, small, sizeof small);
    mu_json_to_text(&json, &text, MU_JSON_LINE);
    mu_json_string(&json, NULL, "much too long");
    CU_ASSERT(text.cut);
    CU_ASSERT_STRING_EQUAL(small, "\"much t");
}

static void test_file(void)
{
    FILE *file = fmemopen(buffer, sizeof buffer, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    mu_json_to_file(&json, file, MU_JSON_LINE);
    mu_json_object(&json, NULL);
    mu_json_uint(&json, "n", 7);
    mu_json_end(&json);
    CU_ASSERT_EQUAL(fclose(file), 0);
    CU_ASSERT_STRING_EQUAL(buffer, "{\"n\": 7}\n");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"one line", test_one_line},
        {"indented", test_indented},
        {"strings are escaped", test_strings_are_escaped},
        {"keys are escaped", test_keys_are_escaped},
        {"numbers read back the same", test_numbers_read_back_the_same},
        {"what is not finite is null", test_what_is_not_finite_is_null},
        {"limit: depth", test_limit_depth},
        {"limit: a full text is cut", test_limit_a_full_text_is_cut},
        {"to a file", test_file},
        CU_TEST_INFO_NULL,
    };
    return suite_run("core/json", tests);
}
