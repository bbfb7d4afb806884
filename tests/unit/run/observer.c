/* SPDX-License-Identifier: Apache-2.0 */
/* What the observer's console makes of a line. */
#include "run/observer.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static struct observer_order order;

static void says(const char *line, const char *performative, const char *who, const char *content)
{
    char bytes[512];
    struct mu_text why;
    mu_text_init(&why, bytes, sizeof bytes);
    CU_ASSERT_EQUAL(observer_read(&order, line, &why), MU_OK);
    READS(why.at, "");
    READS(order.performative ? order.performative : "", performative);
    READS(order.who, who);
    READS(order.content, content);
}

static void is_wrong(const char *line, const char *expected)
{
    char bytes[512];
    struct mu_text why;
    mu_text_init(&why, bytes, sizeof bytes);
    CU_ASSERT_EQUAL(observer_read(&order, line, &why), MU_MALFORMED);
    if (!strstr(why.at, expected)) {
        READS(why.at, expected);
    }
}

static void test_orders(void)
{
    says("(you-do red wander)", "do", "red", "(wander)");
    says("  ( you-do  blue follow   red ) ", "do", "blue", "(follow   red)");
    says("(you-do (create$ red blue) gohome 0 (+ 1 2))", "do", "red,blue", "(gohome 0 (+ 1 2))");
    says("(you-do group:scouts stay)", "do", "group:scouts", "(stay)");
    says("(you-do \"red\" stay)", "do", "red", "(stay)");
    says("(inspect robots)", "do", "robots", "(facts)");
    says("(inspect red (agenda))", "do", "red", "(agenda)");
    says("(inspect red ?*mate*)", "do", "red", "?*mate*");
    says("(suspend all)", "suspend", "all", "");
    says("(step (create$ red) 12)", "step", "red", "12");
    CU_ASSERT_EQUAL(order.answer, OBSERVER_MAIL);
    says("(resume red)", "resume", "red", "");
    CU_ASSERT_EQUAL(order.answer, OBSERVER_MAIL);
    says("(agents)", "", "", "");
}

static void test_mistakes(void)
{
    is_wrong("", "expected one of (you-do WHO");
    is_wrong("you-do", "expected one of");
    is_wrong("(facts)", "expected one of");
    is_wrong("(you-do red)", "expected (you-do WHO COMMAND");
    is_wrong("(you-do)", "expected (you-do WHO");
    is_wrong("(you-do red (wander))", "expected (you-do WHO");
    is_wrong("(you-do (list red) wander)", "expected (you-do WHO");
    is_wrong("(you-do (create$) wander)", "expected (you-do WHO");
    is_wrong("(suspend red blue)", "expected (suspend WHO)");
    is_wrong("(step red)", "expected (step WHO N)");
    is_wrong("(step red 0)", "expected (step WHO N)");
    is_wrong("(step red -1)", "expected (step WHO N)");
    is_wrong("(step red 1 1)", "expected (step WHO N)");
    is_wrong("(agents red)", "expected (agents)");
}

static void test_limit_names(void)
{
    static char line[2 * MU_DST_MAX];
    memcpy(line, "(suspend (create$", 18);
    for (size_t i = 0; i < MU_DST_MAX / 6 + 2; i++) {
        memcpy(line + strlen(line), " robot", 7);
    }
    memcpy(line + strlen(line), "))", 3);
    is_wrong(line, "expected (suspend WHO)");
}

int main(void)
{
    CU_TestInfo tests[] = {{"orders", test_orders},
                           {"mistakes", test_mistakes},
                           {"limit: names", test_limit_names},
                           CU_TEST_INFO_NULL};
    return suite_run("run/observer", tests);
}
