/* SPDX-License-Identifier: Apache-2.0 */
/* Agents with a body and without that begin, move and end while a run goes on. */
#include "physics.h"
#include "sim/session/parts.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>

static struct session_agents agents;

static void set_up(void)
{
    if (!agents.at) {
        physics_clear();
        physics_robot(0, 0, 0);
        physics_robot(1, 0, 0);
        agents_open(&agents, &physics_world);
    }
    agents.count = agents.robots;
    agents.coming_count = 0;
}

static void seat(const char *name, int32_t process)
{
    CU_ASSERT_EQUAL(agents_seat(&agents, name, process), MU_OK);
}

/* Expects "NAME@PROCESS NAME@PROCESS ". */
static void expect(const char *want)
{
    char got[256] = "";
    for (uint32_t i = agents.robots; i < agents.count; i++) {
        size_t len = strlen(got);
        snprintf(got + len, sizeof got - len, "%s@%d ", agents.at[i].name,
                 (int)agents.at[i].process);
    }
    CU_ASSERT_STRING_EQUAL(got, want);
}

static void test_they_stand_in_order_of_name(void)
{
    seat("ruby", 1);
    seat("amber", 2);
    expect("");
    CU_ASSERT_PTR_NULL(agents_find(&agents, "ruby"));
    agents_settle(&agents);
    expect("amber@2 ruby@1 ");
    seat("pearl", 0);
    agents_settle(&agents);
    agents_settle(&agents);
    expect("amber@2 pearl@0 ruby@1 ");
    CU_ASSERT_PTR_EQUAL(agents_find(&agents, "pearl"), &agents.at[3]);
    CU_ASSERT_PTR_NULL(agents_find(&agents, "opal"));
    CU_ASSERT_PTR_NULL(agents_find(&agents, "zircon"));
}

static void test_who_moves_does_so_between_steps(void)
{
    seat("ruby", 1);
    agents_settle(&agents);
    seat("ruby", 2);
    expect("ruby@1 ");
    agents_settle(&agents);
    expect("ruby@2 ");
}

/* Its last act counts; the name may begin anew with the next step. */
static void test_who_ends_is_out(void)
{
    seat("ruby", 1);
    seat("amber", 1);
    agents_settle(&agents);
    agents_find(&agents, "amber")->state = muster_STATE_ABSENT;
    expect("amber@1 ruby@1 ");
    seat("amber", 2);
    agents_settle(&agents);
    expect("amber@2 ruby@1 ");
    CU_ASSERT_EQUAL(agents_find(&agents, "amber")->state, muster_STATE_STANDBY);
    agents_find(&agents, "ruby")->state = muster_STATE_ABSENT;
    agents_settle(&agents);
    expect("amber@2 ");
}

/* Who was about to move lives where it was to go. */
static void test_a_process_dies(void)
{
    seat("ruby", 1);
    seat("amber", 2);
    agents_settle(&agents);
    seat("ruby", 2);
    seat("pearl", 2);
    agents_renumber(&agents, 1, -1);
    expect("amber@2 ruby@2 ");
    agents_renumber(&agents, 2, -1);
    expect("amber@-1 ruby@-1 ");
    agents_settle(&agents);
    expect("amber@-1 pearl@-1 ruby@-1 ");
}

/* Nobody lives there then: who is given another process lives in it at once. */
static void test_a_process_dies_from_which_somebody_set_out(void)
{
    seat("ruby", 1);
    agents_settle(&agents);
    agents_renumber(&agents, 1, -1);
    seat("ruby", 2);
    expect("ruby@2 ");
    agents_settle(&agents);
    expect("ruby@2 ");
}

static void test_a_process_has_another_index(void)
{
    seat("ruby", 3);
    agents_settle(&agents);
    seat("ruby", 5);
    seat("pearl", 5);
    agents_renumber(&agents, 3, 2);
    agents_renumber(&agents, 5, 4);
    expect("ruby@2 ");
    agents_settle(&agents);
    expect("pearl@4 ruby@4 ");
}

/* Robots stand first, in the world's order, and move by a word of their own. */
static void test_robots(void)
{
    struct session_agent *robot = agents_find(&agents, "robot1");
    CU_ASSERT_PTR_EQUAL_FATAL(robot, &agents.at[1]);
    CU_ASSERT_EQUAL(robot->body, 1);
    CU_ASSERT_FALSE(agents_live_in(&agents, 4));
    seat("robot1", 4);
    CU_ASSERT_EQUAL(robot->process, 4); /* at once: nobody had it */
    seat("robot1", 5);
    CU_ASSERT_EQUAL(robot->process, 4);
    CU_ASSERT_EQUAL(agents_home(robot), 5);
    CU_ASSERT_TRUE(agents_live_in(&agents, 4) && agents_live_in(&agents, 5));
    agents_settle(&agents);
    CU_ASSERT_EQUAL(robot->process, 4);
    agents_move_robots(&agents);
    CU_ASSERT_EQUAL(robot->process, 5);
    seat("robot1", -1); /* the process that took it is dead */
    CU_ASSERT_EQUAL(agents_home(robot), -1);
    CU_ASSERT_EQUAL(agents.count, agents.robots);
}

/* A robot that the run does without is an obstacle, and its name is free. */
static void test_a_robot_without_a_controller(void)
{
    agents.at[0].controlled = false;
    CU_ASSERT_PTR_NULL(agents_find(&agents, "robot0"));
    seat("robot0", 3);
    agents_settle(&agents);
    CU_ASSERT_EQUAL(agents_find(&agents, "robot0")->body, -1);
    agents.at[0].controlled = true;
}

/* One that is to begin keeps its process in the run. */
static void test_who_comes_lives_somewhere(void)
{
    seat("ruby", 6);
    CU_ASSERT_TRUE(agents_live_in(&agents, 6));
    agents_settle(&agents);
    CU_ASSERT_TRUE(agents_live_in(&agents, 6));
    agents_find(&agents, "ruby")->state = muster_STATE_ABSENT;
    CU_ASSERT_FALSE(agents_live_in(&agents, 6));
}

static void test_limit_new_ones_of_a_step(void)
{
    char name[16];
    for (int i = 0; i < MU_CAPSULES_MAX; i++) {
        snprintf(name, sizeof name, "g%d", i);
        seat(name, 0);
    }
    CU_ASSERT_EQUAL(agents_seat(&agents, "more", 0), MU_FULL);
    agents_settle(&agents);
    CU_ASSERT_EQUAL(agents.count, agents.robots + MU_CAPSULES_MAX);
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
        {"robots", test_robots},
        {"a robot without a controller", test_a_robot_without_a_controller},
        {"who comes lives somewhere", test_who_comes_lives_somewhere},
        {"limit: new ones of a step", test_limit_new_ones_of_a_step},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"sim/agents", NULL, NULL, set_up, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
