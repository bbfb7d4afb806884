/* SPDX-License-Identifier: Apache-2.0 */
/* muster world draw: what a world holds, as SVG. */
#include "muster/memory.h"
#include "report/drawing/drawing.h"
#include "world/world_load.h"
#include "worldtool/worldtool.h"

#include <math.h>

enum { DRAW_MARGIN = 44, DRAW_NAMED_MAX = 60, DRAW_FIELDS_MAX = 60, DRAW_BRIGHT = 0xe0 };

#define DRAW_WIDTH_PX  760.0
#define DRAW_HEIGHT_PX 760.0

struct draw {
    FILE *file;
    const struct world *world;
    struct svg_scale x, y;
    double px_per_m;
};

static void draw_place(const struct draw *d, const struct world_pose *pose, double at[2])
{
    at[0] = svg_scale_px(&d->x, pose->x_m);
    at[1] = svg_scale_px(&d->y, pose->y_m);
}

static struct world_pose draw_in(const struct world_pose *frame, double x_m, double y_m)
{
    double c = cos(frame->heading_rad);
    double s = sin(frame->heading_rad);
    return (struct world_pose){frame->x_m + c * x_m - s * y_m, frame->y_m + s * x_m + c * y_m,
                               frame->heading_rad};
}

static void draw_init(struct draw *d, FILE *file, const struct world *w)
{
    double width_m = fmax(w->max_x_m - w->min_x_m, 0.1);
    double height_m = fmax(w->max_y_m - w->min_y_m, 0.1);
    double scale = fmin(DRAW_WIDTH_PX / width_m, DRAW_HEIGHT_PX / height_m);
    *d = (struct draw){.file = file, .world = w, .px_per_m = scale};
    d->x = (struct svg_scale){w->min_x_m, w->min_x_m + width_m, DRAW_MARGIN,
                              DRAW_MARGIN + width_m * scale};
    d->y = (struct svg_scale){w->min_y_m, w->min_y_m + height_m, DRAW_MARGIN + height_m * scale,
                              DRAW_MARGIN};
}

static void draw_shape(const struct draw *d, const struct world_shape *shape, const char *style)
{
    double at[2];
    draw_place(d, &shape->pose, at);
    svg_shape(d->file, at, shape, d->px_per_m, style);
}

/* What is nearly as bright as the ground needs a line around it. */
static uint32_t draw_edge(uint32_t rgb)
{
    uint32_t least = DRAW_BRIGHT;
    bool bright = (rgb >> 16 & 255) > least && (rgb >> 8 & 255) > least && (rgb & 255) > least;
    return bright ? 0x999999 : rgb;
}

/* What stands is filled; through what only lies on the floor the ground shines. */
static void draw_shapes(const struct draw *d, bool standing)
{
    char style[128];
    const struct world *w = d->world;
    for (size_t i = 0; i < w->shape_count; i++) {
        const struct world_look *look = &w->shapes[i].look;
        if ((look->stops || look->echoes) == standing) {
            snprintf(style, sizeof style,
                     "fill=\"#%06x\" stroke=\"#%06x\" stroke-width=\".4\" opacity=\"%s\"",
                     look->rgb, draw_edge(look->rgb), standing ? "1" : "0.3");
            draw_shape(d, &w->shapes[i], style);
        }
    }
}

static void draw_objects(const struct draw *d)
{
    char style[96];
    for (size_t i = 0; i < d->world->object_count; i++) {
        const struct world_shape *shape = &d->world->objects[i].shape;
        snprintf(style, sizeof style, "fill=\"#%06x\" stroke=\"#333\" stroke-width=\".6\"",
                 shape->look.rgb);
        draw_shape(d, shape, style);
    }
}

static void draw_field(const struct draw *d, const struct world_robot *robot,
                       const struct world_pose *mount, double range_m, double fov_rad)
{
    struct world_pose from = draw_in(&robot->pose, mount->x_m, mount->y_m);
    struct svg_sector sector = {
        .radius = range_m * d->px_per_m,
        .from_deg = (robot->pose.heading_rad + mount->heading_rad - fov_rad / 2) * 180 / M_PI,
        .span_deg = fov_rad * 180 / M_PI};
    draw_place(d, &from, sector.centre);
    svg_sector(d->file, &sector, "");
}

static void draw_fields(const struct draw *d, const struct world_robot *r)
{
    fputs("<g fill=\"#2b7bba\" fill-opacity=\"0.07\">\n", d->file);
    for (size_t i = 0; i < r->sonar_count; i++) {
        const struct world_sonar *sonar = &r->sonars[i];
        draw_field(d, r, &sonar->pose, sonar->range_max_m, sonar->fov_rad);
    }
    fputs("</g>\n<g fill=\"#c0392b\" fill-opacity=\"0.04\">\n", d->file);
    if (r->laser.samples > 0) {
        draw_field(d, r, &r->laser.pose, r->laser.range_max_m, r->laser.fov_rad);
    }
    fputs("</g>\n<g fill=\"#27ae60\" fill-opacity=\"0.06\">\n", d->file);
    if (r->camera.columns > 0) {
        draw_field(d, r, &r->camera.pose, r->camera.range_m, r->camera.fov_rad);
    }
    fputs("</g>\n<g fill=\"#8e44ad\" fill-opacity=\"0.04\">\n", d->file);
    if (r->finder.range_max_m > 0) {
        draw_field(d, r, &r->finder.pose, r->finder.range_max_m, r->finder.fov_rad);
    }
    fputs("</g>\n", d->file);
}

