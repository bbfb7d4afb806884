/* SPDX-License-Identifier: Apache-2.0 */
#include "report/report_data.h"

#include <string.h>

enum { LEGEND_TEXT_LEFT = 30, LEGEND_LETTERS_MIN = 12 };
#define LEGEND_LETTER_PX 7.2 /* of 12 px text, on average, with some air */

static size_t legend_rows(const struct report_data *data)
{
    size_t robots = data->input->robots_count;
    return robots > REPORT_LEGEND_MAX ? REPORT_LEGEND_MAX + 1 : robots;
}

void report_legend(FILE *file, const struct report_data *data, double x_px, double y_px)
{
    size_t robots = data->input->robots_count;
    double y = y_px + REPORT_LEGEND_ROW / 2.0;
    for (size_t i = 0; i < robots && i < REPORT_LEGEND_MAX; i++) {
        double from[2] = {x_px, y}, to[2] = {x_px + 22, y};
        double at[2] = {x_px + LEGEND_TEXT_LEFT, y + 4};
        struct svg_path line;
        svg_path_open(&line, file, &data->colors[i], 3);
        svg_path_point(&line, from);
        svg_path_point(&line, to);
        svg_path_close(&line);
        svg_text(file, at, SVG_START, "", data->input->robots[i].name);
        y += REPORT_LEGEND_ROW;
    }
    if (robots > REPORT_LEGEND_MAX) {
        char more[48];
        double at[2] = {x_px + LEGEND_TEXT_LEFT, y + 4};
        snprintf(more, sizeof more, "and %zu more", robots - REPORT_LEGEND_MAX);
        svg_text(file, at, SVG_START, "fill=\"#666\"", more);
    }
}

double report_legend_width(const struct report_data *data)
{
    size_t letters = LEGEND_LETTERS_MIN;
    for (size_t i = 0; i < data->input->robots_count && i < REPORT_LEGEND_MAX; i++) {
        size_t len = strlen(data->input->robots[i].name);
        letters = len > letters ? len : letters;
    }
    return LEGEND_TEXT_LEFT + (double)letters * LEGEND_LETTER_PX;
}

double report_legend_height(const struct report_data *data, unsigned more_rows)
{
    return (double)(legend_rows(data) + more_rows) * REPORT_LEGEND_ROW + 14;
}

void report_legend_start(FILE *file, const double at[2])
{
    svg_circle(file, at, 5.5, "fill=\"#fff\" stroke-width=\"2\"");
}

void report_legend_end(FILE *file, const double at[2])
{
    static const double half[2] = {5, 5};
    svg_box(file, at, half, 0, "stroke=\"#fff\" stroke-width=\"1\"");
}

void report_legend_marks(FILE *file, double x_px, double y_px, double mark_s)
{
    double y = y_px + REPORT_LEGEND_ROW / 2.0;
    double mark[2] = {x_px + 11, y}, at[2] = {x_px + LEGEND_TEXT_LEFT, y + 4};
    char every[48];
    fputs("<g stroke=\"#555\" fill=\"#555\">\n", file);
    report_legend_start(file, mark);
    mark[1] += REPORT_LEGEND_ROW;
    report_legend_end(file, mark);
    mark[1] += REPORT_LEGEND_ROW;
    if (mark_s > 0) {
        svg_circle(file, mark, 2.2, "fill=\"#fff\" stroke-width=\"1.2\"");
    }
    fputs("</g>\n", file);
    svg_text(file, at, SVG_START, "", "start");
    at[1] += REPORT_LEGEND_ROW;
    svg_text(file, at, SVG_START, "", "end");
    at[1] += REPORT_LEGEND_ROW;
    if (mark_s > 0) {
        snprintf(every, sizeof every, "every %g s", mark_s);
        svg_text(file, at, SVG_START, "", every);
    }
}
