/* SPDX-License-Identifier: Apache-2.0 */
/* Bytes of a recording to the disk, and back. */
#include "mcap/mcap_reader.h"
#include "mcap/mcap_writer.h"

#include <errno.h>
#include <sys/uio.h>
#include <unistd.h>

/* Writes both, one after the other, as one where the system lets us. */
void mcap_writer_put_pieces(struct mcap_writer *w, struct iovec *pieces, int count)
{
    while (count > 0 && w->error == 0) {
        ssize_t wrote = writev(w->fd, pieces, count);
        if (wrote < 0) {
            w->error = errno == EINTR ? 0 : errno;
            continue;
        }
        if (wrote == 0 && pieces->iov_len > 0) { /* a file that takes nothing, and says nothing */
            w->error = EIO;
        }
        w->offset += (uint64_t)wrote;
        size_t left = (size_t)wrote;
        while (count > 0 && left >= pieces->iov_len) {
            left -= pieces->iov_len;
            pieces++;
            count--;
        }
        if (count > 0) {
            pieces->iov_base = (char *)pieces->iov_base + left;
            pieces->iov_len -= left;
        }
    }
}

void mcap_writer_put(struct mcap_writer *w, const void *bytes, size_t count)
{
    struct iovec piece = {.iov_base = (void *)(uintptr_t)bytes, .iov_len = count};
    mcap_writer_put_pieces(w, &piece, 1);
}

mu_result mcap_reader_bytes(const struct mcap_reader *r, uint64_t at, void *to, size_t count)
{
    if (at > r->size || count > r->size - at) {
        return MU_MALFORMED;
    }
    for (size_t done = 0; done < count;) {
        ssize_t got = pread(r->fd, (char *)to + done, count - done, (off_t)(at + done));
        if (got < 0 && errno != EINTR) {
            return MU_FAULT_OS;
        }
        if (got == 0) {
            return MU_MALFORMED; /* it has become shorter */
        }
        done += got > 0 ? (size_t)got : 0;
    }
    return MU_OK;
}
