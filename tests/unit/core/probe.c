/* SPDX-License-Identifier: Apache-2.0 */
/* Which lines only look: by their first word, and with nothing but literals behind it. */
#include "core/probe.h"
#include "muster/limits.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static void test_every_word_looks_with_and_without_literals(void)
{
    char line[MU_GLANCE_LINE_MAX + 1];
    const char *before = "";
    size_t count = 0;
    for (const char *word; (word = mu_probe_at(count)) != NULL; count++) {
        CU_ASSERT(strcmp(before, word) < 0);
        snprintf(line, sizeof line, "(%s)", word);
        CU_ASSERT_TRUE(mu_probe_is(line));
        snprintf(line, sizeof line, " ( %s\tMAIN 12 -3.5e2\n ) ", word);
        CU_ASSERT_TRUE(mu_probe_is(line));
        before = word;
    }
    CU_ASSERT(count > 30);
}

/* The manual has the list; it is checked where the words are. */
static void test_the_manual_names_every_word(void)
{
    static char page[64 * 1024];
    char quoted[MU_FIELD_MAX + 3];
    FILE *f = fopen("docs/console.md", "r");
    CU_ASSERT_PTR_NOT_NULL_FATAL(f);
    size_t len = fread(page, 1, sizeof page - 1, f);
    fclose(f);
    CU_ASSERT(len > 0 && len < sizeof page - 1);
    for (size_t i = 0; mu_probe_at(i); i++) {
        snprintf(quoted, sizeof quoted, "`%s`", mu_probe_at(i));
        CU_ASSERT_PTR_NOT_NULL(strstr(page, quoted));
    }
}

static void test_globals_look(void)
{
    CU_ASSERT_TRUE(mu_probe_is("?*mate*"));
    CU_ASSERT_TRUE(mu_probe_is(" ?*my-name* \n"));
    CU_ASSERT_TRUE(mu_probe_is("?*MAIN::mate*"));
    CU_ASSERT_FALSE(mu_probe_is("?*mate"));
    CU_ASSERT_FALSE(mu_probe_is("?mate"));
    CU_ASSERT_FALSE(mu_probe_is("?**"));
    CU_ASSERT_FALSE(mu_probe_is("?"));
    CU_ASSERT_FALSE(mu_probe_is("?*mate* ?*mate*"));
    CU_ASSERT_FALSE(mu_probe_is("mate"));
}

static void test_nothing_else_does(void)
{
    static const char *const lines[] = {
        "",
        "()",
        "(",
        "(facts",
        "(facts))",
        "(facts) (facts)",
        "(facts) (assert (a))",
        "(assert (a))",
        "(retract *)",
        "(facts (+ 1 2))",
        "(facts (assert (a)))",
        "(facts ?*mate*)",
        "(facts ?x)",
        "(facts $?x)",
        "(ppdefrule \"a\")",
        "(facts ; a comment\n)",
        "(factsx)",
        "(fact)",
        "(fac ts)",
        "((facts))",
        "(findall (goal ?))",
        "(gensym)",
        "(random)",
        "(sonar)",
        "(run)",
        "(matches a & b)",
        "(facts MAIN | 1)",
        "(facts ~MAIN)",
        "(facts [a])",
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        if (mu_probe_is(lines[i])) {
            printf("\n  looks: %s\n", lines[i]);
        }
        CU_ASSERT_FALSE(mu_probe_is(lines[i]));
    }
}

static void test_the_word_is_found(void)
{
    const char *word = NULL;
    CU_ASSERT_EQUAL(mu_probe_word("  ( facts MAIN)", &word), 5);
    CU_ASSERT_EQUAL(memcmp(word, "facts", 5), 0);
    CU_ASSERT_EQUAL(mu_probe_word("?*mate*", &word), 0);
}

static void test_limit_line(void)
{
    char line[MU_GLANCE_LINE_MAX + 2];
    memset(line, ' ', sizeof line);
    memcpy(line, "(facts", 6);
    line[MU_GLANCE_LINE_MAX - 1] = ')';
    line[MU_GLANCE_LINE_MAX] = '\0';
    CU_ASSERT_TRUE(mu_probe_is(line));
    line[MU_GLANCE_LINE_MAX - 1] = ' ';
    line[MU_GLANCE_LINE_MAX] = ')';
    line[MU_GLANCE_LINE_MAX + 1] = '\0';
    CU_ASSERT_FALSE(mu_probe_is(line));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"every word looks, with and without literals",
         test_every_word_looks_with_and_without_literals},
        {"the manual names every word", test_the_manual_names_every_word},
        {"globals look", test_globals_look},
        {"nothing else does", test_nothing_else_does},
        {"the word is found", test_the_word_is_found},
        {"limit: a line", test_limit_line},
        CU_TEST_INFO_NULL,
    };
    return suite_run("probe", tests);
}
