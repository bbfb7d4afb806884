/* SPDX-License-Identifier: Apache-2.0 */
#include "stats/stats.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double FARTHEST_M = 1e9;

/* @return whether a line is "+INDEX (goal WORD X Y)", and no other */
static bool line_read(const char *line, double *x_m, double *y_m)
{
    double x_mm, y_mm;
    int end = -1;
    if (sscanf(line, "+%*31[0-9] (goal %*63[^ ()] %lf %lf)%n", &x_mm, &y_mm, &end) != 2 ||
        end < 0 || (line[end] != '\n' && line[end] != '\0')) {
        return false;
    }
    *x_m = x_mm / 1000;
    *y_m = y_mm / 1000;
    return fabs(*x_m) <= FARTHEST_M && fabs(*y_m) <= FARTHEST_M;
}

bool goal_in_diary(const char *diary, double *x_m, double *y_m)
{
    bool found = false;
    for (const char *line = diary; line && *line; line = strchr(line, '\n')) {
        line += *line == '\n';
        double x, y;
        if (strncmp(line, "+", 1) == 0 && line_read(line, &x, &y)) {
            found = true;
            *x_m = x;
            *y_m = y;
        }
    }
    return found;
}
