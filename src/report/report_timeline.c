/* SPDX-License-Identifier: Apache-2.0 */
/* What happened when: commands, chaos, and what was expected, a row each over one axis of time. */
#include "core/text.h"
#include "report/report_data.h"

#include <math.h>
#include <string.h>

enum { TIME_LEFT = 24, TIME_TOP = 44, TIME_ROW = 24, TIME_BOTTOM = 46, TIME_ROWS_MAX = 40 };
enum { TIME_TEXT_MAX = 120 };
#define TIME_WIDTH_PX  840.0
#define TIME_LETTER_PX 5.9 /* of 11 px text, at most, as a rule of thumb */

struct timeline {
    FILE *file;
    const struct report_data *data;
    struct svg_scale x;
    double y_px;        /* of the next row's top */
    unsigned rows_left; /* that are drawn; more are counted */
    unsigned left_out;
};

static bool row_take(struct timeline *t)
{
    if (t->rows_left == 0) {
        t->left_out++;
        return false;
    }
    t->rows_left--;
    return true;
}

/* Beside a mark: to its right, or to its left where there is more room. */
static void text_beside(const struct timeline *t, double px, const char *text)
{
    char shown[TIME_TEXT_MAX];
    bool cut = !mu_text_copy(shown, sizeof shown, text);
    if (cut) {
        memcpy(shown + sizeof shown - 4, "...", 4);
    }
    bool right = px + 12 + (double)strlen(shown) * TIME_LETTER_PX < t->x.to_px ||
                 px < (t->x.from_px + t->x.to_px) / 2;
    double at[2] = {px + (right ? 9 : -9), t->y_px + TIME_ROW / 2.0 + 4};
    svg_text(t->file, at, right ? SVG_START : SVG_END,
             "font-size=\"11\" stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\" "
             "stroke-linejoin=\"round\"",
             shown);
}

static void command_draw(struct timeline *t, const struct experiment_command *c)
{
    char text[TIME_TEXT_MAX + 8];
    double px = svg_scale_px(&t->x, c->at), y = t->y_px + TIME_ROW / 2.0;
    if (c->at > t->x.to || !row_take(t)) {
        return;
    }
    struct mu_text label = mu_text_in(text, sizeof text);
    for (unsigned i = 0; i < c->targets_count; i++) {
        mu_text_format(&label, "%s%s", i ? ", " : "", c->targets[i]);
    }
    mu_text_format(&label, ": %s%s", c->move ? "move to " : "", c->move ? c->move : c->line);
    fprintf(t->file, "<path d=\"M%.1f %.1f l-5 -4.5 v9 z\" fill=\"#0b5fa5\"/>\n", px + 5, y);
    text_beside(t, px, text);
    t->y_px += TIME_ROW;
}

static void chaos_draw(struct timeline *t, unsigned index)
{
    const struct experiment_chaos *c = &t->data->input->experiment->chaos[index];
    const struct report_chaos *fate = &t->data->input->chaos[index];
    double at_s = fate->done ? fate->at_s : c->when ? t->x.to : fmin(c->at, t->x.to);
    double px = svg_scale_px(&t->x, at_s), y = t->y_px + TIME_ROW / 2.0;
    char text[TIME_TEXT_MAX + 64];
    if (!row_take(t)) {
        return;
    }
    if (fate->done && c->for_s > 0) {
        double end = svg_scale_px(&t->x, fmin(at_s + c->for_s, t->x.to));
        double middle[2] = {(px + end) / 2, y}, half[2] = {(end - px) / 2, TIME_ROW / 2.0 - 4};
        svg_box(t->file, middle, half, 0, "fill=\"#f6c9c4\"");
    }
    fprintf(t->file,
            "<path d=\"M%.1f %.1f l5 5 l-5 5 l-5 -5 z\" fill=\"%s\" stroke=\"#c0271d\"/>\n", px,
            y - 5, fate->done ? "#c0271d" : "#fff");
    snprintf(text, sizeof text, "%s%s%.60s", c->text, fate->done ? "" : ": not done",
             fate->done || !fate->reason[0] ? "" : fate->reason);
    text_beside(t, px, text);
    t->y_px += TIME_ROW;
}

static void events_draw(const struct timeline *t, const char *event, double from_s, double y)
{
    const struct report_events *events = t->data->events;
    unsigned number = experiment_event_find(t->data->input->experiment, event);
    double before_px = -10;
    for (size_t i = 0; (i = report_events_next(events, number, i)) < events->count; i++) {
        double px = svg_scale_px(&t->x, (double)events->at[i].time_s);
        double from[2] = {px, y + 5}, to[2] = {px, y + 10};
        bool counts = (double)events->at[i].time_s >= from_s - 1e-6;
        if (counts && px - before_px >= 1) { /* what looks the same is drawn once */
            svg_line(t->file, from, to, "stroke=\"#333\" stroke-width=\"1.2\"");
            before_px = px;
        }
    }
}

