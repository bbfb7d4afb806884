/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/policy.h"

#include <stddef.h>
#include <string.h>

bool policy_may_direct(const char *src)
{
    static const char *const trusted[] = {"observer", "operator"};
    for (size_t i = 0; i < sizeof trusted / sizeof trusted[0]; i++) {
        if (strcmp(src, trusted[i]) == 0) {
            return true;
        }
    }
    return false;
}
