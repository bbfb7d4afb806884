/* SPDX-License-Identifier: Apache-2.0 */
#include "broker/node/node.h"

#include "broker/control/parts.h"
#include "core/log.h"
#include "core/text_file.h"
#include "muster/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

mu_result files_policy_load(struct broker *b, const char *path)
{
    struct mu_fault fault = {0};
    struct mu_text text =
        mu_text_in(mu_startup_alloc(FILES_POLICY_BYTES + 1), FILES_POLICY_BYTES + 1);
    mu_result done = mu_text_file_read(path, &text, &fault);
    if (done != MU_OK) {
        done = mu_fault_at(&fault, path, 0, 0, "cannot read the policy: %s", strerror(errno));
    } else if (text.cut) {
        done = mu_fault_at(&fault, path, 0, 0, "expected at most %d bytes of policy",
                           FILES_POLICY_BYTES);
    } else if (strlen(text.at) != text.len) {
        done = mu_fault_at(&fault, path, 0, 0, "expected text: there is a zero byte in it");
    } else {
        done = trust_read(&b->trust, text.at, path, &fault);
    }
    if (done != MU_OK) {
        mu_fault_print(&fault);
    }
    return done;
}

bool files_audit_open(struct files_audit *f, const char *path)
{
    *f = (struct files_audit){.fd = -1};
    if (!path) {
        return true;
    }
    f->fd = open(path, O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0644);
    if (f->fd < 0) {
        fprintf(stderr, "muster broker: cannot write the audit log '%s': %s\n", path,
                strerror(errno));
    }
    return f->fd >= 0;
}

/* @return whether all of it is in the file */
static bool line_write(struct files_audit *f, const char *line, size_t len)
{
    if (f->cut && write(f->fd, "\n", 1) == 1) {
        f->cut = false;
    }
    ssize_t written = f->cut ? -1 : write(f->fd, line, len), rest = 0;
    if (written > 0 && (size_t)written < len) { /* why, the next one says */
        rest = write(f->fd, line + written, len - (size_t)written);
        f->cut = rest != (ssize_t)(len - (size_t)written);
    }
    return !f->cut && written + rest == (ssize_t)len;
}

void files_audit_write(struct files_audit *f, struct broker *b)
{
    struct audit_record record;
    char line[AUDIT_LINE_MAX];
    while (audit_next(&b->audit, &record)) {
        size_t len = audit_line(&record, line);
        bool failed = !line_write(f, line, len);
        if (failed) {
            b->audit.failed++;
        }
        if (failed && !f->failed) {
            mu_log(MU_LOG_ERROR, "audit-not-written", "reason=\"%s\"", strerror(errno));
        } else if (!failed && f->failed) {
            mu_log(MU_LOG_WARNING, "audit-written-again", "fd=%d", f->fd);
        }
        f->failed = failed;
    }
}
