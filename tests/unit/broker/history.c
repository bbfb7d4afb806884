/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Random histories of a broker, its disk and its clients against what docs/mail.md promises.
 *
 *     MUSTER_SEED=N       that history alone; MUSTER_TELL=1 tells it while it goes on
 *     MUSTER_SECONDS=N    so long, with other seeds than by default; `make soak-model`
 *
 * Each history is a process of its own, so that one that trips an assertion is one that failed.
 */
#include "history/history.h"
#include "core/clock.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

enum { STEPS = 900 };

static const uint64_t SECOND_NS = 1000000000;

static struct {
    uint64_t histories, mails, taken, receipts, kills, repeats, again, expired, dropped, refused;
    uint64_t multicasts, by_circular, early, late, lost, astray;
} * sum; /* shared with the histories */

static void abort_explain(int number)
{
    (void)number;
    history_fail("an assertion of the broker", __FILE__, __LINE__);
}

static void sum_up(void)
{
    sum->histories++;
    sum->mails += history.mails;
    sum->taken += history.seen.taken;
    sum->receipts += history.seen.receipts;
    sum->kills += history.seen.kills;
    sum->repeats += history.seen.repeats;
    sum->again += history.seen.again;
    sum->expired += history.seen.expired;
    sum->dropped += history.seen.dropped;
    sum->refused += history.seen.refused;
    sum->multicasts += history.seen.multicasts;
    sum->by_circular += history.seen.by_circular;
    sum->early += history.seen.early;
    sum->late += history.seen.late;
    sum->lost += history.seen.lost;
    sum->astray += history.seen.astray;
}

/* @return whether all was as promised */
static bool live(uint64_t seed)
{
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        signal(SIGABRT, abort_explain);
        history_live(seed, STEPS);
        sum_up();
        _Exit(EXIT_SUCCESS);
    }
    int status = 0;
    bool ended = child > 0 && waitpid(child, &status, 0) == child;
    if (ended && WIFSIGNALED(status)) {
        printf("\n  seed %llu: killed by signal %d\n", (unsigned long long)seed, WTERMSIG(status));
    }
    return ended && WIFEXITED(status) && WEXITSTATUS(status) == EXIT_SUCCESS;
}

static void test_histories(void)
{
    uint64_t seed = suite_setting("MUSTER_SEED", 0);
    uint64_t seconds = suite_setting("MUSTER_SECONDS", 0);
    uint64_t began_ns = mu_clock_ns(), failures = 0;
    sum = mmap(NULL, sizeof *sum, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    CU_ASSERT_TRUE_FATAL(sum != MAP_FAILED);
    if (seed) {
        CU_ASSERT_TRUE(live(seed));
        return;
    }
    seed = seconds ? mu_clock_wall_ns() / 1000 : 1;
    uint64_t until_ns = began_ns + (seconds ? seconds : 5) * SECOND_NS;
    do {
        failures += !live(seed++);
    } while (mu_clock_ns() < until_ns && failures < 3);
    CU_ASSERT_EQUAL(failures, 0);
    printf("\n  %llu histories, %llu mails, %llu taken, %llu receipts, %llu kills, %llu again, "
           "%llu repeats, %llu expired, %llu dropped, %llu refused\n",
           (unsigned long long)sum->histories, (unsigned long long)sum->mails,
           (unsigned long long)sum->taken, (unsigned long long)sum->receipts,
           (unsigned long long)sum->kills, (unsigned long long)sum->again,
           (unsigned long long)sum->repeats, (unsigned long long)sum->expired,
           (unsigned long long)sum->dropped, (unsigned long long)sum->refused);
    printf("  %llu circulars with %llu parcels, %llu lost on their way, %llu early, %llu late; "
           "%llu acknowledgements astray\n",
           (unsigned long long)sum->multicasts, (unsigned long long)sum->by_circular,
           (unsigned long long)sum->lost, (unsigned long long)sum->early,
           (unsigned long long)sum->late, (unsigned long long)sum->astray);
}

int main(void)
{
    CU_TestInfo tests[] = {{"random histories", test_histories}, CU_TEST_INFO_NULL};
    return suite_run("broker/history", tests);
}
