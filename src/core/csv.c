/* SPDX-License-Identifier: Apache-2.0 */
#include "core/csv.h"

#include "core/sensors.h"

#include <math.h>
#include <string.h>

void mu_csv_head(FILE *file)
{
    fputs("time_s,robot", file);
#define COLUMN(type, member, unit, column, ...) fputs(column[0] ? "," column : "", file);
    MU_READINGS(COLUMN)
#undef COLUMN
    fputc('\n', file);
}

/* Writes a number with six decimals.  printf would take a tenth of the time of a step. */
static char *csv_number(char *to, double value)
{
    char digits[24];
    size_t count = 0;
    long long scaled = llround(value * 1e6);
    unsigned long long rest =
        scaled < 0 ? 0ull - (unsigned long long)scaled : (unsigned long long)scaled;
    if (scaled < 0) {
        *to++ = '-';
    }
    do {
        digits[count++] = (char)('0' + rest % 10);
        rest /= 10;
    } while (rest > 0 || count < 7);
    while (count > 0) {
        if (count == 6) {
            *to++ = '.';
        }
        *to++ = digits[--count];
    }
    return to;
}

static char *csv_column(char *to, bool flag, double value)
{
    *to++ = ',';
    if (!flag) {
        return csv_number(to, value);
    }
    *to++ = value != 0 ? '1' : '0';
    return to;
}

static char *csv_begin(char *to, uint64_t time_ns, const char *robot)
{
    size_t len = strlen(robot);
    to = csv_number(to, (double)time_ns * 1e-9);
    *to++ = ',';
    memcpy(to, robot, len);
    return to + len;
}

void mu_csv_row(FILE *file, uint64_t time_ns, const char *robot, const struct mu_percept *body)
{
    char row[(2 + MU_READING_COUNT) * 24 + MU_NAME_MAX + 1];
    char *end = csv_begin(row, time_ns, robot);
#define COLUMN(type, member, unit, column, ...)   \
    if (column[0]) {                              \
        end = csv_column(end,                     \
                         _Generic((type)0, bool   \
                                  : true, default \
                                  : false),       \
                         (double)body->member);   \
    }
    MU_READINGS(COLUMN)
#undef COLUMN
    *end++ = '\n';
    fwrite(row, 1, (size_t)(end - row), file);
}

void mu_csv_placement(FILE *file, uint64_t time_ns, const char *robot)
{
    char row[24 + MU_NAME_MAX + 2];
    char *end = csv_begin(row, time_ns, robot);
    *end++ = '\n';
    fwrite(row, 1, (size_t)(end - row), file);
}

void mu_csv_event(FILE *file, uint64_t time_ns, const char *condition)
{
    fprintf(file, "%.3f,%s\n", (double)time_ns * 1e-9, condition);
}
