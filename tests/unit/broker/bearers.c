/* SPDX-License-Identifier: Apache-2.0 */
/* A broker dies, and newcomers ask another one for the names of those who live on. */
#include "broker_net.h"

enum { A, B, C };

/* Red lives at one broker, and a newcomer asks the other for its name. */
static struct net_agent *newcomer_at_the_other(void)
{
    net_begin();
    net_link(A, B, true);
    net_join_as("red", "", A, 100);
    net_settle();
    struct net_agent *late = net_join_as("red", "2", B, 200);
    net_settle();
    return late;
}

static void test_a_lost_broker_s_names_are_kept(void)
{
    struct net_agent *late = newcomer_at_the_other();
    net_tick(1400 * MS);
    net_link(A, B, false);
    net_settle();
    LIVES(B, "red", "a absent");
    net_tick(300 * MS);
    net_register(late, muster_STATE_RUNNING); /* its heartbeat */
    net_settle();
    LIVES(B, "red", "a absent");
    CU_ASSERT_FALSE(late->accepted);
    net_move("red", B);
    net_settle();
    LIVES(B, "red", "b running");
    CU_ASSERT_TRUE(net_agent("red")->accepted);
    CU_ASSERT_STRING_EQUAL(late->refused, "");
    net_tick(1200 * MS);
    CU_ASSERT_STRING_EQUAL(late->refused, "held by another participant");
    CU_ASSERT_EQUAL(net.b[B]->claims.pool.live, 0);
}

static void test_a_newcomer_asks_when_the_broker_is_lost(void)
{
    net_begin();
    net_link(A, B, true);
    net_join_as("red", "", A, 100);
    net_settle();
    net_link(A, B, false);
    net_settle();
    struct net_agent *late = net_join_as("red", "2", B, 200);
    net_settle();
    CU_ASSERT_FALSE(late->accepted);
    net_tick(1000 * MS);
    net_move("red", B);
    net_tick(500 * MS);
    CU_ASSERT_TRUE(net_agent("red")->accepted);
    CU_ASSERT_STRING_EQUAL(late->refused, "held by another participant");
}

/* Those who wait are served in the order in which they asked, whatever died meanwhile. */
static void test_a_bearer_that_does_not_come_is_inherited(void)
{
    struct net_agent *late = newcomer_at_the_other();
    net_tick(100 * MS);
    struct net_agent *later = net_join_as("red", "3", B, 300);
    net_tick(1000 * MS);
    net_link(A, B, false);
    net_settle();
    net_tick(1499 * MS);
    CU_ASSERT_FALSE(late->accepted);
    net_tick(1 * MS);
    CU_ASSERT_TRUE(late->accepted);
    CU_ASSERT_STRING_EQUAL(later->refused, "held by another participant");
    LIVES(B, "red", "b running");
    CU_ASSERT_EQUAL(net.b[B]->claims.pool.live, 0);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a lost broker's names are kept", test_a_lost_broker_s_names_are_kept},
        {"a newcomer asks when the broker is lost", test_a_newcomer_asks_when_the_broker_is_lost},
        {"a bearer that does not come is inherited", test_a_bearer_that_does_not_come_is_inherited},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/bearers", tests);
}
