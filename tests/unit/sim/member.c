/* SPDX-License-Identifier: Apache-2.0 */
/* The states of a process in a run: the whole table, and what registrations make of them. */
#include "capture.h"
#include "muster/memory.h"
#include "physics.h"
#include "sim/session/parts.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* A letter for each state, in their order; '.' is a refusal. */
static const char letters[] = ".JACLSRO";

/* Rows: from which state.  Columns: heartbeat, loss, claim, answer | joins, claim ends, leaves out,
 * releases. */
static const char *const rows[] = {"JJ.J|A...", "ALCA|....", "CSCA|.A..", "ALSL|..O.",
                                   ".SSS|...R", ".R..|....", ".OS.|...."};

static enum member_state state_of(char letter)
{
    return (enum member_state)(strchr(letters, letter) - letters);
}

/* @return whether the event ends a program */
static bool aborts(enum member_state state, enum member_event event)
{
    int status = 0;
    capture_begin();
    pid_t child = fork();
    if (child == 0) {
        struct session_process p = {.state = state};
        (void)member_on(&p, event);
        _exit(0);
    }
    CU_ASSERT_EQUAL(waitpid(child, &status, 0), child);
    capture_end();
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT;
}

static void check_peer(enum member_state from, enum member_event event, char wanted)
{
    struct session_process p = {.name = "p", .state = from};
    bool refused = wanted == '.';
    capture_begin();
    CU_ASSERT_EQUAL(member_on(&p, event), !refused);
    capture_end();
    CU_ASSERT_EQUAL(p.state, refused ? from : state_of(wanted));
    CU_ASSERT_EQUAL(p.refused, refused);
    CU_ASSERT_EQUAL(said("member-refused"), refused);
    if (refused) { /* the next one is counted, too, and not told again */
        capture_begin();
        CU_ASSERT_FALSE(member_on(&p, event));
        capture_end();
        CU_ASSERT_EQUAL(p.refused, 2);
        CU_ASSERT_FALSE(said("member-refused"));
    }
}

static void check_own(enum member_state from, enum member_event event, char wanted)
{
    if (wanted == '.') {
        CU_ASSERT_TRUE(aborts(from, event));
        return;
    }
    struct session_process p = {.state = from};
    CU_ASSERT_TRUE(member_on(&p, event));
    CU_ASSERT_EQUAL(p.state, state_of(wanted));
}

static void test_the_whole_table(void)
{
    CU_ASSERT_EQUAL(sizeof rows / sizeof rows[0], MEMBER_STATES - MEMBER_JOINING);
    CU_ASSERT_EQUAL(strlen(letters), MEMBER_STATES);
    for (int state = MEMBER_JOINING; state < MEMBER_STATES; state++) {
        const char *row = rows[state - MEMBER_JOINING];
        CU_ASSERT_EQUAL(strlen(row), MEMBER_EVENTS + 1);
        for (int event = 0; event < MEMBER_OWN_EVENTS; event++) {
            check_peer((enum member_state)state, (enum member_event)event, row[event]);
        }
        for (int event = MEMBER_OWN_EVENTS; event < MEMBER_EVENTS; event++) {
            check_own((enum member_state)state, (enum member_event)event, row[event + 1]);
        }
    }
}

static void test_who_gets_steps(void)
{
    for (int state = MEMBER_JOINING; state < MEMBER_STATES; state++) {
        const struct session_process p = {.state = (enum member_state)state};
        bool out = state == MEMBER_RELEASED || state == MEMBER_LEFT_OUT;
        CU_ASSERT_EQUAL(member_is_in_steps(&p), !out);
    }
}

/* --- by registrations ------------------------------------------------------------------------- */

enum { CARTER, RESOLVER, HOST };

static struct session s;

/* A lock step with a robot's process, one that watches and a host; processes may return. */
static void set_up(void)
{
    static const struct session_process processes[] = {
        [CARTER] = {.name = "carter.1", .state = MEMBER_ACTIVE},
        [RESOLVER] = {.name = "resolver.1", .state = MEMBER_ACTIVE, .sight = MEMBER_WATCHES},
        [HOST] = {.name = "host.1", .state = MEMBER_ACTIVE, .host = "inn"}};
    if (!s.processes) {
        s.processes = mu_startup_array(MU_PROCESSES_MAX, sizeof *s.processes);
        physics_clear();
        physics_robot(0, 0, 0);
        agents_open(&s.agents, &physics_world);
        mu_table_init(&s.process_names, MU_PROCESSES_MAX);
        s.process_count = sizeof processes / sizeof processes[0];
        memcpy(s.processes, processes, sizeof processes);
        for (uint32_t i = 0; i < s.process_count; i++) {
            (void)mu_table_put(&s.process_names, s.processes[i].name, i);
        }
    }
    memcpy(s.processes, processes, sizeof processes);
    s.agents.at[0].process = CARTER;
    s.options.return_ns = 1000000000;
    s.step = 7;
    s.phase = PHASE_RUNNING;
}

