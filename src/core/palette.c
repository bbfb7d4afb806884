/* SPDX-License-Identifier: Apache-2.0 */
#include "core/palette.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/*
 * Twenty, as far from each other in CIELAB as their names allow (42 on a light ground, 33 on a dark
 * one), each with a contrast to the ground of 2.1, or 3.  rgb: the colour that a world calls so.
 */
static const struct palette_row {
    const char *name;
    uint32_t rgb, light, dark;
} rows[] = {
    {"red", 0xff0000, 0xe70c44, 0xff4433},       {"blue", 0x0000ff, 0x0179d0, 0x338fcc},
    {"green", 0x00ff00, 0x10bc4a, 0x3fee76},     {"yellow", 0xffff00, 0xd99600, 0xfae753},
    {"purple", 0xa020f0, 0x9e58c0, 0xd5b7fa},    {"orange", 0xffa500, 0xff5c00, 0xffab45},
    {"cyan", 0x00ffff, 0x17c3a1, 0x43faff},      {"pink", 0xffc0cb, 0xff69ac, 0xff88d0},
    {"brown", 0xa52a2a, 0x7e602f, 0xc88766},     {"gray", 0xbebebe, 0x7e627c, 0x9ebea4},
    {"magenta", 0xff00ff, 0xdd0ce0, 0xff57f0},   {"yellowgreen", 0x9acd32, 0x9bb500, 0xacfa44},
    {"navy", 0x000080, 0x00145c, 0x6f8fff},      {"teal", 0x008080, 0x005b54, 0x3dd19b},
    {"maroon", 0xb03060, 0x6b001d, 0xf56279},    {"salmon", 0xfa8072, 0xff967a, 0xffe1a3},
    {"skyblue", 0x87ceeb, 0x4bbfe3, 0xa9deff},   {"darkgreen", 0x006400, 0x1b5b00, 0xacd875},
    {"slateblue", 0x6a5acd, 0x432ae0, 0xa068ff}, {"black", 0x000000, 0x0c0415, 0xffd2d7},
};
enum { ROWS = sizeof rows / sizeof rows[0], CHANNELS = 3, NEAR = 48 };

static int channel(uint32_t rgb, int index)
{
    return (int)(rgb >> (8 * (CHANNELS - 1 - index)) & 0xff);
}

/* --- colours of a world that are none of the twenty ------------------------------------------- */

/* Relative luminance, WCAG 2.1. */
static double luminance(const double c[CHANNELS])
{
    static const double weights[CHANNELS] = {0.2126, 0.7152, 0.0722};
    double sum = 0;
    for (int i = 0; i < CHANNELS; i++) {
        double v = c[i] / 255;
        sum += weights[i] * (v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4));
    }
    return sum;
}

static void hex_write(char hex[PALETTE_HEX], const double c[CHANNELS])
{
    snprintf(hex, PALETTE_HEX, "#%02x%02x%02x", (unsigned)lround(c[0]) & 0xff,
             (unsigned)lround(c[1]) & 0xff, (unsigned)lround(c[2]) & 0xff);
}

/* Towards black or white until it can be seen on a ground of the other kind. */
static void shade(char hex[PALETTE_HEX], uint32_t rgb, bool on_light)
{
    double c[CHANNELS];
    for (int i = 0; i < CHANNELS; i++) {
        c[i] = channel(rgb, i);
    }
    for (int n = 0; n < 20 && (on_light ? luminance(c) > 0.45 : luminance(c) < 0.14); n++) {
        for (int i = 0; i < CHANNELS; i++) {
            c[i] += ((on_light ? 0 : 255) - c[i]) * 0.06;
        }
    }
    hex_write(hex, c);
}

/* Hues a golden angle apart; hue, saturation and lightness as in CSS. */
static void spread(char hex[PALETTE_HEX], size_t index, double lightness)
{
    static const double thirds[CHANNELS] = {0, 8, 4};
    double hue = fmod((double)index * 137.508, 360) / 30;
    double reach = 0.65 * fmin(lightness, 1 - lightness), c[CHANNELS];
    for (int i = 0; i < CHANNELS; i++) {
        double k = fmod(thirds[i] + hue, 12);
        c[i] = 255 * (lightness - reach * fmax(-1, fmin(fmin(k - 3, 9 - k), 1)));
    }
    hex_write(hex, c);
}

/* --- the choice ------------------------------------------------------------------------------- */

static bool is_near(uint32_t one, uint32_t other)
{
    int far = 0;
    for (int i = 0; i < CHANNELS; i++) {
        far += abs(channel(one, i) - channel(other, i));
    }
    return far < NEAR;
}

static struct palette_color color_of(size_t row)
{
    struct palette_color c = {.pattern = 0};
    snprintf(c.light, sizeof c.light, "#%06x", (unsigned)rows[row].light);
    snprintf(c.dark, sizeof c.dark, "#%06x", (unsigned)rows[row].dark);
    return c;
}

static struct palette_color own_color(uint32_t rgb)
{
    struct palette_color c = {.pattern = 0};
    for (size_t i = 0; i < ROWS; i++) {
        if (is_near(rows[i].rgb, rgb)) {
            return color_of(i);
        }
    }
    shade(c.light, rgb, true);
    shade(c.dark, rgb, false);
    return c;
}

static struct palette_color other_color(size_t index)
{
    struct palette_color c = {.pattern = 1 + index % 2};
    spread(c.light, index, 0.42);
    spread(c.dark, index, 0.68);
    return c;
}

static bool is_alone(const struct palette_robot *robots, size_t count, size_t robot)
{
    for (size_t i = 0; i < count; i++) {
        bool other = i != robot && robots[i].stands == robots[robot].stands;
        if (other && robots[i].rgb == robots[robot].rgb) {
            return false;
        }
    }
    return true;
}

/* @return whether it has it now: no other robot has */
static bool take(struct palette_color *colors, size_t count, size_t robot, struct palette_color c)
{
    for (size_t i = 0; i < count; i++) {
        if (strcmp(colors[i].light, c.light) == 0) {
            return false;
        }
    }
    colors[robot] = c;
    return true;
}

static void by_own(struct palette_color *colors, const struct palette_robot *robots, size_t count,
                   bool stands)
{
    for (size_t i = 0; i < count; i++) {
        if (robots[i].stands == stands && is_alone(robots, count, i)) {
            (void)take(colors, count, i, own_color(robots[i].rgb));
        }
    }
}

static void by_name(struct palette_color *colors, const struct palette_robot *robots, size_t count,
                    bool stands)
{
    for (size_t i = 0; i < count; i++) {
        bool wants = robots[i].stands == stands && !colors[i].light[0];
        for (size_t row = 0; wants && row < ROWS; row++) {
            if (strcasecmp(robots[i].name, rows[row].name) == 0) {
                (void)take(colors, count, i, color_of(row));
            }
        }
    }
}

static void by_turn(struct palette_color *colors, const struct palette_robot *robots, size_t count,
                    bool stands)
{
    size_t next = 0;
    for (size_t i = 0; i < count; i++) {
        bool wants = robots[i].stands == stands && !colors[i].light[0];
        while (wants && next < ROWS && !take(colors, count, i, color_of(next))) {
            next++;
        }
        if (wants && next == ROWS) {
            colors[i] = other_color(i);
        }
    }
}

void palette_choose(struct palette_color *colors, const struct palette_robot *robots, size_t count)
{
    memset(colors, 0, count * sizeof *colors);
    for (int stands = 0; stands < 2; stands++) {
        by_own(colors, robots, count, stands);
        by_name(colors, robots, count, stands);
        by_turn(colors, robots, count, stands);
    }
}
