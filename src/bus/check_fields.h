/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file check_fields.h
 * What the checks of the border share: fields, and what samples of several topics have in them.
 */
#ifndef MUSTER_BUS_CHECK_FIELDS_H
#define MUSTER_BUS_CHECK_FIELDS_H

#include "core/name.h"
#include "muster/limits.h"
#include "wire.h"

#include <string.h>

/* Most fields of a mail are empty, and need no call. */
static inline bool text_fits(const char *text, size_t max)
{
    return text && (text[0] == '\0' || strnlen(text, max + 1) <= max);
}

static inline bool is_name(const char *name)
{
    return text_fits(name, MU_NAME_MAX) && mu_name_valid(name);
}

static inline bool is_process(const char *name)
{
    return text_fits(name, MU_PROCESS_MAX) && name[0] != '\0';
}

/* What is counted from 1; the upper half is no count, so that one more never starts again at 0. */
static inline bool is_count(uint64_t number)
{
    return number > 0 && number <= INT64_MAX;
}

bool check_mails(const muster_Mail *mails, uint32_t count);
bool check_acts(const muster_Act *acts, uint32_t count);

#endif
