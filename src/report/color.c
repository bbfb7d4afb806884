/* SPDX-License-Identifier: Apache-2.0 */
#include "report/color.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* CSS Color Module Level 4, section 6.1, in alphabetical order. */
static const char *const color_names[] = {
    "aliceblue",
    "antiquewhite",
    "aqua",
    "aquamarine",
    "azure",
    "beige",
    "bisque",
    "black",
    "blanchedalmond",
    "blue",
    "blueviolet",
    "brown",
    "burlywood",
    "cadetblue",
    "chartreuse",
    "chocolate",
    "coral",
    "cornflowerblue",
    "cornsilk",
    "crimson",
    "cyan",
    "darkblue",
    "darkcyan",
    "darkgoldenrod",
    "darkgray",
    "darkgreen",
    "darkgrey",
    "darkkhaki",
    "darkmagenta",
    "darkolivegreen",
    "darkorange",
    "darkorchid",
    "darkred",
    "darksalmon",
    "darkseagreen",
    "darkslateblue",
    "darkslategray",
    "darkslategrey",
    "darkturquoise",
    "darkviolet",
    "deeppink",
    "deepskyblue",
    "dimgray",
    "dimgrey",
    "dodgerblue",
    "firebrick",
    "floralwhite",
    "forestgreen",
    "fuchsia",
    "gainsboro",
    "ghostwhite",
    "gold",
    "goldenrod",
    "gray",
    "green",
    "greenyellow",
    "grey",
    "honeydew",
    "hotpink",
    "indianred",
    "indigo",
    "ivory",
    "khaki",
    "lavender",
    "lavenderblush",
    "lawngreen",
    "lemonchiffon",
    "lightblue",
    "lightcoral",
    "lightcyan",
    "lightgoldenrodyellow",
    "lightgray",
    "lightgreen",
    "lightgrey",
    "lightpink",
    "lightsalmon",
    "lightseagreen",
    "lightskyblue",
    "lightslategray",
    "lightslategrey",
    "lightsteelblue",
    "lightyellow",
    "lime",
    "limegreen",
    "linen",
    "magenta",
    "maroon",
    "mediumaquamarine",
    "mediumblue",
    "mediumorchid",
    "mediumpurple",
    "mediumseagreen",
    "mediumslateblue",
    "mediumspringgreen",
    "mediumturquoise",
    "mediumvioletred",
    "midnightblue",
    "mintcream",
    "mistyrose",
    "moccasin",
    "navajowhite",
    "navy",
    "oldlace",
    "olive",
    "olivedrab",
    "orange",
    "orangered",
    "orchid",
    "palegoldenrod",
    "palegreen",
    "paleturquoise",
    "palevioletred",
    "papayawhip",
    "peachpuff",
    "peru",
    "pink",
    "plum",
    "powderblue",
    "purple",
    "rebeccapurple",
    "red",
    "rosybrown",
    "royalblue",
    "saddlebrown",
    "salmon",
    "sandybrown",
    "seagreen",
    "seashell",
    "sienna",
    "silver",
    "skyblue",
    "slateblue",
    "slategray",
    "slategrey",
    "snow",
    "springgreen",
    "steelblue",
    "tan",
    "teal",
    "thistle",
    "tomato",
    "turquoise",
    "violet",
    "wheat",
    "white",
    "whitesmoke",
    "yellow",
    "yellowgreen",
};

/* What would be too bright on white. */
static const struct {
    const char *name, *shade;
} color_shades[] = {
    {"red", "#d62728"},    {"blue", "#1f77b4"},  {"green", "#2ca02c"},   {"yellow", "#d4a900"},
    {"white", "#9aa5b1"},  {"cyan", "#0aa5b5"},  {"aqua", "#0aa5b5"},    {"lime", "#5cb800"},
    {"pink", "#e377c2"},   {"gold", "#c99700"},  {"magenta", "#c217c2"}, {"orange", "#ff7f0e"},
    {"purple", "#9467bd"}, {"brown", "#8c564b"},
};

/* Ten hues that people tell apart (the "tab10" of Tableau), without those of color_shades first. */
static const char *const color_palette[] = {"#9467bd", "#ff7f0e", "#17becf", "#e377c2", "#8c564b",
                                            "#7f7f7f", "#bcbd22", "#1f77b4", "#d62728", "#2ca02c"};

static int color_compare(const void *key, const void *row)
{
    return strcasecmp(key, *(const char *const *)row);
}

static bool color_is_hex(const char *color)
{
    size_t digits = strspn(color + 1, "0123456789abcdefABCDEF");
    return color[0] == '#' && (digits == 3 || digits == 6) && color[1 + digits] == '\0';
}

bool color_is_css(const char *color)
{
    return (color[0] && color_is_hex(color)) ||
           bsearch(color, color_names, sizeof color_names / sizeof color_names[0],
                   sizeof color_names[0], color_compare) != NULL;
}

const char *color_of_track(const char *wanted, const char *name, size_t index)
{
    const char *const choices[] = {wanted, name};
    for (size_t i = 0; i < sizeof choices / sizeof choices[0]; i++) {
        if (!choices[i] || !color_is_css(choices[i])) {
            continue;
        }
        for (size_t k = 0; k < sizeof color_shades / sizeof color_shades[0]; k++) {
            if (strcasecmp(choices[i], color_shades[k].name) == 0) {
                return color_shades[k].shade;
            }
        }
        return choices[i];
    }
    return color_palette[index % (sizeof color_palette / sizeof color_palette[0])];
}

/* Hues a golden angle apart, in three depths in turn; hue, saturation and lightness as in CSS. */
void color_spread(char color[COLOR_HEX], size_t index)
{
    static const double depths[] = {0.42, 0.58, 0.3};
    static const double thirds[] = {0, 8, 4};
    double hue = fmod((double)index * 137.508, 360) / 30;
    double light = depths[index % 3], reach = 0.65 * fmin(light, 1 - light);
    unsigned bytes[3];
    for (size_t i = 0; i < 3; i++) {
        double k = fmod(thirds[i] + hue, 12);
        double part = light - reach * fmax(-1, fmin(fmin(k - 3, 9 - k), 1));
        bytes[i] = (unsigned)lround(part * 255);
    }
    snprintf(color, COLOR_HEX, "#%02x%02x%02x", bytes[0] & 0xff, bytes[1] & 0xff, bytes[2] & 0xff);
}