static void draw_gripper(const struct draw *d, const struct world_robot *robot)
{
    static const char style[] = "fill=\"#777\" stroke=\"#333\" stroke-width=\".6\"";
    const struct world_gripper *g = &robot->gripper;
    struct world_pose mount = draw_in(&robot->pose, g->pose.x_m, g->pose.y_m);
    mount.heading_rad += g->pose.heading_rad;
    struct world_shape piece = {
        .kind = WORLD_BOX, .pose = mount, .half_x_m = g->length_m / 2, .half_y_m = g->width_m / 2};
    draw_shape(d, &piece, style);
    piece.half_x_m = g->paddle_length_m / 2;
    piece.half_y_m = g->paddle_width_m / 2;
    for (int side = -1; side <= 1; side += 2) {
        double aside = g->starts_closed ? piece.half_y_m : g->width_m / 2 - piece.half_y_m;
        piece.pose = draw_in(&mount, (g->length_m + g->paddle_length_m) / 2, side * aside);
        draw_shape(d, &piece, style);
    }
}

/* Its outline, and a line from where it turns to its front. */
static void draw_robot(const struct draw *d, const struct world_robot *r)
{
    char style[96];
    double from[2];
    double to[2];
    struct world_shape outline = {.kind = WORLD_BOX,
                                  .pose = draw_in(&r->pose, r->origin_x_m, r->origin_y_m),
                                  .half_x_m = r->length_m / 2,
                                  .half_y_m = r->width_m / 2};
    struct world_pose front = draw_in(&r->pose, r->origin_x_m + r->length_m / 2, r->origin_y_m);
    if (r->gripper.length_m > 0) {
        draw_gripper(d, r);
    }
    snprintf(style, sizeof style, "fill=\"#%06x\" stroke=\"#222\" stroke-width=\".8\"",
             r->look.rgb);
    draw_shape(d, &outline, style);
    draw_place(d, &r->pose, from);
    draw_place(d, &front, to);
    svg_line(d->file, from, to, "stroke=\"#fff\" stroke-width=\"3\"");
    svg_line(d->file, from, to, "stroke=\"#222\" stroke-width=\"1.6\"");
}

static void draw_names(const struct draw *d)
{
    const struct world *w = d->world;
    for (size_t i = 0; i < w->robot_count && w->robot_count <= DRAW_NAMED_MAX; i++) {
        const struct world_robot *r = &w->robots[i];
        double at[2];
        draw_place(d, &r->pose, at);
        at[1] -= hypot(r->length_m, r->width_m) / 2 * d->px_per_m + 4;
        svg_text(d->file, at, SVG_MIDDLE,
                 "font-size=\"11\" stroke=\"#fff\" stroke-width=\"2.4\" paint-order=\"stroke\"",
                 r->name);
    }
}

/* The ground with a line each so many metres, and their numbers beside it. */
static void draw_ground(const struct draw *d)
{
    double step = svg_tick_step(fmax(d->x.to - d->x.from, d->y.to - d->y.from), 8);
    const struct svg_scale *scales[2] = {&d->x, &d->y};
    char label[SVG_TICK_MAX];
    for (size_t k = 0; k < 2; k++) {
        const struct svg_scale *s = scales[k];
        for (double i = ceil(s->from / step - 1e-9); i * step <= s->to + 1e-9; i++) {
            double px = svg_scale_px(s, i * step);
            double from[2] = {k ? d->x.from_px : px, k ? px : d->y.from_px};
            double to[2] = {k ? d->x.to_px : px, k ? px : d->y.to_px};
            double at[2] = {k ? d->x.from_px - 6 : px, k ? px + 4 : d->y.from_px + 16};
            svg_line(d->file, from, to, "stroke=\"#eceef0\"");
            svg_tick_label(label, i * step);
            svg_text(d->file, at, k ? SVG_END : SVG_MIDDLE, "font-size=\"11\"", label);
        }
    }
}

static void draw_all(const struct draw *d)
{
    const struct world *w = d->world;
    svg_open(d->file, d->x.to_px + DRAW_MARGIN, d->y.from_px + DRAW_MARGIN, w->file);
    draw_ground(d);
    fprintf(d->file,
            "<clipPath id=\"world\"><rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\"/>"
            "</clipPath>\n<g clip-path=\"url(#world)\">\n",
            d->x.from_px, d->y.to_px, d->x.to_px - d->x.from_px, d->y.from_px - d->y.to_px);
    draw_shapes(d, false);
    for (size_t i = 0; i < w->robot_count && w->robot_count <= DRAW_FIELDS_MAX; i++) {
        draw_fields(d, &w->robots[i]);
    }
    draw_shapes(d, true);
    draw_objects(d);
    for (size_t i = 0; i < w->robot_count; i++) {
        draw_robot(d, &w->robots[i]);
    }
    fputs("</g>\n", d->file);
    draw_names(d);
    svg_close(d->file);
}

mu_result world_files_draw(const struct world_files_options *options, FILE *to,
                           struct mu_fault *fault)
{
    struct world *world = mu_startup_alloc(sizeof *world);
    struct world_options how = {.quiet = true, .seed = (uint64_t)options->seed};
    struct draw d;
    MU_TRY(world_open(world, options->file, &how, fault));
    draw_init(&d, to, world);
    draw_all(&d);
    return MU_OK;
}
