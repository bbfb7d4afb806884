/* SPDX-License-Identifier: Apache-2.0 */
/* Threads that share a job: each piece is done once, at any timing. */
#include "sim/sensors/pool.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { PIECES = 64, ROUNDS = 2000, THREADS = 4 };

struct job {
    atomic_uint done[PIECES];
    atomic_uint by[THREADS];
    atomic_bool
        busy[THREADS]; /* two simultaneous pieces of one worker would share scratch memory */
    atomic_uint clashes;
    unsigned pause_us;
};

static void work(void *context, size_t worker, size_t piece)
{
    struct job *job = context;
    if (worker >= THREADS || piece >= PIECES || atomic_exchange(&job->busy[worker], true)) {
        atomic_fetch_add(&job->clashes, 1);
        return;
    }
    atomic_fetch_add(&job->done[piece], 1);
    atomic_fetch_add(&job->by[worker], 1);
    if (job->pause_us) {
        usleep(job->pause_us);
    }
    atomic_store(&job->busy[worker], false);
}

static size_t pieces_wrong(const struct job *job, size_t pieces, unsigned times)
{
    size_t wrong = atomic_load(&job->clashes);
    for (size_t k = 0; k < PIECES; k++) {
        wrong += atomic_load(&job->done[k]) != (k < pieces ? times : 0);
    }
    return wrong;
}

static void test_each_piece_is_done_once(void)
{
    for (size_t threads = 0; threads <= THREADS; threads++) {
        static struct job job;
        memset(&job, 0, sizeof job);
        struct pool *pool = pool_open(threads);
        CU_ASSERT_EQUAL(pool_threads(pool), threads < 2 ? 1 : threads);
        for (int round = 0; round < ROUNDS; round++) {
            pool_run(pool, PIECES, work, &job);
        }
        CU_ASSERT_EQUAL(pieces_wrong(&job, PIECES, ROUNDS), 0);
        pool_close(pool);
    }
}

static void test_few_pieces_and_none(void)
{
    struct pool *pool = pool_open(3);
    for (size_t pieces = 0; pieces < 5; pieces++) {
        static struct job job;
        memset(&job, 0, sizeof job);
        pool_run(pool, pieces, work, &job);
        CU_ASSERT_EQUAL(pieces_wrong(&job, pieces, 1), 0);
    }
    pool_close(pool);
}

static void test_the_others_help_also_after_a_rest(void)
{
    static struct job job;
    struct pool *pool = pool_open(2);
    job.pause_us = 2000;
    for (int round = 0; round < 3; round++) {
        usleep(20000); /* by now the threads sleep */
        pool_run(pool, PIECES, work, &job);
    }
    CU_ASSERT_EQUAL(pieces_wrong(&job, PIECES, 3), 0);
    CU_ASSERT(atomic_load(&job.by[0]) > 0 && atomic_load(&job.by[1]) > 0);
    pool_close(pool);
}

/* Jobs follow at once, after a short pause, or when the threads sleep. */
static void test_jobs_may_come_at_any_pace(void)
{
    static const unsigned breaths_us[] = {0, 0, 0, 100, 0, 1000, 0, 0, 300};
    enum { BREATHS = sizeof breaths_us / sizeof breaths_us[0], TIMES = 30 };
    for (size_t threads = 2; threads <= THREADS; threads++) {
        static struct job job;
        memset(&job, 0, sizeof job);
        struct pool *pool = pool_open(threads);
        for (int round = 0; round < TIMES * BREATHS; round++) {
            usleep(breaths_us[round % BREATHS]);
            pool_run(pool, PIECES, work, &job);
        }
        CU_ASSERT_EQUAL(pieces_wrong(&job, PIECES, TIMES * BREATHS), 0);
        pool_close(pool);
    }
}

static double processor_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void test_nobody_spins_for_long(void)
{
    static struct job job;
    struct pool *pool = pool_open(THREADS);
    for (int round = 0; round < ROUNDS; round++) {
        pool_run(pool, PIECES, work, &job);
    }
    double before_s = processor_s();
    usleep(200000);
    CU_ASSERT(processor_s() - before_s < 0.1);
    pool_run(pool, PIECES, work, &job);
    CU_ASSERT_EQUAL(pieces_wrong(&job, PIECES, ROUNDS + 1), 0);
    pool_close(pool);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"each piece is done once", test_each_piece_is_done_once},
        {"few pieces and none", test_few_pieces_and_none},
        {"the others help also after a rest", test_the_others_help_also_after_a_rest},
        {"jobs may come at any pace", test_jobs_may_come_at_any_pace},
        {"nobody spins for long", test_nobody_spins_for_long},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/pool", tests);
}
