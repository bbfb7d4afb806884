/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file text_file.h
 * Files as text, and files that take their name when they are whole.
 */
#ifndef MUSTER_CORE_TEXT_FILE_H
#define MUSTER_CORE_TEXT_FILE_H

#include "core/fault.h"
#include "core/text.h"

#include <limits.h>
#include <stdio.h>

/**
 * Fills a text with a file, zero bytes and all; out->cut: the file is larger.
 *
 * @return MU_OK; MU_ABSENT: it cannot be opened; MU_FAULT_FILE: it cannot be read.  The fault says
 *         why
 */
mu_result mu_text_file_read(const char *path, struct mu_text *out, struct mu_fault *fault);

/* A file that is written beside its place, as ".NAME.new". */
struct mu_draft {
    FILE *file;
    char path[PATH_MAX + 32];
    char beside[PATH_MAX + 32]; /* "": it is written in its place, which a link or a device has */
};

/** Creates a file in a folder; NULL: name is a path.  @return MU_OK, or MU_FAULT_OS */
MU_MUST_USE mu_result mu_draft_open(struct mu_draft *d, const char *folder, const char *name,
                                    struct mu_fault *fault);

/**
 * Gives the file its name, or takes it away when it is not whole.
 *
 * @return MU_OK; MU_FAULT_OS when it should be whole and is not
 */
MU_MUST_USE mu_result mu_draft_close(struct mu_draft *d, bool whole, struct mu_fault *fault);

#endif
