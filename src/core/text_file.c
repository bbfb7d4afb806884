/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text_file.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

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

mu_result mu_draft_open(struct mu_draft *d, const char *folder, const char *name,
                        struct mu_fault *fault)
{
    struct stat there;
    int len =
        snprintf(d->path, sizeof d->path, "%s%s%s", folder ? folder : "", folder ? "/" : "", name);
    const char *slash = strrchr(d->path, '/');
    int before = slash ? (int)(slash + 1 - d->path) : 0;
    d->beside[0] = '\0';
    if (lstat(d->path, &there) != 0 || S_ISREG(there.st_mode)) {
        len =
            snprintf(d->beside, sizeof d->beside, "%.*s.%s.new", before, d->path, d->path + before);
    }
    errno = ENAMETOOLONG;
    bool fits = len > 0 && (size_t)len < sizeof d->path;
    d->file = fits ? fopen(d->beside[0] ? d->beside : d->path, "we") : NULL;
    return d->file ? MU_OK : mu_fault_os(fault, d->path, "write");
}

mu_result mu_draft_close(struct mu_draft *d, bool whole, struct mu_fault *fault)
{
    errno = 0;
    bool written = fflush(d->file) == 0 && !ferror(d->file);
    int why = errno ? errno : EIO;
    written = fclose(d->file) == 0 && written;
    if (whole && written && (!d->beside[0] || rename(d->beside, d->path) == 0)) {
        return MU_OK;
    }
    why = written ? errno : why;
    if (d->beside[0]) {
        unlink(d->beside);
    }
    errno = why;
    return whole ? mu_fault_os(fault, d->path, "write") : MU_OK;
}
