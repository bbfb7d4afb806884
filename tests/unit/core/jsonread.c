/* SPDX-License-Identifier: Apache-2.0 */
#include "core/json.h"
#include "core/json_read.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>

static char told_bytes[8192];
static struct mu_text told;
static struct mu_fault fault;

static void note(void *self, const char *path, const struct mu_json_value *value)
{
    (void)self;
    static const char *const words[] = {"null", "bool", "number", "string"};
    mu_text_format(&told, "%s=%s:%g:%s;", path, words[value->kind], value->number, value->text);
}

static mu_result read_text(const char *text)
{
    mu_text_init(&told, told_bytes, sizeof told_bytes);
    return mu_json_read("a.json", text, note, NULL, &fault);
}

static void test_paths(void)
{
    CU_ASSERT_EQUAL(read_text("{\"a\": 1, \"mail\": {\"sent\": 2e3, \"x\": {}},\n"
                              " \"robots\": [{\"name\": \"red\", \"met\": true}, null], "
                              "\"none\": []}\n"),
                    MU_OK);
    READS(told.at, "a=number:1:;mail.sent=number:2000:;robots.0.name=string:0:red;"
                   "robots.0.met=bool:1:;robots.1=null:0:;");
    CU_ASSERT_EQUAL(read_text(" -0.5 "), MU_OK);
    READS(told.at, "=number:-0.5:;");
}

static void test_strings(void)
{
    CU_ASSERT_EQUAL(read_text("[\"a\\\"\\\\\\/\\n\\u00e9\\u20AC\\ud83d\\ude00\", "
                              "\"\xc3\xa9\", \"\\ud83dx\", \"\\u0000\"]"),
                    MU_OK);
    READS(told.at, "0=string:0:a\"\\/\n\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80;1=string:0:\xc3\xa9;"
                   "2=string:0:\xef\xbf\xbdx;3=string:0:\xef\xbf\xbd;");
}

static void test_faults(void)
{
    static const struct {
        const char *text;
        int line, column;
        const char *expected;
    } rows[] = {
        {"", 1, 1, "expected a value"},
        {"{\"a\": 1,\n \"b\" 2}", 2, 6, "expected ':'"},
        {"{\"a\": 1 \"b\": 2}", 1, 9, "expected ',' or '}'"},
        {"[1, 2", 1, 6, "expected ',' or ']'"},
        {"{a: 1}", 1, 2, "expected a name in quotes"},
        {"\"abc", 1, 5, "expected the end of a string"},
        {"\"a\nb\"", 1, 3, "expected the end of a string"},
        {"\"\\x\"", 1, 3, "expected one of \\\" \\\\ \\/ \\b \\f \\n \\r \\t \\u"},
        {"\"\\u12g4\"", 1, 6, "expected four hexadecimal digits"},
        {"nan", 1, 1, "expected a value"},
        {"0x10", 1, 1, "expected a value"},
        {"1-2", 1, 1, "expected a value"},
        {"+1", 1, 1, "expected a value"},
        {"[1,]", 1, 4, "expected a value"},
        {"1 2", 1, 3, "expected the end of the file"},
        {"truely", 1, 5, "expected the end of the file"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        CU_ASSERT_EQUAL(read_text(rows[i].text), MU_FAULT_FILE);
        READS(fault.text, rows[i].expected);
        CU_ASSERT_EQUAL(fault.line, rows[i].line);
        CU_ASSERT_EQUAL(fault.column, rows[i].column);
    }
}

static void test_limit_depth(void)
{
    char text[64] = "";
    memset(text, '[', MU_JSON_DEPTH_MAX + 1);
    CU_ASSERT_EQUAL(read_text(text), MU_FAULT_FILE);
    READS(fault.text, "expected no more than 16 objects and lists in each other");
    memset(text, '[', MU_JSON_DEPTH_MAX);
    memset(text + MU_JSON_DEPTH_MAX, ']', MU_JSON_DEPTH_MAX);
    text[(size_t)2 * MU_JSON_DEPTH_MAX] = '\0';
    CU_ASSERT_EQUAL(read_text(text), MU_OK);
}

static void test_limit_texts_are_cut(void)
{
    static char text[3 * MU_JSON_TEXT_MAX];
    text[0] = '"';
    memset(text + 1, 'x', sizeof text - 3);
    text[sizeof text - 2] = '"';
    CU_ASSERT_EQUAL(read_text(text), MU_OK);
    CU_ASSERT_EQUAL(told.len, sizeof "=string:0:;" - 1 + MU_JSON_TEXT_MAX - 1);
    snprintf(text, sizeof text, "{\"%0*d\": 1, \"b\": 2}", MU_JSON_PATH_MAX, 0);
    CU_ASSERT_EQUAL(read_text(text), MU_OK);
    CU_ASSERT_PTR_NOT_NULL(strstr(told.at, ";b=number:2:;"));
}

/* What the writer writes, the reader reads. */
static void test_there_and_back(void)
{
    static char bytes[1024];
    struct mu_text text;
    struct mu_json j;
    mu_text_init(&text, bytes, sizeof bytes);
    mu_json_to_text(&j, &text, MU_JSON_INDENTED);
    mu_json_object(&j, NULL);
    mu_json_string(&j, "</script>\x01", "\t\"\\\x7f\xff");
    mu_json_real(&j, "x", 0.1);
    mu_json_string(&j, "none", NULL);
    mu_json_end(&j);
    CU_ASSERT_EQUAL(read_text(bytes), MU_OK);
    READS(told.at, "</script>\x01=string:0:\t\"\\\x7f\xef\xbf\xbd;x=number:0.1:;none=null:0:;");
}

/* Every beginning of a document ends in a place, never beyond it. */
static void test_cut_anywhere(void)
{
    static const char whole[] = "{\"a\": [1, \"\\u00e9\\n\", {\"b\": true}], \"c\": null}";
    for (size_t len = 0; len < sizeof whole - 1; len++) {
        char *text = malloc(len + 1);
        memcpy(text, whole, len);
        text[len] = '\0';
        CU_ASSERT_EQUAL(read_text(text), MU_FAULT_FILE);
        CU_ASSERT(fault.line == 1 && fault.column >= 1 && fault.column <= (int)len + 1);
        free(text);
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"paths", test_paths},
        {"strings", test_strings},
        {"faults", test_faults},
        {"limit: depth", test_limit_depth},
        {"limit: texts are cut", test_limit_texts_are_cut},
        {"there and back", test_there_and_back},
        {"cut anywhere", test_cut_anywhere},
        CU_TEST_INFO_NULL,
    };
    return suite_run("core/json_read", tests);
}
