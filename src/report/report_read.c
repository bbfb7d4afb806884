/* SPDX-License-Identifier: Apache-2.0 */
#include "report/report_data.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char read_header[] = "time_s,robot,x_m,y_m,heading_rad,forward_m_s,turn_rad_s,stalled";

enum read_column {
    READ_TIME,
    READ_ROBOT,
    READ_X,
    READ_Y,
    READ_HEADING,
    READ_FORWARD,
    READ_TURN,
    READ_STALLED,
    READ_COLUMNS
};

enum { READ_LINE_MAX = 512 };

/* @return MU_OK with a line without its end, MU_DONE, or a fault */
static mu_result read_line(struct report_reader *r, char line[READ_LINE_MAX],
                           struct mu_fault *fault)
{
    if (!fgets(line, READ_LINE_MAX, r->file)) {
        return ferror(r->file) ? mu_fault_os(fault, r->path, "read") : MU_DONE;
    }
    r->line++;
    size_t len = strlen(line);
    if (len == 0 || line[len - 1] != '\n') {
        return mu_fault_at(fault, r->path, r->line, 0, "expected a whole line of text");
    }
    line[--len] = '\0';
    if (len > 0 && line[len - 1] == '\r') {
        line[len - 1] = '\0';
    }
    return MU_OK;
}

/* Counts lines, which is far cheaper than reading them twice. */
static mu_result read_count_lines(struct report_reader *r, size_t *lines, struct mu_fault *fault)
{
    char block[1 << 16];
    size_t len;
    *lines = 0;
    while ((len = fread(block, 1, sizeof block, r->file)) > 0) {
        for (const char *c = block; (c = memchr(c, '\n', (size_t)(block + len - c))); c++) {
            (*lines)++;
        }
    }
    return ferror(r->file) ? mu_fault_os(fault, r->path, "read") : MU_OK;
}

/* placements.csv is there when a robot was placed; its rows are in the order of run.csv's. */
static void placement_next(struct report_reader *r)
{
    r->placement[0] = '\0';
    if (r->placements && fgets(r->placement, sizeof r->placement, r->placements)) {
        r->placement[strcspn(r->placement, "\n")] = '\0';
    }
}

static void placements_open(struct report_reader *r, const char *folder)
{
    char path[REPORT_PATH_MAX];
    int len = snprintf(path, sizeof path, "%s/placements.csv", folder);
    r->placements = len > 0 && (size_t)len < sizeof path ? fopen(path, "re") : NULL;
    placement_next(r); /* the head */
    placement_next(r);
}

/* @return whether the robot was put where this row has it */
static bool placement_take(struct report_reader *r, const char *time, const char *robot)
{
    size_t len = strlen(time);
    bool placed = strncmp(r->placement, time, len) == 0 && r->placement[len] == ',' &&
                  strcmp(r->placement + len + 1, robot) == 0;
    if (placed) {
        placement_next(r);
    }
    return placed;
}

mu_result report_reader_open(struct report_reader *r, const char *folder,
                             const struct report_input *input, size_t *rows_max,
                             struct mu_fault *fault)
{
    *r = (struct report_reader){.input = input, .robot = input->robots_count - 1};
    int len = snprintf(r->path, sizeof r->path, "%s/run.csv", folder);
    errno = ENAMETOOLONG;
    bool fits = len > 0 && (size_t)len < sizeof r->path;
    r->file = fits ? fopen(r->path, "re") : NULL;
    if (!r->file) {
        return mu_fault_os(fault, r->path, "read");
    }
    char line[READ_LINE_MAX];
    mu_result result = read_count_lines(r, rows_max, fault);
    rewind(r->file);
    placements_open(r, folder);
    result = result == MU_OK ? read_line(r, line, fault) : result;
    if (result == MU_DONE) {
        result = mu_fault_at(fault, r->path, 1, 1, "it is empty: no step of the run was written");
    } else if (result == MU_OK && strcmp(line, read_header) != 0) {
        result = mu_fault_at(fault, r->path, 1, 1, "expected the line '%s'", read_header);
    }
    if (result != MU_OK) {
        report_reader_close(r);
    }
    return result;
}

void report_reader_close(struct report_reader *r)
{
    if (r->placements) {
        fclose(r->placements);
    }
    fclose(r->file);
    r->file = NULL;
}

static bool read_number(const char *text, double *value)
{
    char *end;
    *value = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*value);
}

/* Robots stand in the same order in each step, so the next one is tried first. */
static bool read_robot(struct report_reader *r, const char *name, size_t *robot)
{
    size_t count = r->input->robots_count;
    for (size_t i = 1; i <= count; i++) {
        size_t candidate = (r->robot + i) % count;
        if (strcmp(r->input->robots[candidate].name, name) == 0) {
            *robot = candidate;
            return true;
        }
    }
    return false;
}

static mu_result read_fields(struct report_reader *r, char *line, struct report_row *row,
                             struct mu_fault *fault)
{
    char *fields[READ_COLUMNS];
    size_t count = 0;
    for (char *field; (field = strsep(&line, ",")) != NULL; count++) {
        if (count < READ_COLUMNS) {
            fields[count] = field;
        }
    }
    if (count != READ_COLUMNS) {
        return mu_fault_at(fault, r->path, r->line, 0, "expected %d fields, not %zu", READ_COLUMNS,
                           count);
    }
    double forward, turn, stalled;
    const struct {
        enum read_column column;
        double *value;
    } numbers[] = {{READ_TIME, &row->time_s},         {READ_X, &row->x_m},      {READ_Y, &row->y_m},
                   {READ_HEADING, &row->heading_rad}, {READ_FORWARD, &forward}, {READ_TURN, &turn},
                   {READ_STALLED, &stalled}};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        if (!read_number(fields[numbers[i].column], numbers[i].value)) {
            return mu_fault_at(fault, r->path, r->line, 0, "expected a number, not '%.40s'",
                               fields[numbers[i].column]);
        }
    }
    row->placed = placement_take(r, fields[READ_TIME], fields[READ_ROBOT]);
    const char *flag = fields[READ_STALLED];
    row->stalled = flag[0] == '1';
    if (strcmp(flag, "0") != 0 && strcmp(flag, "1") != 0) {
        return mu_fault_at(fault, r->path, r->line, 0, "expected stalled 0 or 1, not '%.40s'",
                           flag);
    }
    if (!read_robot(r, fields[READ_ROBOT], &row->robot)) {
        return mu_fault_at(fault, r->path, r->line, 0, "no robot '%.40s' in this run",
                           fields[READ_ROBOT]);
    }
    return MU_OK;
}

mu_result report_reader_next(struct report_reader *r, struct report_row *row,
                             struct mu_fault *fault)
{
    char line[READ_LINE_MAX];
    mu_result result = read_line(r, line, fault);
    if (result == MU_OK) {
        result = read_fields(r, line, row, fault);
    }
    if (result != MU_OK) {
        return result;
    }
    if (r->line > 2 && row->time_s < r->time_s) {
        return mu_fault_at(fault, r->path, r->line, 0, "expected a time from %g s on, not %g",
                           r->time_s, row->time_s);
    }
    r->robot = row->robot;
    r->time_s = row->time_s;
    return MU_OK;
}
