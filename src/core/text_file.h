/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file text_file.h
 * Files as text.
 */
#ifndef MUSTER_CORE_TEXT_FILE_H
#define MUSTER_CORE_TEXT_FILE_H

#include "core/fault.h"
#include "core/text.h"

/**
 * Fills a text with a file, zero bytes and all; out->cut: the file is larger.
 *
 * @return MU_OK; MU_ABSENT: it cannot be opened; MU_FAULT_FILE: it cannot be read.  The fault says
 *         why
 */
mu_result mu_text_file_read(const char *path, struct mu_text *out, struct mu_fault *fault);

#endif
