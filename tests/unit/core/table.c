/* SPDX-License-Identifier: Apache-2.0 */
#include "core/table.h"
#include "core/random.h"
#include "suite.h"

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

/* Tables that grow, each with names of its own, some of which go again: after each change all are
 * found that are there, and nobody else. */
static void test_growing_loses_nobody(void)
{
    enum { TABLES = 24, MOST = 700 };
    static struct mu_table tables[TABLES]; /* static: leak checkers see their memory */
    static char many[TABLES][MOST][12];
    struct mu_random r;
    mu_random_seed(&r, 2, "table");
    for (unsigned k = 0; k < TABLES; k++) {
        struct mu_table *t = &tables[k];
        bool there[MOST] = {false};
        mu_table_init(t, MOST);
        uint32_t first_mask = t->mask;
        for (uint32_t i = 0; i < MOST; i++) {
            snprintf(many[k][i], sizeof many[k][i], "%u.%u", k, i);
            CU_ASSERT_EQUAL_FATAL(mu_table_put(t, many[k][i], i), MU_OK);
            there[i] = true;
            uint32_t goes = (uint32_t)mu_random_between(&r, 0, (int)(4 * i));
            if (goes < i && there[goes]) {
                CU_ASSERT_EQUAL_FATAL(mu_table_remove(t, many[k][goes]), MU_OK);
                there[goes] = false;
            }
            uint32_t wrong = 0;
            for (uint32_t n = 0; n <= i; n++) {
                wrong += mu_table_find(t, many[k][n]) != (there[n] ? n : MU_NONE);
            }
            CU_ASSERT_EQUAL_FATAL(wrong, 0);
        }
        CU_ASSERT(t->mask > first_mask);
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"put, find, remove", test_put_find_remove},
        {"limit: the table is full", test_limit_is_refused},
        {"random against a model", test_random_against_a_model},
        {"growing loses nobody", test_growing_loses_nobody},
        CU_TEST_INFO_NULL,
    };
    return suite_run("core/table", tests);
}
