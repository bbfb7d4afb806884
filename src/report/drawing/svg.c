/* SPDX-License-Identifier: Apache-2.0 */
#include "report/drawing/drawing.h"

#include "core/text.h"

#include <math.h>

#define SVG_SEEN_PX 0.3

/* Only what XML 1.0 allows at all. */
static bool svg_code_allowed(uint32_t code)
{
    return code == '\t' || code == '\n' || (code >= 0x20 && code != 0x7f && code < 0xfffd) ||
           code >= 0x10000;
}

void svg_escape(FILE *file, const char *text)
{
    uint32_t code;
    for (size_t len; (len = mu_utf8_next(text, &code)) > 0; text += len) {
        switch (code) {
        case '&': fputs("&amp;", file); break;
        case '<': fputs("&lt;", file); break;
        case '>': fputs("&gt;", file); break;
        case '"': fputs("&quot;", file); break;
        case '\'': fputs("&#39;", file); break;
        default:
            if (svg_code_allowed(code)) {
                fwrite(text, 1, len, file);
            } else {
                fputs(MU_UTF8_BROKEN_TEXT, file);
            }
        }
    }
}

/* What pictures are drawn with, beside the colours of robots. */
static const struct palette_color inks[] = {
    {"#fff", "#15191d", 0},    {"#111", "#eef1f4", 0},    {"#222", "#e4e8ec", 0},
    {"#333", "#dde2e7", 0},    {"#444", "#c6cdd4", 0},    {"#555", "#b4bcc5", 0},
    {"#666", "#a5aeb8", 0},    {"#777", "#9aa5b0", 0},    {"#767f88", "#9aa5b0", 0},
    {"#7d8792", "#94a0ac", 0}, {"#8b939c", "#86919d", 0}, {"#c3c8ce", "#4a535c", 0},
    {"#c9ced3", "#4a535c", 0}, {"#e4e7ea", "#2c343b", 0}, {"#eceef0", "#262d34", 0},
    {"#eceff1", "#262d34", 0}, {"#cdebd4", "#1d4a2b", 0}, {"#f6c9c4", "#5c2522", 0},
    {"#0b5fa5", "#6cb8f0", 0}, {"#c0271d", "#ff7b72", 0}, {"#27ae60", "#4cc26a", 0},
    {"#2b7bba", "#6cb8f0", 0}, {"#8e44ad", "#c79bf2", 0}, {"#c0392b", "#ff7b72", 0},
};

void svg_open(FILE *file, double width, double height, const char *title)
{
    fprintf(file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" width=\"%.0f\" "
            "height=\"%.0f\" role=\"img\" font-family=\"Helvetica, Arial, 'Liberation Sans', "
            "'DejaVu Sans', sans-serif\" font-size=\"12\" fill=\"#333\">\n<title>",
            width, height, width, height);
    svg_escape(file, title);
    fputs("</title>\n", file);
    svg_darken(file, inks, sizeof inks / sizeof inks[0]);
    fprintf(file, "<rect width=\"%.0f\" height=\"%.0f\" fill=\"#fff\"/>\n", width, height);
}

void svg_darken(FILE *file, const struct palette_color *colors, size_t count)
{
    fputs("<style>@media(prefers-color-scheme:dark){", file);
    for (size_t i = 0; i < count; i++) {
        fprintf(file, "[fill=\"%s\"]{fill:%s}[stroke=\"%s\"]{stroke:%s}", colors[i].light,
                colors[i].dark, colors[i].light, colors[i].dark);
    }
    fputs("}</style>\n", file);
}

void svg_close(FILE *file)
{
    fputs("</svg>\n", file);
}

void svg_line(FILE *file, const double from[2], const double to[2], const char *style)
{
    fprintf(file, "<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\" %s/>\n", from[0], from[1],
            to[0], to[1], style);
}

void svg_circle(FILE *file, const double centre[2], double radius, const char *style)
{
    fprintf(file, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\" %s/>\n", centre[0], centre[1], radius,
            style);
}

