/* SPDX-License-Identifier: Apache-2.0 */
/* The words of KQML and FIPA: each is found, nothing else is, and the answers are marked. */
#include "core/performatives.h"
#include "muster/kind.h"
#include "muster/limits.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static void test_every_row_is_found_and_fits_a_mail(void)
{
    size_t count = 0;
    const char *before = "";
    for (const struct mu_performative *p; (p = mu_performative_at(count)) != NULL; count++) {
        CU_ASSERT(strcmp(before, p->word) < 0); /* the search relies on the order */
        CU_ASSERT_PTR_EQUAL(mu_performative_find(p->word), p);
        CU_ASSERT_TRUE(mu_performative_known(p->word));
        CU_ASSERT(p->of & (MU_OF_KQML | MU_OF_FIPA));
        CU_ASSERT(strlen(p->word) <= MU_FIELD_MAX);
        before = p->word;
    }
    CU_ASSERT(count > 60);
    CU_ASSERT_PTR_NULL(mu_performative_at(count));
    CU_ASSERT_PTR_NULL(mu_performative_at(SIZE_MAX));
}

static unsigned of(const char *word)
{
    const struct mu_performative *p = mu_performative_find(word);
    CU_ASSERT_PTR_NOT_NULL_FATAL(p);
    return p->of & (MU_OF_KQML | MU_OF_FIPA);
}

static void test_whose_word_it_is(void)
{
    CU_ASSERT_EQUAL(of("tell"), MU_OF_KQML);
    CU_ASSERT_EQUAL(of("ask-one"), MU_OF_KQML);
    CU_ASSERT_EQUAL(of("achieve"), MU_OF_KQML);
    CU_ASSERT_EQUAL(of("inform"), MU_OF_FIPA);
    CU_ASSERT_EQUAL(of("cfp"), MU_OF_FIPA);
    CU_ASSERT_EQUAL(of("request-whenever"), MU_OF_FIPA);
    CU_ASSERT_EQUAL(of("subscribe"), MU_OF_KQML | MU_OF_FIPA);
}

static void test_no_other_word_is_known(void)
{
    static const char *const others[] = {"", "Tell", "tell ", "tel", "zzz", "aaa", "suspend"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        CU_ASSERT_FALSE(mu_performative_known(others[i]));
        CU_ASSERT_FALSE(mu_performative_answers(others[i]));
    }
}

static void test_which_words_answer(void)
{
    static const char *const answers[] = {"not-understood", "refuse", "agree", "failure",
                                          "sorry",          "error",  "reply"};
    static const char *const others[] = {"inform", "tell", "request", "ask-one", "cfp", "propose"};
    for (size_t i = 0; i < sizeof answers / sizeof answers[0]; i++) {
        CU_ASSERT_TRUE(mu_performative_answers(answers[i]));
    }
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        CU_ASSERT_FALSE(mu_performative_answers(others[i]));
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"every row is found and fits a mail", test_every_row_is_found_and_fits_a_mail},
        {"whose word it is", test_whose_word_it_is},
        {"no other word is known", test_no_other_word_is_known},
        {"which words answer", test_which_words_answer},
        CU_TEST_INFO_NULL,
    };
    return suite_run("core/performatives", tests);
}
