/* SPDX-License-Identifier: Apache-2.0 */
/* Which known word somebody may have meant. */
#include "core/spell.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>

static void test_slips_are_counted(void)
{
    static const struct {
        const char *a, *b;
        size_t slips;
    } cases[] = {
        {"", "", 0},           {"laser", "laser", 0},    {"lazer", "laser", 1},
        {"laer", "laser", 1},  {"lasser", "laser", 1},   {"lsaer", "laser", 1},
        {"", "laser", 5},      {"kitten", "sitting", 3}, {"modle", "model", 1},
        {"mdoel", "model", 1}, {"abc", "cba", 2},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        CU_ASSERT_EQUAL(mu_spell_distance(cases[i].a, cases[i].b), cases[i].slips);
        CU_ASSERT_EQUAL(mu_spell_distance(cases[i].b, cases[i].a), cases[i].slips);
    }
    char longer[200];
    memset(longer, 'a', sizeof longer - 1);
    longer[sizeof longer - 1] = '\0';
    CU_ASSERT_EQUAL(mu_spell_distance(longer, "a"), sizeof longer - 1);
}

static const char *nearest(const char *word)
{
    static const char *const known[] = {"pose", "size", "laser", "ranger_return", "z", "fov"};
    struct mu_spell s;
    mu_spell_init(&s, word);
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        mu_spell_offer(&s, known[i]);
    }
    return s.nearest ? s.nearest : "none";
}

static void test_the_nearest_is_found(void)
{
    CU_ASSERT_STRING_EQUAL(nearest("posse"), "pose");
    CU_ASSERT_STRING_EQUAL(nearest("lazer"), "laser");
    CU_ASSERT_STRING_EQUAL(nearest("rangr_retrun"), "ranger_return");
    CU_ASSERT_STRING_EQUAL(nearest("siez"), "size");
    CU_ASSERT_STRING_EQUAL(nearest("velocity"), "none");
    CU_ASSERT_STRING_EQUAL(nearest("q"), "none"); /* a word of one letter resembles nothing */
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"slips are counted", test_slips_are_counted},
        {"the nearest is found", test_the_nearest_is_found},
        CU_TEST_INFO_NULL,
    };
    return suite_run("core/spell", tests);
}
