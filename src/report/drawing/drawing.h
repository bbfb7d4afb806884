/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file drawing.h
 * Writes the frame of HTML pages, and SVG: a few shapes, things of a world, paths that leave out
 * what cannot be seen, and axes.
 *
 * Lengths are pixels, y downwards.  `style` is trusted text, such as "fill=\"none\""; every other
 * string may hold anything and is escaped.  Errors stay with the FILE.
 */
#ifndef MUSTER_REPORT_DRAWING_H
#define MUSTER_REPORT_DRAWING_H

#include "core/palette.h"
#include "world/model/world.h"

#include <stdbool.h>
#include <stdio.h>

/** Begins a page that stands alone, without scripts, in light and dark; what is given may hold
 * anything and is escaped. */
void page_open(FILE *file, const char *title, const char *heading);

void page_close(FILE *file);

/** Writes text for XML or HTML, in a double-quoted attribute or between tags. */
void svg_escape(FILE *file, const char *text);

/** Starts a picture; on a dark screen its inks are others.  title: what a screen reader says. */
void svg_open(FILE *file, double width, double height, const char *title);

/** Says what colours of it are on a dark screen. */
void svg_darken(FILE *file, const struct palette_color *colors, size_t count);

void svg_close(FILE *file);

void svg_line(FILE *file, const double from[2], const double to[2], const char *style);
void svg_circle(FILE *file, const double centre[2], double radius, const char *style);

/** A rectangle about its centre, turned clockwise. */
void svg_box(FILE *file, const double centre[2], const double half[2], double turn_deg,
             const char *style);

/** What stands in a world: a disc or a box.  @param at  its middle in px */
void svg_shape(FILE *file, const double at[2], const struct world_shape *shape, double px_per_m,
               const char *style);

/** A piece of a cake, counter-clockwise from an angle on; 360 degrees and more are a circle. */
struct svg_sector {
    double centre[2], radius;
    double from_deg, span_deg;
};

void svg_sector(FILE *file, const struct svg_sector *sector, const char *style);

enum svg_anchor { SVG_START, SVG_MIDDLE, SVG_END };

void svg_text(FILE *file, const double at[2], enum svg_anchor anchor, const char *style,
              const char *text);

/* A line through many points; those that move it by less than 0.3 px are left out. */
struct svg_path {
    FILE *file;
    double last[2];    /* the last point written */
    double pending[2]; /* the last point left out */
    bool drawing, has_pending;
};

void svg_path_open(struct svg_path *path, FILE *file, const struct palette_color *color,
                   double width);
void svg_path_point(struct svg_path *path, const double at[2]);

/** Lifts the pen. */
void svg_path_break(struct svg_path *path);
void svg_path_close(struct svg_path *path);

/* Maps values to pixels along one axis. */
struct svg_scale {
    double from, to;       /* values */
    double from_px, to_px; /* where they are */
};

double svg_scale_px(const struct svg_scale *scale, double value);

/** @return a step of 1, 2 or 5 times a power of ten that divides a range into about count parts */
double svg_tick_step(double range, unsigned count);

enum { SVG_TICK_MAX = 32 };

/** Writes a tick's value as print does: a real minus sign, and no minus zero. */
void svg_tick_label(char label[SVG_TICK_MAX], double value);

#endif