static enum member_state state(uint32_t process)
{
    return s.processes[process].state;
}

/* @param agent  "": none, and it watches */
static void hear(const char *process, const char *agent, enum bus_life life)
{
    char name[MU_PROCESS_MAX + 1], agent_name[MU_NAME_MAX + 1];
    snprintf(name, sizeof name, "%s", process);
    snprintf(agent_name, sizeof agent_name, "%s", agent);
    bool hosts = strcmp(agent, "inn") == 0;
    muster_Entry e = {.name = agent_name,
                      .kind = hosts ? muster_KIND_HOST : muster_KIND_ROBOT,
                      .state = muster_STATE_RUNNING};
    muster_Registration r = {.wire = muster_WIRE, .process = name, .watches = agent[0] == '\0'};
    r.agents._buffer = &e;
    r.agents._length = agent[0] != '\0';
    roster_hear(&s, &r, life);
}

/* In free running, or before the first step: what a process says of robot0. */
static void say(uint32_t process, muster_State its_state, bool newcomer, enum bus_life life)
{
    static struct session_robot robot;
    char name[] = "robot0";
    muster_Entry e = {
        .name = name, .kind = muster_KIND_ROBOT, .state = its_state, .newcomer = newcomer};
    muster_Registration r = {.wire = muster_WIRE, .process = s.processes[process].name};
    r.broker = name;
    r.agents._buffer = &e;
    r.agents._length = 1;
    s.phase = PHASE_GATHERING;
    s.robots = &robot;
    roster_register(&s, &r, life);
}

static int32_t controller(void)
{
    return s.agents.at[0].process;
}

static void test_a_body_has_the_process_that_has_the_name(void)
{
    say(HOST, muster_STATE_MOVING, true, BUS_DATA); /* it asks for it */
    say(CARTER, muster_STATE_ABSENT, false, BUS_DATA);
    CU_ASSERT_EQUAL(controller(), -1);
    say(HOST, muster_STATE_RUNNING, false, BUS_DATA);
    CU_ASSERT_EQUAL(controller(), HOST);
    say(CARTER, muster_STATE_MOVING, true, BUS_DATA);
    say(CARTER, muster_STATE_RUNNING, false, BUS_DATA); /* heard of before the other one has left */
    CU_ASSERT_EQUAL(controller(), HOST);
    say(HOST, muster_STATE_ABSENT, false, BUS_DATA);
    CU_ASSERT_EQUAL(controller(), CARTER);
    say(HOST, muster_STATE_ABSENT, false, BUS_DATA);
    CU_ASSERT_EQUAL(controller(), CARTER);
}

static void test_an_heir_that_has_gone_inherits_nothing(void)
{
    say(HOST, muster_STATE_RUNNING, false, BUS_DATA);
    say(HOST, muster_STATE_ABSENT, false, BUS_DATA);
    say(CARTER, muster_STATE_ABSENT, false, BUS_DATA);
    CU_ASSERT_EQUAL(controller(), -1);
    say(CARTER, muster_STATE_RUNNING, false, BUS_DATA);
    for (enum bus_life life = BUS_DISPOSED; life <= BUS_LOST; life++) {
        say(HOST, muster_STATE_RUNNING, false, BUS_DATA);
        say(HOST, muster_STATE_RUNNING, false, life);
        say(CARTER, muster_STATE_RUNNING, false, life);
        CU_ASSERT_EQUAL(controller(), -1);
        say(CARTER, muster_STATE_RUNNING, false, BUS_DATA);
        say(HOST, muster_STATE_RUNNING, false, BUS_DATA);
        say(CARTER, muster_STATE_RUNNING, false, life);
        CU_ASSERT_EQUAL(controller(), HOST);
        say(HOST, muster_STATE_RUNNING, false, life);
        say(CARTER, muster_STATE_RUNNING, false, BUS_DATA);
        CU_ASSERT_EQUAL(controller(), CARTER);
    }
}

static void test_a_process_is_slow_for_a_moment(void)
{
    hear("carter.1", "robot0", BUS_LOST);
    CU_ASSERT_EQUAL(state(CARTER), MEMBER_LOST);
    hear("carter.1", "robot0", BUS_DATA);
    CU_ASSERT_EQUAL(state(CARTER), MEMBER_ACTIVE);
}

