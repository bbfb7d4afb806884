/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file world_text.h
 * Loads worlds that stand as texts in a test.
 */
#ifndef MUSTER_TESTS_WORLD_TEXT_H
#define MUSTER_TESTS_WORLD_TEXT_H

#include "hush.h"
#include "world/world_load.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A loaded world lives as long as its process: each test takes new ones. */
static struct world worlds[160];
static size_t worlds_used;
static struct mu_fault fault;

/** Puts bytes into a new file. */
static inline void put(char *path, const char *bytes, size_t len)
{
    int fd = mkstemp(path);
    CU_ASSERT_FATAL(fd >= 0);
    CU_ASSERT_EQUAL(write(fd, bytes, len), (ssize_t)len);
    close(fd);
}

/** Loads a world of this text.  @return NULL when it is refused */
static inline struct world *load_with(const char *text, const struct world_options *options)
{
    char path[] = "/tmp/muster-world-XXXXXX";
    put(path, text, strlen(text));
    CU_ASSERT_FATAL(worlds_used < sizeof worlds / sizeof worlds[0]);
    struct world *world = &worlds[worlds_used++];
    fault = (struct mu_fault){0};
    int kept = hush();
    mu_result r = world_open(world, path, options, &fault);
    unhush(kept);
    unlink(path);
    return r == MU_OK ? world : NULL;
}

static inline struct world *load(const char *text)
{
    return load_with(text, &(struct world_options){.quiet = true, .seed = 1});
}

static inline mu_result check_places(const struct world *world)
{
    int kept = hush();
    mu_result r = world_check_places(world, NULL, &fault);
    unhush(kept);
    return r;
}

#endif
