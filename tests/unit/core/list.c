/* SPDX-License-Identifier: Apache-2.0 */
#include "core/list.h"
#include "core/random.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

enum { ITEMS = 40 };

struct item {
    char cargo[3];
    struct mu_link one, other;
};

static struct item items[ITEMS];

/* Checks that a list has these elements in this order, both ways. */
static void list_check(const struct mu_list *l, struct mu_links links, const uint32_t *all,
                       uint32_t count)
{
    uint32_t i = mu_list_first(l), last = MU_NONE;
    CU_ASSERT_EQUAL(l->count, count);
    for (uint32_t k = 0; k < count; k++, i = mu_list_next(links, i)) {
        CU_ASSERT_EQUAL_FATAL(i, all[k]);
        CU_ASSERT_TRUE(mu_list_has(links, i));
        CU_ASSERT_EQUAL(mu_list_prev(links, i), last);
        last = i;
    }
    CU_ASSERT_EQUAL(i, MU_NONE);
    CU_ASSERT_EQUAL(mu_list_last(l), last);
}

static void test_zeroed_memory_is_an_empty_list(void)
{
    struct mu_list l = {0};
    memset(items, 0, sizeof items);
    list_check(&l, MU_LINKS(items, one), NULL, 0);
    CU_ASSERT_EQUAL(mu_list_take(&l, MU_LINKS(items, one)), MU_NONE);
    CU_ASSERT_FALSE(mu_list_has(MU_LINKS(items, one), 0));
    CU_ASSERT_FALSE(mu_list_remove(&l, MU_LINKS(items, one), 0));
}

static void test_an_element_is_in_a_list_once(void)
{
    struct mu_list l = {0}, m = {0};
    struct mu_links one = MU_LINKS(items, one), other = MU_LINKS(items, other);
    memset(items, 0, sizeof items);
    CU_ASSERT_TRUE(mu_list_append(&l, one, 3));
    CU_ASSERT_FALSE(mu_list_append(&l, one, 3));
    CU_ASSERT_FALSE(mu_list_prepend(&l, one, 3));
    CU_ASSERT_TRUE(mu_list_prepend(&m, other, 3)); /* of another list, with another link */
    CU_ASSERT_TRUE(mu_list_prepend(&l, one, 0));
    list_check(&l, one, (const uint32_t[]){0, 3}, 2);
    list_check(&m, other, (const uint32_t[]){3}, 1);
    CU_ASSERT_EQUAL(mu_list_take(&l, one), 0);
    CU_ASSERT_EQUAL(mu_list_take(&l, one), 3);
    list_check(&l, one, NULL, 0);
    list_check(&m, other, (const uint32_t[]){3}, 1);
}

/* Against an array that is moved about. */
static void test_like_an_array(void)
{
    struct mu_random r;
    struct mu_list l = {0};
    struct mu_links links = MU_LINKS(items, one);
    uint32_t all[ITEMS], count = 0;
    memset(items, 0, sizeof items);
    mu_random_seed(&r, 7, "list");
    for (int round = 0; round < 20000; round++) {
        uint32_t i = (uint32_t)mu_random_between(&r, 0, ITEMS - 1), at = 0;
        while (at < count && all[at] != i) {
            at++;
        }
        bool first = mu_random_between(&r, 0, 1) == 1;
        if (mu_random_between(&r, 0, 2) == 0) {
            CU_ASSERT_EQUAL(mu_list_remove(&l, links, i), at < count);
            if (at < count) {
                memmove(&all[at], &all[at + 1], (--count - at) * sizeof *all);
            }
        } else {
            CU_ASSERT_EQUAL((first ? mu_list_prepend : mu_list_append)(&l, links, i), at == count);
            if (at == count && first) {
                memmove(&all[1], all, count * sizeof *all);
                all[0] = i;
            } else if (at == count) {
                all[count] = i;
            }
            count += at == count;
        }
        list_check(&l, links, all, count);
    }
}

static void test_a_pool_gives_each_element_once(void)
{
    static struct mu_pool p;
    uint32_t taken[3];
    mu_pool_init(&p, 3);
    for (uint32_t i = 0; i < 3; i++) {
        taken[i] = mu_pool_take(&p);
        CU_ASSERT_EQUAL(taken[i], i); /* memory is used from its beginning */
    }
    CU_ASSERT_EQUAL(mu_pool_take(&p), MU_NONE);
    mu_pool_give(&p, 0);
    mu_pool_give(&p, 2);
    CU_ASSERT_EQUAL(p.live, 1);
    CU_ASSERT_EQUAL(mu_pool_take(&p), 2); /* the one given back last is warm */
    CU_ASSERT_EQUAL(mu_pool_take(&p), 0);
    CU_ASSERT_EQUAL(mu_pool_take(&p), MU_NONE);
    CU_ASSERT_EQUAL(p.live, 3);
}

static void test_what_was_never_used_is_left_alone(void)
{
    static struct mu_pool p;
    mu_pool_init(&p, 1000);
    for (int i = 0; i < 50; i++) {
        CU_ASSERT_EQUAL(mu_pool_take(&p), 0);
        mu_pool_give(&p, 0);
    }
    CU_ASSERT_EQUAL(p.used, 1);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"zeroed memory is an empty list", test_zeroed_memory_is_an_empty_list},
        {"an element is in a list once", test_an_element_is_in_a_list_once},
        {"a list is like an array", test_like_an_array},
        {"a pool gives each element once", test_a_pool_gives_each_element_once},
        {"what was never used is left alone", test_what_was_never_used_is_left_alone},
        CU_TEST_INFO_NULL};
    return suite_run("core/list", tests);
}
