/* SPDX-License-Identifier: Apache-2.0 */
#include "muster/result.h"

#include <stdio.h>
#include <stdlib.h>

const char *mu_result_text(mu_result r)
{
    switch (r) {
#define X(name, value, text) \
    case MU_##name: return (text);
        MU_RESULTS(X)
#undef X
    }
    return "unknown-result";
}

mu_result mu_fault_trace(mu_result r, const char *function, const char *file, int line)
{
    /* A mistake in a person's file or words has been explained where it was found. */
    if (r != MU_FAULT_FILE && r != MU_FAULT_USAGE) {
        fprintf(stderr, "fault %s: %s (%s:%d)\n", mu_result_text(r), function, file, line);
    }
    return r;
}

void mu_assert_failed(const char *expression, const char *function, const char *file, int line)
{
    fprintf(stderr, "assertion failed: %s in %s (%s:%d)\n", expression, function, file, line);
    abort();
}
