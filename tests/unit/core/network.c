/* SPDX-License-Identifier: Apache-2.0 */
#include "core/network.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdlib.h>

static struct mu_network network;

static mu_result parse(int argc, char **argv)
{
    static struct mu_option table[] = {MU_JOIN_OPTIONS(network)};
    static struct mu_options options;
    network = (struct mu_network){0};
    options = (struct mu_options){.program = "test", .table = table, .count = 5};
    return mu_options_parse(&options, argc, argv);
}

static void test_peers_are_joined(void)
{
    char program[] = "test", peer[] = "--peer", a[] = "10.0.0.1", b[] = "b.example,c",
         broker[] = "--broker=x";
    CU_ASSERT_EQUAL_FATAL(parse(1, (char *[]){program, NULL}), MU_OK);
    CU_ASSERT_PTR_NULL(mu_network_peers(&network));
    CU_ASSERT_PTR_NULL(network.broker);
    CU_ASSERT_EQUAL_FATAL(parse(6, (char *[]){program, peer, a, peer, b, broker, NULL}), MU_OK);
    CU_ASSERT_STRING_EQUAL(mu_network_peers(&network), "10.0.0.1,b.example,c");
    CU_ASSERT_STRING_EQUAL(network.broker, "x");
}

static void test_peers_from_the_environment(void)
{
    char program[] = "test";
    setenv("MUSTER_PEER", "a,b", 1);
    setenv("MUSTER_BROKER", "y", 1);
    CU_ASSERT_EQUAL_FATAL(parse(1, (char *[]){program, NULL}), MU_OK);
    CU_ASSERT_STRING_EQUAL(mu_network_peers(&network), "a,b");
    CU_ASSERT_STRING_EQUAL(network.broker, "y");
    unsetenv("MUSTER_PEER");
    unsetenv("MUSTER_BROKER");
}

static int begin(void)
{
    setenv("MUSTER_CONFIG", "/dev/null", 1);
    return 0;
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"peers are joined", test_peers_are_joined},
        {"peers from the environment", test_peers_from_the_environment},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"core/network", begin, NULL, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
