/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/pool.h"

#include "muster/memory.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

/* Looks at the next job so often before a thread lies down: some 10 us, a step of a small team. */
enum { POOL_SPINS = 2000 };

struct pool_thread {
    struct pool *pool;
    size_t number;
    pthread_t id;
};

struct pool {
    struct pool_thread *threads;
    size_t thread_count; /* without the caller's */
    pthread_mutex_t lock;
    pthread_cond_t wake, left;
    /* Under the lock, but for the round, which is looked at without it: */
    _Atomic uint64_t round;
    bool open, quit; /* open: who comes now may still help */
    size_t inside;   /* helpers at work */
    pool_work *work;
    void *context;
    size_t pieces;
    atomic_size_t next;
};

static void pool_pieces(struct pool *pool, size_t worker)
{
    for (;;) {
        size_t piece = atomic_fetch_add_explicit(&pool->next, 1, memory_order_relaxed);
        if (piece >= pool->pieces) {
            return;
        }
        pool->work(pool->context, worker, piece);
    }
}

static void pool_spin(struct pool *pool, uint64_t seen)
{
    for (int k = 0; k < POOL_SPINS && atomic_load(&pool->round) == seen; k++) {
#if defined(__x86_64__)
        __builtin_ia32_pause();
#endif
    }
}

static void *pool_live(void *argument)
{
    struct pool_thread *self = argument;
    struct pool *pool = self->pool;
    uint64_t seen = 0;
    pthread_mutex_lock(&pool->lock);
    while (!pool->quit) {
        if (atomic_load(&pool->round) == seen) {
            pthread_mutex_unlock(&pool->lock);
            pool_spin(pool, seen);
            pthread_mutex_lock(&pool->lock);
        }
        while (atomic_load(&pool->round) == seen && !pool->quit) {
            pthread_cond_wait(&pool->wake, &pool->lock);
        }
        seen = atomic_load(&pool->round);
        if (pool->open) { /* else it came too late, and the others have done it all */
            pool->inside++;
            pthread_mutex_unlock(&pool->lock);
            pool_pieces(pool, self->number);
            pthread_mutex_lock(&pool->lock);
            pool->inside--;
            pthread_cond_signal(&pool->left);
        }
    }
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

struct pool *pool_open(size_t threads)
{
    if (threads < 2) {
        return NULL;
    }
    struct pool *pool = mu_startup_alloc(sizeof *pool);
    pool->threads = mu_startup_array(threads - 1, sizeof *pool->threads);
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->wake, NULL);
    pthread_cond_init(&pool->left, NULL);
    sigset_t everything;
    sigset_t before;
    sigfillset(&everything);
    pthread_sigmask(SIG_SETMASK, &everything, &before);
    for (size_t k = 0; k + 1 < threads; k++) {
        struct pool_thread *thread = &pool->threads[pool->thread_count];
        *thread = (struct pool_thread){.pool = pool, .number = pool->thread_count + 1};
        pool->thread_count += pthread_create(&thread->id, NULL, pool_live, thread) == 0;
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return pool;
}

void pool_close(struct pool *pool)
{
    if (!pool) {
        return;
    }
    pthread_mutex_lock(&pool->lock);
    pool->quit = true;
    atomic_fetch_add(&pool->round, 1);
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->lock);
    for (size_t k = 0; k < pool->thread_count; k++) {
        pthread_join(pool->threads[k].id, NULL);
    }
}

size_t pool_threads(const struct pool *pool)
{
    return pool ? pool->thread_count + 1 : 1;
}

void pool_run(struct pool *pool, size_t pieces, pool_work *work, void *context)
{
    if (!pool || pieces < 2) {
        for (size_t k = 0; k < pieces; k++) {
            work(context, 0, k);
        }
        return;
    }
    pthread_mutex_lock(&pool->lock);
    pool->work = work;
    pool->context = context;
    pool->pieces = pieces;
    atomic_store(&pool->next, 0);
    pool->open = true;
    atomic_fetch_add(&pool->round, 1);
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->lock);
    pool_pieces(pool, 0);
    pthread_mutex_lock(&pool->lock);
    pool->open = false;
    while (pool->inside > 0) {
        pthread_cond_wait(&pool->left, &pool->lock);
    }
    pthread_mutex_unlock(&pool->lock);
}
