/* SPDX-License-Identifier: Apache-2.0 */
/* What a console makes of what is typed: forms, and words that are completed. */
#include "operator/operator.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static struct forms forms;

/* Asserts that a text has these forms, which end with NULL, and nothing is open behind them. */
static void has(const char *text, const char *const *wanted)
{
    const char *at = text;
    enum forms_found found;
    forms_clear(&forms);
    while ((found = forms_next(&forms, &at)) != FORMS_MORE) {
        CU_ASSERT_EQUAL(found, FORMS_READY);
        CU_ASSERT_PTR_NOT_NULL_FATAL(*wanted);
        READS(forms.text, *wanted);
        wanted++;
    }
    CU_ASSERT_PTR_NULL(*wanted);
    CU_ASSERT_FALSE(forms_are_open(&forms));
}

static void test_forms_are_found(void)
{
    has("", (const char *const[]){NULL});
    has("  ; a comment (\n\n", (const char *const[]){NULL});
    has("(facts)\n", (const char *const[]){"(facts)", NULL});
    has("(a)(b (c))  ; no (\n d \"e f\"g\n",
        (const char *const[]){"(a)", "(b (c))", "d", "\"e f\"", "g", NULL});
    has("?*mate*\n", (const char *const[]){"?*mate*", NULL});
    has("(x \")\\\"(\" ; )\n y)\n", (const char *const[]){"(x \")\\\"(\" ; )\n y)", NULL});
    has("word(x)\n", (const char *const[]){"word", "(x)", NULL});
}

static void test_an_open_form_goes_on(void)
{
    const char *at = "(defrule a\n";
    forms_clear(&forms);
    CU_ASSERT_EQUAL(forms_next(&forms, &at), FORMS_MORE);
    CU_ASSERT_TRUE(forms_are_open(&forms));
    at = "  (b \"open\n";
    CU_ASSERT_EQUAL(forms_next(&forms, &at), FORMS_MORE);
    at = "string\") => )\n";
    CU_ASSERT_EQUAL(forms_next(&forms, &at), FORMS_READY);
    READS(forms.text, "(defrule a\n  (b \"open\nstring\") => )");
    CU_ASSERT_FALSE(forms_are_open(&forms));
}

static void test_one_too_many_is_left_out(void)
{
    const char *at = ")(a))(b)\n";
    forms_clear(&forms);
    CU_ASSERT_EQUAL(forms_next(&forms, &at), FORMS_EXTRA);
    CU_ASSERT_EQUAL(forms_next(&forms, &at), FORMS_READY);
    READS(forms.text, "(a)");
    CU_ASSERT_EQUAL(forms_next(&forms, &at), FORMS_EXTRA);
    CU_ASSERT_EQUAL(forms_next(&forms, &at), FORMS_READY);
    READS(forms.text, "(b)");
}

static void test_limit_form(void)
{
    static char text[MU_CONTENT_MAX + 8];
    memset(text, 'x', MU_CONTENT_MAX + 1);
    text[0] = '(';
    text[MU_CONTENT_MAX - 1] = ')';
    text[MU_CONTENT_MAX] = '\0';
    const char *at = text;
    forms_clear(&forms);
    CU_ASSERT_EQUAL(forms_next(&forms, &at), FORMS_READY);
    CU_ASSERT_EQUAL(strlen(forms.text), MU_CONTENT_MAX);
    text[MU_CONTENT_MAX - 1] = 'x';
    text[MU_CONTENT_MAX] = ')';
    strncpy(text + MU_CONTENT_MAX + 1, "(b)", 4);
    at = text;
    CU_ASSERT_EQUAL(forms_next(&forms, &at), FORMS_LONG);
    CU_ASSERT_EQUAL(strlen(forms.text), MU_CONTENT_MAX);
    CU_ASSERT_EQUAL(forms_next(&forms, &at), FORMS_READY);
    READS(forms.text, "(b)");
}

static const char words[] = "f facts\nf follow\nr follow-robot\nt follow\nt fiducial\ng ?*mate*\n";

/* Asserts what the line's last word may become. */
static void becomes(const char *line, size_t wanted_count, const char *wanted_rest)
{
    struct complete_match first = {.at = "", .len = 0};
    size_t count;
    struct complete_word w = complete_word(line, strlen(line));
    size_t common = complete_common(words, w, &count, &first);
    CU_ASSERT_EQUAL(count, wanted_count);
    CU_ASSERT_EQUAL(common, strlen(wanted_rest));
    CU_ASSERT_EQUAL(memcmp(first.at + w.len, wanted_rest, common), 0);
}

static void test_words_are_completed(void)
{
    becomes("(fa", 1, "cts");
    becomes("(f", 3, ""); /* no rule stands behind a parenthesis, and no name twice */
    becomes("(fo", 1, "llow");
    becomes("(ppdefrule fo", 2, "llow");
    becomes("(ppdefrule follow-", 1, "robot");
    becomes("?*", 1, "mate*");
    becomes("(follow green", 0, "");
    becomes("(printout t \"fa", 1, "cts");
    becomes("", 5, "");
}

/* Asserts how the line goes on. */
static void goes_on(const char *line, size_t wanted_count, const char *wanted_rest)
{
    char rest[COMPLETE_REST];
    CU_ASSERT_EQUAL(complete_rest(words, complete_word(line, strlen(line)), rest), wanted_count);
    READS(rest, wanted_rest);
}

static void test_a_line_goes_on(void)
{
    goes_on("(fa", 1, "cts ");
    goes_on("(facts", 1, " ");
    goes_on("(f", 3, "");
    goes_on("(ppdefrule fo", 2, "llow");
    goes_on("(nothing", 0, "");
}

static void test_no_character_is_cut(void)
{
    static const char two[] = "f gr\xc3\xa4\nf gr\xc3\xb6\n";
    char rest[COMPLETE_REST];
    CU_ASSERT_EQUAL(complete_rest(two, complete_word("(g", 2), rest), 2);
    READS(rest, "r");
}

static void test_limit_rest(void)
{
    static char one[COMPLETE_REST + 8] = "f ";
    char rest[COMPLETE_REST];
    memset(one + 2, 'x', COMPLETE_REST + 4);
    CU_ASSERT_EQUAL(complete_rest(one, complete_word("(x", 2), rest), 1);
    CU_ASSERT(strlen(rest) < COMPLETE_REST);
}

int main(void)
{
    CU_TestInfo tests[] = {{"forms are found", test_forms_are_found},
                           {"an open form goes on", test_an_open_form_goes_on},
                           {"one too many is left out", test_one_too_many_is_left_out},
                           {"limit: form", test_limit_form},
                           {"words are completed", test_words_are_completed},
                           {"a line goes on", test_a_line_goes_on},
                           {"no character is cut", test_no_character_is_cut},
                           {"limit: rest", test_limit_rest},
                           CU_TEST_INFO_NULL};
    return suite_run("operator/console", tests);
}
