/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>

static struct beacon_table own(void)
{
    return (struct beacon_table){
        .own = {.broker = words("alpha"), .host = words("here"), .incarnation = 5, .pid = 9}};
}

static muster_Beacon beacon(const char *name, uint64_t incarnation)
{
    return (muster_Beacon){.broker = words(name),
                           .incarnation = incarnation,
                           .host = words("there"),
                           .pid = 9,
                           .takes_agents = true};
}

static enum beacon_news hear(struct beacon_table *b, const char *name, uint64_t incarnation)
{
    muster_Beacon heard = beacon(name, incarnation);
    return beacon_table_hear(b, &heard);
}

static void test_others_come_and_go(void)
{
    struct beacon_table b = own();
    CU_ASSERT_EQUAL(hear(&b, "beta", 7), BEACON_MET);
    CU_ASSERT_EQUAL(hear(&b, "beta", 7), BEACON_NOTHING);
    CU_ASSERT_EQUAL(hear(&b, "beta", 8), BEACON_MET); /* another life */
    CU_ASSERT_TRUE(beacons_lose(&b.others, "beta"));
    CU_ASSERT_FALSE(beacons_lose(&b.others, "beta"));
    CU_ASSERT_FALSE(beacons_lose(&b.others, "gamma"));
    CU_ASSERT_EQUAL(hear(&b, "beta", 8), BEACON_MET);
    muster_Beacon doubtful = beacon("beta", 9);
    doubtful.takes_agents = false;
    CU_ASSERT_EQUAL(beacon_table_hear(&b, &doubtful), BEACON_NOTHING);
    CU_ASSERT_EQUAL(hear(&b, "beta", 8), BEACON_NOTHING);
}

static void test_the_earlier_one_of_a_name_stays(void)
{
    struct beacon_table b = own();
    CU_ASSERT_EQUAL(hear(&b, "alpha", 4), BEACON_EARLIER);
    CU_ASSERT_EQUAL(hear(&b, "alpha", 6), BEACON_LATER);
    CU_ASSERT_EQUAL(b.others.count, 0);
}

/* Each of two that began at the same time says the same of who stays. */
static void test_of_two_at_the_same_time_one_stays(void)
{
    struct beacon_table b = own();
    muster_Beacon other = beacon("alpha", 5);
    CU_ASSERT_EQUAL(beacon_table_hear(&b, &other), BEACON_LATER); /* "here" is before "there" */
    other.host = words("here");
    CU_ASSERT_EQUAL(beacon_table_hear(&b, &other), BEACON_NOTHING); /* it is our own */
    other.pid = 8;
    CU_ASSERT_EQUAL(beacon_table_hear(&b, &other), BEACON_EARLIER);
    other.pid = 10;
    CU_ASSERT_EQUAL(beacon_table_hear(&b, &other), BEACON_LATER);
    other.host = words("aaa");
    CU_ASSERT_EQUAL(beacon_table_hear(&b, &other), BEACON_EARLIER);
}

static void test_limit_brokers(void)
{
    struct beacon_table b = own();
    char name[MU_NAME_MAX + 1];
    for (int i = 0; i < MU_BROKERS_MAX; i++) {
        snprintf(name, sizeof name, "b%d", i);
        CU_ASSERT_EQUAL(hear(&b, name, 1), BEACON_MET);
    }
    CU_ASSERT_EQUAL(hear(&b, "more", 1), BEACON_FULL);
    CU_ASSERT_EQUAL(hear(&b, "more", 1), BEACON_NOTHING); /* it was said once */
    CU_ASSERT_TRUE(beacons_lose(&b.others, "b3"));
    CU_ASSERT_EQUAL(hear(&b, "more", 1), BEACON_MET);
    CU_ASSERT_EQUAL(hear(&b, "b4", 1), BEACON_NOTHING);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"others come and go", test_others_come_and_go},
        {"the earlier one of a name stays", test_the_earlier_one_of_a_name_stays},
        {"of two at the same time one stays", test_of_two_at_the_same_time_one_stays},
        {"limit: brokers", test_limit_brokers},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/beacons", tests);
}
