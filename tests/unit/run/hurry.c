/* SPDX-License-Identifier: Apache-2.0 */
/* A child, and beside it a process that computes and is no child. */
#include "run/supervise.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { LONG_NS = 300000000 }; /* it looks again after that */

static struct supervise all;
static struct child children[1];

static pid_t process_start(bool computes)
{
    pid_t pid = fork();
    if (pid == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        alarm(60);
        for (volatile unsigned i = 0;; i++) {
            if (!computes) {
                pause();
            }
        }
    }
    CU_ASSERT_FATAL(pid > 0);
    return pid;
}

static void process_end(pid_t pid)
{
    kill(pid, SIGKILL);
    waitpid(pid, NULL, 0);
}

/* Looks again when enough time has passed.  @return whether the child is batch */
static bool look(void)
{
    nanosleep(&(struct timespec){.tv_nsec = LONG_NS}, NULL);
    supervise_hurry(&all);
    int policy = sched_getscheduler(all.children[0].pid);
    CU_ASSERT_EQUAL(policy, all.haste.batch ? SCHED_BATCH : SCHED_OTHER);
    return policy == SCHED_BATCH;
}

static void begin(void)
{
    all = (struct supervise){.children = children, .count = 1};
    memset(children, 0, sizeof children);
    CU_ASSERT_EQUAL_FATAL(sched_getaffinity(0, sizeof all.processors, &all.processors), 0);
    children[0].pid = process_start(false);
}

static void test_beside_another_that_computes_none_is_batch(void)
{
    begin();
    sched_setscheduler(children[0].pid, SCHED_BATCH, &(struct sched_param){0});
    supervise_hurry(&all);
    CU_ASSERT_EQUAL(sched_getscheduler(children[0].pid), SCHED_BATCH); /* it knows nothing yet */
    pid_t other = process_start(true);
    CU_ASSERT_FALSE(look());
    process_end(other);
    process_end(children[0].pid);
}

static void test_a_policy_of_its_own_stays(void)
{
    begin();
    sched_setscheduler(children[0].pid, SCHED_IDLE, &(struct sched_param){0});
    supervise_hurry(&all);
    all.haste.looked_ns -= LONG_NS;
    supervise_hurry(&all);
    CU_ASSERT_EQUAL(sched_getscheduler(children[0].pid), SCHED_IDLE);
    process_end(children[0].pid);
}

/* What its own children take does not count: on processors that nobody uses they are batch. */
static void test_alone_they_are_batch(void)
{
    begin();
    CPU_ZERO(&all.processors); /* others may work here just now, and on none of these */
    supervise_hurry(&all);
    CU_ASSERT_TRUE(look());
    children[0].ended = true; /* its number may be another's by now */
    sched_setscheduler(children[0].pid, SCHED_OTHER, &(struct sched_param){0});
    all.haste.looked_ns -= LONG_NS;
    supervise_hurry(&all);
    CU_ASSERT_EQUAL(sched_getscheduler(children[0].pid), SCHED_OTHER);
    process_end(children[0].pid);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"beside another that computes, none is batch",
         test_beside_another_that_computes_none_is_batch},
        {"alone they are batch", test_alone_they_are_batch},
        {"a policy of its own stays", test_a_policy_of_its_own_stays},
        CU_TEST_INFO_NULL,
    };
    return suite_run("run/hurry", tests);
}
