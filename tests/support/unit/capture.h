/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file capture.h
 * Catches what the code under test says on standard error: between capture_begin and capture_end
 * it goes to a file, and then into `captured`.
 */
#ifndef MUSTER_TESTS_CAPTURE_H
#define MUSTER_TESTS_CAPTURE_H

#include <CUnit/Basic.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static char captured[8192];
static FILE *capture_file;
static int capture_saved;

static inline void capture_begin(void)
{
    fflush(stderr);
    capture_file = tmpfile();
    CU_ASSERT_PTR_NOT_NULL_FATAL(capture_file);
    capture_saved = dup(STDERR_FILENO);
    dup2(fileno(capture_file), STDERR_FILENO);
}

static inline void capture_end(void)
{
    fflush(stderr);
    dup2(capture_saved, STDERR_FILENO);
    close(capture_saved);
    rewind(capture_file);
    captured[fread(captured, 1, sizeof captured - 1, capture_file)] = '\0';
    fclose(capture_file);
}

/** @return whether these words were said */
static inline bool said(const char *words)
{
    return strstr(captured, words) != NULL;
}

#endif
