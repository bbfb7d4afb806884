/* SPDX-License-Identifier: Apache-2.0 */
/* bearing.svg: where each robot headed over time; after figure 6 of the paper. */
#include "core/text.h"
#include "report/report_data.h"

#include <math.h>
#include <string.h>

enum { BEARING_LEFT = 58, BEARING_TITLE = 40, BEARING_BOTTOM = 54, BEARING_LABEL_ROW = 16 };
enum { BEARING_LABEL_ROWS_MAX = 4, BEARING_LABEL_MAX = 72 };
#define BEARING_WIDTH_PX  700.0
#define BEARING_HEIGHT_PX 340.0
#define BEARING_LETTER_PX 5.9 /* of 11 px text, at most, as a rule of thumb */

struct bearing {
    FILE *file;
    const struct report_data *data;
    struct svg_scale x, y;
    double rows_end_px[BEARING_LABEL_ROWS_MAX]; /* how far each row of labels is taken */
    unsigned rows_count;
};

/* One moment at which the observer commanded something. */
struct bearing_label {
    double px;
    double left_px;
    unsigned row; /* BEARING_LABEL_ROWS_MAX: no room */
    char text[BEARING_LABEL_MAX];
};

/* Puts all commands of one moment into one label, and finds it a row.
 * @param at  index of a command; the next moment's first one afterwards */
static bool bearing_next_label(struct bearing *b, unsigned *at, struct bearing_label *label)
{
    const struct experiment *e = b->data->input->experiment;
    while (*at < e->observer_count &&
           !(e->observer[*at].at > 0 && e->observer[*at].at <= b->x.to)) {
        (*at)++;
    }
    if (*at == e->observer_count) {
        return false;
    }
    double time_s = e->observer[*at].at;
    struct mu_text text = mu_text_in(label->text, BEARING_LABEL_MAX);
    for (; *at < e->observer_count && fabs(e->observer[*at].at - time_s) < 1e-9; (*at)++) {
        const struct experiment_command *c = &e->observer[*at];
        mu_text_add(&text, text.len ? "; " : "");
        for (unsigned i = 0; i < c->targets_count; i++) {
            mu_text_format(&text, "%s%s", i ? ", " : "", c->targets[i]);
        }
        mu_text_format(&text, ": %s%s", c->move ? "move to " : "", c->move ? c->move : c->line);
    }
    if (text.cut) {
        memcpy(label->text + BEARING_LABEL_MAX - 4, "...", 4);
    }
    double width_px = (double)text.len * BEARING_LETTER_PX;
    label->px = svg_scale_px(&b->x, time_s);
    double right_px = b->x.to_px + report_legend_width(b->data);
    label->left_px = fmax(fmin(label->px, right_px - width_px), 4);
    label->row = 0;
    while (label->row < BEARING_LABEL_ROWS_MAX && label->left_px < b->rows_end_px[label->row]) {
        label->row++;
    }
    if (label->row < BEARING_LABEL_ROWS_MAX) {
        b->rows_end_px[label->row] = label->left_px + width_px + 10;
        b->rows_count = label->row >= b->rows_count ? label->row + 1 : b->rows_count;
    }
    return true;
}

static void bearing_init(struct bearing *b, FILE *file, const struct report_data *data)
{
    *b = (struct bearing){.file = file, .data = data};
    double end_s = fmax(data->end_s, data->start_s + 0.1);
    double step_s = svg_tick_step(end_s, 10);
    double from_s = floor(data->start_s / step_s) * step_s;
    b->x = (struct svg_scale){from_s, end_s, BEARING_LEFT, BEARING_LEFT + BEARING_WIDTH_PX};
    struct bearing_label label;
    for (unsigned at = 0; bearing_next_label(b, &at, &label);) {
    }
    double top_px = BEARING_TITLE + b->rows_count * BEARING_LABEL_ROW;
    b->y = (struct svg_scale){-180, 180, top_px + BEARING_HEIGHT_PX, top_px};
}

