/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file pool.h
 * Threads that share the pieces of one job.
 *
 * Which thread does which piece is left to chance, so pieces must not depend on one another.
 * Between jobs that follow one another within parts of a millisecond the threads spin; else they
 * sleep.
 */
#ifndef MUSTER_SIM_POOL_H
#define MUSTER_SIM_POOL_H

#include <stddef.h>

/* @param worker  0 to threads - 1: whose scratch memory may be used */
typedef void pool_work(void *context, size_t worker, size_t piece);

/**
 * Starts threads beside the caller's, and takes memory.  They take no signals.
 *
 * @return NULL when threads is 0 or 1, or none could be started: pool_run then does with one
 */
struct pool *pool_open(size_t threads);

/** Ends and joins the threads.  NULL is fine. */
void pool_close(struct pool *pool);

/** @return how many threads work, the caller's included */
size_t pool_threads(const struct pool *pool);

/** Does all pieces, and returns when they are done; wakes nobody for little work.  Only one thread
 * may ask. */
void pool_run(struct pool *pool, size_t pieces, pool_work *work, void *context);

#endif
