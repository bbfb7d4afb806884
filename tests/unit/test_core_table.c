/* SPDX-License-Identifier: Apache-2.0 */
#include "../support/suite.h"
#include "core/random.h"
#include "core/table.h"

#include <CUnit/Basic.h>
#include <stdbool.h>
#include <stdio.h>

enum { NAMES = 200 };

static char names[NAMES][8];

static void names_make(void)
{
    for (unsigned i = 0; i < NAMES; i++) {
        snprintf(names[i], sizeof names[i], "n%u", i);
    }
}

static void test_put_find_remove(void)
{
    static struct mu_table t; /* static: leak checkers see its memory */
    mu_table_init(&t, 4);
    CU_ASSERT_EQUAL(mu_table_find(&t, "red"), MU_NONE);
    CU_ASSERT_EQUAL(mu_table_put(&t, "red", 7), MU_OK);
    CU_ASSERT_EQUAL(mu_table_put(&t, "red", 8), MU_EXISTS);
    CU_ASSERT_EQUAL(mu_table_find(&t, "red"), 7);
    CU_ASSERT_EQUAL(mu_table_remove(&t, "green"), MU_ABSENT);
    CU_ASSERT_EQUAL(mu_table_remove(&t, "red"), MU_OK);
    CU_ASSERT_EQUAL(mu_table_find(&t, "red"), MU_NONE);
    CU_ASSERT_EQUAL(t.count, 0);
}

static void test_limit_is_refused(void)
{
    static struct mu_table t; /* static: leak checkers see its memory */
    names_make();
    mu_table_init(&t, 3);
    for (uint32_t i = 0; i < 3; i++) {
        CU_ASSERT_EQUAL(mu_table_put(&t, names[i], i), MU_OK);
    }
    CU_ASSERT_EQUAL(mu_table_put(&t, names[3], 3), MU_FULL);
    CU_ASSERT_EQUAL(mu_table_put(&t, names[2], 3), MU_EXISTS);
    CU_ASSERT_EQUAL(mu_table_remove(&t, names[0]), MU_OK);
    CU_ASSERT_EQUAL(mu_table_put(&t, names[3], 3), MU_OK);
    CU_ASSERT_EQUAL(mu_table_find(&t, names[3]), 3);
}

/* Random puts and removes in a table that is nearly full, against a plain array of truths. */
static void test_random_against_a_model(void)
{
    static struct mu_table t; /* static: leak checkers see its memory */
    bool there[NAMES] = {false};
    uint32_t count = 0;
    struct mu_random r;
    names_make();
    mu_table_init(&t, 64);
    mu_random_seed(&r, 1, "table");
    for (int round = 0; round < 20000; round++) {
        uint32_t i = (uint32_t)mu_random_between(&r, 0, NAMES - 1);
        if (mu_random_between(&r, 0, 2) > 0) {
            mu_result want = there[i] ? MU_EXISTS : count == 64 ? MU_FULL : MU_OK;
            CU_ASSERT_EQUAL_FATAL(mu_table_put(&t, names[i], i), want);
            count += want == MU_OK;
            there[i] = there[i] || want == MU_OK;
        } else {
            CU_ASSERT_EQUAL_FATAL(mu_table_remove(&t, names[i]), there[i] ? MU_OK : MU_ABSENT);
            count -= there[i];
            there[i] = false;
        }
        uint32_t look = (uint32_t)mu_random_between(&r, 0, NAMES - 1);
        CU_ASSERT_EQUAL_FATAL(mu_table_find(&t, names[look]), there[look] ? look : MU_NONE);
        CU_ASSERT_EQUAL_FATAL(t.count, count);
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"put, find, remove", test_put_find_remove},
        {"limit: the table is full", test_limit_is_refused},
        {"random against a model", test_random_against_a_model},
        CU_TEST_INFO_NULL,
    };
    return suite_run("core/table", tests);
}
