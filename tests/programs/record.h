/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file record.h
 * The record of a program: a file of lines.  A program that is killed while it writes a line across
 * two pages leaves the first half of it: its next life cuts that off, and takes that mail again.
 */
#ifndef MUSTER_TESTS_RECORD_H
#define MUSTER_TESTS_RECORD_H

#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

/* @return the length of a record up to the end of its last whole line */
static inline off_t record_whole(int record, off_t len)
{
    char last = '\n';
    while (len > 0 && pread(record, &last, 1, len - 1) == 1 && last != '\n') {
        len--;
    }
    return len;
}

/** @return a descriptor, for reading too; an earlier life's record is gone on with; -1: refused */
static inline int record_open(const char *path)
{
    int record = open(path, O_RDWR | O_CREAT | O_APPEND, 0600);
    off_t len = record < 0 ? -1 : lseek(record, 0, SEEK_END);
    return len >= 0 && ftruncate(record, record_whole(record, len)) == 0 ? record : -1;
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
