/* SPDX-License-Identifier: Apache-2.0 */
/* compare.html: a plot for each statistic, every run a dot, every group a mean with its interval.
 */
#include "core/text_file.h"
#include "report/compare/compare.h"
#include "report/drawing/drawing.h"

#include <math.h>
#include <stdlib.h>

enum { PLOT_LEFT = 76, PLOT_TOP = 44, PLOT_BOTTOM = 46, PLOT_RIGHT = 24, PLOT_NAMED_MAX = 12 };
#define PLOT_WIDTH_PX  620.0
#define PLOT_HEIGHT_PX 240.0

static const struct palette_color plot_color = {"#0b5fa5", "#6cb8f0", 0};

struct plot {
    FILE *file;
    const struct compare *compare;
    unsigned statistic;
    struct svg_scale x, y;
    bool numbers; /* the groups are numbers, and stand where these are */
};

static bool number_of(const char *text, double *number)
{
    char *end;
    *number = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*number);
}

static double group_place(const struct plot *p, unsigned group)
{
    double number = group;
    if (p->numbers) {
        (void)number_of(p->compare->groups[group].name, &number);
    }
    return svg_scale_px(&p->x, number);
}

static void x_choose(struct plot *p)
{
    const struct compare *c = p->compare;
    double first = 0, last = 0, number;
    p->numbers = c->groups_count > 1;
    for (unsigned g = 0; g < c->groups_count; g++) {
        p->numbers = p->numbers && number_of(c->groups[g].name, &number);
    }
    if (p->numbers) {
        (void)number_of(c->groups[0].name, &first);
        (void)number_of(c->groups[c->groups_count - 1].name, &last);
    } else {
        last = c->groups_count - 1;
    }
    double air = p->numbers && last > first ? (last - first) * 0.08 : 0.6;
    p->x = (struct svg_scale){first - air, last + air, PLOT_LEFT, PLOT_LEFT + PLOT_WIDTH_PX};
}

/* All runs and all intervals; from zero on, unless that would leave most of it empty. */
static void y_choose(struct plot *p)
{
    double low = INFINITY, high = -INFINITY;
    for (unsigned g = 0; g < p->compare->groups_count; g++) {
        const struct interval *i = &p->compare->groups[g].statistics[p->statistic];
        double half = i->count > 1 ? interval_half_width(i) : 0;
        if (i->count > 0) {
            low = fmin(low, fmin(i->least, i->mean - half));
            high = fmax(high, fmax(i->most, i->mean + half));
        }
    }
    low = low > 0 && low < 0.5 * high ? 0 : low;
    double air = high > low ? (high - low) * 0.06 : fmax(fabs(high) * 0.1, 0.5);
    p->y = (struct svg_scale){low == 0 ? 0 : low - air, high + air, PLOT_TOP + PLOT_HEIGHT_PX,
                              PLOT_TOP};
}

static void y_axis_draw(const struct plot *p)
{
    char label[SVG_TICK_MAX];
    double step = svg_tick_step(p->y.to - p->y.from, 6);
    for (double k = ceil(p->y.from / step - 1e-9); k * step <= p->y.to + 1e-9 * step; k++) {
        double px = svg_scale_px(&p->y, k * step);
        double from[2] = {p->x.from_px, px}, to[2] = {p->x.to_px, px};
        double at[2] = {p->x.from_px - 8, px + 4};
        svg_line(p->file, from, to, "stroke=\"#e4e7ea\"");
        svg_tick_label(label, k * step);
        svg_text(p->file, at, SVG_END, "", label);
    }
}

static void x_axis_draw(const struct plot *p)
{
    const struct compare *c = p->compare;
    for (unsigned g = 0; g < c->groups_count; g++) {
        double at[2] = {group_place(p, g), p->y.from_px + 20};
        char name[32], runs[48];
        bool room = c->groups_count <= PLOT_NAMED_MAX || g % (c->groups_count / 8) == 0;
        mu_text_copy(name, sizeof name, c->groups[g].name);
        snprintf(runs, sizeof runs, "%zu runs", c->groups[g].statistics[p->statistic].count);
        if (room) {
            svg_text(p->file, at, SVG_MIDDLE, "", name);
            at[1] += 15;
            svg_text(p->file, at, SVG_MIDDLE, "font-size=\"10\" fill=\"#767f88\"", runs);
        }
    }
    if (c->by) {
        double at[2] = {(p->x.from_px + p->x.to_px) / 2, p->y.from_px + 52};
        svg_text(p->file, at, SVG_MIDDLE, "", c->by);
    }
}

/* Every run where it is, beside the mean: which way it is moved aside goes by its number. */
static void runs_draw(const struct plot *p, unsigned group)
{
    const struct compare *c = p->compare;
    unsigned number = 0;
    for (unsigned i = 0; i < c->runs_count; i++) {
        const struct compare_run *run = &c->runs[i];
        if (run->group != &c->groups[group] || isnan(run->values[p->statistic])) {
            continue;
        }
        double aside = fmod(number++ * 0.618034, 1) * 22 + 14; /* the golden section spreads them */
        double at[2] = {group_place(p, group) + aside,
                        svg_scale_px(&p->y, run->values[p->statistic])};
        svg_circle(p->file, at, 2.6,
                   run->met == run->expected ? "fill=\"#7d8792\" fill-opacity=\".55\""
                                             : "fill=\"#c0271d\" fill-opacity=\".8\"");
    }
}

