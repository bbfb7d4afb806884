/* SPDX-License-Identifier: Apache-2.0 */
/* tracks.svg: the world, and where each robot went; after figure 5 of the paper. */
#include "report/report_data.h"

#include <math.h>

enum { TRACKS_LEFT = 58, TRACKS_TOP = 40, TRACKS_BOTTOM = 54, TRACKS_LABELLED_MAX = 8 };
#define TRACKS_WIDTH_PX      700.0
#define TRACKS_HEIGHT_PX     760.0
#define TRACKS_HEIGHT_MIN_PX 120.0
#define TRACKS_MARK_ROOM_PX  16.0

struct tracks {
    FILE *file;
    const struct report_data *data;
    struct svg_scale x, y;
    double px_per_m;
    double mark_s; /* a dot on each track every so often; 0: none */
};

static void tracks_init(struct tracks *t, FILE *file, const struct report_data *data)
{
    const struct world *w = data->input->world;
    double width_m = fmax(w->max_x_m - w->min_x_m, 0.1);
    double height_m = fmax(w->max_y_m - w->min_y_m, 0.1);
    t->file = file;
    t->data = data;
    t->px_per_m = fmin(TRACKS_WIDTH_PX / width_m, TRACKS_HEIGHT_PX / height_m);
    double width_px = width_m * t->px_per_m;
    double height_px = fmax(height_m * t->px_per_m, TRACKS_HEIGHT_MIN_PX);
    double middle_px = TRACKS_TOP + height_px / 2;
    t->x =
        (struct svg_scale){w->min_x_m, w->min_x_m + width_m, TRACKS_LEFT, TRACKS_LEFT + width_px};
    t->y = (struct svg_scale){w->min_y_m, w->min_y_m + height_m,
                              middle_px + height_m * t->px_per_m / 2,
                              middle_px - height_m * t->px_per_m / 2};
    double span_s = data->end_s - data->start_s;
    bool crowd = data->input->robots_count > REPORT_LEGEND_MAX;
    t->mark_s = span_s > 0 && !crowd ? svg_tick_step(span_s, 5) : 0;
}

static void tracks_place(const struct tracks *t, double x_m, double y_m, double at[2])
{
    at[0] = svg_scale_px(&t->x, x_m);
    at[1] = svg_scale_px(&t->y, y_m);
}

static void tracks_draw_axis(const struct tracks *t, const struct svg_scale *scale, bool upright)
{
    double step = svg_tick_step(fmax(t->x.to - t->x.from, t->y.to - t->y.from), 8);
    double low_px = fmax(t->y.from_px, t->y.to_px);
    char label[SVG_TICK_MAX];
    for (double i = ceil(scale->from / step - 1e-9); i * step <= scale->to + 1e-9; i++) {
        double px = svg_scale_px(scale, i * step);
        double from[2] = {upright ? t->x.from_px : px, upright ? px : low_px};
        double to[2] = {upright ? t->x.to_px : px, upright ? px : t->y.to_px};
        double at[2] = {upright ? from[0] - 8 : px, upright ? px + 4 : low_px + 18};
        svg_line(t->file, from, to, "stroke=\"#eceef0\"");
        svg_tick_label(label, i * step);
        svg_text(t->file, at, upright ? SVG_END : SVG_MIDDLE, "", label);
    }
    double end[2] = {(t->x.from_px + t->x.to_px) / 2, low_px + 40};
    if (!upright) {
        svg_text(t->file, end, SVG_MIDDLE, "", "x (m)");
        return;
    }
    fprintf(t->file,
            "<text transform=\"translate(18 %.1f) rotate(-90)\" text-anchor=\"middle\">y (m)"
            "</text>\n",
            (t->y.from_px + t->y.to_px) / 2);
}

static void tracks_draw_shape(const struct tracks *t, const struct world_shape *shape,
                              const char *style)
{
    double at[2];
    tracks_place(t, shape->pose.x_m, shape->pose.y_m, at);
    svg_shape(t->file, at, shape, t->px_per_m, style);
}

/* What robots drive over has its colour, faintly. */
static void tracks_draw_world(const struct tracks *t)
{
    static const char solid[] = "fill=\"#c3c8ce\" stroke=\"#c3c8ce\" stroke-width=\".6\"";
    const struct world *w = t->data->input->world;
    for (size_t i = 0; i < w->shape_count; i++) {
        char flat[64];
        snprintf(flat, sizeof flat, "fill=\"#%06x\" fill-opacity=\".15\"",
                 (unsigned)w->shapes[i].look.rgb);
        bool stands = w->shapes[i].look.stops || w->shapes[i].look.echoes;
        tracks_draw_shape(t, &w->shapes[i], stands ? solid : flat);
    }
    double centre[2] = {(t->x.from_px + t->x.to_px) / 2, (t->y.from_px + t->y.to_px) / 2};
    double half[2] = {(t->x.to_px - t->x.from_px) / 2, (t->y.from_px - t->y.to_px) / 2};
    svg_box(t->file, centre, half, 0, "fill=\"none\" stroke=\"#8b939c\"");
}

