/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/record/record.h"

#include "core/sensors.h"
#include "muster/memory.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { TRACKS_BUFFER = 256 * 1024 };

struct tracks {
    FILE *file, *placements; /* NULL: no robot was placed yet */
    char path[512], placements_path[512];
    char buffer[TRACKS_BUFFER];
};

static mu_result tracks_fault(const char *path, const char *what)
{
    fprintf(stderr, "cannot %s %s: %s\n", what, path, strerror(errno));
    return MU_FAULT_OS;
}

mu_result tracks_open(struct tracks **out, const char *path)
{
    struct tracks *r = mu_startup_alloc(sizeof *r);
    const char *slash = strrchr(path, '/');
    snprintf(r->path, sizeof r->path, "%s", path);
    snprintf(r->placements_path, sizeof r->placements_path, "%.*splacements.csv",
             slash ? (int)(slash + 1 - path) : 0, path);
    unlink(r->placements_path); /* an earlier run may have left it */
    r->file = fopen(path, "w");
    if (!r->file) {
        return tracks_fault(path, "create");
    }
    setvbuf(r->file, r->buffer, _IOFBF, sizeof r->buffer);
    fputs("time_s,robot", r->file);
#define COLUMN(type, member, unit, column, ...) \
    if (column[0]) {                            \
        fputs("," column, r->file);             \
    }
    MU_READINGS(COLUMN)
#undef COLUMN
    fputc('\n', r->file);
    *out = r;
    return MU_OK;
}

/* Writes a number with six decimals.  printf would take a tenth of the time of a step. */
static char *number_write(char *to, double value)
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

/* Creates placements.csv when the first robot is placed.  A full disk also shows in the tracks. */
static void placement_add(struct tracks *r, uint64_t time_ns, const char *robot)
{
    char time[24];
    *number_write(time, (double)time_ns * 1e-9) = '\0';
    if (!r->placements && (r->placements = fopen(r->placements_path, "w"))) {
        fputs("time_s,robot\n", r->placements);
    }
    if (r->placements) {
        fprintf(r->placements, "%s,%s\n", time, robot);
        fflush(r->placements);
    }
}

static char *column_write(char *to, bool flag, double value)
{
    *to++ = ',';
    if (!flag) {
        return number_write(to, value);
    }
    *to++ = value != 0 ? '1' : '0';
    return to;
}

void tracks_add(struct tracks *r, uint64_t time_ns, const char *robot,
                const struct engine_sample *sample)
{
    char row[(2 + MU_READING_COUNT) * 24 + MU_NAME_MAX + 1];
    char *end = number_write(row, (double)time_ns * 1e-9);
    size_t len = strlen(robot);
    struct mu_percept body = engine_truth(sample);
    *end++ = ',';
    memcpy(end, robot, len);
    end += len;
#define COLUMN(type, member, unit, column, ...)     \
    if (column[0]) {                                \
        end = column_write(end,                     \
                           _Generic((type)0, bool   \
                                    : true, default \
                                    : false),       \
                           (double)body.member);    \
    }
    MU_READINGS(COLUMN)
#undef COLUMN
    *end++ = '\n';
    fwrite(row, 1, (size_t)(end - row), r->file);
    if (sample->placed) {
        placement_add(r, time_ns, robot);
    }
}

mu_result tracks_close(struct tracks *r)
{
    bool whole = !ferror(r->file);
    if (r->placements) {
        fclose(r->placements);
    }
    whole = fclose(r->file) == 0 && whole;
    return whole ? MU_OK : tracks_fault(r->path, "write");
}
