/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file sample.h
 * Text in a sample that is about to be written.
 */
#ifndef MUSTER_BROKER_SAMPLE_H
#define MUSTER_BROKER_SAMPLE_H

#include <stdint.h>

/** @return the text, for a member of a sample: idlc makes none const, and nobody writes there */
static inline char *sample_text(const char *text)
{
    return (char *)(uintptr_t)text;
}

#endif
