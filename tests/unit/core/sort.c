/* SPDX-License-Identifier: Apache-2.0 */
#include "core/sort.h"
#include "core/random.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum { ITEMS = 1025 };

/* Longer than what is moved in one piece, and no multiple of it. */
struct item {
    uint32_t key;
    char cargo[151];
};

static uint64_t looks;

static int item_compare(const void *one, const void *other, const void *context)
{
    const struct item *x = one, *y = other;
    const int *sign = context;
    looks++;
    return *sign * ((x->key > y->key) - (x->key < y->key));
}

static void items_fill(struct item *items, size_t count, struct mu_random *r, int64_t keys)
{
    for (size_t i = 0; i < count; i++) {
        items[i].key = (uint32_t)mu_random_between(r, 0, keys - 1);
        memset(items[i].cargo, (int)(items[i].key % 256), sizeof items[i].cargo);
    }
}

static bool item_is_whole(const struct item *item)
{
    struct item want = {.key = item->key};
    memset(want.cargo, (int)(item->key % 256), sizeof want.cargo);
    return memcmp(want.cargo, item->cargo, sizeof want.cargo) == 0;
}

static void order_check(struct item *items, size_t count, int sign)
{
    uint64_t before = 0, after = 0;
    for (size_t i = 0; i < count; i++) {
        before += items[i].key;
    }
    mu_sort(items, count, sizeof *items, item_compare, &sign);
    bool ordered = true, whole = true;
    for (size_t i = 0; i < count; i++) {
        after += items[i].key;
        whole = whole && item_is_whole(&items[i]);
        ordered = ordered && (i == 0 || item_compare(&items[i - 1], &items[i], &sign) <= 0);
    }
    CU_ASSERT_TRUE(ordered);
    CU_ASSERT_TRUE(whole);
    CU_ASSERT_EQUAL(after, before);
}

static void test_any_number_in_any_order(void)
{
    static struct item items[ITEMS];
    struct mu_random r;
    mu_random_seed(&r, 1, "sort");
    for (size_t count = 0; count <= 130; count++) {
        items_fill(items, count, &r, 1000000);
        order_check(items, count, 1);
        items_fill(items, count, &r, 3);
        order_check(items, count, -1);
    }
    items_fill(items, ITEMS, &r, 1u << 31);
    order_check(items, ITEMS, 1);
    order_check(items, ITEMS, -1);
}

static int byte_compare(const void *one, const void *other, const void *context)
{
    (void)context;
    return *(const char *)one - *(const char *)other;
}

static void test_the_smallest_items(void)
{
    char text[] = "thequickbrownfox";
    mu_sort(text, strlen(text), 1, byte_compare, NULL);
    CU_ASSERT_STRING_EQUAL(text, "bcefhiknooqrtuwx");
}

/* Whatever the order, 2 n log n looks; one each where there is nothing to do. */
static void test_what_it_costs(void)
{
    static struct item items[ITEMS];
    int up = 1;
    const uint64_t most = 2 * ITEMS * 11;
    for (uint32_t i = 0; i < ITEMS; i++) {
        items[i].key = ITEMS - i;
    }
    looks = 0;
    mu_sort(items, ITEMS, sizeof *items, item_compare, &up);
    CU_ASSERT_EQUAL(items[0].key, 1);
    CU_ASSERT(looks <= most);
    looks = 0;
    mu_sort(items, ITEMS, sizeof *items, item_compare, &up);
    CU_ASSERT_EQUAL(looks, ITEMS - 1);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"any number, in any order", test_any_number_in_any_order},
        {"the smallest items", test_the_smallest_items},
        {"what it costs", test_what_it_costs},
        CU_TEST_INFO_NULL,
    };
    return suite_run("core/sort", tests);
}
