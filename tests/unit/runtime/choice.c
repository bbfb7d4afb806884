/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/choice.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>

static struct beacons choice;

static muster_Beacon beacon(const char *name, const char *host, uint32_t index)
{
    return (muster_Beacon){.broker = words(name),
                           .incarnation = 1,
                           .host = words(host),
                           .index = index,
                           .takes_agents = true};
}

static void note(const char *name, const char *host, uint32_t index)
{
    muster_Beacon b = beacon(name, host, index);
    (void)beacons_note(&choice, &b);
}

static const char *best(const char *wanted)
{
    const struct beacons_broker *b = choice_best(&choice, "here", wanted);
    return b ? b->name : "none";
}

static void begin(void)
{
    memset(&choice, 0, sizeof choice);
}

static void test_order_of_choice(void)
{
    begin();
    CU_ASSERT_STRING_EQUAL(best(NULL), "none");
    note("z", "there", 3);
    CU_ASSERT_STRING_EQUAL(best(NULL), "z");
    note("y", "there", 2);
    CU_ASSERT_STRING_EQUAL(best(NULL), "y"); /* the lower index */
    note("x", "anywhere", 2);
    CU_ASSERT_STRING_EQUAL(best(NULL), "x"); /* then the name */
    note("w", "here", 4);
    CU_ASSERT_STRING_EQUAL(best(NULL), "w"); /* this host first */
    note("v", "here", 0);
    CU_ASSERT_STRING_EQUAL(best(NULL), "v");
    CU_ASSERT_STRING_EQUAL(best("z"), "z"); /* a wanted one, or none */
    CU_ASSERT_STRING_EQUAL(best("u"), "none");
}

static void test_nothing_can_be_better(void)
{
    begin();
    note("a", "here", 0);
    note("b", "here", 2);
    note("c", "there", 0);
    CU_ASSERT_TRUE(choice_is_final(beacons_find(&choice, "a"), "here", NULL));
    CU_ASSERT_FALSE(choice_is_final(beacons_find(&choice, "b"), "here", NULL));
    CU_ASSERT_FALSE(choice_is_final(beacons_find(&choice, "c"), "here", NULL));
    CU_ASSERT_TRUE(choice_is_final(beacons_find(&choice, "c"), "here", "c"));
}

static void test_who_is_silent_or_full_is_not_chosen(void)
{
    begin();
    note("a", "here", 0);
    note("b", "here", 2);
    (void)beacons_lose(&choice, "a");
    (void)beacons_lose(&choice, "nobody");
    CU_ASSERT_STRING_EQUAL(best(NULL), "b");
    CU_ASSERT_STRING_EQUAL(best("a"), "none");
    CU_ASSERT_FALSE(beacons_find(&choice, "a")->there);
    muster_Beacon full = beacon("b", "here", 2);
    full.takes_agents = false;
    full.agents = 1;
    (void)beacons_note(&choice, &full);
    CU_ASSERT_STRING_EQUAL(best(NULL), "b"); /* it refuses in words */
    CU_ASSERT_TRUE(beacons_find(&choice, "b")->there);
    note("a", "here", 0);
    CU_ASSERT_STRING_EQUAL(best(NULL), "a");
}

static void test_another_life_is_noticed(void)
{
    begin();
    note("a", "here", 0);
    muster_Beacon b = beacon("a", "here", 2);
    b.incarnation = 9;
    b.takes_agents = false; /* it has just started, and may have to give way */
    (void)beacons_note(&choice, &b);
    CU_ASSERT_EQUAL(beacons_find(&choice, "a")->incarnation, 1);
    CU_ASSERT_STRING_EQUAL(best(NULL), "a");
    b.takes_agents = true;
    (void)beacons_note(&choice, &b);
    CU_ASSERT_EQUAL(beacons_find(&choice, "a")->incarnation, 9);
    CU_ASSERT_EQUAL(beacons_find(&choice, "a")->index, 2);
    CU_ASSERT_EQUAL(choice.count, 1);
}

static void test_limit_brokers(void)
{
    begin();
    char name[MU_NAME_MAX + 1];
    for (int i = 0; i < MU_BROKERS_MAX; i++) {
        snprintf(name, sizeof name, "b%d", i);
        note(name, "there", 2);
    }
    note("more", "here", 0);
    CU_ASSERT_PTR_NULL(beacons_find(&choice, "more"));
    CU_ASSERT_EQUAL(choice.count, MU_BROKERS_MAX);
    (void)beacons_lose(&choice, "b7"); /* who is silent makes room */
    note("more", "here", 0);
    CU_ASSERT_STRING_EQUAL(best(NULL), "more");
    CU_ASSERT_PTR_NULL(beacons_find(&choice, "b7"));
    CU_ASSERT_PTR_NOT_NULL(beacons_find(&choice, "b31"));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"order of choice", test_order_of_choice},
        {"nothing can be better", test_nothing_can_be_better},
        {"who is silent or full is not chosen", test_who_is_silent_or_full_is_not_chosen},
        {"another life is noticed", test_another_life_is_noticed},
        {"limit: brokers", test_limit_brokers},
        CU_TEST_INFO_NULL,
    };
    return suite_run("runtime/choice", tests);
}
