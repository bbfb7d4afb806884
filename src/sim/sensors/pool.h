/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file pool.h
 * Threads that share the pieces of a job.
 *
 * Any thread may do any piece, so pieces must not depend on one another.  Threads spin between jobs
 * that follow within a fraction of a millisecond, and otherwise sleep.
 */
#ifndef MUSTER_SIM_POOL_H
#define MUSTER_SIM_POOL_H

#include <stddef.h>

/* @param worker  0 to threads - 1: the scratch memory that the piece may use */
typedef void pool_work(void *context, size_t worker, size_t piece);

/**
 * Takes memory, and starts threads beside the caller's.  They take no signals.
 *
 * @return NULL if threads is 0 or 1, or no thread could be started: pool_run then uses the caller's
 */
struct pool *pool_open(size_t threads);

/** Ends and joins the threads.  The pool may be NULL. */
void pool_close(struct pool *pool);

/** @return the number of threads, including the caller's */
size_t pool_threads(const struct pool *pool);

/**
 * Does all pieces, and returns when they are done.  A small job wakes no thread.  Only one thread
 * may call it.
 */
void pool_run(struct pool *pool, size_t pieces, pool_work *work, void *context);

#endif
