/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file json_read.h
 * Reads JSON: each value with its path, such as `mail.sent` or `robots.0.name`.
 */
#ifndef MUSTER_CORE_JSON_READ_H
#define MUSTER_CORE_JSON_READ_H

#include "core/fault.h"

#include <stdbool.h>
#include <stddef.h>

/* Bytes of a path and of a text, with the zero; longer ones are cut. */
enum { MU_JSON_PATH_MAX = 256, MU_JSON_TEXT_MAX = 4096 };

enum mu_json_kind { MU_JSON_NULL, MU_JSON_BOOL, MU_JSON_NUMBER, MU_JSON_STRING };

/* A value that has no others in it. */
struct mu_json_value {
    enum mu_json_kind kind;
    double number;    /* of a number; of a truth value 0 or 1 */
    const char *text; /* of a string, in UTF-8; "" for anything else */
};

/** Is told every such value in the order of the file; path and value live as long as the call. */
typedef void mu_json_take(void *self, const char *path, const struct mu_json_value *value);

/**
 * Reads a whole document: any value, at most MU_JSON_DEPTH_MAX deep.
 *
 * @param file  its name, for faults
 * @param text  ends with a zero
 * @return MU_OK; MU_FAULT_FILE with the place and the expected text: then some values may have
 *         been told already
 */
MU_MUST_USE mu_result mu_json_read(const char *file, const char *text, mu_json_take *take,
                                   void *self, struct mu_fault *fault);

#endif
