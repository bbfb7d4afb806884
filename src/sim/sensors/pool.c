/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/sensors/pool.h"

#include "core/clock.h"
#include "muster/memory.h"
#include "muster/result.h"

#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/*
 * Threads stay awake between jobs that follow within this time: waking takes about as long as all
 * sonars of a hundred robots.  After one later job they sleep as soon as there is no work.
 */
#define POOL_SOON_NS 400000

/* A smaller job wakes no thread. */
#define POOL_WORTH_NS 100000

/* The caller spins this long for pieces that other threads have taken, and then sleeps. */
#define POOL_PATIENCE_NS 100000

enum {
    POOL_CALM = 200, /* jobs without spinning, after the caller had to sleep */
    POOL_LOOKS = 16, /* between two reads of the clock */
    POOL_LINE = 64   /* bytes of a cache line */
};

struct pool_thread {
    struct pool *pool;
    size_t number;
    pthread_t id;
};

struct pool {
    struct pool_thread *threads;
    size_t thread_count; /* without the caller's */
    bool may_spin;       /* each thread has a processor */
    /* Of the job, constant until all of its pieces are done: */
    pool_work *work;
    void *context;
    size_t pieces;
    /* Of the job before it: */
    uint64_t ended_ns, work_ns;
    unsigned calm; /* jobs for which no thread spins, because other programs want the processors */
    pthread_mutex_t lock;
    pthread_cond_t wake, done;
    atomic_size_t sleepers;
    atomic_bool caller_sleeps, soon, quit;
    char apart_1[POOL_LINE];
    /*
     * Number of the job; in the lower half, the pieces that no thread has taken.  So a thread that
     * arrives late takes a piece of the present job.
     */
    _Atomic uint64_t ticket;
    char apart_2[POOL_LINE];
    atomic_size_t finished; /* pieces */
};

static uint64_t pool_job(uint64_t ticket)
{
    return ticket >> 32;
}

/* Takes a piece.  @return how many were left, including it; 0: none */
static size_t pool_take(struct pool *pool)
{
    uint64_t ticket = atomic_load(&pool->ticket);
    while ((uint32_t)ticket > 0 &&
           !atomic_compare_exchange_weak(&pool->ticket, &ticket, ticket - 1)) {
    }
    return (uint32_t)ticket;
}

/* Works until no piece is left.  @return how many it did */
static size_t pool_pieces(struct pool *pool, size_t worker)
{
    size_t count = 0;
    for (size_t left = pool_take(pool); left > 0; left = pool_take(pool)) {
        pool->work(pool->context, worker, pool->pieces - left);
        count++;
    }
    return count;
}

static void pool_pause(void)
{
    for (int k = 0; k < POOL_LOOKS; k++) {
#if defined(__x86_64__)
        __builtin_ia32_pause();
#endif
    }
}

/* --- other threads ---------------------------------------------------------------------------- */

static bool pool_has_news(struct pool *pool, uint64_t seen)
{
    return pool_job(atomic_load(&pool->ticket)) != seen || atomic_load(&pool->quit);
}

static void pool_stay_awake(struct pool *pool, uint64_t seen)
{
    uint64_t until_ns = mu_clock_ns() + POOL_SOON_NS;
    while (atomic_load(&pool->soon) && !pool_has_news(pool, seen) && mu_clock_ns() < until_ns) {
        pool_pause();
    }
}

/* The caller changes the ticket before it reads `sleepers`: so it misses no sleeping thread. */
static void pool_sleep(struct pool *pool, uint64_t seen)
{
    pthread_mutex_lock(&pool->lock);
    atomic_fetch_add(&pool->sleepers, 1);
    while (!pool_has_news(pool, seen)) {
        pthread_cond_wait(&pool->wake, &pool->lock);
    }
    atomic_fetch_sub(&pool->sleepers, 1);
    pthread_mutex_unlock(&pool->lock);
}

static void pool_hand_in(struct pool *pool, size_t count)
{
    atomic_fetch_add(&pool->finished, count);
    if (atomic_load(&pool->caller_sleeps)) {
        pthread_mutex_lock(&pool->lock);
        pthread_cond_signal(&pool->done);
        pthread_mutex_unlock(&pool->lock);
    }
}

static void *pool_live(void *argument)
{
    struct pool_thread *self = argument;
    struct pool *pool = self->pool;
    uint64_t seen = 0;
    while (!atomic_load(&pool->quit)) {
        pool_stay_awake(pool, seen);
        if (!pool_has_news(pool, seen)) {
            pool_sleep(pool, seen);
        }
        seen = pool_job(atomic_load(&pool->ticket));
        size_t count = pool_pieces(pool, self->number);
        if (count > 0) {
            pool_hand_in(pool, count);
        }
    }
    return NULL;
}

