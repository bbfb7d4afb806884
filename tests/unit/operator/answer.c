/* SPDX-License-Identifier: Apache-2.0 */
#include "operator/operator.h"
#include "suite.h"

#include <CUnit/Basic.h>

static void test_a_refusal_says_by_whom(void)
{
    READS(answer_outcome_advice(MU_MAIL_REFUSED, "red"), " by the trust policy of its broker");
    CU_ASSERT_PTR_NOT_NULL(strstr(answer_outcome_advice(MU_MAIL_NO_STORE, "red"), "disk"));
    READS(answer_outcome_advice(MU_MAIL_BOX_FULL, "red"), "");
    READS(answer_outcome_advice(MU_MAIL_DELIVERED, "red"), "");
}

static void test_who_is_unknown_is_looked_for_where_he_would_be(void)
{
    enum mu_outcome unknown = MU_MAIL_UNKNOWN_NAME;
    READS(answer_outcome_advice(unknown, "red"), "; muster ps lists all agents");
    READS(answer_outcome_advice(unknown, "group:scouts"), "; muster group list lists groups");
    CU_ASSERT_PTR_NOT_NULL(strstr(answer_outcome_advice(unknown, "role:scout"), "resolver"));
}

static void test_the_last_word_says_why_an_agent_stays(void)
{
    READS(answer_travel_advice("red here-already"), "it is on that host");
    CU_ASSERT_PTR_NOT_NULL(strstr(answer_travel_advice("red unknown-host"), "muster ps"));
    CU_ASSERT_PTR_NULL(answer_travel_advice("red at south"));
    CU_ASSERT_PTR_NULL(answer_travel_advice("unknown-host"));
    CU_ASSERT_PTR_NULL(answer_travel_advice("red not-busy"));
    CU_ASSERT_PTR_NULL(answer_travel_advice(""));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a refusal says by whom", test_a_refusal_says_by_whom},
        {"unknown names", test_who_is_unknown_is_looked_for_where_he_would_be},
        {"why an agent stays", test_the_last_word_says_why_an_agent_stays},
        CU_TEST_INFO_NULL,
    };
    return suite_run("operator/answer", tests);
}
