/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file result.h
 * What every muster call answers.
 *
 * Two kinds of result are told apart, because they ask different things of the caller:
 *
 *  - *outcomes* (> 0) are normal answers with a documented meaning ("no such agent", "full").
 *    The caller handles them and never passes them on.
 *  - *faults* (< 0) mean that the process cannot do its work (DDS refused, a bad file).
 *    The caller passes them up unchanged with MU_TRY; main() reports and exits.
 *
 * A broken precondition is neither: it is a bug, and MU_ASSERT stops the process in every build.
 */
#ifndef MUSTER_RESULT_H
#define MUSTER_RESULT_H

#pragma GCC visibility push(default)
#ifdef __cplusplus
extern "C" {
#endif

/* The one list: enumerators, and the words that people and rules see. */
#define MU_RESULTS(X)                       \
    X(FAULT_FILE, -4, "bad-file")           \
    X(FAULT_USAGE, -3, "wrong-usage")       \
    X(FAULT_DDS, -2, "dds-failure")         \
    X(FAULT_OS, -1, "system-failure")       \
    X(OK, 0, "ok")                          \
    X(ABSENT, 1, "unknown-name")            \
    X(EXISTS, 2, "name-taken")              \
    X(FULL, 3, "full")                      \
    X(BUSY, 4, "busy")                      \
    X(DUPLICATE, 5, "duplicate")            \
    X(REFUSED, 6, "refused")                \
    X(MALFORMED, 7, "malformed")            \
    X(TIMEOUT, 8, "timeout")                \
    X(NAME_HELD, 9, "name-held-by-another") \
    X(DONE, 10, "done")

typedef enum mu_result {
#define X(name, value, text) MU_##name = (value),
    MU_RESULTS(X)
#undef X
} mu_result;

#define MU_MUST_USE __attribute__((warn_unused_result))

/** @return the word for a result; never NULL */
const char *mu_result_text(mu_result r);

/** Passes a fault up, leaving one line of trace; an outcome is not a fault and is not passed. */
#define MU_TRY(call)                                                            \
    do {                                                                        \
        mu_result mu_try_result = (call);                                       \
        if (mu_try_result < 0) {                                                \
            return mu_fault_trace(mu_try_result, __func__, __FILE__, __LINE__); \
        }                                                                       \
    } while (0)

/** Prints the line of trace for MU_TRY.  @return r */
mu_result mu_fault_trace(mu_result r, const char *function, const char *file, int line);

/** Checks a precondition, in every build.  Prints the expression and aborts. */
#define MU_ASSERT(condition) \
    ((condition) ? (void)0 : mu_assert_failed(#condition, __func__, __FILE__, __LINE__))

/** Prints the expression and where it stands, and aborts. */
void mu_assert_failed(const char *expression, const char *function, const char *file, int line)
    __attribute__((noreturn));

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
