/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/record/record.h"

#include "muster/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <stdio.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

/* openat2 resolves the path in the kernel: a check of ours before the call could be outrun by a
 * link. */
static int file_make(int folder, const char *path)
{
    struct open_how how = {.flags = O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC,
                           .mode = 0644,
                           .resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS};
    return (int)syscall(SYS_openat2, folder, path, &how, sizeof how);
}

mu_result snapshot_file_write(int folder, const char *path, const unsigned char *bytes,
                              size_t count)
{
    int fd = file_make(folder, path);
    if (fd < 0) {
        return MU_FAULT_OS;
    }
    size_t done = 0;
    while (done < count) {
        ssize_t written = write(fd, bytes + done, count - done);
        if (written < 0 && errno != EINTR) {
            break;
        }
        done += written > 0 ? (size_t)written : 0;
    }
    int failed = done < count ? errno : 0;
    if (close(fd) != 0 && failed == 0) {
        failed = errno;
    }
    if (failed != 0) {
        unlinkat(folder, path, 0);
        errno = failed;
        return MU_FAULT_OS;
    }
    return MU_OK;
}

static mu_result snapshot_file_fault(const char *path, const char *why)
{
    fprintf(stderr, "%s: %s\n", path, why);
    return MU_FAULT_FILE;
}

mu_result snapshot_file_restore(struct engine *e, const char *path)
{
    const char *reason = NULL;
    size_t size = engine_save_size(e);
    unsigned char *bytes = mu_startup_alloc(size + 1);
    FILE *f = fopen(path, "rb");
    if (!f) {
        return snapshot_file_fault(path, strerror(errno));
    }
    size_t count =
        fread(bytes, 1, size + 1, f); /* a byte more than a snapshot has shows a longer file */
    bool failed = ferror(f);
    fclose(f);
    if (failed) {
        return snapshot_file_fault(path, "cannot be read");
    }
    mu_result restored = engine_restore(e, bytes, count, &reason);
    return restored == MU_OK ? MU_OK : snapshot_file_fault(path, reason);
}
