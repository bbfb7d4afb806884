/* SPDX-License-Identifier: Apache-2.0 */
/* What a program may get wrong with the library: refused by name, and nothing else happens. */
#include "hush.h"
#include "muster/muster.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <limits.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

static mu_process *process;
static mu_agent *red;

static int domain(void)
{
    return 100 + (int)(getpid() % 100);
}

static mu_result open_with(struct mu_process_options options)
{
    mu_process *p = NULL;
    int kept = hush();
    mu_result opened = mu_process_open(&p, &options);
    unhush(kept);
    if (opened == MU_OK) {
        mu_process_close(p);
    }
    return opened;
}

/* What is wrong leaves nothing behind: the next one enters the domain. */
static void test_options_that_are_none(void)
{
    const struct mu_process_options wrong[] = {
        {.domain = -1},
        {.domain = MU_DOMAIN_MAX + 1},
        {.domain = INT_MAX},
        {.domain = domain(), .agents = MU_LOCAL_AGENTS_MAX + 1},
        {.domain = domain(), .outbox = MU_OUTBOX_MOST + 1},
        {.domain = domain(), .with_body = true, .watches = true},
        {.domain = domain(), .interface = "127.0.0.1,127.0.0.2"},
        {.domain = domain(), .peer = "a b"},
        {.domain = domain(), .broker = "a b"},
        {.domain = domain(), .broker = ""},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        CU_ASSERT_EQUAL(open_with(wrong[i]), MU_FAULT_USAGE);
    }
    CU_ASSERT_EQUAL(open_with((struct mu_process_options){.domain = MU_DOMAIN_MAX}), MU_OK);
    CU_ASSERT_EQUAL_FATAL(
        mu_process_open(&process, &(struct mu_process_options){.domain = domain(), .agents = 4}),
        MU_OK);
    CU_ASSERT_EQUAL(open_with((struct mu_process_options){.domain = domain()}), MU_FAULT_USAGE);
}

static void test_names_and_kinds_that_are_none(void)
{
    mu_agent *a = NULL;
    const char *const names[] = {NULL, "", "a b", "\"a\"", "a\n", "*", "1a", "\xc3\xa9"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        CU_ASSERT_EQUAL(mu_agent_join(process, &a, names[i], MU_KIND_AGENT, 0, NULL), MU_MALFORMED);
    }
    enum mu_kind above = (enum mu_kind)(MU_KIND_SPECIAL + 1), below = (enum mu_kind) - 1;
    CU_ASSERT_EQUAL(mu_agent_join(process, &a, "a", above, 0, NULL), MU_MALFORMED);
    CU_ASSERT_EQUAL(mu_agent_join(process, &a, "a", below, 0, NULL), MU_MALFORMED);
    CU_ASSERT_EQUAL(mu_agent_arrive(process, &a, "a", NULL, MU_EVENTS, NULL), MU_MALFORMED);
    CU_ASSERT_EQUAL_FATAL(mu_agent_join(process, &red, "red", MU_KIND_AGENT, 0, NULL), MU_OK);
    CU_ASSERT_PTR_NULL(mu_process_lookup(process, NULL));
    CU_ASSERT_FALSE(mu_performative_known(NULL));
}

/* The broker would refuse them, and with them all that the process says beside. */
static void test_mails_that_are_none(void)
{
    const struct mu_mail wrong[] = {
        {.dst = NULL},
        {.dst = ""},
        {.dst = "blue", .priority = (enum mu_priority)(MU_PRIORITY_HIGH + 1)},
        {.dst = "blue", .priority = (enum mu_priority)(MU_PRIORITY_LOW - 1)},
        {.dst = "blue", .level = (enum mu_level)(MU_LEVEL_SYNCED + 1)},
        {.dst = "blue", .level = (enum mu_level) - 1},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        CU_ASSERT_EQUAL(mu_agent_send(red, &wrong[i], NULL), MU_MALFORMED);
    }
    uint64_t seq = 0;
    CU_ASSERT_EQUAL(mu_agent_send(red, &(struct mu_mail){.dst = "blue"}, &seq), MU_OK);
    CU_ASSERT_EQUAL(seq, 1);
}

static void test_other_values_that_are_none(void)
{
    enum mu_paddles paddles = (enum mu_paddles)INT_MIN;
    CU_ASSERT_EQUAL(mu_agent_grip(red, paddles, MU_LIFT_UP), MU_MALFORMED);
    CU_ASSERT_EQUAL(mu_agent_grip(red, MU_PADDLES_OPEN, (enum mu_lift)2), MU_MALFORMED);
    CU_ASSERT_EQUAL(mu_agent_advertise(red, "map", NULL, UINT64_MAX), MU_MALFORMED);
    CU_ASSERT_EQUAL(mu_agent_advertise(red, "map", NULL, 3200000000000000000u), MU_OK);
    mu_agent_want(red, NULL);
    mu_agent_note(red, NULL);
    mu_agent_fired(red, 0, NULL);
    mu_agent_fired_also(red, 0, NULL);
    mu_agent_suspend(red, NULL);
    CU_ASSERT_EQUAL(mu_agent_state(red), MU_SUSPENDED);
}

/* DDS lives in threads, which fork does not copy: closing would wait for them for ever. */
static void test_a_child_has_no_connection(void)
{
    int status = 0;
    pid_t child = fork();
    if (child == 0) {
        alarm(20);
        bool busy = mu_process_spin(process, 0) != MU_FAULT_USAGE;
        mu_process_close(process);
        _exit(busy);
    }
    CU_ASSERT_EQUAL_FATAL(waitpid(child, &status, 0), child);
    CU_ASSERT(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    CU_ASSERT_EQUAL(mu_process_spin(process, 0), MU_OK);
}

static void test_who_is_gone_stays_so(void)
{
    mu_agent_set_state(red, MU_GONE);
    mu_agent_set_state(red, MU_RUNNING);
    CU_ASSERT_EQUAL(mu_agent_state(red), MU_GONE);
    CU_ASSERT_EQUAL(mu_agent_broadcast(red, "last words"), MU_OK);
    CU_ASSERT_EQUAL(mu_process_spin(process, 0), MU_OK);
    CU_ASSERT_EQUAL(mu_agent_broadcast(red, "more"), MU_REFUSED);
    CU_ASSERT_EQUAL(mu_agent_group_join(red, "scouts"), MU_REFUSED);
    mu_process_close(process);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"options that are none", test_options_that_are_none},
        {"names and kinds that are none", test_names_and_kinds_that_are_none},
        {"mails that are none", test_mails_that_are_none},
        {"other values that are none", test_other_values_that_are_none},
        {"a child has no connection", test_a_child_has_no_connection},
        {"who is gone stays so", test_who_is_gone_stays_so},
        CU_TEST_INFO_NULL,
    };
    unsetenv("CYCLONEDDS_URI");
    return suite_run("runtime/misuse", tests);
}