static void bearing_draw_axes(const struct bearing *b)
{
    char label[SVG_TICK_MAX];
    for (int degrees = -180; degrees <= 180; degrees += 45) {
        double px = svg_scale_px(&b->y, degrees);
        double from[2] = {b->x.from_px, px}, to[2] = {b->x.to_px, px};
        double at[2] = {b->x.from_px - 8, px + 4};
        svg_line(b->file, from, to, degrees == 0 ? "stroke=\"#c9ced3\"" : "stroke=\"#eceef0\"");
        if (degrees % 90 == 0) {
            svg_tick_label(label, degrees);
            svg_text(b->file, at, SVG_END, "", label);
        }
    }
    double step_s = svg_tick_step(b->x.to - b->x.from, 10);
    for (double i = ceil(b->x.from / step_s - 1e-9); i * step_s <= b->x.to + 1e-6; i++) {
        double px = svg_scale_px(&b->x, i * step_s);
        double from[2] = {px, b->y.from_px}, to[2] = {px, b->y.to_px};
        double at[2] = {px, b->y.from_px + 18};
        svg_line(b->file, from, to, "stroke=\"#eceef0\"");
        svg_tick_label(label, i * step_s);
        svg_text(b->file, at, SVG_MIDDLE, "", label);
    }
    double centre[2] = {(b->x.from_px + b->x.to_px) / 2, (b->y.from_px + b->y.to_px) / 2};
    double half[2] = {(b->x.to_px - b->x.from_px) / 2, (b->y.from_px - b->y.to_px) / 2};
    svg_box(b->file, centre, half, 0, "fill=\"none\" stroke=\"#8b939c\"");
    double at[2] = {centre[0], b->y.from_px + 40};
    svg_text(b->file, at, SVG_MIDDLE, "", "time (s)");
    fprintf(b->file,
            "<text transform=\"translate(14 %.1f) rotate(-90)\" text-anchor=\"middle\">"
            "bearing (degrees)</text>\n",
            centre[1]);
}

/* Half a turn between two samples is the step from 180 to -180 degrees, not a movement. */
static void bearing_draw_line(const struct bearing *b, size_t robot)
{
    struct svg_path path;
    double before_deg = 0;
    svg_path_open(&path, b->file, &b->data->colors[robot], 1.3);
    for (int32_t i = b->data->tracks[robot].first; i >= 0; i = b->data->samples[i].next) {
        const struct report_sample *s = &b->data->samples[i];
        double degrees = remainder((double)s->heading_rad * 180 / M_PI, 360);
        double at[2] = {svg_scale_px(&b->x, (double)s->time_s), svg_scale_px(&b->y, degrees)};
        if (fabs(degrees - before_deg) > 180) {
            svg_path_break(&path);
        }
        svg_path_point(&path, at);
        before_deg = degrees;
    }
    svg_path_close(&path);
}

static void bearing_draw_commands(struct bearing *b)
{
    struct bearing_label label;
    for (unsigned row = 0; row < BEARING_LABEL_ROWS_MAX; row++) {
        b->rows_end_px[row] = 0;
    }
    for (unsigned at = 0; bearing_next_label(b, &at, &label);) {
        bool placed = label.row < BEARING_LABEL_ROWS_MAX;
        double y_px = BEARING_TITLE + (label.row + 0.7) * BEARING_LABEL_ROW;
        double from[2] = {label.px, b->y.from_px};
        double to[2] = {label.px, placed ? y_px + 4 : b->y.to_px};
        double text[2] = {label.left_px + 4, y_px};
        svg_line(b->file, from, to, "stroke=\"#444\" stroke-dasharray=\"5 4\"");
        if (placed) {
            svg_text(b->file, text, SVG_START, "font-size=\"11\"", label.text);
        }
    }
}

void report_write_bearing(FILE *file, const struct report_data *data)
{
    struct bearing b;
    bearing_init(&b, file, data);
    double right_px = b.x.to_px + 24;
    double low_px = fmax(b.y.from_px + BEARING_BOTTOM, b.y.to_px + report_legend_height(data, 0));
    char title[192];
    snprintf(title, sizeof title, "%s: bearing, seed %llu", data->input->experiment->name,
             (unsigned long long)data->input->seed);
    svg_open(file, right_px + report_legend_width(data), low_px, title);
    svg_darken(file, data->colors, data->input->robots_count);
    double at[2] = {b.x.from_px, 24};
    svg_text(file, at, SVG_START, "font-size=\"15\" font-weight=\"600\" fill=\"#111\"", title);
    bearing_draw_axes(&b);
    for (size_t i = 0; i < data->input->robots_count; i++) {
        bearing_draw_line(&b, i);
    }
    bearing_draw_commands(&b);
    report_legend(file, data, right_px, b.y.to_px);
    svg_close(file);
}
