/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file color.h
 * Colours of tracks: CSS, and readable on white.
 */
#ifndef MUSTER_REPORT_COLOR_H
#define MUSTER_REPORT_COLOR_H

#include <stdbool.h>
#include <stddef.h>

/** @return whether CSS understands it: one of its names, or #rgb, or #rrggbb */
bool color_is_css(const char *color);

/**
 * Chooses a track's colour: the wanted one, else one that the robot's name names, else the
 * index-th of a palette.  red, blue, green and yellow become shades that read well on white.
 *
 * @param wanted  may be NULL, and anything
 * @return wanted itself, or a constant
 */
const char *color_of_track(const char *wanted, const char *name, size_t index);

enum { COLOR_HEX = sizeof "#rrggbb" };

/** Writes the index-th of ever so many colours that are as different as so many can be. */
void color_spread(char color[COLOR_HEX], size_t index);

#endif
