/* SPDX-License-Identifier: Apache-2.0 */
#include "mind/syntax/syntax.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>

static void rewrites(const char *from, const char *want)
{
    char bytes[512];
    struct mu_text out;
    mu_text_init(&out, bytes, sizeof bytes);
    syntax_rewrite(&out, from, strlen(from));
    CU_ASSERT_STRING_EQUAL(bytes, want);
    syntax_as_written(bytes);
    CU_ASSERT_STRING_EQUAL(bytes, from);
}

static void test_globals_in_patterns(void)
{
    static const char *const rows[][2] = {
        {"(defrule r (a ?*g* ?x) =>)", "(defrule r (a =(progn ?*g*) ?x) =>)"},
        {"(defrule r (a ~?*g*&~?*h*) =>)", "(defrule r (a ~=(progn ?*g*)&~=(progn ?*h*)) =>)"},
        {"(defrule r (not (a ?*g*)) =>)", "(defrule r (not (a =(progn ?*g*))) =>)"},
        {"(defrule r (t (slot ?*g*)) =>)", "(defrule r (t (slot =(progn ?*g*))) =>)"},
        {"(defrule r \"?*g*\" ; ?*g*\n (a) =>)", NULL},
        {"(defrule r (declare (salience ?*g*)) (a) =>)", NULL},
        {"(defrule r (test (> ?*g* 1)) (testing ?*g*) =>)",
         "(defrule r (test (> ?*g* 1)) (testing =(progn ?*g*)) =>)"},
        {"(defrule r (a ?x&:(> ?x ?*g*)) (b =(+ 1 ?*g*)) =>)", NULL},
        {"(defrule r (a) => (bind ?*g* 1) (assert (b ?*g*)))", NULL},
        {"(deffunction f () ?*g*)", NULL},
        {"(defrule r (a ?*) =>)", NULL},
        {"(defrule r (a ?*g", NULL},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        rewrites(rows[i][0], rows[i][1] ? rows[i][1] : rows[i][0]);
    }
}

static void test_as_written_over_a_line_break(void)
{
    char text[] = "(message mate-pos =(progn\n      ?*mate*) ?x) =(progn 1)";
    syntax_as_written(text);
    CU_ASSERT_STRING_EQUAL(text, "(message mate-pos ?*mate* ?x) =(progn 1)");
}

static void test_forms(void)
{
    const char *at = "; comment (\n(a \")\" ; )\n)\n word \"str\"(b) ) (c";
    static const struct {
        enum syntax_form_kind kind;
        const char *text;
        int line;
    } want[] = {{SYNTAX_FORM_LIST, "(a \")\" ; )\n)", 2},
                {SYNTAX_FORM_ATOM, "word", 4},
                {SYNTAX_FORM_ATOM, "\"str\"", 4},
                {SYNTAX_FORM_LIST, "(b)", 4},
                {SYNTAX_FORM_BAD, ")", 4},
                {SYNTAX_FORM_BAD, "(c", 4}};
    int line = 1;
    for (size_t i = 0; i < sizeof want / sizeof want[0]; i++) {
        struct syntax_form f = syntax_read_form(&at, &line);
        CU_ASSERT_EQUAL(f.kind, want[i].kind);
        CU_ASSERT_EQUAL(f.line, want[i].line);
        CU_ASSERT(f.len == strlen(want[i].text) && strncmp(f.at, want[i].text, f.len) == 0);
    }
    CU_ASSERT_EQUAL(syntax_read_form(&at, &line).kind, SYNTAX_FORM_END);
}

static void test_fields(void)
{
    const char *at = "mate-pos \"a \\\"b\\\"\" -12 1.5 1e3 9223372036854775808 + 1-2 [name] "
                     "1e999 ?x";
    static const enum syntax_field_kind want[] = {
        SYNTAX_FIELD_SYMBOL,   SYNTAX_FIELD_STRING, SYNTAX_FIELD_INTEGER, SYNTAX_FIELD_FLOAT,
        SYNTAX_FIELD_FLOAT,    SYNTAX_FIELD_FLOAT,  SYNTAX_FIELD_SYMBOL,  SYNTAX_FIELD_SYMBOL,
        SYNTAX_FIELD_INSTANCE, SYNTAX_FIELD_SYMBOL, SYNTAX_FIELD_SYMBOL,  SYNTAX_FIELD_END};
    for (size_t i = 0; i < sizeof want / sizeof want[0]; i++) {
        CU_ASSERT_EQUAL(syntax_read_field(&at).kind, want[i]);
    }
    at = "(a)";
    CU_ASSERT_EQUAL(syntax_read_field(&at).kind, SYNTAX_FIELD_BAD);
    at = "\"open";
    CU_ASSERT_EQUAL(syntax_read_field(&at).kind, SYNTAX_FIELD_BAD);
}

static void test_numbers_and_symbols_read_back(void)
{
    static const double numbers[] = {0.1, 100, -0.0, 1e300, 5e-324, 123456789.123456789};
    static const char *const words[] = {"red", "a b", "",    "1.5",   "x)",
                                        "?x",  "$?y", "a;b", "say\"", "<="};
    char bytes[128];
    struct mu_text out;
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        mu_text_init(&out, bytes, sizeof bytes);
        syntax_add_float(&out, numbers[i]);
        const char *at = bytes;
        struct syntax_field f = syntax_read_field(&at);
        CU_ASSERT_EQUAL(f.kind, SYNTAX_FIELD_FLOAT);
        CU_ASSERT(f.real == numbers[i] && *at == '\0');
    }
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        char word[64];
        mu_text_init(&out, bytes, sizeof bytes);
        syntax_add_symbol(&out, words[i]);
        const char *at = bytes;
        struct syntax_field f = syntax_read_field(&at);
        CU_ASSERT_EQUAL(f.kind, i == 0 ? SYNTAX_FIELD_SYMBOL : SYNTAX_FIELD_STRING);
        syntax_unescape(word, f.at, f.len);
        CU_ASSERT_STRING_EQUAL(word, words[i]);
        CU_ASSERT_EQUAL(*at, '\0');
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"globals in patterns", test_globals_in_patterns},
        {"as written, over a line break", test_as_written_over_a_line_break},
        {"forms of a text", test_forms},
        {"fields of a content", test_fields},
        {"numbers and symbols read back", test_numbers_and_symbols_read_back},
        CU_TEST_INFO_NULL,
    };
    return suite_run("mind/text", tests);
}