void svg_box(FILE *file, const double centre[2], const double half[2], double turn_deg,
             const char *style)
{
    fprintf(file, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" ",
            centre[0] - half[0], centre[1] - half[1], 2 * half[0], 2 * half[1]);
    if (fabs(turn_deg) > 1e-6) {
        fprintf(file, "transform=\"rotate(%.3f %.2f %.2f)\" ", turn_deg, centre[0], centre[1]);
    }
    fprintf(file, "%s/>\n", style);
}

void svg_shape(FILE *file, const double at[2], const struct world_shape *shape, double px_per_m,
               const char *style)
{
    const double half[2] = {shape->half_x_m * px_per_m, shape->half_y_m * px_per_m};
    if (shape->kind == WORLD_DISC) {
        svg_circle(file, at, shape->radius_m * px_per_m, style);
    } else {
        svg_box(file, at, half, -shape->pose.heading_rad * 180 / M_PI, style);
    }
}

void svg_sector(FILE *file, const struct svg_sector *sector, const char *style)
{
    const double *at = sector->centre;
    double r = sector->radius;
    if (sector->span_deg >= 360) {
        svg_circle(file, at, r, style);
        return;
    }
    double from = sector->from_deg * M_PI / 180;
    double to = from + sector->span_deg * M_PI / 180;
    fprintf(file, "<path d=\"M%.2f %.2f L%.2f %.2f A%.2f %.2f 0 %d 0 %.2f %.2f Z\" %s/>\n", at[0],
            at[1], at[0] + r * cos(from), at[1] - r * sin(from), r, r, sector->span_deg > 180,
            at[0] + r * cos(to), at[1] - r * sin(to), style);
}

void svg_text(FILE *file, const double at[2], enum svg_anchor anchor, const char *style,
              const char *text)
{
    static const char *const anchors[] = {"start", "middle", "end"};
    fprintf(file, "<text x=\"%.2f\" y=\"%.2f\" text-anchor=\"%s\" %s>", at[0], at[1],
            anchors[anchor], style);
    svg_escape(file, text);
    fputs("</text>\n", file);
}

void svg_path_open(struct svg_path *path, FILE *file, const struct palette_color *color,
                   double width)
{
    static const char *const dashes[] = {"", " stroke-dasharray=\"7 4\"",
                                         " stroke-dasharray=\"1 4\""};
    *path = (struct svg_path){.file = file};
    fprintf(file,
            "<path fill=\"none\" stroke=\"%s\"%s stroke-width=\"%.2f\" stroke-linejoin=\"round\" "
            "stroke-linecap=\"round\" d=\"",
            color->light, dashes[color->pattern], width);
}

static void svg_path_write(struct svg_path *path, const double at[2])
{
    fprintf(path->file, "%s%.1f %.1f", path->drawing ? " " : "M", at[0], at[1]);
    path->drawing = true;
    path->has_pending = false;
    path->last[0] = at[0];
    path->last[1] = at[1];
}

void svg_path_point(struct svg_path *path, const double at[2])
{
    if (path->drawing && hypot(at[0] - path->last[0], at[1] - path->last[1]) < SVG_SEEN_PX) {
        path->has_pending = true;
        path->pending[0] = at[0];
        path->pending[1] = at[1];
        return;
    }
    svg_path_write(path, at);
}

void svg_path_break(struct svg_path *path)
{
    if (path->has_pending) {
        double at[2] = {path->pending[0], path->pending[1]};
        svg_path_write(path, at);
    }
    path->drawing = false;
}

void svg_path_close(struct svg_path *path)
{
    svg_path_break(path);
    fputs("\"/>\n", path->file);
}

double svg_scale_px(const struct svg_scale *scale, double value)
{
    double part = (value - scale->from) / (scale->to - scale->from);
    return scale->from_px + part * (scale->to_px - scale->from_px);
}

double svg_tick_step(double range, unsigned count)
{
    double rough = range / (double)count;
    double power = pow(10, floor(log10(rough)));
    double lead = rough / power;
    return power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
}

void svg_tick_label(char label[SVG_TICK_MAX], double value)
{
    bool zero = fabs(value) < 1e-12;
    snprintf(label, SVG_TICK_MAX, "%s%g", value < 0 && !zero ? "\xe2\x88\x92" : "",
             zero ? 0 : fabs(value));
}
