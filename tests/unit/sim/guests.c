/* SPDX-License-Identifier: Apache-2.0 */
/* Agents without a body that begin, move and end while a run goes on. */
#include "sim/session/guests.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>

static struct guests *guests;

static void set_up(void)
{
    if (!guests) {
        guests = guests_open();
    }
    guests->count = guests->coming_count = 0;
}

static void seat(const char *name, int32_t process)
{
    CU_ASSERT_EQUAL(guests_seat(guests, name, process), MU_OK);
}

/* Expects "NAME@PROCESS NAME@PROCESS ". */
static void expect(const char *want)
{
    char got[256] = "";
    for (uint32_t i = 0; i < guests->count; i++) {
        size_t len = strlen(got);
        snprintf(got + len, sizeof got - len, "%s@%d ", guests->at[i].name,
                 (int)guests->at[i].process);
    }
    CU_ASSERT_STRING_EQUAL(got, want);
}

static void test_they_stand_in_order_of_name(void)
{
    seat("ruby", 1);
    seat("amber", 2);
    expect("");
    CU_ASSERT_PTR_NULL(guests_find(guests, "ruby"));
    guests_settle(guests);
    expect("amber@2 ruby@1 ");
    seat("pearl", 0);
    guests_settle(guests);
    guests_settle(guests);
    expect("amber@2 pearl@0 ruby@1 ");
    CU_ASSERT_PTR_EQUAL(guests_find(guests, "pearl"), &guests->at[1]);
    CU_ASSERT_PTR_NULL(guests_find(guests, "opal"));
    CU_ASSERT_PTR_NULL(guests_find(guests, "zircon"));
}

static void test_who_moves_does_so_between_steps(void)
{
    seat("ruby", 1);
    guests_settle(guests);
    seat("ruby", 2);
    expect("ruby@1 ");
    guests_settle(guests);
    expect("ruby@2 ");
}

/* Its last act counts; the name may begin anew with the next step. */
static void test_who_ends_is_out(void)
{
    seat("ruby", 1);
    seat("amber", 1);
    guests_settle(guests);
    guests_find(guests, "amber")->state = muster_STATE_ABSENT;
    expect("amber@1 ruby@1 ");
    seat("amber", 2);
    guests_settle(guests);
    expect("amber@2 ruby@1 ");
    CU_ASSERT_EQUAL(guests_find(guests, "amber")->state, muster_STATE_STANDBY);
    guests_find(guests, "ruby")->state = muster_STATE_ABSENT;
    guests_settle(guests);
    expect("amber@2 ");
}

/* Who was about to move lives where it was to go. */
static void test_a_process_dies(void)
{
    seat("ruby", 1);
    seat("amber", 2);
    guests_settle(guests);
    seat("ruby", 2);
    seat("pearl", 2);
    guests_renumber(guests, 1, -1);
    expect("amber@2 ruby@2 ");
    guests_renumber(guests, 2, -1);
    expect("amber@-1 ruby@-1 ");
    guests_settle(guests);
    expect("amber@-1 pearl@-1 ruby@-1 ");
}

/* Nobody lives there then: who is given another process lives in it at once. */
static void test_a_process_dies_from_which_somebody_set_out(void)
{
    seat("ruby", 1);
    guests_settle(guests);
    guests_renumber(guests, 1, -1);
    seat("ruby", 2);
    expect("ruby@2 ");
    guests_settle(guests);
    expect("ruby@2 ");
}

static void test_a_process_has_another_index(void)
{
    seat("ruby", 3);
    guests_settle(guests);
    seat("ruby", 5);
    seat("pearl", 5);
    guests_renumber(guests, 3, 2);
    guests_renumber(guests, 5, 4);
    expect("ruby@2 ");
    guests_settle(guests);
    expect("pearl@4 ruby@4 ");
}

static void test_limit_new_ones_of_a_step(void)
{
    char name[16];
    for (int i = 0; i < MU_CAPSULES_MAX; i++) {
        snprintf(name, sizeof name, "g%d", i);
        seat(name, 0);
    }
    CU_ASSERT_EQUAL(guests_seat(guests, "more", 0), MU_FULL);
    guests_settle(guests);
    CU_ASSERT_EQUAL(guests->count, MU_CAPSULES_MAX);
    seat("more", 0);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"they stand in order of name", test_they_stand_in_order_of_name},
        {"who moves does so between steps", test_who_moves_does_so_between_steps},
        {"who ends is out", test_who_ends_is_out},
        {"a process dies", test_a_process_dies},
        {"a process dies from which somebody set out",
         test_a_process_dies_from_which_somebody_set_out},
        {"a process has another index", test_a_process_has_another_index},
        {"limit: new ones of a step", test_limit_new_ones_of_a_step},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"sim/guests", NULL, NULL, set_up, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
