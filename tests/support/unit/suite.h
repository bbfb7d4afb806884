/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file suite.h
 * Runs a unit test's suites and tells what its main returns: EXIT_FAILURE if an assertion did not
 * hold, and also if a suite's set-up or clean-up failed, or if CUnit took the tests not in.
 */
#ifndef MUSTER_TESTS_SUITE_H
#define MUSTER_TESTS_SUITE_H

#include <CUnit/Basic.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/** One suite that needs no set-up.  @param tests  ends with CU_TEST_INFO_NULL */
int suite_run(const char *name, CU_TestInfo *tests);

/** Suites of any sort.  @param suites  ends with CU_SUITE_INFO_NULL */
int suites_run(CU_SuiteInfo *suites);

/** @return the whole number in an environment variable, which a soak sets; else what is usual */
uint64_t suite_setting(const char *name, uint64_t usual);

/** Asserts that a text is exactly this; both are shown where it is not. */
#define READS(text, wanted)                                        \
    do {                                                           \
        const char *got_ = (text), *want_ = (wanted);              \
        if (strcmp(got_, want_) != 0) {                            \
            printf("\n  wanted: %s\n  got:    %s\n", want_, got_); \
        }                                                          \
        CU_ASSERT_STRING_EQUAL(got_, want_);                       \
    } while (0)

#endif
