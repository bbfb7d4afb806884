/* SPDX-License-Identifier: Apache-2.0 */
#include "core/built.h"

#include "muster/version.h"

#include <stdio.h>

bool built_fits(const char *version, const uint32_t *sizes, const struct built_struct *ours,
                size_t count)
{
    for (size_t i = 0; i < count && sizes[i] > 0; i++) {
        bool fits = sizes[i] == ours[i].size || (ours[i].grows && sizes[i] < ours[i].size);
        if (!fits) {
            fprintf(
                stderr,
                "this program was built with muster %s, where struct %s has %u bytes; libmuster "
                "is %s, and wants %u: build the program again, or use the libmuster that it "
                "was built with\n",
                version, ours[i].name, sizes[i], MU_VERSION, ours[i].size);
            return false;
        }
    }
    return true;
}
