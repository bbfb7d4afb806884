/* SPDX-License-Identifier: Apache-2.0 */
#include "core/pairs.h"
#include "core/random.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>

static struct mu_pairs kept[4]; /* static: leak checkers see their memory */

static void test_order(void)
{
    struct mu_pairs *p = &kept[0];
    mu_pairs_init(p, 8);
    CU_ASSERT_EQUAL(mu_pairs_find(p, "a", "x"), MU_NONE);
    CU_ASSERT_EQUAL(mu_pairs_of(p, mu_pairs_start(p, "a"), "a"), MU_NONE);
    static const char *const pairs[][2] = {{"b", "x"}, {"a-b", "x"}, {"a", "z"},
                                           {"a", ""},  {"a.", "y"},  {"a", "m"}};
    for (uint32_t i = 0; i < 6; i++) {
        CU_ASSERT_EQUAL(mu_pairs_add(p, pairs[i][0], pairs[i][1]), i);
    }
    static const uint32_t order[] = {3, 5, 2, 1, 4, 0};
    CU_ASSERT_EQUAL(memcmp(p->order, order, sizeof order), 0);
    CU_ASSERT_EQUAL(mu_pairs_find(p, "a", "m"), 5);
    CU_ASSERT_EQUAL(mu_pairs_find(p, "a", "n"), MU_NONE);
    uint32_t start = mu_pairs_start(p, "a");
    CU_ASSERT_EQUAL(mu_pairs_of(p, start + 2, "a"), 2);
    CU_ASSERT_EQUAL(mu_pairs_of(p, start + 3, "a"), MU_NONE);
    CU_ASSERT_STRING_EQUAL(mu_pairs_first(p, 4), "a.");
    CU_ASSERT_STRING_EQUAL(mu_pairs_second(p, 4), "y");
    CU_ASSERT_STRING_EQUAL(mu_pairs_second(p, 3), "");
}

static void test_limit(void)
{
    struct mu_pairs *p = &kept[1];
    char name[MU_NAME_MAX + 1];
    mu_pairs_init(p, 3);
    memset(name, 'n', MU_NAME_MAX);
    name[MU_NAME_MAX] = '\0';
    CU_ASSERT_EQUAL(mu_pairs_add(p, name, name), 0);
    CU_ASSERT_STRING_EQUAL(mu_pairs_second(p, 0), name);
    CU_ASSERT_EQUAL(mu_pairs_add(p, "a", "b"), 1);
    CU_ASSERT_EQUAL(mu_pairs_add(p, "b", "a"), 2);
    CU_ASSERT_EQUAL(mu_pairs_add(p, "c", "c"), MU_NONE);
    mu_pairs_remove(p, 1);
    CU_ASSERT_EQUAL(mu_pairs_find(p, "a", "b"), MU_NONE);
    CU_ASSERT_EQUAL(mu_pairs_add(p, "c", "c"), 1);
    CU_ASSERT_EQUAL(p->count, 3);
}

/* Against a plain table of what is in it. */
static void test_model(void)
{
    enum { FIRSTS = 7, SECONDS = 11 };
    static uint32_t index_of[FIRSTS][SECONDS];
    struct mu_pairs *p = &kept[2];
    struct mu_random r;
    char first[8], second[8];
    uint32_t count = 0;
    mu_pairs_init(p, 60);
    memset(index_of, 0xff, sizeof index_of);
    mu_random_seed(&r, 1, "pairs");
    for (int i = 0; i < 20000; i++) {
        int64_t f = mu_random_between(&r, 0, FIRSTS - 1), s = mu_random_between(&r, 0, SECONDS - 1);
        snprintf(first, sizeof first, "f%d", (int)f);
        snprintf(second, sizeof second, "s%d", (int)s);
        CU_ASSERT_EQUAL_FATAL(mu_pairs_find(p, first, second), index_of[f][s]);
        if (index_of[f][s] != MU_NONE) {
            mu_pairs_remove(p, index_of[f][s]);
            index_of[f][s] = MU_NONE;
            count--;
        } else {
            index_of[f][s] = mu_pairs_add(p, first, second);
            CU_ASSERT_EQUAL_FATAL(index_of[f][s] != MU_NONE, count < 60);
            count += index_of[f][s] != MU_NONE;
        }
        CU_ASSERT_EQUAL_FATAL(p->count, count);
        for (uint32_t k = 1; k < count; k++) {
            CU_ASSERT_FATAL(strcmp(p->at[p->order[k - 1]].key, p->at[p->order[k]].key) < 0);
        }
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"order", test_order}, {"limit", test_limit}, {"model", test_model}, CU_TEST_INFO_NULL};
    return suite_run("core/pairs", tests);
}