/* --- start and end ---------------------------------------------------------------------------- */

static bool pool_has_processors(size_t threads)
{
    cpu_set_t set;
    return sched_getaffinity(0, sizeof set, &set) == 0 && (size_t)CPU_COUNT(&set) >= threads;
}

static void pool_start(struct pool *pool, size_t others)
{
    sigset_t everything;
    sigset_t before;
    sigfillset(&everything);
    pthread_sigmask(SIG_SETMASK, &everything, &before);
    for (size_t k = 0; k < others; k++) {
        struct pool_thread *thread = &pool->threads[pool->thread_count];
        *thread = (struct pool_thread){.pool = pool, .number = pool->thread_count + 1};
        pool->thread_count += pthread_create(&thread->id, NULL, pool_live, thread) == 0;
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

struct pool *pool_open(size_t threads)
{
    if (threads < 2) {
        return NULL;
    }
    struct pool *pool = mu_startup_alloc(sizeof *pool);
    pool->threads = mu_startup_array(threads - 1, sizeof *pool->threads);
    pool->may_spin = pool_has_processors(threads);
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->wake, NULL);
    pthread_cond_init(&pool->done, NULL);
    pool_start(pool, threads - 1);
    return pool;
}

static void pool_wake(struct pool *pool)
{
    pthread_mutex_lock(&pool->lock);
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->lock);
}

void pool_close(struct pool *pool)
{
    if (!pool) {
        return;
    }
    atomic_store(&pool->quit, true);
    pool_wake(pool);
    for (size_t k = 0; k < pool->thread_count; k++) {
        pthread_join(pool->threads[k].id, NULL);
    }
}

size_t pool_threads(const struct pool *pool)
{
    return pool ? pool->thread_count + 1 : 1;
}

/* --- a job ------------------------------------------------------------------------------------ */

static bool pool_is_done(struct pool *pool)
{
    return atomic_load(&pool->finished) == pool->pieces;
}

static void pool_wait(struct pool *pool)
{
    uint64_t until_ns = mu_clock_ns() + POOL_PATIENCE_NS;
    while (pool->may_spin && !pool_is_done(pool) && mu_clock_ns() < until_ns) {
        pool_pause();
    }
    if (pool_is_done(pool)) {
        return;
    }
    pool->calm = POOL_CALM;
    pthread_mutex_lock(&pool->lock);
    atomic_store(&pool->caller_sleeps, true);
    while (!pool_is_done(pool)) {
        pthread_cond_wait(&pool->done, &pool->lock);
    }
    atomic_store(&pool->caller_sleeps, false);
    pthread_mutex_unlock(&pool->lock);
}

/* Announces a job to the other threads.  @return the time */
static uint64_t pool_announce(struct pool *pool)
{
    uint64_t began_ns = mu_clock_ns();
    bool soon = pool->may_spin && pool->calm == 0 && began_ns - pool->ended_ns < POOL_SOON_NS;
    pool->calm -= pool->calm > 0;
    atomic_store(&pool->soon, soon);
    atomic_store(&pool->finished, 0);
    uint64_t job = pool_job(atomic_load(&pool->ticket)) + 1;
    atomic_store(&pool->ticket, job << 32 | pool->pieces);
    if (atomic_load(&pool->sleepers) > 0 && (soon || pool->work_ns >= POOL_WORTH_NS)) {
        pool_wake(pool);
    }
    return began_ns;
}

static void pool_share(struct pool *pool)
{
    uint64_t began_ns = pool_announce(pool);
    size_t own = pool_pieces(pool, 0);
    uint64_t took_ns = mu_clock_ns() - began_ns;
    pool->work_ns = own > 0 ? took_ns * pool->pieces / own : POOL_WORTH_NS;
    atomic_fetch_add(&pool->finished, own);
    pool_wait(pool);
    pool->ended_ns = mu_clock_ns();
}

void pool_run(struct pool *pool, size_t pieces, pool_work *work, void *context)
{
    MU_ASSERT(pieces < UINT32_MAX);
    if (!pool || pieces < 2) {
        for (size_t k = 0; k < pieces; k++) {
            work(context, 0, k);
        }
        return;
    }
    pool->work = work;
    pool->context = context;
    pool->pieces = pieces;
    pool_share(pool);
}
