/* SPDX-License-Identifier: Apache-2.0 */
#include "core/forks.h"

#include "muster/result.h"

#include <pthread.h>

static uint32_t forks;

static void count(void)
{
    forks++;
}

static void begin(void)
{
    int failed = pthread_atfork(NULL, NULL, count);
    MU_ASSERT(!failed);
}

uint32_t mu_forks(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, begin);
    return forks;
}