/* Things that can be moved: hollow where they began, filled where they are at the end. */
static void tracks_draw_objects(const struct tracks *t)
{
    const struct report_input *input = t->data->input;
    for (size_t i = 0; i < input->world->object_count; i++) {
        struct world_shape shape = input->world->objects[i].shape;
        char style[96];
        snprintf(style, sizeof style, "fill=\"none\" stroke=\"#%06x\"", (unsigned)shape.look.rgb);
        tracks_draw_shape(t, &shape, style);
        if (i < input->objects_count) {
            shape.pose = input->objects[i].pose;
            snprintf(style, sizeof style, "fill=\"#%06x\" stroke=\"#333\" stroke-width=\".6\"",
                     (unsigned)shape.look.rgb);
            tracks_draw_shape(t, &shape, style);
        }
    }
}

static void tracks_draw_line(const struct tracks *t, size_t robot)
{
    struct svg_path path;
    double at[2];
    svg_path_open(&path, t->file, &t->data->colors[robot], 1.6);
    for (int32_t i = t->data->tracks[robot].first; i >= 0; i = t->data->samples[i].next) {
        const struct report_sample *s = &t->data->samples[i];
        tracks_place(t, (double)s->x_m, (double)s->y_m, at);
        if (s->lifted) {
            svg_path_break(&path);
        }
        svg_path_point(&path, at);
    }
    const struct report_robot_result *end = &t->data->result->robots[robot];
    tracks_place(t, end->final_x_m, end->final_y_m, at);
    svg_path_point(&path, at);
    svg_path_close(&path);
}

static void tracks_draw_time(const struct tracks *t, const double at[2], double time_s)
{
    char label[SVG_TICK_MAX];
    double beside[2] = {at[0] + 5, at[1] - 5};
    svg_circle(t->file, at, 2.2, "fill=\"#fff\" stroke-width=\"1.2\"");
    if (t->data->input->robots_count <= TRACKS_LABELLED_MAX) {
        svg_tick_label(label, time_s);
        svg_text(t->file, beside, SVG_START,
                 "font-size=\"9.5\" stroke=\"#fff\" stroke-width=\"2.4\" paint-order=\"stroke\" "
                 "stroke-linejoin=\"round\"",
                 label);
    }
}

/* Small dots say when; where a robot lingers there is room for one. */
static void tracks_draw_times(const struct tracks *t, size_t robot)
{
    const struct report_robot_result *end = &t->data->result->robots[robot];
    if (!(t->mark_s > 0)) {
        return;
    }
    double next_s = (floor(t->data->start_s / t->mark_s) + 1) * t->mark_s;
    double before[2] = {-TRACKS_MARK_ROOM_PX, 0}, stop[2];
    tracks_place(t, end->final_x_m, end->final_y_m, stop);
    for (int32_t i = t->data->tracks[robot].first; i >= 0; i = t->data->samples[i].next) {
        const struct report_sample *s = &t->data->samples[i];
        if ((double)s->time_s < next_s - 1e-3) {
            continue;
        }
        double at[2];
        tracks_place(t, (double)s->x_m, (double)s->y_m, at);
        if (hypot(at[0] - before[0], at[1] - before[1]) >= TRACKS_MARK_ROOM_PX &&
            hypot(at[0] - stop[0], at[1] - stop[1]) >= TRACKS_MARK_ROOM_PX) {
            tracks_draw_time(t, at, next_s);
            before[0] = at[0];
            before[1] = at[1];
        }
        next_s += t->mark_s;
    }
}

static void tracks_draw_ends(const struct tracks *t, size_t robot)
{
    int32_t first = t->data->tracks[robot].first;
    if (first < 0) {
        return;
    }
    const struct report_robot_result *end = &t->data->result->robots[robot];
    double start[2], stop[2];
    tracks_place(t, (double)t->data->samples[first].x_m, (double)t->data->samples[first].y_m,
                 start);
    tracks_place(t, end->final_x_m, end->final_y_m, stop);
    report_legend_start(t->file, start);
    report_legend_end(t->file, stop);
}

void report_write_tracks(FILE *file, const struct report_data *data)
{
    struct tracks t;
    tracks_init(&t, file, data);
    double right_px = t.x.to_px + 24;
    char title[192];
    snprintf(title, sizeof title, "%s: tracks, seed %llu", data->input->experiment->name,
             (unsigned long long)data->input->seed);
    double low_px = fmax(t.y.from_px + TRACKS_BOTTOM, TRACKS_TOP + report_legend_height(data, 3));
    svg_open(file, right_px + report_legend_width(data), low_px, title);
    svg_darken(file, data->colors, data->input->robots_count);
    double at[2] = {t.x.from_px, 24};
    svg_text(file, at, SVG_START, "font-size=\"15\" font-weight=\"600\" fill=\"#111\"", title);
    tracks_draw_axis(&t, &t.x, false);
    tracks_draw_axis(&t, &t.y, true);
    tracks_draw_world(&t);
    for (size_t i = 0; i < data->input->robots_count; i++) {
        tracks_draw_line(&t, i);
    }
    tracks_draw_objects(&t);
    for (size_t i = 0; i < data->input->robots_count; i++) {
        fprintf(file, "<g stroke=\"%s\" fill=\"%s\">\n", data->colors[i].light,
                data->colors[i].light);
        tracks_draw_times(&t, i);
        tracks_draw_ends(&t, i);
        fputs("</g>\n", file);
    }
    report_legend(file, data, right_px, TRACKS_TOP);
    report_legend_marks(file, right_px, TRACKS_TOP + report_legend_height(data, 0), t.mark_s);
    svg_close(file);
}
