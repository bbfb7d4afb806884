/* SPDX-License-Identifier: Apache-2.0 */
#include "core/attributes.h"
#include "garble.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>

static const char offer[] = "role=scout battery=0.8 x=3 y=-4 site=a=b port=007 \"q\\";

static bool fits(const char *query, const char *attributes)
{
    struct mu_query q;
    CU_ASSERT_EQUAL_FATAL(mu_attributes_query(&q, query), MU_OK);
    return mu_attributes_match(&q, "mapper", attributes);
}

static void test_constraints(void)
{
    static const struct {
        const char *query;
        bool fits;
    } cases[] = {
        {"mapper", true},
        {"*", true},
        {"Mapper", false},
        {" mapper   role=scout ", true},
        {"mapper role=scou", false},
        {"* role=scouts", false},
        {"* role!=scout", false},
        {"* role!=cook", true},
        {"* battery=0.80", true},
        {"* battery=8e-1", true},
        {"* battery!=0.8", false},
        {"* battery>0.8", false},
        {"* battery>=0.8", true},
        {"* battery<0.8", false},
        {"* battery<=0.8", true},
        {"* battery<10", true},
        {"* x>-10", true},
        {"* y<0 x>0", true},
        {"* y<0 x<0", false},
        {"* port=7", true},
        {"* port=0x7", false},
        {"* role>1", false}, /* a text has no order */
        {"* none=1", false},
        {"* none!=1", false}, /* nobody says so */
        {"* rol=scout", false},
        {"* site=a=b", true},
        {"* near=0,0,5", true},
        {"* near=0,0,4.9", false},
        {"* near=3,-4,0", true},
        {"* near=-1e3,0,2000", true},
    };
    const char *attributes = "role=scout battery=0.8 x=3 y=-4 site=a=b port=007";
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (fits(cases[i].query, attributes) != cases[i].fits) {
            printf("\n  %s: not %d\n", cases[i].query, cases[i].fits);
            CU_FAIL("a constraint");
        }
    }
    CU_ASSERT_FALSE(fits("* near=0,0,5", "x=1"));
    CU_ASSERT_FALSE(fits("* near=0,0,5", "x=1 y=here"));
    CU_ASSERT_FALSE(fits("* a=1", ""));
    CU_ASSERT_TRUE(fits("*", ""));
}

static void test_malformed_queries(void)
{
    static const char *const bad[] = {"",
                                      " ",
                                      "1mapper",
                                      "map*",
                                      "** a=1",
                                      "* role",
                                      "* role=",
                                      "* =scout",
                                      "* role==scout",
                                      "* role=>1",
                                      "* a<b",
                                      "* a>=",
                                      "* a! =1",
                                      "* 1a=2",
                                      "* near=1,2",
                                      "* near=1",
                                      "* near=a,b,c",
                                      "* near=1,2,-3",
                                      "* near=1,2,3,4",
                                      "* near=,,",
                                      "* near=1,2,",
                                      "* a\t=1",
                                      "* a=1\n",
                                      "* a<inf",
                                      "* a<nan",
                                      "* a<1e999",
                                      "* \xff=1",
                                      "an-agent-with-a-long-name-000001"};
    struct mu_query q;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        if (mu_attributes_query(&q, bad[i]) != MU_MALFORMED) {
            printf("\n  accepted: %s\n", bad[i]);
            CU_FAIL("a malformed query");
        }
    }
}

static void test_attributes(void)
{
    static const char *const good[] = {"", " ", "a=1", " a=1  b=2 ", "a==", "a=\"\\;()"};
    static const char *const bad[] = {"a",    "a=",  "=1",     "a=1 a=2",  "a=1 b", "a<1",
                                      "a!=1", "1=2", "a=\x7f", "a=b\tc=d", "a=1\n", "a b=1"};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        bool odd = strcmp(good[i], "a==") == 0; /* a relation that is none */
        CU_ASSERT_EQUAL(mu_attributes_valid(good[i]), !odd);
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        CU_ASSERT_FALSE(mu_attributes_valid(bad[i]));
    }
}

static void test_limits(void)
{
    static char text[2 * MU_QUERY_MAX];
    struct mu_query q;
    memset(text, 'v', sizeof text);
    memcpy(text, "* a=", 4);
    text[4 + MU_FIELD_MAX] = '\0';
    CU_ASSERT_EQUAL(mu_attributes_query(&q, text), MU_OK);
    text[4 + MU_FIELD_MAX] = 'v';
    text[5 + MU_FIELD_MAX] = '\0';
    CU_ASSERT_EQUAL(mu_attributes_query(&q, text), MU_MALFORMED);

    memset(text, ' ', sizeof text);
    text[0] = '*';
    text[MU_QUERY_MAX] = '\0';
    CU_ASSERT_EQUAL(mu_attributes_query(&q, text), MU_OK);
    text[MU_QUERY_MAX] = ' ';
    text[MU_QUERY_MAX + 1] = '\0';
    CU_ASSERT_EQUAL(mu_attributes_query(&q, text), MU_MALFORMED);

    text[1] = '\0';
    for (int i = 0; i < MU_CONSTRAINTS_MAX; i++) {
        strncat(text, " a=1", sizeof text - strlen(text) - 1);
    }
    CU_ASSERT_EQUAL(mu_attributes_query(&q, text), MU_OK);
    strncat(text, " a=1", sizeof text - strlen(text) - 1);
    CU_ASSERT_EQUAL(mu_attributes_query(&q, text), MU_FULL);

    memset(text, ' ', sizeof text);
    text[MU_ATTRIBUTES_MAX] = '\0';
    CU_ASSERT_TRUE(mu_attributes_valid(text));
    text[MU_ATTRIBUTES_MAX] = ' ';
    text[MU_ATTRIBUTES_MAX + 1] = '\0';
    CU_ASSERT_FALSE(mu_attributes_valid(text));
}

static void test_garbage(void)
{
    static const char query[] = "mapper role=scout battery>=0.5 near=1,2,3 y!=2 x<=1e3";
    char query_text[256], offer_text[256];
    struct mu_random r;
    struct mu_query q;
    unsigned good = 0;
    mu_random_seed(&r, 3, "attributes");
    for (int i = 0; i < 50000; i++) {
        garble(&r, query_text, sizeof query_text, query, sizeof query - 1);
        garble(&r, offer_text, sizeof offer_text, offer, sizeof offer - 1);
        (void)mu_attributes_valid(offer_text);
        if (mu_attributes_query(&q, query_text) == MU_OK) {
            good++;
            (void)mu_attributes_match(&q, "mapper", offer_text);
        }
    }
    CU_ASSERT(good > 100 && good < 50000);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"constraints", test_constraints}, {"malformed queries", test_malformed_queries},
        {"attributes", test_attributes},   {"limits", test_limits},
        {"garbage", test_garbage},         CU_TEST_INFO_NULL,
    };
    return suite_run("core/attributes", tests);
}