static void test_a_successor_comes_before_or_after_the_loss(void)
{
    hear("carter.2", "robot0", BUS_DATA);
    CU_ASSERT_EQUAL(state(CARTER), MEMBER_CONTESTED);
    CU_ASSERT_FALSE(recover_is_due(&s));
    hear("carter.1", "robot0", BUS_LOST);
    CU_ASSERT_EQUAL(state(CARTER), MEMBER_SUPERSEDED);
    CU_ASSERT_TRUE(recover_is_due(&s));
    hear("host.1", "inn", BUS_LOST);
    hear("host.2", "inn", BUS_DATA);
    CU_ASSERT_EQUAL(state(HOST), MEMBER_SUPERSEDED);
    capture_begin();
    hear("carter.1", "robot0", BUS_DATA); /* it was stopped, and has a successor */
    capture_end();
    CU_ASSERT_EQUAL(state(CARTER), MEMBER_SUPERSEDED);
    CU_ASSERT_EQUAL(s.processes[CARTER].refused, 1);
}

/* A second resolver that begins in a run is no successor of the first. */
static void test_a_second_watcher_claims_nothing(void)
{
    hear("resolver.2", "", BUS_DATA);
    CU_ASSERT_EQUAL(state(RESOLVER), MEMBER_ACTIVE);
    hear("resolver.1", "", BUS_LOST);
    CU_ASSERT_FALSE(recover_is_due(&s));
    hear("resolver.1", "", BUS_DATA);
    CU_ASSERT_EQUAL(state(RESOLVER), MEMBER_ACTIVE);
    CU_ASSERT_EQUAL(state(CARTER), MEMBER_ACTIVE);
}

static void test_a_watcher_has_a_successor_when_it_is_lost(void)
{
    hear("resolver.1", "", BUS_LOST);
    hear("resolver.2", "", BUS_DATA);
    CU_ASSERT_EQUAL(state(RESOLVER), MEMBER_SUPERSEDED);
    CU_ASSERT_EQUAL(state(HOST), MEMBER_ACTIVE);
}

static void test_a_claim_ends_with_its_claimer(void)
{
    hear("carter.2", "robot0", BUS_DATA);
    hear("carter.3", "robot0", BUS_LOST); /* not its */
    CU_ASSERT_EQUAL(state(CARTER), MEMBER_CONTESTED);
    hear("carter.2", "robot0", BUS_LOST);
    CU_ASSERT_EQUAL(state(CARTER), MEMBER_ACTIVE);
    hear("carter.1", "robot0", BUS_LOST);
    hear("carter.1", "robot0", BUS_DATA);
    CU_ASSERT_EQUAL(state(CARTER), MEMBER_ACTIVE);
}

static void test_without_returns_nothing_is_claimed(void)
{
    s.options.return_ns = 0;
    hear("carter.1", "robot0", BUS_LOST);
    hear("carter.2", "robot0", BUS_DATA);
    CU_ASSERT_EQUAL(state(CARTER), MEMBER_LOST);
    CU_ASSERT_FALSE(recover_is_due(&s));
}

static void test_patience_is_longer_while_a_process_is_lost(void)
{
    s.options.silence_ns = 5;
    CU_ASSERT_EQUAL(recover_patience_ns(&s), 5);
    hear("host.1", "inn", BUS_LOST);
    CU_ASSERT_EQUAL(recover_patience_ns(&s), 1000000000);
    (void)member_on(&s.processes[HOST], MEMBER_LEAVES_OUT);
    CU_ASSERT_EQUAL(recover_patience_ns(&s), 5);
}

/* A later recovery does not wait for it either. */
static void test_a_process_that_was_left_out_is_not_awaited(void)
{
    for (uint32_t i = 0; i < s.process_count; i++) {
        s.processes[i].joined = MEMBER_GREETED; /* and not heard yet */
    }
    CU_ASSERT_FALSE(roster_is_complete(&s));
    READS(s.waits_for, "robot0 resolver.1 host.1");
    hear("host.1", "inn", BUS_LOST);
    (void)member_on(&s.processes[HOST], MEMBER_LEAVES_OUT);
    CU_ASSERT_FALSE(roster_is_complete(&s));
    READS(s.waits_for, "robot0 resolver.1");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"the whole table", test_the_whole_table},
        {"who gets steps", test_who_gets_steps},
        {"a body has the process that has the name", test_a_body_has_the_process_that_has_the_name},
        {"an heir that has gone inherits nothing", test_an_heir_that_has_gone_inherits_nothing},
        {"a process is slow for a moment", test_a_process_is_slow_for_a_moment},
        {"a successor comes before or after the loss",
         test_a_successor_comes_before_or_after_the_loss},
        {"a second watcher claims nothing", test_a_second_watcher_claims_nothing},
        {"a watcher has a successor when it is lost",
         test_a_watcher_has_a_successor_when_it_is_lost},
        {"a claim ends with its claimer", test_a_claim_ends_with_its_claimer},
        {"without returns nothing is claimed", test_without_returns_nothing_is_claimed},
        {"patience is longer while a process is lost",
         test_patience_is_longer_while_a_process_is_lost},
        {"a process that was left out is not awaited",
         test_a_process_that_was_left_out_is_not_awaited},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"sim/member", NULL, NULL, set_up, NULL, tests}, CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
