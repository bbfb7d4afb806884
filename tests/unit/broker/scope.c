/* SPDX-License-Identifier: Apache-2.0 */
/* The whole table of rules that keep a run in lock step apart from everything else. */
#include "broker/steps/steps.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>

static void expect(bool holds, const char *rule)
{
    if (!holds) {
        printf("\n  the rule: %s\n", rule);
    }
    CU_ASSERT_TRUE(holds);
}

/* A column for each scope: open, awaited, beside, run, broker, part. */
struct row {
    const char *name;
    bool (*rule)(enum scope);
    const char *holds;
};

static void test_each_scope_under_each_rule(void)
{
    static const struct row rows[] = {
        {"inside", scope_is_inside, "...x.."},
        {"paced", scope_is_paced, "..xx.."},
        {"waits for its first step", scope_waits, ".x...."},
        {"told by others", scope_is_told, "xxx.xx"},
        {"shown lines", scope_is_shown_lines, "x..x.."},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        CU_ASSERT_EQUAL_FATAL(strlen(rows[i].holds), SCOPES);
        for (int scope = 0; scope < SCOPES; scope++) {
            bool holds = rows[i].rule((enum scope)scope);
            expect(holds == (rows[i].holds[scope] == 'x'), rows[i].name);
        }
    }
}

/* A line for the one that acts, a column for the other. */
struct square {
    const char *name;
    bool (*rule)(enum scope, enum scope);
    const char *holds[SCOPES];
};

static void test_each_scope_to_each_other(void)
{
    static const struct square squares[] = {
        {"sees", scope_sees, {"xxxxxx", "xxxxxx", "xxxxxx", "...xx.", "xxxxxx", "xxxxxx"}},
        {"addresses",
         scope_addresses,
         {"xxxxxx", "xxxxxx", "xxxxxx", "xxxxx.", "xxxxxx", "xxxxxx"}},
        {"crosses", scope_crosses, {"......", "......", "......", "xxx...", "......", "......"}},
    };
    for (size_t i = 0; i < sizeof squares / sizeof squares[0]; i++) {
        for (int one = 0; one < SCOPES; one++) {
            for (int other = 0; other < SCOPES; other++) {
                bool holds = squares[i].rule((enum scope)one, (enum scope)other);
                expect(holds == (squares[i].holds[one][other] == 'x'), squares[i].name);
            }
        }
    }
}

static void test_scopes_of_agents(void)
{
    for (int process = 0; process < SCOPES; process++) {
        for (int looks_on = 0; looks_on < 2; looks_on++) {
            for (int awaited = 0; awaited < 2; awaited++) {
                enum scope outside = awaited ? SCOPE_AWAITED : SCOPE_OPEN;
                enum scope member = looks_on ? SCOPE_BESIDE : SCOPE_RUN;
                CU_ASSERT_EQUAL(scope_of_agent((enum scope)process, looks_on, awaited),
                                process == SCOPE_RUN ? member : outside);
            }
        }
    }
    CU_ASSERT_EQUAL(scope_of_line(false), SCOPE_BROKER);
    CU_ASSERT_EQUAL(scope_of_line(true), SCOPE_PART);
    CU_ASSERT_EQUAL(scope_of_word(false), SCOPE_OPEN);
    CU_ASSERT_EQUAL(scope_of_word(true), SCOPE_RUN);
}

static void test_accounts_and_refusals(void)
{
    for (int one = 0; one < SCOPES; one++) {
        bool inside = one == SCOPE_RUN;
        const char *counters = scope_refuses_counters((enum scope)one);
        CU_ASSERT_EQUAL(scope_account((enum scope)one), inside ? QUOTA_INSIDE : QUOTA_OUTSIDE);
        CU_ASSERT_TRUE(inside ? counters && strcmp(counters, "in-lock-step") == 0 : !counters);
        for (int other = 0; other < SCOPES; other++) {
            const char *move = scope_refuses_move((enum scope)one, (enum scope)other);
            bool leaves = inside && other != SCOPE_RUN;
            CU_ASSERT_TRUE(leaves ? move && strcmp(move, "lock-step") == 0 : !move);
        }
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"each scope under each rule", test_each_scope_under_each_rule},
        {"each scope to each other", test_each_scope_to_each_other},
        {"scopes of agents", test_scopes_of_agents},
        {"accounts and refusals", test_accounts_and_refusals},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/scope", tests);
}
