/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text_file.h"

#include <errno.h>
#include <string.h>

mu_result mu_text_file_read(const char *path, struct mu_text *out, struct mu_fault *fault)
{
    mu_text_clear(out);
    FILE *f = fopen(path, "rb");
    if (!f) {
        (void)mu_fault_at(fault, path, 0, 0, "cannot be opened: %s", strerror(errno));
        return MU_ABSENT;
    }
    out->len = fread(out->at, 1, out->size - 1, f);
    out->at[out->len] = '\0';
    out->cut = out->len == out->size - 1 && fgetc(f) != EOF;
    int failed = ferror(f) ? errno : 0;
    fclose(f);
    return failed ? mu_fault_at(fault, path, 0, 0, "cannot be read: %s", strerror(failed)) : MU_OK;
}