static void expectation_draw(struct timeline *t, unsigned index)
{
    const struct experiment_expectation *e = &t->data->input->experiment->expect[index];
    const struct report_result *result = t->data->result;
    if (!row_take(t)) {
        return;
    }
    double to_s = e->near_robot ? fmin(e->to_s, t->x.to) : t->x.to;
    /* A number is of the whole run; what it has from a time on is only whether it is judged. */
    double from_s = e->statistic || e->objects ? 0 : e->from_s;
    double from_px = svg_scale_px(&t->x, fmin(fmax(from_s, t->x.from), t->x.to));
    double to_px = fmax(svg_scale_px(&t->x, to_s), from_px + 2), y = t->y_px + TIME_ROW / 2.0;
    double middle[2] = {(from_px + to_px) / 2, y};
    double half[2] = {(to_px - from_px) / 2, TIME_ROW / 2.0 - 2};
    svg_box(t->file, middle, half, 0,
            !result->judged[index] ? "fill=\"#eceff1\""
            : result->met[index]   ? "fill=\"#cdebd4\""
                                   : "fill=\"#f6c9c4\"");
    for (unsigned i = 0; i < e->sequence_count; i++) {
        events_draw(t, e->sequence[i], e->from_s, y);
    }
    if (e->never) {
        events_draw(t, e->never, e->from_s, y);
    }
    char text[sizeof result->texts[0] + 8];
    snprintf(text, sizeof text, "%s%s",
             !result->judged[index] ? ""
             : result->met[index]   ? "\xe2\x9c\x93 "
                                    : "\xe2\x9c\x97 ",
             result->texts[index]);
    text_beside(t, from_px, text);
    t->y_px += TIME_ROW;
}

static void axis_draw(const struct timeline *t, double low_px)
{
    char label[SVG_TICK_MAX];
    double step = svg_tick_step(t->x.to - t->x.from, 12);
    for (double i = 0; i * step <= t->x.to + 1e-6; i++) {
        double px = svg_scale_px(&t->x, i * step);
        double from[2] = {px, TIME_TOP - 6}, to[2] = {px, low_px}, at[2] = {px, low_px + 16};
        svg_line(t->file, from, to, "stroke=\"#e4e7ea\"");
        svg_tick_label(label, i * step);
        svg_text(t->file, at, SVG_MIDDLE, "", label);
    }
    double from[2] = {t->x.from_px, low_px}, to[2] = {t->x.to_px, low_px};
    double at[2] = {(t->x.from_px + t->x.to_px) / 2, low_px + 36};
    svg_line(t->file, from, to, "stroke=\"#8b939c\"");
    svg_text(t->file, at, SVG_MIDDLE, "", "time (s)");
}

static unsigned rows_count(const struct report_data *data)
{
    const struct experiment *e = data->input->experiment;
    unsigned rows = e->chaos_count + e->expect_count;
    for (unsigned i = 0; i < e->observer_count; i++) {
        rows += e->observer[i].at <= fmax(data->end_s, 0.1);
    }
    return rows;
}

void report_write_timeline(FILE *file, const struct report_data *data)
{
    const struct experiment *e = data->input->experiment;
    struct timeline t = {.file = file, .data = data, .y_px = TIME_TOP, .rows_left = TIME_ROWS_MAX};
    char title[192], more[64];
    unsigned rows = rows_count(data);
    double low_px = TIME_TOP + fmin(rows, TIME_ROWS_MAX) * TIME_ROW + (rows > TIME_ROWS_MAX) * 20;
    t.x = (struct svg_scale){0, fmax(data->end_s, 0.1), TIME_LEFT, TIME_LEFT + TIME_WIDTH_PX};
    snprintf(title, sizeof title, "%s: what happened when, seed %llu", e->name,
             (unsigned long long)data->input->seed);
    svg_open(file, t.x.to_px + 24, low_px + TIME_BOTTOM, title);
    double at[2] = {TIME_LEFT, 24};
    svg_text(file, at, SVG_START, "font-size=\"15\" font-weight=\"600\" fill=\"#111\"", title);
    axis_draw(&t, low_px);
    for (unsigned i = 0; i < e->observer_count; i++) {
        command_draw(&t, &e->observer[i]);
    }
    for (unsigned i = 0; i < e->chaos_count; i++) {
        chaos_draw(&t, i);
    }
    for (unsigned i = 0; i < e->expect_count; i++) {
        expectation_draw(&t, i);
    }
    if (t.left_out > 0) {
        double below[2] = {TIME_LEFT, t.y_px + 14};
        snprintf(more, sizeof more, "and %u more", t.left_out);
        svg_text(file, below, SVG_START, "fill=\"#666\"", more);
    }
    svg_close(file);
}