static void mean_draw(const struct plot *p, unsigned group)
{
    const struct interval *i = &p->compare->groups[group].statistics[p->statistic];
    double half = interval_half_width(i), x = group_place(p, group);
    double mean[2] = {x, svg_scale_px(&p->y, i->mean)};
    if (isfinite(half)) {
        for (int end = -1; end <= 1; end += 2) {
            double y = svg_scale_px(&p->y, i->mean + end * half);
            double to[2] = {x, y}, left[2] = {x - 7, y}, right[2] = {x + 7, y};
            svg_line(p->file, mean, to, "stroke=\"#0b5fa5\" stroke-width=\"2\"");
            svg_line(p->file, left, right, "stroke=\"#0b5fa5\" stroke-width=\"2\"");
        }
    }
    svg_circle(p->file, mean, 5, "fill=\"#0b5fa5\" stroke=\"#fff\" stroke-width=\"1.5\"");
}

/* Numbers are joined: what lies between them is likely between. */
static void means_join(const struct plot *p)
{
    struct svg_path path;
    svg_path_open(&path, p->file, &plot_color, 1.2);
    for (unsigned g = 0; g < p->compare->groups_count; g++) {
        const struct interval *i = &p->compare->groups[g].statistics[p->statistic];
        double at[2] = {group_place(p, g), svg_scale_px(&p->y, i->mean)};
        if (i->count > 0) {
            svg_path_point(&path, at);
        }
    }
    svg_path_close(&path);
}

static void plot_draw(FILE *file, const struct compare *c, unsigned statistic)
{
    struct plot p = {.file = file, .compare = c, .statistic = statistic};
    char label[COMPARE_NAME_MAX + 16];
    compare_label(label, c->statistics[statistic]);
    x_choose(&p);
    y_choose(&p);
    svg_open(file, p.x.to_px + PLOT_RIGHT, p.y.from_px + PLOT_BOTTOM + (c->by ? 16 : 0), label);
    double title[2] = {PLOT_LEFT, 26};
    svg_text(file, title, SVG_START, "font-size=\"15\" font-weight=\"600\" fill=\"#111\"", label);
    y_axis_draw(&p);
    double centre[2] = {(p.x.from_px + p.x.to_px) / 2, (p.y.from_px + p.y.to_px) / 2};
    double half[2] = {PLOT_WIDTH_PX / 2, PLOT_HEIGHT_PX / 2};
    svg_box(file, centre, half, 0, "fill=\"none\" stroke=\"#8b939c\"");
    x_axis_draw(&p);
    if (p.numbers) {
        means_join(&p);
    }
    for (unsigned g = 0; g < c->groups_count; g++) {
        if (c->groups[g].statistics[statistic].count > 0) {
            runs_draw(&p, g);
            mean_draw(&p, g);
        }
    }
    svg_close(file);
}

/* --- the table -------------------------------------------------------------------------------- */

static void cell_write(FILE *file, double value)
{
    if (isfinite(value)) {
        fprintf(file, "<td>%.4g</td>", value);
    } else {
        fputs("<td>\xe2\x80\x93</td>", file);
    }
}

static void row_write(FILE *file, const char *label, const struct compare_group *group,
                      const struct interval *i)
{
    fputs("<tr><td>", file);
    svg_escape(file, label);
    fputs("</td><td>", file);
    svg_escape(file, group->name);
    fprintf(file, "</td><td>%zu</td>", i->count);
    cell_write(file, i->mean);
    cell_write(file, interval_half_width(i));
    cell_write(file, interval_deviation(i));
    cell_write(file, i->least);
    cell_write(file, i->most);
    fputs("</tr>\n", file);
}

static void table_write(FILE *file, const struct compare *c)
{
    fputs("<h2>All numbers</h2>\n<div class=\"wide\"><table>\n<tr><th>statistic</th><th>group</th>"
          "<th>runs</th><th>mean</th><th>\xc2\xb1 95 %</th><th>deviation</th><th>least</th>"
          "<th>most</th></tr>\n",
          file);
    for (unsigned k = 0; k < c->statistics_count; k++) {
        char label[COMPARE_NAME_MAX + 16];
        compare_label(label, c->statistics[k]);
        for (unsigned g = 0; g < c->groups_count; g++) {
            if (c->groups[g].statistics[k].count > 0) {
                row_write(file, label, &c->groups[g], &c->groups[g].statistics[k]);
            }
        }
    }
    fputs("</table></div>\n", file);
}

static void groups_write(FILE *file, const struct compare *c)
{
    fputs("<table class=\"text\">\n<tr><th>group</th><th>runs</th><th>as expected</th></tr>\n",
          file);
    for (unsigned g = 0; g < c->groups_count; g++) {
        const struct compare_group *group = &c->groups[g];
        fputs("<tr><td>", file);
        svg_escape(file, group->name);
        fprintf(file, "</td><td>%u</td><td class=\"%s\">%u of %u</td></tr>\n", group->runs,
                group->as_expected == group->runs ? "met" : "failed", group->as_expected,
                group->runs);
    }
    fputs("</table>\n", file);
}

static void page_write(FILE *file, const struct compare *c)
{
    page_open(file, "muster: runs compared", "Runs compared");
    fprintf(file,
            "<p class=\"soft\">%u runs. A dot is a run, red where an expectation failed; the "
            "bar is the mean with the interval that has the true mean in it 95 times of 100 "
            "(Student\xe2\x80\x99s t).</p>\n",
            c->runs_count);
    groups_write(file, c);
    for (unsigned k = 0; k < c->statistics_count; k++) {
        if (compare_has(c, k)) {
            fputs("<figure>\n", file);
            plot_draw(file, c, k);
            fputs("</figure>\n", file);
        }
    }
    table_write(file, c);
    page_close(file);
}

mu_result compare_page(const struct compare *c, const char *path, struct mu_fault *fault)
{
    struct mu_draft draft;
    MU_TRY(mu_draft_open(&draft, NULL, path, fault));
    page_write(draft.file, c);
    return mu_draft_close(&draft, true, fault);
}
