/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file record.h
 * The record of a program: a file of lines, each written with one write, so that a program that is
 * killed leaves whole lines only.
 */
#ifndef MUSTER_TESTS_RECORD_H
#define MUSTER_TESTS_RECORD_H

#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

/** @return a descriptor, for reading too; an earlier life's record is gone on with; -1: refused */
static inline int record_open(const char *path)
{
    return open(path, O_RDWR | O_CREAT | O_APPEND, 0600);
}

static inline void record_line(int record, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/** Writes a line of less than 512 bytes, a longer one cut off; a program that cannot, ends with 9.
 */
static inline void record_line(int record, const char *format, ...)
{
    char line[512];
    va_list args;
    va_start(args, format);
    int len = vsnprintf(line, sizeof line - 1, format, args);
    va_end(args);
    size_t bytes = (size_t)len < sizeof line - 1 ? (size_t)len : sizeof line - 2;
    line[bytes++] = '\n';
    if (write(record, line, bytes) != (ssize_t)bytes) {
        _exit(9);
    }
}

#endif
