/* SPDX-License-Identifier: Apache-2.0 */
/* Threads that share a job: each piece is done once, whoever comes late. */
#include "sim/pool.h"

#include <CUnit/Basic.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PIECES = 64, ROUNDS = 2000, THREADS = 4 };

struct job {
    atomic_uint done[PIECES];
    atomic_uint by[THREADS];
    atomic_bool busy[THREADS]; /* two pieces at once for one worker would share its scratch */
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
        usleep(20000); /* by now they have lain down */
        pool_run(pool, PIECES, work, &job);
    }
    CU_ASSERT_EQUAL(pieces_wrong(&job, PIECES, 3), 0);
    CU_ASSERT(atomic_load(&job.by[0]) > 0 && atomic_load(&job.by[1]) > 0);
    pool_close(pool);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"each piece is done once", test_each_piece_is_done_once},
        {"few pieces and none", test_few_pieces_and_none},
        {"the others help also after a rest", test_the_others_help_also_after_a_rest},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"sim/pool", NULL, NULL, NULL, NULL, tests}, CU_SUITE_INFO_NULL};
    CU_initialize_registry();
    CU_register_suites(suites);
    CU_basic_set_mode(CU_BRM_NORMAL);
    CU_basic_run_tests();
    unsigned failures = CU_get_number_of_failures();
    CU_cleanup_registry();
    return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
