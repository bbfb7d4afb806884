/* SPDX-License-Identifier: Apache-2.0 */
/* Changes from outside wait in one order, whatever the one of their arrival, and only so many. */
#include "sim/record/record.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct order_queue orders;

static void set_up(void)
{
    memset(&orders, 0, sizeof orders);
}

static mu_result put(const char *source, uint64_t seq)
{
    char from[16], name[16], file[] = "here";
    snprintf(from, sizeof from, "%s", source);
    snprintf(name, sizeof name, "n%llu", (unsigned long long)seq);
    muster_RunCommand c = {
        .source = from, .seq = seq, .name = name, .file = file, .when = file, .x_m = 0.5};
    mu_result r = order_queue_put(&orders, &c);
    memset(from, '?', sizeof from - 1); /* what was given is not kept */
    memset(name, '?', sizeof name - 1);
    return r;
}

static void expect(const char *source, uint64_t seq)
{
    const muster_RunCommand *c = order_queue_take(&orders);
    CU_ASSERT_PTR_NOT_NULL_FATAL(c);
    char name[16];
    snprintf(name, sizeof name, "n%llu", (unsigned long long)seq);
    CU_ASSERT_STRING_EQUAL(c->source, source);
    CU_ASSERT_EQUAL(c->seq, seq);
    CU_ASSERT_STRING_EQUAL(c->name, name);
    CU_ASSERT_STRING_EQUAL(c->file, "here");
    CU_ASSERT_DOUBLE_EQUAL(c->x_m, 0.5, 0);
}

static void test_in_order_of_source_and_number(void)
{
    CU_ASSERT_EQUAL(put("operator", 9), MU_OK);
    CU_ASSERT_EQUAL(put("red", 1), MU_OK);
    CU_ASSERT_EQUAL(put("observer", 70), MU_OK);
    CU_ASSERT_EQUAL(put("operator", 8), MU_OK);
    expect("observer", 70);
    expect("operator", 8);
    expect("operator", 9);
    expect("red", 1);
    CU_ASSERT_PTR_NULL(order_queue_take(&orders));
}

static void test_equal_ones_as_they_came(void)
{
    CU_ASSERT_EQUAL(put("a", 1), MU_OK);
    CU_ASSERT_EQUAL(put("a", 1), MU_OK);
    expect("a", 1);
    expect("a", 1);
    CU_ASSERT_PTR_NULL(order_queue_take(&orders));
}

static void test_limit_orders_of_a_step(void)
{
    for (uint64_t i = 0; i < MU_ORDERS_MAX; i++) {
        CU_ASSERT_EQUAL(put("a", i), MU_OK);
    }
    CU_ASSERT_EQUAL(put("a", MU_ORDERS_MAX), MU_FULL);
    for (uint64_t i = 0; i < MU_ORDERS_MAX; i++) {
        expect("a", i);
    }
    CU_ASSERT_PTR_NULL(order_queue_take(&orders));
    CU_ASSERT_EQUAL(put("a", 1), MU_OK);
    expect("a", 1);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"in order of source and number", test_in_order_of_source_and_number},
        {"equal ones as they came", test_equal_ones_as_they_came},
        {"limit: orders of a step", test_limit_orders_of_a_step},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"sim/order_queue", NULL, NULL, set_up, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
